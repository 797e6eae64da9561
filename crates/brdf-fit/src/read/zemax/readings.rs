//! The readings of the values, and the values that are left out.

use std::f64::consts::FRAC_PI_2;

use super::sections::{Block, Header};
use super::specular::from_specular;
use crate::read::conversion::{LeftOut, left_out};
use crate::scan::Measurement;

/// View zenith angles from here on are at the horizon: within the rounding of pi/2, in radians.
const HORIZON: f64 = FRAC_PI_2 - 1e-9;

/// The readings of a file, with the numbers of values that are left out.
#[derive(Default)]
pub(super) struct Readings {
    wavelength_um: Option<f64>,
    pub(super) kept: Vec<Measurement>,
    left: LeftOut,
    zeros: usize,
    repeated: usize,
}

impl Readings {
    /// No readings yet, at a wavelength in micrometres.
    pub(super) fn at(wavelength_um: Option<f64>) -> Self {
        Self {
            wavelength_um,
            ..Self::default()
        }
    }

    /// Adds the values of a block but those that repeat an equal value of the same direction: at
    /// radial angle 0, or at azimuths that differ by whole turns.
    pub(super) fn add(&mut self, block: &Block, header: &Header) {
        let mut values = block.values.iter();
        let first = block.values.first().copied();
        for (i, &azimuth_deg) in header.azimuths.iter().enumerate() {
            let is_specular_again =
                |radial_deg: f64, value| radial_deg == 0.0 && i > 0 && Some(value) == first;
            let turn = azimuth_deg.rem_euclid(360.0);
            let same = header.azimuths[..i]
                .iter()
                .position(|a| a.rem_euclid(360.0) == turn);
            for (j, (&radial_deg, &value)) in header.radials.iter().zip(&mut values).enumerate() {
                let before = same.and_then(|k| block.values.get(k * header.radials.len() + j));
                if is_specular_again(radial_deg, value) || before == Some(&value) {
                    self.repeated += 1;
                } else {
                    self.add_value(block.psi_deg, azimuth_deg, radial_deg, value);
                }
            }
        }
    }

    fn add_value(&mut self, psi_deg: f64, azimuth_deg: f64, radial_deg: f64, value: Option<f64>) {
        let psi = psi_deg.to_radians();
        let (theta, phi) = from_specular(psi, azimuth_deg.to_radians(), radial_deg.to_radians());
        match value {
            _ if psi_deg >= 90.0 || theta >= HORIZON => self.left.beyond += 1,
            None => self.left.not_taken += 1,
            Some(0.0) => self.zeros += 1,
            Some(brdf) => self.kept.push(Measurement {
                wavelength_um: self.wavelength_um,
                psi,
                theta,
                phi,
                brdf,
                sigma: None,
            }),
        }
    }

    /// The sentences that report what was converted and what was left out.
    pub(super) fn conversions(&self, header: &Header) -> Vec<String> {
        let specular = "scatter angles about the specular ray are converted to view angles";
        let mut conversions = vec![specular.to_owned()];
        if header.xyz {
            let y = "of X, Y and Z, Y is read: the BRDF weighted by the luminous efficiency";
            conversions.push(y.to_owned());
        }
        let rotations = header.rotations.len();
        if rotations > 1 {
            conversions.push(format!(
                "{rotations} rotations of the sample are read as one isotropic sample"
            ));
        }
        conversions.extend(self.left.notes());
        conversions.extend(left_out(
            self.zeros,
            "of exactly 0, the format's mark for a value that was not measured,",
        ));
        conversions.extend(left_out(
            self.repeated,
            "that repeat the value of the same direction",
        ));
        conversions
    }
}
