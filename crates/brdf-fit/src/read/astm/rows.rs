//! The rows, and what becomes of them.

use super::header::{Column, Header};
use crate::read::ReadError;
use crate::read::angles::{AngleUnit, TwoDirections};
use crate::read::text::{
    BEYOND_HORIZON, Field, Text, is_angle, is_deviation, is_reading, left_out, words,
};
use crate::scan::{Convention, Format, Side};
use crate::scan::{Measurement, Measurements};

/// The rows as they stand in the file.
#[derive(Default)]
pub(super) struct Rows {
    pub(super) directions: Vec<TwoDirections>,
    /// For each row a value for each column of values.
    values: Vec<f64>,
    /// For each row, where there is that column.
    sigmas: Vec<Option<f64>>,
}

impl Rows {
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
                Column::Angle(place) => {
                    let angle = text.number(number, name, &field, "expected an angle", is_angle)?;
                    if let Some(slot) = angles.get_mut(*place) {
                        *slot = angle;
                    }
                }
                Column::Value(_) => {
                    let value =
                        text.number(number, name, &field, "expected a value", is_reading)?;
                    self.values.push(value);
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

    /// The unit of the angles, and the sentence about it.
    fn unit(&self, header: &Header) -> (AngleUnit, String) {
        let named = |unit| match unit {
            AngleUnit::Degrees => "degrees",
            AngleUnit::Radians => "radians",
        };
        if let Some(unit) = header.unit {
            return (
                unit,
                format!("angles are in {}, as the file says", named(unit)),
            );
        }
        let turn = 2.0 * std::f64::consts::PI + 1e-3;
        let in_radians = |row: &TwoDirections| {
            row.theta_i.abs() < turn / 4.0
                && row.theta_s.abs() < turn / 2.0
                && row.phi_i.abs() < turn
                && row.phi_s.abs() < turn
        };
        let (unit, why) = if self.directions.iter().all(in_radians) {
            (
                AngleUnit::Radians,
                "none is larger than there are in radians",
            )
        } else {
            (
                AngleUnit::Degrees,
                "some are larger than there are in radians",
            )
        };
        (
            unit,
            format!(
                "angles are taken for {}: the file does not say, and {why}",
                named(unit)
            ),
        )
    }

    pub(super) fn measurements(
        self,
        text: &Text<'_>,
        header: Header,
        convention: Convention,
    ) -> Result<Measurements, ReadError> {
        let (unit, said) = self.unit(&header);
        let mut conversions = vec![said, azimuth(convention)];
        conversions.extend(header.said.iter().cloned());
        conversions.extend(header.quantity.conversion());
        let (readings, beyond) = self.readings(&header, unit, convention);
        if readings.is_empty() {
            return Err(text.error("has no reading above the surface"));
        }
        conversions.extend(left_out(beyond, BEYOND_HORIZON));
        Ok(Measurements {
            source: text.path.display().to_string(),
            ignored_columns: header.unused(),
            metadata: header.metadata,
            refractive_index: header.refractive_index,
            convention,
            format: Format::Astm,
            conversions,
            incidence_class: None,
            readings,
        })
    }

    /// The readings, and how many are left out beyond the horizon.
    fn readings(
        &self,
        header: &Header,
        unit: AngleUnit,
        convention: Convention,
    ) -> (Vec<Measurement>, usize) {
        let wavelengths: Vec<Option<f64>> = header.wavelengths().collect();
        let rows = self.values.chunks(wavelengths.len().max(1));
        let sigmas = self.sigmas.iter().copied().chain(std::iter::repeat(None));
        let mut readings = Vec::with_capacity(self.values.len());
        for ((directions, values), sigma) in self.directions.iter().zip(rows).zip(sigmas) {
            let Some((psi, theta, phi)) = turned(*directions, unit, convention).in_model(unit)
            else {
                continue;
            };
            let reading = |(&value, &wavelength_um): (&f64, &Option<f64>)| Measurement {
                wavelength_um,
                psi,
                theta,
                phi,
                brdf: header.quantity.to_brdf(value, theta),
                sigma: sigma.map(|sigma| header.quantity.to_brdf(sigma, theta)),
            };
            readings.extend(values.iter().zip(&wavelengths).map(reading));
        }
        let beyond = self.values.len() - readings.len();
        (readings, beyond)
    }
}

/// With phi_s such that phi_s = phi_i is the source's side.
fn turned(directions: TwoDirections, unit: AngleUnit, convention: Convention) -> TwoDirections {
    match convention.phi_zero {
        Side::Source => directions,
        Side::Forward => TwoDirections {
            phi_s: directions.phi_s + unit.half_turn(),
            ..directions
        },
    }
}

fn azimuth(convention: Convention) -> String {
    let said = match convention.phi_zero {
        Side::Source => "azimuth is phi_s - phi_i, 0 on the source's side",
        Side::Forward => "azimuth 0 is the forward side, turned by 180 deg",
    };
    said.to_owned()
}
