//! The readings of the tables, and the values that are left out.

use super::header::{Header, Reflectances, is_percent};
use super::lines::Lines;
use super::table::Table;
use crate::format::{counted, shortest};
use crate::read::angles::{AngleUnit, TwoDirections};
use crate::read::conversion::{BEYOND_HORIZON, left_out};
use crate::read::error::ReadError;
use crate::read::number::is_reading;
use crate::scan::Measurement;

/// The largest number of readings of an `.anisotropicbsdf`, whose spectrum may multiply them.
const MOST_READINGS: usize = 4 << 20;

/// The azimuth of the source in degrees: phi = 0 is the forward side.
const SOURCE_AZIMUTH: f64 = 180.0;

/// The readings of a file, with the numbers of values that are left out.
#[derive(Default)]
pub(super) struct Readings {
    pub(super) kept: Vec<Measurement>,
    beyond: usize,
    zeros: usize,
    repeated: usize,
    /// Tables of other anisotropy angles with the values of the first one.
    repeated_tables: usize,
    /// The smallest and the largest factor of the values.
    factors: Option<(f64, f64)>,
    /// What is read of a spectrum that scales all tables.
    spectrum: Option<String>,
}

impl Readings {
    /// Adds the tables of a `.brdf`: for each incidence one for each wavelength.
    ///
    /// # Errors
    ///
    /// A table is not as expected, or its values cannot be normalised.
    pub(super) fn add_spectral(
        &mut self,
        lines: &mut Lines<'_>,
        header: &Header,
        wavelengths: &[f64],
    ) -> Result<(), ReadError> {
        let incidences = header.incidences.iter().flat_map(|(_, all)| all);
        for &psi_deg in incidences {
            for &wavelength in wavelengths {
                let percent = lines.numbers(1, "a reflectance in percent", is_percent)?;
                let reflectance = percent.first().copied().unwrap_or(0.0) / 100.0;
                let table = Table::read(lines)?;
                let integral = integral(lines, header, &table)?;
                let factor = reflectance / integral;
                let at = [(Some(wavelength), 1.0)];
                self.add(lines, header, psi_deg, &table, factor, &at)?;
            }
        }
        if header.has_transmission {
            return Ok(());
        }
        end(lines)
    }

    /// Adds the tables of an `.anisotropicbsdf`.
    ///
    /// # Errors
    ///
    /// A table is not as expected, the values cannot be normalised, or they depend on the anisotropy
    /// angle.
    pub(super) fn add_anisotropic(
        &mut self,
        lines: &mut Lines<'_>,
        header: &Header,
        spectrum: &Reflectances,
    ) -> Result<(), ReadError> {
        let mut angles = header.incidences.iter();
        let Some((first_angle, incidences)) = angles.next() else {
            return Ok(());
        };
        let mut tables = Vec::new();
        for &psi_deg in incidences {
            tables.push((psi_deg, Table::read(lines)?));
        }
        for (angle, incidences) in angles {
            for (i, &psi_deg) in incidences.iter().enumerate() {
                let table = Table::read(lines)?;
                let repeats = tables
                    .get(i)
                    .is_some_and(|(psi, first)| *psi == psi_deg && first.values == table.values);
                if !repeats {
                    let message = format!(
                        "the table of the incidence {psi_deg} deg differs between the anisotropy \
                         angles {first_angle} and {angle} deg: the sample is anisotropic and cannot \
                         be read because the model is isotropic, expected one anisotropy angle"
                    );
                    return Err(lines.text.line_error(table.line, message));
                }
                self.repeated_tables += 1;
            }
        }
        let factor = factor_at(lines, header, &tables, spectrum.psi_deg)?;
        let values = tables.iter().map(|(_, table)| table.values.len()).sum();
        let at = self.wavelengths(spectrum, values);
        for (psi_deg, table) in &tables {
            self.add(lines, header, *psi_deg, table, factor, &at)?;
        }
        Ok(())
    }

