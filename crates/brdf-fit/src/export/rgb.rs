//! Red, green and blue of a coating.

use super::material::{Fitted, Material, MaterialError};
use crate::read::merl::Channel;

/// The colours, in the order of [`Material::rgb`].
pub const COLOURS: [&str; 3] = [
    Channel::Red.name(),
    Channel::Green.name(),
    Channel::Blue.name(),
];

/// The wavelengths of the colours in micrometres.
pub const PRIMARIES_UM: [f64; 3] = [
    Channel::Red.wavelength_um(),
    Channel::Green.wavelength_um(),
    Channel::Blue.wavelength_um(),
];

/// How far from its primary the fit of a colour may be, in micrometres.
pub const REACH_UM: f64 = 0.06;

impl Material {
    /// The fits that stand for red, green and blue: those of the wavelengths that are given, in
    /// micrometres; the only fit there is, for grey; or those nearest to the [`PRIMARIES_UM`].
    ///
    /// Errors: a fit is not within 1 % of its wavelength, or, where none is given, not within
    /// [`REACH_UM`] of its primary.
    pub fn rgb(&self, wavelengths_um: Option<[f64; 3]>) -> Result<[&Fitted; 3], MaterialError> {
        if let Some([red, green, blue]) = wavelengths_um {
            let fit = |wavelength_um| self.at_wavelength(wavelength_um);
            return Ok([fit(red)?, fit(green)?, fit(blue)?]);
        }
        if let [fit] = self.fits.as_slice() {
            return Ok([fit; 3]);
        }
        let fit = |i| {
            self.within(PRIMARIES_UM[i], REACH_UM)
                .ok_or_else(|| MaterialError::NoColour {
                    colour: COLOURS[i],
                    primary_um: PRIMARIES_UM[i],
                    reach_um: REACH_UM,
                    found: self.wavelengths(),
                })
        };
        Ok([fit(0)?, fit(1)?, fit(2)?])
    }
}

#[cfg(test)]
mod tests {
    use brdf_core::{AnyBrdf, Family, ModelParameters};

    use super::*;

    fn coating(wavelengths_um: &[Option<f64>]) -> Material {
        let at = ModelParameters {
            k2: 1.0,
            kd: 0.1,
            k1: 0.1,
            n: 1.5,
            p: 1.0,
        };
        let fits = wavelengths_um.iter().map(|&wavelength_um| Fitted {
            file: "scan.csv".to_owned(),
            wavelength_um,
            brdf: AnyBrdf::new(Family::Paper, &at).unwrap(),
            e_percent: 1.0,
            psi_max_deg: 60.0,
        });
        Material {
            fits: fits.collect(),
        }
    }

    fn colours(coating: &Material, wavelengths_um: Option<[f64; 3]>) -> [Option<f64>; 3] {
        coating
            .rgb(wavelengths_um)
            .unwrap()
            .map(|f| f.wavelength_um)
    }

    #[test]
    fn one_fit_is_grey_whatever_its_wavelength() {
        for wavelength in [None, Some(1.04)] {
            assert_eq!(colours(&coating(&[wavelength]), None), [wavelength; 3]);
        }
    }

    #[test]
    fn the_nearest_to_the_primaries_are_taken() {
        let spectrum = [0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 1.04].map(Some);
        let expected = [0.6, 0.55, 0.45].map(Some);
        assert_eq!(colours(&coating(&spectrum), None), expected);
    }

    #[test]
    fn a_colour_without_a_fit_is_an_error_that_says_what_to_do() {
        let coating = coating(&[Some(0.55), Some(0.62), Some(0.91)]);
        assert_eq!(
            coating.rgb(None).unwrap_err().to_string(),
            "no fit within 0.06 um of blue (0.464 um): expected --wavelength UM, for grey, or --rgb \
             RED,GREEN,BLUE, of 0.55 um, 0.62 um, 0.91 um"
        );
    }

    #[test]
    fn named_wavelengths_are_taken_within_one_percent() {
        let coating = coating(&[None, Some(0.62), Some(0.91), Some(1.04)]);
        let expected = [1.04, 0.91, 0.62].map(Some);
        assert_eq!(colours(&coating, Some([1.04, 0.905, 0.62])), expected);
        let error = coating.rgb(Some([1.04, 0.8, 0.62])).unwrap_err();
        assert!(error.to_string().starts_with("no fit of 0.8 um: expected"));
    }
}
