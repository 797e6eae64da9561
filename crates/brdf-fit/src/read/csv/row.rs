//! The rows of a table: a reading each, or several, and the refractive index of their wavelength.

use std::collections::BTreeMap;
use std::fmt;

use brdf_core::check_refractive_index;

use super::header::Column;
use super::roles::{AngleColumn, Readings, Roles};
use crate::format::counted;
use crate::read::conversion::{Kind, LeftOut, Scale, Values};
use crate::read::error::ReadError;
use crate::read::names::{AngleForm, LengthUnit};
use crate::read::number::{
    Field, is_angle, is_deviation, is_reading, is_wavelength, micrometres, was_not_taken,
    without_percent_sign,
};
use crate::read::text::Text;
use crate::scan::{Convention, Measurement, RefractiveIndex};

/// One line of a table, split into its fields.
pub(super) struct Row<'a> {
    pub(super) text: &'a Text<'a>,
    /// The number of the line, counted from 1.
    pub(super) line: u64,
    pub(super) fields: &'a [&'a [u8]],
    /// Whether the file ends within the line, before the last column.
    pub(super) is_cut_off: bool,
    pub(super) columns: &'a [Column],
}

/// How the rows of a table are read.
pub(super) struct RowReader {
    pub(super) roles: Roles,
    pub(super) values: Values,
    pub(super) convention: Convention,
    /// The value that stands for a reading that was not taken.
    pub(super) missing: Option<f64>,
    /// The polarisation of which the readings are taken, 0 for s and 1 for p; `None` takes the mean.
    pub(super) polarisation: Option<usize>,
    /// What a comment states in place of a column: angles in degrees, the wavelength in um.
    pub(super) psi_deg: Option<f64>,
    pub(super) phi_deg: Option<f64>,
    pub(super) source_azimuth_deg: Option<f64>,
    pub(super) wavelength_um: Option<f64>,
}

/// What was found in the rows.
#[derive(Default)]
pub(super) struct Found {
    pub(super) readings: Vec<Measurement>,
    pub(super) left: LeftOut,
    /// Rows with a negative incidence angle.
    pub(super) mirrored: usize,
    /// The largest absolute zenith angle that is read as degrees.
    pub(super) largest_angle: f64,
}

impl Found {
    fn note_angle(&mut self, form: AngleForm, angle: f64) {
        if matches!(form, AngleForm::Degrees | AngleForm::Unstated) {
            self.largest_angle = self.largest_angle.max(angle.abs());
        }
    }
}

/// The directions of a row.
struct Directions {
    psi: f64,
    theta_deg: f64,
    phi_deg: f64,
}

impl RowReader {
    /// Adds the readings of a row, converted to f_r and the model's convention.
    ///
    /// # Errors
    ///
    /// A value is missing, is not a number or is out of range.
    pub(super) fn add(&self, row: &Row<'_>, found: &mut Found) -> Result<(), ReadError> {
        let wavelength_um = self.wavelength(row)?;
        let directions = self.directions(row, found)?;
        let Some(directions) = directions else {
            found.left.beyond += self.readings_in_a_row();
            return Ok(());
        };
        let (theta, phi) = self
            .convention
            .in_model(directions.theta_deg, directions.phi_deg);
        let mut add = |column: usize, value: Option<f64>, wavelength_um, sigma: Option<f64>| {
            let Some(value) = value else {
                found.left.not_taken += 1;
                return Ok(());
            };
            let brdf = self.values.to_brdf(value, theta);
            let sigma = sigma.map(|sigma| self.values.deviation(sigma, value, theta));
            if !is_reading(brdf) || sigma.is_some_and(|sigma| !is_deviation(sigma)) {
                let message = format!("is out of range: f_r would be {brdf:e} 1/sr");
                return Err(row.error(column, message));
            }
            found.readings.push(Measurement {
                wavelength_um,
                psi: directions.psi,
                theta,
                phi,
                brdf,
                sigma,
            });
            Ok(())
        };
        let reading = |column| self.reading(row, column);
        match &self.roles.readings {
            Readings::One(column) => {
                let value = reading(*column)?;
                add(*column, value, wavelength_um, self.sigma(row)?)
            }
            Readings::Polarised(first, second) => {
                let (s, p) = (reading(*first)?, reading(*second)?);
                let value = match self.polarisation {
                    Some(0) => s,
                    Some(_) => p,
                    None => s.zip(p).map(|(s, p)| 0.5 * (s + p)),
                };
                add(*first, value, wavelength_um, None)
            }
            Readings::Ratio(column, reference) => {
                let signal = reading(*column)?;
                let expected = "expected the signal of the white standard, above 0";
                let reference = row.value(*reference, expected, |x| x > 0.0)?;
                let ratio = signal.map(|signal| signal / reference);
                add(*column, ratio, wavelength_um, None)
            }
            Readings::None => {
                found.readings.push(Measurement {
                    wavelength_um: None,
                    psi: directions.psi,
                    theta,
                    phi,
                    brdf: f64::NAN,
                    sigma: None,
                });
                Ok(())
            }
            Readings::Channels(channels) => {
                let mut channels = channels.iter();
                channels
                    .try_for_each(|(column, um)| add(*column, reading(*column)?, Some(*um), None))
            }
        }
    }

