//! Tables of angles alone, of scans whose readings are elsewhere.

use std::fs;
use std::path::Path;

use super::header::Preamble;
use super::row::Found;
use super::{Rows, check_found, for_each_row, reader};
use crate::read::conversion::Values;
use crate::read::error::ReadError;
use crate::read::options::ReadOptions;
use crate::read::text::Text;
use crate::scan::{Measurement, RefractiveIndex};

/// The angles of scans whose readings are elsewhere, and what their table states about the readings.
#[derive(Debug, Clone, PartialEq)]
pub struct AngleTable {
    /// The angles in the model's convention, in the order of the rows; the readings are NaN.
    pub angles: Vec<Measurement>,
    /// The refractive index, where the table states it.
    pub refractive_index: Option<RefractiveIndex>,
    /// The sentences that report the conversions of the readings.
    pub conversions: Vec<String>,
    values: Values,
    missing: Option<f64>,
}

impl AngleTable {
    /// Reads the angles of a [table](crate::read::csv), a row for each reading of a scan. Columns of readings
    /// have no effect. The keys `quantity`, `unit`, `factor` and `missing` of its comments and of
    /// [`ReadOptions::declarations`] are those of the readings.
    ///
    /// # Errors
    ///
    /// The file cannot be read or is not such a table, it has no row, or a direction is at or beyond 90 deg.
    pub fn read(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Self, ReadError> {
        let path = path.as_ref();
        let bytes = fs::read(path).map_err(|error| ReadError::io(path, error))?;
        Self::of(Text::new(path, &bytes)?, options)
    }

    fn of(text: Text<'_>, options: &ReadOptions) -> Result<Self, ReadError> {
        let Preamble {
            comments, header, ..
        } = Preamble::read(&text, Rows::Angles, options)?;
        let reader = reader(&text, &header, &comments, Rows::Angles, options)?;
        let mut found = Found::default();
        for_each_row(&text, &header, |row| {
            row.check_length()?;
            reader.add(row, &mut found)?;
            if found.left.beyond == 0 {
                return Ok(());
            }
            let message = "a direction at or beyond 90 deg from the normal: the readings of a scan need \
                           angles below 90 deg";
            Err(text.line_error(row.line, message.to_owned()))
        })?;
        if found.readings.is_empty() {
            return Err(text.line_error(header.number, "no angles follow the header".to_owned()));
        }
        check_found(&text, &header, &reader, &mut found)?;
        Ok(Self {
            angles: found.readings,
            refractive_index: comments.refractive_index,
            conversions: reader.values.conversions(),
            values: reader.values,
            missing: reader.missing,
        })
    }

    /// Whether the readings are f_r in 1/sr, without a number that stands for one that was not taken.
    pub fn readings_are_brdf(&self) -> bool {
        self.conversions.is_empty() && self.missing.is_none()
    }

    /// f_r in 1/sr of the reading with this index; NaN for one that was not taken.
    ///
    /// # Panics
    ///
    /// The index is not below the number of angles.
    pub fn to_brdf(&self, index: usize, reading: f64) -> f64 {
        if self.missing == Some(reading) {
            f64::NAN
        } else {
            self.values.to_brdf(reading, self.angles[index].theta)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(table: &str, declared: &[(&str, &str)]) -> Result<AngleTable, String> {
        let declarations = declared.iter();
        let options = ReadOptions {
            declarations: declarations
                .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
                .collect(),
            ..ReadOptions::default()
        };
        Text::new(Path::new("angles.csv"), table.as_bytes())
            .and_then(|text| AngleTable::of(text, &options))
            .map_err(|error| error.to_string())
    }

    #[test]
    fn angles_need_no_reading_and_keep_their_order() {
        let table = read("psi_deg,theta_deg\n30,-20\n0,10\n30,-20\n", &[]).unwrap();
        let thetas: Vec<f64> = table.angles.iter().map(|angle| angle.theta).collect();
        assert_eq!(thetas, [-20.0, 10.0, -20.0].map(f64::to_radians));
        assert!(table.readings_are_brdf());
        assert_eq!(table.to_brdf(1, 0.25), 0.25);
    }

    #[test]
    fn readings_beside_the_angles_have_no_effect() {
        let with = "psi_deg,theta_deg,brdf_per_sr\n30,-20,\n0,10,x\n";
        let with = read(with, &[]).unwrap();
        assert_eq!(with.angles.len(), 2);
        assert!(with.angles.iter().all(|angle| angle.brdf.is_nan()));
    }

    #[test]
    fn the_quantity_of_the_readings_is_declared() {
        let declared = [
            ("quantity", "reflectance_factor"),
            ("unit", "percent"),
            ("missing", "-1"),
        ];
        let table = read("psi_deg,theta_deg\n30,-20\n", &declared).unwrap();
        assert!(!table.readings_are_brdf());
        let value = table.to_brdf(0, 50.0 * std::f64::consts::PI);
        assert!((value - 0.5).abs() < 1e-15);
        assert!(table.to_brdf(0, -1.0).is_nan());
    }

    #[test]
    fn every_direction_must_be_above_the_surface() {
        let error = read("psi_deg,theta_deg\n30,20\n30,90\n", &[]).unwrap_err();
        assert!(
            error.starts_with("angles.csv, line 3: a direction at or beyond"),
            "{error}"
        );
        let error = read("psi_deg,theta_deg\n", &[]).unwrap_err();
        assert!(error.contains("no angles follow"), "{error}");
        let error = read("psi_deg,brdf\n1,2\n", &[]).unwrap_err();
        assert!(error.contains("no column for the view angle"), "{error}");
    }
}
