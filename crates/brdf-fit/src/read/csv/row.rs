//! The rows of a table: a reading each, and the refractive index of its wavelength.

use std::collections::BTreeMap;

use brdf_core::check_refractive_index;

use super::header::{BRDF, Columns, INDEX, PHI, PSI, SIGMA, THETA, WAVELENGTH};
use crate::read::conversion::Quantity;
use crate::read::error::ReadError;
use crate::read::number::{Field, is_deviation, is_reading, is_wavelength};
use crate::read::text::Text;
use crate::scan::{Convention, Measurement, RefractiveIndex};

/// One line of a table, split into its fields.
pub(super) struct Row<'a> {
    pub(super) text: &'a Text<'a>,
    /// The number of the line, counted from 1.
    pub(super) line: u64,
    pub(super) fields: &'a [&'a [u8]],
    pub(super) decimal_comma: bool,
}

impl Row<'_> {
    /// # Errors
    ///
    /// The row has more fields than the header has columns, and one of them is not blank.
    pub(super) fn check_length(&self, expected: usize) -> Result<(), ReadError> {
        let surplus = self
            .fields
            .iter()
            .skip(expected)
            .any(|field| !field.trim_ascii().is_empty());
        if surplus {
            let found = self.fields.len();
            let message = format!("{found} fields: expected {expected}, as in the header");
            return Err(self.text.line_error(self.line, message));
        }
        Ok(())
    }

    /// The reading of the row, converted to f_r and the model's convention.
    ///
    /// # Errors
    ///
    /// A value is missing, is not a number or is out of range.
    pub(super) fn reading(
        &self,
        columns: &Columns,
        quantity: Quantity,
        convention: Convention,
    ) -> Result<Measurement, ReadError> {
        let optional = |column: Option<usize>, name, expected, accepts: fn(f64) -> bool| {
            column
                .map(|column| self.value(column, name, expected, accepts))
                .transpose()
        };
        let wavelength_um = optional(
            columns.wavelength,
            WAVELENGTH,
            "expected micrometres above 0",
            is_wavelength,
        )?;
        let psi_deg = self.value(
            columns.psi,
            PSI,
            "expected degrees from 0 to below 90",
            |x| (0.0..90.0).contains(&x),
        )?;
        let theta_deg = self.value(
            columns.theta,
            THETA,
            "expected degrees between -90 and 90",
            |x| x.abs() < 90.0,
        )?;
        let phi_deg = optional(columns.phi, PHI, "expected degrees", |_| true)?.unwrap_or(0.0);
        let reading = self.value(columns.brdf, BRDF, "expected a reading in 1/sr", is_reading)?;
        // The standard deviation may be blank in single rows.
        let sigma = columns.sigma.filter(|&column| !self.is_blank(column));
        let sigma = optional(sigma, SIGMA, "expected 1/sr above 0", is_deviation)?;

        let (theta, phi) = convention.in_model(theta_deg, phi_deg);
        Ok(Measurement {
            wavelength_um,
            psi: psi_deg.to_radians(),
            theta,
            phi,
            brdf: quantity.to_brdf(reading, theta),
            sigma: sigma.map(|sigma| quantity.to_brdf(sigma, theta)),
        })
    }

    fn is_blank(&self, column: usize) -> bool {
        self.fields
            .get(column)
            .is_none_or(|field| field.trim_ascii().is_empty())
    }

    /// The number in a column for which `accepts` is true.
    fn value(
        &self,
        column: usize,
        name: &str,
        expected: &str,
        accepts: impl Fn(f64) -> bool,
    ) -> Result<f64, ReadError> {
        let field = Field {
            text: self.fields.get(column).copied().unwrap_or_default(),
            decimal_comma: self.decimal_comma,
        };
        self.text.number(self.line, name, &field, expected, accepts)
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
        let n = row.value(column, INDEX, expected, |n| {
            check_refractive_index(n).is_ok()
        })?;
        let before = *self
            .by_wavelength
            .entry(wavelength_um.map(f64::to_bits))
            .or_insert(n);
        if before == n {
            return Ok(());
        }
        let message = format!("differs from {before}, given before at the same wavelength");
        let value = n.to_string();
        Err(row
            .text
            .value_error(row.line, INDEX, value.as_bytes(), message))
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