    fn readings_in_a_row(&self) -> usize {
        match &self.roles.readings {
            Readings::Channels(channels) => channels.len(),
            _ => 1,
        }
    }

    fn wavelength(&self, row: &Row<'_>) -> Result<Option<f64>, ReadError> {
        let Some((column, unit)) = self.roles.wavelength else {
            return Ok(self.wavelength_um);
        };
        let expected = match unit {
            LengthUnit::Micrometres => "expected micrometres above 0",
            LengthUnit::Nanometres => "expected nanometres above 0",
            LengthUnit::Unstated => "expected a wavelength above 0",
        };
        let number = row.value(column, expected, is_wavelength)?;
        if unit != LengthUnit::Nanometres {
            return Ok(Some(number));
        }
        let text = row.field(column);
        let um = micrometres(text).unwrap_or(number / 1000.0);
        if is_wavelength(um) {
            Ok(Some(um))
        } else {
            Err(row.error(column, "is too small for a wavelength"))
        }
    }

    /// The directions of a row; `None` where one of them is at or beyond the horizon.
    fn directions(
        &self,
        row: &Row<'_>,
        found: &mut Found,
    ) -> Result<Option<Directions>, ReadError> {
        const PSI: &str = "expected the incidence angle";
        const THETA: &str = "expected the view angle";
        let (psi_deg, psi) = match self.roles.psi {
            Some(column) => {
                let (raw, degrees) = row.angle(column, PSI)?;
                found.note_angle(column.1, raw);
                let psi = match column.1 {
                    AngleForm::Radians => raw.abs(),
                    _ => degrees.abs().to_radians(),
                };
                (degrees, psi)
            }
            None => self
                .psi_deg
                .map_or((0.0, 0.0), |psi| (psi, psi.abs().to_radians())),
        };
        let (raw, theta_deg) = row.angle(self.roles.theta, THETA)?;
        found.note_angle(self.roles.theta.1, raw);
        let azimuth = |column: Option<AngleColumn>| {
            let degrees = column.map(|column| row.angle(column, "expected an azimuth"));
            degrees
                .transpose()
                .map(|angle| angle.map(|(_, degrees)| degrees))
        };
        let view = azimuth(self.roles.view_azimuth)?
            .or(self.phi_deg)
            .unwrap_or(0.0);
        let source = azimuth(self.roles.source_azimuth)?
            .or(self.source_azimuth_deg)
            .unwrap_or(0.0);
        if psi_deg.abs() >= 90.0 || theta_deg.abs() >= 90.0 {
            return Ok(None);
        }
        let mut phi_deg = view - source;
        if psi_deg < 0.0 {
            found.mirrored += 1;
            phi_deg += 180.0;
        }
        Ok(Some(Directions {
            psi,
            theta_deg,
            phi_deg,
        }))
    }

    /// The reading in a column; `None` where it was not taken.
    fn reading(&self, row: &Row<'_>, column: usize) -> Result<Option<f64>, ReadError> {
        match without_percent_sign(row.field(column)) {
            Some(number) => self.percentage(row, column, number).map(Some),
            None => row.reading(column, self.missing),
        }
    }

    /// The reading in a field `5 %`, whose number is given without the sign: 5 in a column in percent, and
    /// 0.05 in one of reflectance factors.
    fn percentage(&self, row: &Row<'_>, column: usize, number: &[u8]) -> Result<f64, ReadError> {
        let quantity = self.values.quantity;
        let divisor = match (quantity.kind, quantity.scale) {
            (Kind::ReflectanceFactor, Scale::Percent) => 1.0,
            (Kind::ReflectanceFactor, Scale::One) => 100.0,
            _ => {
                let message = format!(
                    "is a percentage: expected a number, because the column holds {quantity}"
                );
                return Err(row.error(column, message));
            }
        };
        let field = Field {
            text: number,
            decimal_comma: true,
        };
        let name = &row.columns[column].name;
        let expected = "expected a reading in percent";
        let number = row
            .text
            .number(row.line, name, &field, expected, is_reading)?;
        Ok(number / divisor)
    }

    fn sigma(&self, row: &Row<'_>) -> Result<Option<f64>, ReadError> {
        // The standard deviation may be blank in single rows.
        let column = self
            .roles
            .sigma
            .filter(|&column| !was_not_taken(row.field(column)));
        column
            .map(|column| {
                row.value(
                    column,
                    "expected a standard deviation above 0",
                    is_deviation,
                )
            })
            .transpose()
    }
}

