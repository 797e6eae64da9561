//! Zemax tabular BSDF: a table about the specular ray; [`read::zemax`](crate::read::zemax)
//! describes the format.
//!
//! Between the entries f_r is to be interpolated linearly in the incidence angle, the azimuth and
//! the radial angle, as libbsdf does with such files; OpticStudio does not document its
//! interpolation. The incidence angle ends at 85 deg; the views cover the hemisphere, and the
//! tolerance applies up to 85 deg. Below the surface the table continues with the value at the
//! horizon as far as the interpolation above it needs; further down it is 0.

use std::io::{self, Write};

use brdf_core::{AnyBrdf, Geometry};

use super::comments;
use super::domain::{
    MAX_ZENITH_DEG, continued_geometry, continued_value, dense_near_zero, evenly_spaced,
};
use super::error::ExportError;
use super::interpolated::{Angles, Table, Tabulated};
use super::material::Fitted;
use crate::read::zemax::from_specular;

/// Writes the fit as a plane-symmetrical BRDF.
///
/// # Errors
///
/// A table within the tolerance is too large; writing fails.
pub(super) fn write(
    fitted: &Fitted,
    tolerance: f64,
    writer: &mut dyn Write,
) -> Result<(), ExportError> {
    let function = AboutSpecular { brdf: fitted.brdf };
    let table = Table::within(&function, tolerance)
        .map_err(|error| ExportError::tolerance(tolerance, &error))?;
    write_header(fitted, tolerance, &table, writer)?;
    let [incidences, azimuths, _] = &table.axes;
    for (i, psi_deg) in incidences.iter().enumerate() {
        let psi = psi_deg.to_radians();
        let tis = fitted.brdf.hemispherical_reflectance(psi, 1e-6);
        writeln!(writer, "TIS\t{:e}", tis.map_err(ExportError::Geometry)?)?;
        for j in 0..azimuths.len() {
            write_row(&table, i, j, writer)?;
        }
    }
    writeln!(writer, "DataEnd")?;
    Ok(())
}

fn write_row(table: &Table, i: usize, j: usize, writer: &mut dyn Write) -> io::Result<()> {
    for k in 0..table.axes[2].len() {
        let tab = if k == 0 { "" } else { "\t" };
        write!(writer, "{tab}{:e}", table.value([i, j, k], 0))?;
    }
    writeln!(writer)
}

fn write_header(
    fitted: &Fitted,
    tolerance: f64,
    table: &Table,
    writer: &mut dyn Write,
) -> io::Result<()> {
    comments::write(std::slice::from_ref(fitted), tolerance, table, writer)?;
    if let Some(wavelength_um) = fitted.wavelength_um {
        writeln!(writer, "# wavelength_um: {wavelength_um}")?;
    }
    writeln!(
        writer,
        "# interpolation: linear in incidence, azimuth and radial angle"
    )?;
    writeln!(writer, "Source\tMeasured\nSymmetry\tPlaneSymmetrical")?;
    writeln!(
        writer,
        "SpectralContent\tMonochrome\nScatterType\tBRDF\nSampleRotation\t1\n0"
    )?;
    for (name, angles) in ["AngleOfIncidence", "ScatterAzimuth", "ScatterRadial"]
        .iter()
        .zip(&table.axes)
    {
        let list: Vec<String> = angles.iter().map(f64::to_string).collect();
        writeln!(writer, "{name}\t{}\n{}", angles.len(), list.join("\t"))?;
    }
    writeln!(writer, "\nMonochrome\nDataBegin")
}

/// f_r by incidence, azimuth and radial angle about the specular ray, in degrees.
struct AboutSpecular {
    brdf: AnyBrdf,
}

/// A direction pair of the table.
struct Point {
    geometry: Option<Geometry>,
    is_within_limits: bool,
}

impl AboutSpecular {
    /// The view zenith angle in radians, which may be below the surface, and the azimuth.
    fn view([psi_deg, azimuth_deg, radial_deg]: Angles) -> (f64, f64) {
        from_specular(
            psi_deg.to_radians(),
            azimuth_deg.to_radians(),
            radial_deg.to_radians(),
        )
    }
}

impl Tabulated for AboutSpecular {
    type Point = Point;