    /// The wavelengths at which a distribution is read, with the reflectances.
    fn wavelengths(&mut self, spectrum: &Reflectances, values: usize) -> Vec<(Option<f64>, f64)> {
        let all = &spectrum.at;
        let reflectances = || all.iter().map(|(_, reflectance)| *reflectance);
        let (lowest, highest) = (
            reflectances().fold(f64::INFINITY, f64::min),
            reflectances().fold(0.0, f64::max),
        );
        let one = "one distribution is scaled by a spectrum";
        if lowest == highest {
            let percent = shortest(100.0 * highest);
            self.spectrum = Some(format!(
                "{one}, {percent} % at {}: it is read without a wavelength",
                counted(all.len(), "wavelength")
            ));
            return vec![(None, highest)];
        }
        if values.saturating_mul(all.len()) <= MOST_READINGS {
            let wavelengths = counted(all.len(), "wavelength");
            self.spectrum = Some(format!(
                "{one}: f_r at its {wavelengths} differs by factors only"
            ));
            let each = all
                .iter()
                .map(|(um, reflectance)| (Some(*um), *reflectance));
            return each.collect();
        }
        let distance = |um: f64| (um - 0.555).abs();
        let nearest = all
            .iter()
            .min_by(|a, b| distance(a.0).total_cmp(&distance(b.0)));
        self.spectrum = nearest.map(|(um, _)| {
            format!(
                "{one}: of its {}, {um} um is read, the nearest to 0.555 um; f_r at the others \
                 differs by factors only",
                counted(all.len(), "wavelength")
            )
        });
        nearest
            .map(|(um, reflectance)| (Some(*um), *reflectance))
            .into_iter()
            .collect()
    }

    /// Adds the values of a table, times a factor and that of each wavelength.
    ///
    /// # Errors
    ///
    /// A product is out of range.
    fn add(
        &mut self,
        lines: &Lines<'_>,
        header: &Header,
        psi_deg: f64,
        table: &Table,
        factor: f64,
        wavelengths: &[(Option<f64>, f64)],
    ) -> Result<(), ReadError> {
        let start = self.kept.len();
        for (_, scale) in wavelengths.iter().filter(|_| factor > 0.0) {
            let factor = factor * scale;
            let (low, high) = self.factors.unwrap_or((factor, factor));
            self.factors = Some((low.min(factor), high.max(factor)));
        }
        for (theta_deg, row) in table.rows() {
            let repeats = repeats(theta_deg, &table.phis_deg, row);
            for ((&phi_deg, &value), repeats) in table.phis_deg.iter().zip(row).zip(repeats) {
                let directions = TwoDirections {
                    theta_i: psi_deg,
                    phi_i: SOURCE_AZIMUTH,
                    theta_s: theta_deg,
                    phi_s: phi_deg,
                };
                let count = wavelengths.len();
                match directions.in_model(AngleUnit::Degrees) {
                    None => self.beyond += count,
                    Some(_) if value == 0.0 => self.zeros += count,
                    Some(_) if repeats => self.repeated += count,
                    Some((psi, theta, phi)) => {
                        let cosine = if header.is_intensity {
                            theta.cos()
                        } else {
                            1.0
                        };
                        let each = wavelengths
                            .iter()
                            .map(|(wavelength_um, scale)| Measurement {
                                wavelength_um: *wavelength_um,
                                psi,
                                theta,
                                phi,
                                brdf: value * (factor * scale) / cosine,
                                sigma: None,
                            });
                        self.kept.extend(each);
                    }
                }
            }
        }
        let mut added = self.kept.iter().skip(start);
        match added.find(|reading| !is_reading(reading.brdf)) {
            None => Ok(()),
            Some(reading) => {
                let message = format!(
                    "the values of the table are out of range: f_r would be {:e} 1/sr",
                    reading.brdf
                );
                Err(lines.text.line_error(table.line, message))
            }
        }
    }

