//! Which wavelengths of a sample are red, green and blue.

use brdf_core::AnyBrdf;
use brdf_fit::export::{Fitted, MAX_DISTANCE_UM, Material, SelectionError};

/// The BRDFs of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Channels {
    /// Those of red, green and blue, or one for grey.
    pub brdfs: Vec<AnyBrdf>,
    /// Which wavelengths they are, or why the picture is grey.
    pub note: String,
}

/// The BRDFs of red, green and blue among those of a sample, each with its wavelength in micrometres, as
/// the export chooses them; the current one for grey where a colour has none.
pub fn channels(all: &[(Option<f64>, AnyBrdf)], current: (Option<f64>, AnyBrdf)) -> Channels {
    let fits = all.iter().map(|(wavelength_um, brdf)| Fitted {
        file: String::new(),
        wavelength_um: *wavelength_um,
        brdf: *brdf,
        e_percent: 0.0,
        psi_max_deg: 90.0,
    });
    let material = Material {
        fits: fits.collect(),
    };
    let grey = |reason: &str| {
        let at = current
            .0
            .map_or_else(String::new, |um| format!(" at {um} µm"));
        Channels {
            brdfs: vec![current.1],
            note: format!("grey{at}{reason}"),
        }
    };
    if all.len() < 2 {
        return grey(": one wavelength");
    }
    match material.rgb(None) {
        Ok(fits) => {
            let um = fits.map(|fit| fit.wavelength_um.unwrap_or(f64::NAN));
            let [red, green, blue] = um;
            Channels {
                brdfs: fits.map(|fit| fit.brdf).to_vec(),
                note: format!("in colour: {red}, {green}, {blue} µm"),
            }
        }
        Err(SelectionError::NoColour {
            colour, primary_um, ..
        }) => grey(&format!(
            ": no wavelength within {MAX_DISTANCE_UM} µm of {colour} ({primary_um} µm)"
        )),
        Err(error) => grey(&format!(": {error}")),
    }
}

#[cfg(test)]
mod tests {
    use brdf_core::{Family, ModelParameters};

    use super::*;

    fn at(um: f64) -> (Option<f64>, AnyBrdf) {
        let parameters = ModelParameters {
            k2: 0.1,
            kd: um,
            k1: 0.2,
            n: 1.5,
            p: 1.0,
        };
        (Some(um), AnyBrdf::new(Family::Paper, &parameters).unwrap())
    }

    #[test]
    fn the_wavelengths_are_those_of_the_export() {
        let all = [0.4, 0.45, 0.5, 0.55, 0.6, 0.65].map(at);
        let chosen = channels(&all, at(0.5));
        let kd: Vec<f64> = chosen.brdfs.iter().map(|b| b.parameters().kd).collect();
        assert_eq!(kd, [0.6, 0.55, 0.45]);
        assert_eq!(chosen.note, "in colour: 0.6, 0.55, 0.45 µm");
    }

    #[test]
    fn a_picture_without_colours_says_why() {
        let chosen = channels(&[0.55, 0.62, 0.91].map(at), at(0.91));
        assert_eq!(chosen.brdfs, [at(0.91).1]);
        let expected = "grey at 0.91 µm: no wavelength within 0.06 µm of blue (0.464 µm)";
        assert_eq!(chosen.note, expected);
        let one = channels(&[at(0.62)], at(0.62));
        assert_eq!(one.note, "grey at 0.62 µm: one wavelength");
    }
}
