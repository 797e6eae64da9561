//! The fits of a material, and the choice among them by file and by wavelength.

use std::path::Path;

use brdf_core::AnyBrdf;
use serde::{Deserialize, Serialize};

use super::error::SelectionError;
use crate::format::distinct;
use crate::scan::WAVELENGTH_TOLERANCE;

/// The fits of one surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// One fit for each wavelength, in ascending order; at least one.
    pub fits: Vec<Fitted>,
}

/// A fitted BRDF and its origin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fitted {
    /// The file of the scan.
    pub file: String,
    /// Wavelength in micrometres, where the scan states one.
    pub wavelength_um: Option<f64>,
    /// The BRDF: its family and its parameters.
    pub brdf: AnyBrdf,
    /// The error criterion E over the fitted readings, in percent: Li, Yan and Wu (2002), eq. (5).
    pub e_percent: f64,
    /// The largest incidence angle of the readings, in degrees.
    pub psi_max_deg: f64,
}

impl Material {
    /// The fits of one scan, given by its path or its file name; without a name, those of the only
    /// scan.
    ///
    /// # Errors
    ///
    /// [`SelectionError::NoSuchFile`] where no scan has the name; [`SelectionError::SeveralFiles`]
    /// where several have, or where no name is given for several scans.
    pub fn for_file(self, name: Option<&str>) -> Result<Self, SelectionError> {
        let files = distinct(self.fits.iter().map(|fit| fit.file.clone()));
        let Some(name) = name else {
            return match files.len() {
                1 => Ok(self),
                _ => Err(SelectionError::SeveralFiles { available: files }),
            };
        };
        let is_named = |fit: &Fitted| {
            fit.file == name
                || Path::new(&fit.file)
                    .file_name()
                    .is_some_and(|file| file == name)
        };
        let fits: Vec<Fitted> = self.fits.into_iter().filter(is_named).collect();
        let named = distinct(fits.iter().map(|fit| fit.file.clone()));
        match named.len() {
            0 => Err(SelectionError::NoSuchFile {
                name: name.to_owned(),
                available: files,
            }),
            1 => Ok(Self { fits }),
            _ => Err(SelectionError::SeveralFiles { available: named }),
        }
    }

    /// The fit nearest to a wavelength in micrometres.
    ///
    /// # Errors
    ///
    /// [`SelectionError::NoSuchWavelength`] where no fit is within 1 % of the wavelength.
    pub fn at_wavelength(self, wavelength_um: f64) -> Result<Self, SelectionError> {
        let fit = self.fit_at(wavelength_um)?.clone();
        Ok(Self { fits: vec![fit] })
    }

    /// As [`at_wavelength`](Self::at_wavelength), by reference.
    pub(in crate::export) fn fit_at(&self, wavelength_um: f64) -> Result<&Fitted, SelectionError> {
        self.nearest_fit(wavelength_um, WAVELENGTH_TOLERANCE * wavelength_um)
            .ok_or_else(|| SelectionError::NoSuchWavelength {
                wavelength_um,
                available: self.wavelengths(),
            })
    }

    /// The fit nearest to a wavelength and not farther from it than a distance, both in
    /// micrometres.
    pub(in crate::export) fn nearest_fit(
        &self,
        wavelength_um: f64,
        max_distance_um: f64,
    ) -> Option<&Fitted> {
        let distance = |fit: &Fitted| fit.wavelength_um.map(|w| (w - wavelength_um).abs());
        let with_distance = self
            .fits
            .iter()
            .filter_map(|fit| Some((fit, distance(fit)?)));
        with_distance
            .filter(|(_, distance)| *distance <= max_distance_um)
            .min_by(|(_, a), (_, b)| a.total_cmp(b))
            .map(|(fit, _)| fit)
    }

    /// The only fit.
    ///
    /// # Errors
    ///
    /// [`SelectionError::SeveralWavelengths`] where there are several.
    pub fn only(&self) -> Result<&Fitted, SelectionError> {
        match self.fits.as_slice() {
            [fit] => Ok(fit),
            _ => Err(SelectionError::SeveralWavelengths {
                available: self.wavelengths(),
            }),
        }
    }

    /// The wavelengths of the fits as text, each once.
    pub(in crate::export) fn wavelengths(&self) -> Vec<String> {
        distinct(self.fits.iter().map(|fit| match fit.wavelength_um {
            Some(wavelength) => format!("{wavelength} um"),
            None => "unspecified".to_owned(),
        }))
    }
}

impl Fitted {
    /// The wavelength as a suffix to the name of the scan, empty where there is none.
    pub(in crate::export) fn wavelength_suffix(&self) -> String {
        self.wavelength_um
            .map_or_else(String::new, |um| format!(" at {um} um"))
    }
}

#[cfg(test)]
mod tests {
    use brdf_core::Family;

    use super::Material;
    use crate::export::test_fits::{material, of_scan};

    #[test]
    fn the_fits_of_a_file_are_found_by_its_path_or_its_name() {
        for name in ["a/x.csv", "x.csv"] {
            let found = material().for_file(Some(name)).unwrap();
            assert_eq!(found.fits, material().fits[..3]);
        }
        let error = material().for_file(Some("z.csv")).unwrap_err().to_string();
        assert_eq!(error, "no fit of z.csv: expected one of a/x.csv, b/y.csv");
        let error = material().for_file(None).unwrap_err().to_string();
        let expected = "there are fits of several files: choose one of a/x.csv, b/y.csv";
        assert_eq!(error, expected);
        let mut two = material();
        two.fits.push(of_scan("b/x.csv", Some(0.5), Family::Paper));
        let error = two.for_file(Some("x.csv")).unwrap_err().to_string();
        let expected = "there are fits of several files: choose one of a/x.csv, b/x.csv";
        assert_eq!(error, expected);
        let alone = material().for_file(Some("y.csv")).unwrap();
        assert_eq!(alone.clone().for_file(None).unwrap(), alone);
    }

    #[test]
    fn the_nearest_wavelength_within_one_percent_is_taken() {
        for (wanted, expected) in [(0.5, 0.5), (0.502, 0.503), (0.899, 0.9), (0.498, 0.5)] {
            let found = material().at_wavelength(wanted).unwrap();
            assert_eq!(found.only().unwrap().wavelength_um, Some(expected));
        }
        for wanted in [0.494, 0.91, f64::NAN] {
            let error = material().at_wavelength(wanted).unwrap_err().to_string();
            let expected = format!(
                "no fit at {wanted} um: expected one of 0.5 um, 0.503 um, 0.9 um, unspecified"
            );
            assert_eq!(error, expected);
        }
    }

    #[test]
    fn of_thousands_of_fits_the_first_are_named_and_the_others_counted() {
        let fits = (0_u32..3000).map(|i| {
            let wavelength_um = Some(f64::from(1000 + i % 1500));
            of_scan(&format!("{}.csv", i / 1500), wavelength_um, Family::Paper)
        });
        let many = Material {
            fits: fits.collect(),
        };
        let error = many.only().unwrap_err().to_string();
        assert!(error.contains("1000 um, 1001 um, "), "{error}");
        assert!(error.ends_with(", 1019 um and 1480 others"), "{error}");
        let error = many.for_file(None).unwrap_err().to_string();
        assert!(error.ends_with("choose one of 0.csv, 1.csv"), "{error}");
    }

    #[test]
    fn of_several_fits_none_is_the_only_one() {
        let error = material().only().unwrap_err().to_string();
        assert_eq!(
            error,
            "there are several fits: choose one of the wavelengths 0.5 um, 0.503 um, 0.9 um, unspecified"
        );
    }
}