    /// The sentences that report what was converted and what was left out.
    pub(super) fn conversions(&self, header: &Header) -> Vec<String> {
        let kind = if header.is_intensity {
            "values are proportional to f_r cos theta"
        } else {
            "values are proportional to f_r"
        };
        let factors = self.factors.map(|(low, high)| {
            let (low, high) = (shortest(low), shortest(high));
            let by = if low == high {
                low
            } else {
                format!("{low} to {high}")
            };
            format!("{kind}: they are scaled to the stated reflectances, by {by}")
        });
        let mut conversions: Vec<String> = factors.into_iter().collect();
        conversions.extend(self.spectrum.clone());
        conversions
            .push("azimuth 0 is the forward side: azimuths are rotated by 180 deg".to_owned());
        if header.has_transmission {
            conversions.push("the tables of transmission are not read".to_owned());
        }
        if self.repeated_tables > 0 {
            conversions.push(format!(
                "{} of other anisotropy angles with the values of the first one: the sample is read \
                 as isotropic",
                counted(self.repeated_tables, "table")
            ));
        }
        conversions.extend(left_out(self.beyond, BEYOND_HORIZON));
        let zeros = "of exactly 0, the format's mark for a value that was not measured,";
        conversions.extend(left_out(self.zeros, zeros));
        let repeated = "that repeat the value of the same direction";
        conversions.extend(left_out(self.repeated, repeated));
        conversions
    }
}

/// Whether each value of a row repeats an equal value of the same direction: at theta = 0, or at the
/// last azimuth where it is a whole turn after the first one.
fn repeats(theta_deg: f64, phis_deg: &[f64], row: &[f64]) -> Vec<bool> {
    let first = phis_deg.first().copied().unwrap_or(0.0);
    let same = |phi_deg: f64| theta_deg == 0.0 || phi_deg - first == 360.0;
    let is_repeated = |(i, (phi_deg, value)): (usize, (&f64, &f64))| {
        i > 0 && same(*phi_deg) && Some(value) == row.first()
    };
    phis_deg
        .iter()
        .zip(row)
        .enumerate()
        .map(is_repeated)
        .collect()
}

/// The integral over the hemisphere of f_r cos theta times a constant; infinite for a table of zeros,
/// which is not measured.
fn integral(lines: &Lines<'_>, header: &Header, table: &Table) -> Result<f64, ReadError> {
    let error = |message: &str| Err(lines.text.line_error(table.line, message));
    if table.values.iter().all(|value| *value == 0.0) {
        return Ok(f64::INFINITY);
    }
    match table.integral(header.is_intensity) {
        Some(integral) if integral > 0.0 && integral.is_finite() => Ok(integral),
        Some(_) => error(
            "the values of the table reflect no light: expected positive values, which are \
             normalised to a reflectance",
        ),
        None => error(
            "phi covers neither 180 nor 360 deg: expected a table over the hemisphere, whose values \
             are normalised to a reflectance",
        ),
    }
}

/// The factor of all tables of an `.anisotropicbsdf` for a reflectance of 1 at an incidence in degrees.
fn factor_at(
    lines: &Lines<'_>,
    header: &Header,
    tables: &[(f64, Table)],
    psi_deg: f64,
) -> Result<f64, ReadError> {
    let nearest = |is_side: fn(f64, f64) -> bool| {
        let side = tables.iter().filter(|(psi, _)| is_side(*psi, psi_deg));
        side.min_by(|a, b| {
            let distance = |psi: f64| (psi - psi_deg).abs();
            distance(a.0).total_cmp(&distance(b.0))
        })
    };
    let factor = |(_, table): &(f64, Table)| Ok(1.0 / integral(lines, header, table)?);
    match (nearest(|psi, at| psi <= at), nearest(|psi, at| psi >= at)) {
        (Some(below), Some(above)) if above.0 > below.0 => {
            let part = (psi_deg - below.0) / (above.0 - below.0);
            Ok(factor(below)? * (1.0 - part) + factor(above)? * part)
        }
        (Some(one), _) | (None, Some(one)) => factor(one),
        (None, None) => Ok(0.0),
    }
}

/// # Errors
///
/// Anything but the last line of some writers follows the tables.
fn end(lines: &mut Lines<'_>) -> Result<(), ReadError> {
    while let Ok(line) = lines.any("nothing") {
        let line = line.trim_ascii();
        if !line.is_empty() && !line.eq_ignore_ascii_case(b"End of file") {
            let message = "a line follows the last table: expected as many tables as there are \
                           incidence angles and wavelengths";
            return Err(lines.error(message));
        }
    }
    Ok(())
}
