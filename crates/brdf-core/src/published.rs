//! Table 1 of the paper, the fitted parameters of three lacquers.

use crate::parameters::Parameters;

/// One row of Table 1 of Li, Yan and Wu (2002).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PublishedSample {
    /// The number of the sample in the paper.
    pub sample: &'static str,
    /// The lacquer.
    pub coating: &'static str,
    /// The substrate.
    pub base: &'static str,
    /// The wavelength in micrometres.
    pub wavelength_um: f64,
    /// The refractive index of the lacquer at the wavelength, relative to air.
    pub n: f64,
    /// The fitted parameters.
    pub parameters: Parameters,
    /// The error E of eq. (5) that the paper reports, in percent.
    pub e_percent: f64,
}

/// The rows of Table 1 in the paper's order.
pub const PUBLISHED: [PublishedSample; 6] = [
    row(GREY, 0.44, 1.699, [1.137, 0.0, 0.130], 6.20),
    row(GREY, 0.91, 1.60, [1.211, 0.521, 0.071], 6.47),
    row(YELLOW, 0.62, 1.62, [0.225, 0.246, 0.900], 4.02),
    row(YELLOW, 1.04, 1.56, [0.156, 0.584, 1.338], 3.10),
    row(GREEN, 0.91, 1.44, [0.186, 0.065, 0.177], 2.10),
    row(GREEN, 1.04, 1.43, [0.190, 0.059, 0.166], 1.73),
];

const GREY: [&str; 3] = ["001", "dark grey lacquer", "aluminium"];
const YELLOW: [&str; 3] = ["002", "sand yellow lacquer", "aluminium"];
const GREEN: [&str; 3] = ["003", "green lacquer", "steel"];

const fn row(
    [sample, coating, base]: [&'static str; 3],
    wavelength_um: f64,
    n: f64,
    [k2, kd, k1]: [f64; 3],
    e_percent: f64,
) -> PublishedSample {
    PublishedSample {
        sample,
        coating,
        base,
        wavelength_um,
        n,
        parameters: Parameters { k2, kd, k1 },
        e_percent,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ThreeParameterBrdf;

    #[test]
    fn every_row_is_in_the_domain() {
        for row in PUBLISHED {
            assert!(ThreeParameterBrdf::new(row.parameters, row.n).is_ok());
        }
    }
}
