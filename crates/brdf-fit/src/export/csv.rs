//! Our own table on a grid of angles: what [`crate::read::csv`] reads.

use std::io::{self, Write};
use std::str::FromStr;

use brdf_core::Geometry;

use super::domain::parameters;
use super::material::{Fitted, Material};
use super::target::ExportError;

/// More points are no table that anyone wants to read.
const MOST_POINTS: usize = 10_000_000;

/// The angles of a table, in degrees: every combination of them.
///
/// As text `psi=10:70:20 theta=-85:85:1 phi=0`: for each angle `FROM:TO:STEP`, or numbers between
/// commas. What is left out is as in the default.
#[derive(Debug, Clone, PartialEq)]
pub struct AngleGrid {
    /// Incidence zenith angles, in [0, 90).
    pub psi_deg: Vec<f64>,
    /// View zenith angles, in (-90, 90), positive on the source's side.
    pub theta_deg: Vec<f64>,
    /// View azimuths from the source's.
    pub phi_deg: Vec<f64>,
}

/// The plane of incidence: psi 0, 10, ... 70, theta -80, -75, ... 80 deg.
impl Default for AngleGrid {
    fn default() -> Self {
        let steps = |from: i32, to: i32, step| (from..=to).step_by(step).map(f64::from).collect();
        Self {
            psi_deg: steps(0, 70, 10),
            theta_deg: steps(-80, 80, 5),
            phi_deg: vec![0.0],
        }
    }
}

impl FromStr for AngleGrid {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut grid = Self::default();
        let mut given = Vec::new();
        for part in text.split_whitespace() {
            let expected = || format!("\"{part}\": expected psi=, theta= or phi= and degrees");
            let (name, angles) = part.split_once('=').ok_or_else(expected)?;
            if given.contains(&name) {
                return Err(format!("\"{part}\": {name} stands there twice"));
            }
            given.push(name);
            let (list, limits) = match name {
                "psi" => (&mut grid.psi_deg, 0.0..90.0),
                "theta" => (&mut grid.theta_deg, -90.0..90.0),
                "phi" => (&mut grid.phi_deg, -360.0..360.1),
                _ => return Err(expected()),
            };
            let found = angles_of(angles).map_err(|error| format!("\"{part}\": {error}"))?;
            let outside = found
                .iter()
                .find(|angle| !limits.contains(*angle) || **angle == -90.0);
            if let Some(angle) = outside {
                return Err(format!("\"{part}\": {angle} is out of range"));
            }
            *list = found;
        }
        let points = [&grid.psi_deg, &grid.theta_deg, &grid.phi_deg].map(Vec::len);
        let points = points.into_iter().fold(1_usize, usize::saturating_mul);
        if points > MOST_POINTS {
            return Err(format!("{points} points: expected at most {MOST_POINTS}"));
        }
        Ok(grid)
    }
}

/// `FROM:TO:STEP`, or numbers between commas.
fn angles_of(text: &str) -> Result<Vec<f64>, String> {
    let number = |text: &str| {
        let number = text.trim().parse::<f64>().ok().filter(|n| n.is_finite());
        number.ok_or_else(|| format!("\"{text}\" is not a number"))
    };
    let parts: Vec<&str> = text.split(':').collect();
    match parts.as_slice() {
        [list] => list.split(',').map(number).collect(),
        [from, to, step] => steps(number(from)?, number(to)?, number(step)?),
        _ => Err("expected FROM:TO:STEP, or numbers between commas".to_owned()),
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "checked to be a count that fits"
)]
fn steps(from: f64, to: f64, step: f64) -> Result<Vec<f64>, String> {
    let count = ((to - from) / step + 1e-9).floor();
    if step <= 0.0 || !(0.0..MOST_POINTS as f64).contains(&count) {
        return Err("expected FROM <= TO and a STEP above 0".to_owned());
    }
    // The decimals of the step, not those of its rounding.
    let rounded = |angle: f64| (angle * 1e9).round() / 1e9;
    let angle = |i| rounded(from + f64::from(i) * step);
    Ok((0..=count as u32).map(angle).collect())
}

