//! The fits of a material that represent red, green and blue.

use super::material::{Fitted, Material, SelectionError};
use crate::read::merl::Channel;

/// The colours, in the order of [`Material::rgb`].
pub const COLOURS: [&str; 3] = [
    Channel::Red.name(),
    Channel::Green.name(),
    Channel::Blue.name(),
];

/// The wavelengths of the colours in micrometres: the dominant wavelengths of the sRGB primaries.
pub const PRIMARY_WAVELENGTHS_UM: [f64; 3] = [
    Channel::Red.wavelength_um(),
    Channel::Green.wavelength_um(),
    Channel::Blue.wavelength_um(),
];

/// The largest distance of a fit from the wavelength of the colour it represents, in micrometres.
pub const MAX_DISTANCE_UM: f64 = 0.06;

impl Material {
    /// The fits that represent red, green and blue: those at the given wavelengths in micrometres.
    /// Without wavelengths they are the only fit three times, for grey, or the fits nearest to the
    /// [`PRIMARY_WAVELENGTHS_UM`].
    ///
    /// # Errors
    ///
    /// [`SelectionError::NoSuchWavelength`] where no fit is within 1 % of a given wavelength;
    /// [`SelectionError::NoColour`] where none is within [`MAX_DISTANCE_UM`] of that of a colour.
    pub fn rgb(&self, wavelengths_um: Option<[f64; 3]>) -> Result<[&Fitted; 3], SelectionError> {
        if let Some([red, green, blue]) = wavelengths_um {
            let fit = |wavelength_um| self.fit_at(wavelength_um);
            return Ok([fit(red)?, fit(green)?, fit(blue)?]);
        }
        if let [fit] = self.fits.as_slice() {
            return Ok([fit; 3]);
        }
        let fit = |i| {
            self.nearest_fit(PRIMARY_WAVELENGTHS_UM[i], MAX_DISTANCE_UM)
                .ok_or_else(|| SelectionError::NoColour {
                    colour: COLOURS[i],
                    primary_um: PRIMARY_WAVELENGTHS_UM[i],
                    max_distance_um: MAX_DISTANCE_UM,
                    available: self.wavelengths(),
                })
        };
        Ok([fit(0)?, fit(1)?, fit(2)?])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::test_fits::of_paper;

    fn material(wavelengths_um: &[Option<f64>]) -> Material {
        let fits = wavelengths_um.iter().map(|&wavelength_um| Fitted {
            wavelength_um,
            ..of_paper([1.0, 0.1, 0.1, 1.5])
        });
        Material {
            fits: fits.collect(),
        }
    }

    fn colours(material: &Material, wavelengths_um: Option<[f64; 3]>) -> [Option<f64>; 3] {
        material
            .rgb(wavelengths_um)
            .unwrap()
            .map(|f| f.wavelength_um)
    }

    #[test]
    fn one_fit_is_grey_whatever_its_wavelength() {
        for wavelength in [None, Some(1.04)] {
            assert_eq!(colours(&material(&[wavelength]), None), [wavelength; 3]);
        }
    }

    #[test]
    fn the_nearest_to_the_primaries_are_taken() {
        let spectrum = [0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 1.04].map(Some);
        let expected = [0.6, 0.55, 0.45].map(Some);
        assert_eq!(colours(&material(&spectrum), None), expected);
    }

    #[test]
    fn a_colour_without_a_fit_is_an_error_that_says_what_to_do() {
        let material = material(&[Some(0.55), Some(0.62), Some(0.91)]);
        assert_eq!(
            material.rgb(None).unwrap_err().to_string(),
            "no fit within 0.06 um of blue (0.464 um): choose one wavelength, for grey, or those of red, \
             green and blue, from 0.55 um, 0.62 um, 0.91 um"
        );
    }

    #[test]
    fn named_wavelengths_are_taken_within_one_percent() {
        let material = material(&[None, Some(0.62), Some(0.91), Some(1.04)]);
        let expected = [1.04, 0.91, 0.62].map(Some);
        assert_eq!(colours(&material, Some([1.04, 0.905, 0.62])), expected);
        let error = material.rgb(Some([1.04, 0.8, 0.62])).unwrap_err();
        assert!(error.to_string().starts_with("no fit at 0.8 um: expected"));
    }
}