impl Row<'_> {
    /// # Errors
    ///
    /// The row has more fields than the header has columns, and one of them is not blank; or it ends the
    /// file, has fewer fields and no line end, as of a file that was cut off.
    pub(super) fn check_length(&self) -> Result<(), ReadError> {
        let expected = self.columns.len();
        if self.is_cut_off {
            let found = counted(self.fields.len(), "field");
            let message = format!(
                "the last line has {found} and no line end: expected {expected}, as in the header (is \
                 the file cut off?)"
            );
            return Err(self.text.line_error(self.line, message));
        }
        let mut surplus = self.fields.iter().skip(expected);
        if surplus.any(|field| !field.trim_ascii().is_empty()) {
            let found = self.fields.len();
            let message = format!("{found} fields: expected {expected}, as in the header");
            return Err(self.text.line_error(self.line, message));
        }
        Ok(())
    }

    /// The angle in a column, as it is written and in degrees.
    fn angle(&self, (column, form): AngleColumn, what: &str) -> Result<(f64, f64), ReadError> {
        let (unit, accepts): (_, fn(f64) -> bool) = match form {
            AngleForm::Degrees | AngleForm::Unstated => (" in degrees", is_angle),
            AngleForm::Radians => (" in radians", is_angle),
            AngleForm::Cosine => (" as a cosine from -1 to 1", |x| x.abs() <= 1.0),
        };
        let raw = self.value(column, format_args!("{what}{unit}"), accepts)?;
        let degrees = match form {
            AngleForm::Degrees | AngleForm::Unstated => raw,
            AngleForm::Radians => raw.to_degrees(),
            AngleForm::Cosine => raw.acos().to_degrees(),
        };
        Ok((raw, degrees))
    }

    /// The text in a column; empty where the row is shorter.
    fn field(&self, column: usize) -> &[u8] {
        self.fields.get(column).copied().unwrap_or_default()
    }

    /// The number in a column for which `accepts` is true.
    fn value(
        &self,
        column: usize,
        expected: impl fmt::Display,
        accepts: impl Fn(f64) -> bool,
    ) -> Result<f64, ReadError> {
        let name = &self.columns[column].name;
        self.text.number(
            self.line,
            name,
            &self.number_field(column),
            expected,
            accepts,
        )
    }

    /// The reading in a column; `None` where it was not taken.
    fn reading(&self, column: usize, missing: Option<f64>) -> Result<Option<f64>, ReadError> {
        let name = &self.columns[column].name;
        self.text
            .reading(self.line, name, &self.number_field(column), missing)
    }

    fn number_field(&self, column: usize) -> Field<'_> {
        Field {
            text: self.field(column),
            // A comma that does not separate fields is a decimal comma.
            decimal_comma: true,
        }
    }

    fn error(&self, column: usize, message: impl Into<String>) -> ReadError {
        let field = self.field(column);
        self.text
            .value_error(self.line, &self.columns[column].name, field, message)
    }
}

/// The refractive index of each wavelength, from the column `n`.
#[derive(Default)]
pub(super) struct IndexColumn {
    /// By the bit pattern of the wavelength, which is ordered as the positive numbers are.
    by_wavelength: BTreeMap<Option<u64>, f64>,
}

impl IndexColumn {
    /// Adds the index of a row.
    ///
    /// # Errors
    ///
    /// The value is not a refractive index, or differs from an earlier one at the same wavelength.
    pub(super) fn add(
        &mut self,
        row: &Row<'_>,
        column: usize,
        wavelength_um: Option<f64>,
    ) -> Result<(), ReadError> {
        let expected = "expected a refractive index from 1 to 1e5";
        let n = row.value(column, expected, |n| check_refractive_index(n).is_ok())?;
        let before = *self
            .by_wavelength
            .entry(wavelength_um.map(f64::to_bits))
            .or_insert(n);
        if before == n {
            return Ok(());
        }
        let message = format!("differs from {before}, given before at the same wavelength");
        let value = n.to_string();
        let name = &row.columns[column].name;
        Err(row
            .text
            .value_error(row.line, name, value.as_bytes(), message))
    }

    /// The index of all rows; `None` where no row gives one.
    pub(super) fn refractive_index(&self) -> Option<RefractiveIndex> {
        if let Some(n) = self.by_wavelength.get(&None) {
            return Some(RefractiveIndex::Same(*n));
        }
        let list = self.by_wavelength.iter();
        let list: Vec<_> = list
            .filter_map(|(bits, n)| bits.map(|bits| (f64::from_bits(bits), *n)))
            .collect();
        (!list.is_empty()).then_some(RefractiveIndex::ByWavelength(list))
    }
}
