//! The rows, and their conversion to readings.

use super::header::{Column, Header};
use crate::read::angles::{AngleUnit, TwoDirections};
use crate::read::conversion::LeftOut;
use crate::read::error::ReadError;
use crate::read::number::{Field, is_angle, is_deviation};
use crate::read::text::{Text, words};
use crate::scan::{Convention, Format, Measurement, Measurements, Side};

/// The rows as they are in the file.
#[derive(Default)]
pub(super) struct Rows {
    pub(super) directions: Vec<TwoDirections>,
    /// The values, row by row: one for each column of values, where one was taken.
    values: Vec<Option<f64>>,
    /// The standard deviations of the rows; empty where the file has none.
    sigmas: Vec<Option<f64>>,
}

impl Rows {
    /// # Errors
    ///
    /// The row has another number of fields than there are columns, or one of them is not valid.
    pub(super) fn add(
        &mut self,
        text: &Text<'_>,
        header: &Header,
        number: u64,
        line: &[u8],
    ) -> Result<(), ReadError> {
        let fields: Vec<&[u8]> = words(line).collect();
        let (found, expected) = (fields.len(), header.columns.len());
        if found != expected {
            let message = format!("{found} fields: expected {expected}, as in VARS");
            return Err(text.line_error(number, message));
        }
        let mut angles = header.given.map(|given| given.unwrap_or(0.0));
        let named = header.names.iter().zip(&header.columns);
        for (field, (name, column)) in fields.into_iter().zip(named) {
            let field = Field::plain(field);
            match column {
                Column::Angle(index) => {
                    let angle = text.number(number, name, &field, "expected an angle", is_angle)?;
                    if let Some(slot) = angles.get_mut(*index) {
                        *slot = angle;
                    }
                }
                Column::Value(_) => {
                    self.values.push(text.reading(number, name, &field, None)?);
                }
                Column::Sigma => {
                    let expected = "expected 1/sr above 0";
                    let sigma = text.number(number, name, &field, expected, is_deviation)?;
                    self.sigmas.push(Some(sigma));
                }
                Column::Unused => {}
            }
        }
        let [theta_i, phi_i, theta_s, phi_s] = angles;
        self.directions.push(TwoDirections {
            theta_i,
            phi_i,
            theta_s,
            phi_s,
        });
        Ok(())
    }

    /// The unit of the angles, and the sentence that reports it.
    fn unit(&self, header: &Header) -> (AngleUnit, String) {
        let named = |unit| match unit {
            AngleUnit::Degrees => "degrees",
            AngleUnit::Radians => "radians",
        };
        if let Some(unit) = header.unit {
            return (
                unit,
                format!("angles are in {}, as the file states", named(unit)),
            );
        }
        // Rounding of the last digit in the file is allowed for.
        let turn = 2.0 * std::f64::consts::PI + 1e-3;
        let in_radians = |row: &TwoDirections| {
            row.theta_i.abs() < turn / 4.0
                && row.theta_s.abs() < turn / 2.0
                && row.phi_i.abs() < turn
                && row.phi_s.abs() < turn
        };
        let (unit, why) = if self.directions.iter().all(in_radians) {
            (AngleUnit::Radians, "all are within the range of radians")
        } else {
            (AngleUnit::Degrees, "some exceed the range of radians")
        };
        (
            unit,
            format!(
                "angles are assumed to be in {}: the file states no unit, and {why}",
                named(unit)
            ),
        )
    }

    /// # Errors
    ///
    /// No reading is above the surface.
    pub(super) fn measurements(
        self,
        text: &Text<'_>,
        header: Header,
        convention: Convention,
    ) -> Result<Measurements, ReadError> {
        let (unit, about_unit) = self.unit(&header);
        let mut conversions = vec![about_unit, azimuth(convention)];
        conversions.extend(header.conversions.iter().cloned());
        conversions.extend(header.quantity.conversion());
        let (readings, left) = self.readings(&header, unit, convention);
        if readings.is_empty() {
            return Err(text.error("has no reading above the surface"));
        }
        conversions.extend(left.notes());
        Ok(Measurements {
            source: text.path.display().to_string(),
            ignored_columns: header.unused(),
            metadata: header.metadata,
            refractive_index: header.refractive_index,
            convention,
            format: Format::Astm,
            conversions,
            readings,
            ..Measurements::default()
        })
    }

    /// The readings, and how many are left out.
    fn readings(
        &self,
        header: &Header,
        unit: AngleUnit,
        convention: Convention,
    ) -> (Vec<Measurement>, LeftOut) {
        let wavelengths: Vec<Option<f64>> = header.wavelengths().collect();
        let rows = self.values.chunks(wavelengths.len().max(1));
        let sigmas = self.sigmas.iter().copied().chain(std::iter::repeat(None));
        let mut readings = Vec::with_capacity(self.values.len());
        let mut left = LeftOut::default();
        for ((directions, values), sigma) in self.directions.iter().zip(rows).zip(sigmas) {
            let Some((psi, theta, phi)) = from_source(*directions, unit, convention).in_model(unit)
            else {
                left.beyond += values.len();
                continue;
            };
            for (&value, &wavelength_um) in values.iter().zip(&wavelengths) {
                let Some(value) = value else {
                    left.not_taken += 1;
                    continue;
                };
                readings.push(Measurement {
                    wavelength_um,
                    psi,
                    theta,
                    phi,
                    brdf: header.quantity.to_brdf(value, theta),
                    sigma: sigma.map(|sigma| header.quantity.deviation(sigma, value, theta)),
                });
            }
        }
        (readings, left)
    }
}

/// The directions with azimuths in which phi_s = phi_i is the source's side.
fn from_source(
    directions: TwoDirections,
    unit: AngleUnit,
    convention: Convention,
) -> TwoDirections {
    match convention.phi_zero {
        Side::Source => directions,
        Side::Forward => TwoDirections {
            phi_s: directions.phi_s + unit.half_turn(),
            ..directions
        },
    }
}

/// The sentence that reports the convention of the azimuths.
fn azimuth(convention: Convention) -> String {
    let sentence = match convention.phi_zero {
        Side::Source => "azimuth is phi_s - phi_i, 0 on the source's side",
        Side::Forward => "azimuth 0 is the forward side: azimuths are rotated by 180 deg",
    };
    sentence.to_owned()
}
