//! ASTM E1392 text in the layout of Cornell University; [`read::astm`](crate::read::astm) describes
//! the format. Angles are in radians, phi_i is 0, and each wavelength has a column.
//!
//! Between the entries f_r is to be interpolated linearly in theta_i, theta_s and phi_s, as libbsdf
//! does. The angles form a grid; phi_s ranges from 0, the source's side, to pi, and the other half
//! of the azimuths mirrors it.

use std::f64::consts::PI;
use std::io::{self, Write};

use brdf_core::{AnyBrdf, Geometry};

use super::comments;
use super::domain::{
    MAX_ZENITH_DEG, continued_geometry, continued_value, dense_near_zero, evenly_spaced,
};
use super::error::ExportError;
use super::interpolated::{Angles, Table, Tabulated};
use super::material::{Fitted, Material};

/// Writes all fits of the material.
///
/// # Errors
///
/// One of several fits has no wavelength; a table within the tolerance is too large; writing fails.
pub(super) fn write(
    material: &Material,
    tolerance: f64,
    writer: &mut dyn Write,
) -> Result<(), ExportError> {
    if material.fits.iter().any(|fit| fit.wavelength_um.is_none()) {
        material.only()?;
    }
    let function = BySphericalAngles {
        brdfs: material.fits.iter().map(|fit| fit.brdf).collect(),
    };
    let table = Table::within(&function, tolerance)
        .map_err(|error| ExportError::tolerance(tolerance, &error))?;
    write_header(&material.fits, tolerance, &table, writer)?;
    let [theta_i, theta_s, phi_s] = &table.axes;
    for (i, theta_i) in theta_i.iter().enumerate() {
        for (j, theta_s) in theta_s.iter().enumerate() {
            for (k, phi_s) in phi_s.iter().enumerate() {
                write!(writer, "{theta_i},0,{theta_s},{phi_s}")?;
                for channel in 0..material.fits.len() {
                    write!(writer, ",{:e}", table.value([i, j, k], channel))?;
                }
                writeln!(writer)?;
            }
        }
    }
    Ok(())
}

fn write_header(
    fits: &[Fitted],
    tolerance: f64,
    table: &Table,
    writer: &mut dyn Write,
) -> io::Result<()> {
    comments::write(fits, tolerance, table, writer)?;
    writeln!(
        writer,
        "# interpolation: linear in theta_i, theta_s and phi_s"
    )?;
    let points: usize = table.axes.iter().map(Vec::len).product();
    writeln!(
        writer,
        "ANGLE_UNIT rad\nMEAS_NAME BRDF\nNUM_POINTS {points}"
    )?;
    let columns: Vec<String> = fits.iter().map(column).collect();
    writeln!(
        writer,
        "VARS theta_i,phi_i,theta_s,phi_s,{}",
        columns.join(",")
    )
}

/// The name of the column of a fit: its wavelength in nanometres, with the decimal digits of the
/// micrometres.
fn column(fit: &Fitted) -> String {
    let Some(um) = fit.wavelength_um else {
        return "BRDF".to_owned();
    };
    let nm = format!("{um}e3").parse().unwrap_or(um * 1e3);
    let nm: f64 = nm;
    format!("{nm}nm")
}

/// f_r of each fit by theta_i, theta_s and phi_s, in radians.
struct BySphericalAngles {
    brdfs: Vec<AnyBrdf>,
}

impl Tabulated for BySphericalAngles {
    type Point = Option<Geometry>;

    fn point(&self, at: Angles) -> Option<Geometry> {
        continued_geometry(at)
    }

    fn channels(&self) -> usize {
        self.brdfs.len()
    }

    fn ranges(&self) -> [(f64, f64); 3] {
        let limit = MAX_ZENITH_DEG.to_radians();
        [(0.0, limit), (0.0, limit), (0.0, PI)]
    }

    fn value(&self, channel: usize, geometry: &Option<Geometry>) -> f64 {
        continued_value(&self.brdfs[channel], geometry.as_ref())
    }

    fn tolerance_applies(&self, _: &Option<Geometry>) -> bool {
        true
    }

    fn samples(&self) -> [Vec<f64>; 3] {
        let thetas = evenly_spaced(0.0, MAX_ZENITH_DEG.to_radians(), 18);
        let forward = dense_near_zero(PI).into_iter().map(|phi| PI - phi);
        [thetas.clone(), thetas, forward.collect()]
    }

    /// Points with equal zenith angles, about the specular direction.
    fn lobe_points(&self, axis: usize, angle: f64) -> Vec<Angles> {
        let [thetas, _, phis] = self.samples();
        match axis {
            0 | 1 => phis.into_iter().map(|phi| [angle, angle, phi]).collect(),
            _ => thetas
                .into_iter()
                .map(|theta| [theta, theta, angle])
                .collect(),
        }
    }

    fn rounded(&self, angle: f64) -> f64 {
        (angle * 1e6).round() / 1e6
    }

    fn is_defined(&self, _: Angles) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::test_fits::of_paper;
    use crate::read::ReadOptions;
    use crate::scan::Format;
    use crate::scan::Measurements;

    fn fitted(wavelength_um: Option<f64>, k1: f64) -> Fitted {
        Fitted {
            wavelength_um,
            ..of_paper([0.225, 0.246, k1, 1.62])
        }
    }

    fn written(fits: Vec<Fitted>) -> Measurements {
        let mut bytes = Vec::new();
        write(&Material { fits }, 3e-2, &mut bytes).unwrap();
        Measurements::from_bytes("a", &bytes, &ReadOptions::default()).unwrap()
    }

    #[test]
    fn what_is_written_is_read_again_to_the_last_digit() {
        let fits = vec![fitted(Some(0.630_79), 0.9), fitted(Some(0.852_23), 0.8)];
        let scan = written(fits.clone());
        assert_eq!(scan.format, Format::Astm);
        assert_eq!(scan.wavelengths(), [Some(0.630_79), Some(0.852_23)]);
        assert!(scan.readings().len() > 1000);
        for reading in scan.readings() {
            let fit = fits
                .iter()
                .find(|fit| fit.wavelength_um == reading.wavelength_um);
            let exact = fit.unwrap().brdf.value(&reading.geometry().unwrap());
            assert_eq!(reading.brdf, exact);
        }
        assert_eq!(
            scan.refractive_index.unwrap().at(Some(0.630_79)),
            Some(1.62)
        );
    }

    #[test]
    fn a_fit_without_a_wavelength_is_written_alone() {
        let scan = written(vec![fitted(None, 0.9)]);
        assert_eq!(scan.wavelengths(), [None]);
        let two = Material {
            fits: vec![fitted(None, 0.9), fitted(Some(0.6), 0.9)],
        };
        let error = write(&two, 3e-2, &mut Vec::new()).unwrap_err().to_string();
        assert!(error.contains("there are several fits"), "{error}");
    }

    #[test]
    fn the_lobe_is_at_the_azimuth_that_readers_of_the_format_expect() {
        let scan = written(vec![fitted(None, 0.3)]);
        let largest = |a: &&crate::Measurement, b: &&crate::Measurement| a.brdf.total_cmp(&b.brdf);
        let near = |r: &&crate::Measurement| (r.psi - 0.5).abs() < 0.1;
        let lobe = scan.readings().iter().filter(near).max_by(largest).unwrap();
        assert_eq!(lobe.phi, PI);
    }
}