/// Writes f_r of every fit on the grid.
pub(super) fn write(
    coating: &Material,
    grid: &AngleGrid,
    writer: &mut dyn Write,
) -> Result<(), ExportError> {
    let several = coating.fits.len() > 1;
    if several && coating.fits.iter().any(|fit| fit.wavelength_um.is_none()) {
        coating.only()?;
    }
    write_header(coating, writer)?;
    for fit in &coating.fits {
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

fn write_header(coating: &Material, writer: &mut dyn Write) -> io::Result<()> {
    for fit in &coating.fits {
        let file = fit.file.replace(['\n', '\r'], " ");
        let wavelength = fit
            .wavelength_um
            .map_or_else(String::new, |um| format!(" at {um} um"));
        writeln!(writer, "# computed from the fit of {file}{wavelength}")?;
        writeln!(writer, "# {}", parameters(fit))?;
    }
    writeln!(writer, "# quantity: brdf")?;
    let wavelength = coating.fits.iter().any(|fit| fit.wavelength_um.is_some());
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
    use brdf_core::{Parameters, ThreeParameterBrdf};
    use proptest::prelude::*;

    use super::*;
    use crate::Measurements;

    fn fitted(wavelength_um: Option<f64>) -> Fitted {
        let parameters = Parameters::new(1.211, 0.521, 0.071).unwrap();
        Fitted {
            file: "paint.csv".to_owned(),
            wavelength_um,
            brdf: ThreeParameterBrdf::new(parameters, 1.6).unwrap().into(),
            e_percent: 6.47,
            psi_max_deg: 70.0,
        }
    }

    fn written(coating: &Material, grid: &str) -> Measurements {
        let mut bytes = Vec::new();
        write(coating, &grid.parse().unwrap(), &mut bytes).unwrap();
        Measurements::from_reader(bytes.as_slice()).unwrap()
    }

    #[test]
    fn the_grid_is_read_from_text() {
        let grid: AngleGrid = "psi=10:70:20 theta=-0.2:0.1:0.1 phi=0,90".parse().unwrap();
        assert_eq!(grid.psi_deg, [10.0, 30.0, 50.0, 70.0]);
        assert_eq!(grid.theta_deg, [-0.2, -0.1, 0.0, 0.1]);
        assert_eq!(grid.phi_deg, [0.0, 90.0]);
        assert_eq!("".parse(), Ok(AngleGrid::default()));
    }

    #[test]
    fn grids_that_are_none_are_refused() {
        let error = |text: &str| text.parse::<AngleGrid>().unwrap_err();
        assert!(error("psi=90").contains("90 is out of range"));
        assert!(error("theta=-90").contains("-90 is out of range"));
        assert!(error("psi=1:2").contains("expected FROM:TO:STEP"));
        assert!(error("psi=1:2:0").contains("a STEP above 0"));
        assert!(error("psi=2:1:1").contains("FROM <= TO"));
        assert!(error("gamma=1").contains("expected psi=, theta= or phi="));
        assert!(error("psi=x").contains("\"x\" is not a number"));
        assert!(error("psi=0:89:0.01 theta=-89:89:0.01").contains("at most"));
        assert!(error("psi=0:89:1e-300").contains("a STEP above 0"));
    }

    #[test]
    fn several_wavelengths_stand_in_one_file_and_one_without_alone() {
        let coating = Material {
            fits: vec![fitted(Some(0.63)), fitted(Some(0.91))],
        };
        let scan = written(&coating, "psi=10 theta=20,30");
        assert_eq!(scan.wavelengths(), [Some(0.63), Some(0.91)]);
        assert_eq!(scan.refractive_index.unwrap().at(Some(0.91)), Some(1.6));
        let coating = Material {
            fits: vec![fitted(None)],
        };
        assert_eq!(written(&coating, "").readings().len(), 8 * 33);
    }

    proptest! {
        #[test]
        fn what_is_written_is_read_again_to_the_last_digit(
            psi in 0.0..89.9_f64,
            theta in -89.9..89.9_f64,
            phi in -180.0..180.0_f64,
        ) {
            let fit = fitted(Some(0.91));
            let coating = Material { fits: vec![fit.clone()] };
            let scan = written(&coating, &format!("psi={psi} theta={theta} phi={phi}"));
            let reading = scan.readings()[0];
            let read = [reading.psi, reading.theta, reading.phi];
            prop_assert_eq!(read, [psi, theta, phi].map(f64::to_radians));
            prop_assert_eq!(reading.brdf, fit.brdf.value(&reading.geometry().unwrap()));
        }
    }
}