    fn point(&self, at: Angles) -> Point {
        let (theta, phi) = Self::view(at);
        let limit = MAX_ZENITH_DEG.to_radians();
        Point {
            geometry: continued_geometry([at[0].to_radians(), theta, phi]),
            is_within_limits: at[0] <= MAX_ZENITH_DEG && theta <= limit,
        }
    }

    fn channels(&self) -> usize {
        1
    }

    fn ranges(&self) -> [(f64, f64); 3] {
        [
            (0.0, MAX_ZENITH_DEG),
            (0.0, 180.0),
            (0.0, 2.0 * MAX_ZENITH_DEG),
        ]
    }

    fn value(&self, _: usize, at: &Point) -> f64 {
        continued_value(&self.brdf, at.geometry.as_ref())
    }

    fn tolerance_applies(&self, at: &Point) -> bool {
        at.is_within_limits
    }

    fn samples(&self) -> [Vec<f64>; 3] {
        [
            evenly_spaced(0.0, MAX_ZENITH_DEG, 18),
            evenly_spaced(0.0, 180.0, 19),
            dense_near_zero(2.0 * MAX_ZENITH_DEG),
        ]
    }

    fn lobe_points(&self, _: usize, _: f64) -> Vec<Angles> {
        Vec::new()
    }

    /// To 1e-4 deg: finer than the accuracy of any goniometer, and short to write.
    fn rounded(&self, angle: f64) -> f64 {
        (angle * 1e4).round() / 1e4
    }

    fn is_defined(&self, at: Angles) -> bool {
        Self::view(at).0 < std::f64::consts::FRAC_PI_2
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::test_fits::of_paper;
    use crate::read::ReadOptions;
    use crate::scan::Format;
    use crate::scan::Measurements;

    fn fitted() -> Fitted {
        Fitted {
            wavelength_um: Some(0.62),
            ..of_paper([0.225, 0.246, 0.9, 1.62])
        }
    }

    #[test]
    fn what_is_written_is_read_again_to_the_last_digit() {
        let mut bytes = Vec::new();
        write(&fitted(), 2e-2, &mut bytes).unwrap();
        let scan = Measurements::from_bytes("a", &bytes, &ReadOptions::default()).unwrap();
        assert_eq!(scan.format, Format::Zemax);
        assert_eq!(scan.wavelengths(), [Some(0.62)]);
        assert_eq!(
            scan.refractive_index.as_ref().unwrap().at(Some(0.62)),
            Some(1.62)
        );
        assert!(scan.readings().len() > 1000);
        for reading in scan.readings() {
            let exact = fitted().brdf.value(&reading.geometry().unwrap());
            assert_eq!(reading.brdf, exact);
        }
    }

    #[test]
    fn the_comments_state_the_tolerance_the_domain_and_the_error() {
        let mut bytes = Vec::new();
        write(&fitted(), 2e-2, &mut bytes).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        assert!(text.contains("# tolerance: 0.02 "), "{}", &text[..900]);
        assert!(
            text.contains("# domain: incidence and view up to 85 deg"),
            "{}",
            &text[..900]
        );
        let error = text
            .lines()
            .find_map(|line| line.strip_prefix("# largest_error: "))
            .unwrap();
        let error: f64 = error.split(' ').next().unwrap().parse().unwrap();
        assert!(error > 2e-3 && error <= 2e-2, "{error}");
    }

    #[test]
    fn total_scatter_is_the_hemispherical_reflectance() {
        let mut bytes = Vec::new();
        write(&fitted(), 2e-2, &mut bytes).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        let tis = text
            .lines()
            .find_map(|line| line.strip_prefix("TIS\t"))
            .unwrap();
        let tis: f64 = tis.parse().unwrap();
        // Sample 002 of Table 1 at 0.62 um: 0.54 at normal incidence.
        assert!((tis - 0.54).abs() < 0.005, "{tis}");
    }

    #[test]
    fn a_tolerance_that_is_too_small_is_reported_with_one_that_is_not() {
        let message = write(&fitted(), 1e-3, &mut Vec::new())
            .unwrap_err()
            .to_string();
        assert!(
            message.contains("more than 4000000 entries: expected a tolerance of about "),
            "{message}"
        );
    }
}
