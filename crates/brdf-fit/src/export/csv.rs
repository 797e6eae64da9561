//! A CSV table on a grid of angles, which [`read::csv`](crate::read::csv) reads.

use std::io::{self, Write};

use brdf_core::Geometry;

use super::comments::{origin, parameters};
use super::error::ExportError;
use super::grid::AngleGrid;
use super::material::{Fitted, Material};

/// Writes f_r of every fit on the grid.
///
/// # Errors
///
/// One of several fits has no wavelength; an angle is outside the domain of the model; writing
/// fails.
pub(super) fn write(
    material: &Material,
    grid: &AngleGrid,
    writer: &mut dyn Write,
) -> Result<(), ExportError> {
    let several = material.fits.len() > 1;
    if several && material.fits.iter().any(|fit| fit.wavelength_um.is_none()) {
        material.only()?;
    }
    write_header(material, writer)?;
    for fit in &material.fits {
        for &psi_deg in &grid.psi_deg {
            for &theta_deg in &grid.theta_deg {
                for &phi_deg in &grid.phi_deg {
                    write_row(fit, [psi_deg, theta_deg, phi_deg], writer)?;
                }
            }
        }
    }
    Ok(())
}

fn write_header(material: &Material, writer: &mut dyn Write) -> io::Result<()> {
    for fit in &material.fits {
        writeln!(writer, "# computed from the fit of {}", origin(fit))?;
        writeln!(writer, "# {}", parameters(fit))?;
    }
    writeln!(writer, "# quantity: brdf")?;
    let wavelength = material.fits.iter().any(|fit| fit.wavelength_um.is_some());
    let wavelength = if wavelength { "wavelength_um," } else { "" };
    writeln!(
        writer,
        "{wavelength}psi_deg,theta_deg,phi_deg,brdf_per_sr,n"
    )
}

fn write_row(fit: &Fitted, degrees: [f64; 3], writer: &mut dyn Write) -> Result<(), ExportError> {
    let [psi, theta, phi] = degrees.map(f64::to_radians);
    let geometry = Geometry::new(psi, theta, phi).map_err(ExportError::Geometry)?;
    if let Some(wavelength_um) = fit.wavelength_um {
        write!(writer, "{wavelength_um},")?;
    }
    let [psi_deg, theta_deg, phi_deg] = degrees;
    let (value, n) = (fit.brdf.value(&geometry), fit.brdf.model_parameters().n);
    writeln!(writer, "{psi_deg},{theta_deg},{phi_deg},{value:e},{n}")?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::export::test_fits::of_paper;
    use crate::scan::Measurements;

    fn fitted(wavelength_um: Option<f64>) -> Fitted {
        Fitted {
            wavelength_um,
            ..of_paper([1.211, 0.521, 0.071, 1.6])
        }
    }

    fn written(material: &Material, grid: &str) -> Measurements {
        let mut bytes = Vec::new();
        write(material, &grid.parse().unwrap(), &mut bytes).unwrap();
        Measurements::from_reader(bytes.as_slice()).unwrap()
    }

    #[test]
    fn several_wavelengths_share_a_file_and_a_fit_without_one_is_alone() {
        let material = Material {
            fits: vec![fitted(Some(0.63)), fitted(Some(0.91))],
        };
        let scan = written(&material, "psi=10 theta=20,30");
        assert_eq!(scan.wavelengths(), [Some(0.63), Some(0.91)]);
        assert_eq!(scan.refractive_index.unwrap().at(Some(0.91)), Some(1.6));
        let material = Material {
            fits: vec![fitted(None)],
        };
        assert_eq!(written(&material, "").readings().len(), 8 * 33);
    }

    proptest! {
        #[test]
        fn what_is_written_is_read_again_to_the_last_digit(
            psi in 0.0..89.9_f64,
            theta in -89.9..89.9_f64,
            phi in -180.0..180.0_f64,
        ) {
            let fit = fitted(Some(0.91));
            let material = Material { fits: vec![fit.clone()] };
            let scan = written(&material, &format!("psi={psi} theta={theta} phi={phi}"));
            let reading = scan.readings()[0];
            let read = [reading.psi, reading.theta, reading.phi];
            prop_assert_eq!(read, [psi, theta, phi].map(f64::to_radians));
            prop_assert_eq!(reading.brdf, fit.brdf.value(&reading.geometry().unwrap()));
        }
    }
}
