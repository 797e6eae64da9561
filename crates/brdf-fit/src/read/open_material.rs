//! BRDF look-up tables of ASAM OpenMATERIAL 3D (`.xompt`): a JSON document with a row for each wavelength
//! and pair of directions.
//!
//! ```text
//! {
//!   "metadata": {"name": "red paint", "openMaterial3dVersion": "1.1.0"},
//!   "brdf": {
//!     "wavelengths": [9.05e-07],
//!     "lookupTable": [
//!       [9.05e-07, 0.174533, 0.349066, 3.141593, 0.13248]
//!     ]
//!   }
//! }
//! ```
//!
//! (The numbers are made up.) The columns are
//!
//! | column | unit | |
//! |---|---|---|
//! | wavelength | m | from 1e-9 to 0.01716 |
//! | incident zenith angle | rad | from 0 to pi/2 |
//! | exit zenith angle | rad | from 0 to pi/2 |
//! | exit azimuth | rad | relative to the incident azimuth, which is 0 |
//! | BRDF | 1/sr | `null` where it was not taken |
//!
//! Both directions point away from the surface, as usual for a BRDF, so that azimuth 0 is the source's side.
//! (The schema says that "the incident ray is used as the reference". Where a program took that for the
//! direction in which the light travels, the options of the reading put azimuth 0 on the forward side.)
//!
//! Readings without a value, and those at the horizon, are left out and counted. The schema writes pi/2 as
//! 1.570796, so that angles within 1e-6 of it are at the horizon. Other tables of OpenMATERIAL (reflection
//! coefficients, optical and electromagnetic properties) are errors, as are tables of drafts of the format,
//! which had other columns.
//!
//! Source: `schemas/material_brdf_schema.json`, the examples and issue 436 of
//! github.com/asam-ev/OpenMATERIAL-3D (version 1.1.0).

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt;
use std::path::Path;

use serde::Deserialize;
use serde::de::{Deserializer, Error as _, IgnoredAny, SeqAccess, Visitor};

use super::conversion::LeftOut;
use super::error::ReadError;
use super::number::{is_reading, shifted};
use super::options::ReadOptions;
use super::reader::{Content, Reader};
use super::text::{HEAD, quotable, without_byte_order_mark};
use crate::scan::{Convention, Format, Measurement, Measurements, Metadata, Side};

pub(super) const READER: Reader = Reader {
    format: Format::OpenMaterial,
    extensions: &["xompt"],
    recognises: is_open_material,
    content: Content::Bytes(read),
};

/// Angles from here on are at the horizon, in radians.
const HORIZON: f64 = FRAC_PI_2 - 1e-6;

/// Whether a text is a JSON document that states the version or the schema of the standard, or has a
/// look-up table of a BRDF.
fn is_open_material(head: &[u8]) -> bool {
    let head = head.get(..HEAD).unwrap_or(head);
    let head = without_byte_order_mark(head).trim_ascii_start();
    let has = |word: &[u8]| head.windows(word.len()).any(|window| window == word);
    head.starts_with(b"{")
        && (has(b"\"openMaterial3dVersion\"")
            || has(b"OpenMATERIAL-3D/")
            || has(b"\"lookupTable\"") && has(b"\"brdf\""))
}

/// A document, without what the readings do not depend on.
#[derive(Deserialize)]
struct Document {
    #[serde(default)]
    metadata: serde_json::Map<String, serde_json::Value>,
    brdf: Option<Brdf>,
}

#[derive(Deserialize)]
struct Brdf {
    #[serde(rename = "lookupTable")]
    rows: Vec<Row>,
}

/// A row of the table. Angles are in radians, the wavelength is in metres.
struct Row {
    wavelength_m: Option<f64>,
    psi: f64,
    theta: f64,
    phi: f64,
    brdf: Option<f64>,
}

impl<'de> Deserialize<'de> for Row {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(RowVisitor)
    }
}

struct RowVisitor;

impl<'de> Visitor<'de> for RowVisitor {
    type Value = Row;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a row of wavelength, incident zenith, exit zenith, exit azimuth and BRDF")
    }

    /// Checks the values here, where the reader of the document knows the line.
    fn visit_seq<A: SeqAccess<'de>>(self, mut row: A) -> Result<Row, A::Error> {
        let zenith = "expected radians from 0 to pi/2";
        let metres = "expected metres from 1e-9 to 0.01716";
        let accepts = |metres| (1e-9..=0.01716).contains(&metres);
        let wavelength = next(&mut row, "wavelength", metres, accepts)?;
        let accepts = |angle| (0.0..=FRAC_PI_2 + 1e-6).contains(&angle);
        let psi = next(&mut row, "incident zenith", zenith, accepts)?;
        let theta = next(&mut row, "exit zenith", zenith, accepts)?;
        let accepts = |angle: f64| angle.abs() <= TAU + 1e-6;
        let phi = next(
            &mut row,
            "exit azimuth",
            "expected radians from 0 to 2 pi",
            accepts,
        )?;
        let brdf = next(&mut row, "BRDF", "expected a value in 1/sr", is_reading)?;
        if row.next_element::<IgnoredAny>()?.is_some() {
            let message = "more than 5 values in a row: expected wavelength, incident zenith, exit zenith, \
                           exit azimuth and BRDF";
            return Err(A::Error::custom(message));
        }
        let angle = |name: &str, angle: Option<f64>| {
            angle.ok_or_else(|| A::Error::custom(format!("column {name}: null: expected radians")))
        };
        Ok(Row {
            wavelength_m: wavelength,
            psi: angle("incident zenith", psi)?,
            theta: angle("exit zenith", theta)?,
            phi: angle("exit azimuth", phi)?,
            brdf,
        })
    }
}

/// The next value of a row; `None` where it is `null`.
fn next<'de, A: SeqAccess<'de>>(
    row: &mut A,
    name: &str,
    expected: &str,
    accepts: impl Fn(f64) -> bool,
) -> Result<Option<f64>, A::Error> {
    match row.next_element::<Option<f64>>()? {
        None => Err(A::Error::custom(format!(
            "the row ends before the column {name}: expected 5 values"
        ))),
        Some(Some(value)) if !accepts(value) => Err(A::Error::custom(format!(
            "column {name}: \"{value}\" is out of range: {expected}"
        ))),
        Some(value) => Ok(value),
    }
}

/// # Errors
///
/// The text is not such a document, or has no readings above the surface.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    options: &ReadOptions,
) -> Result<Measurements, ReadError> {
    let convention = options.convention(Convention::default());
    let document: Document = serde_json::from_slice(without_byte_order_mark(bytes))
        .map_err(|error| json_error(path, &error))?;
    let Some(brdf) = document.brdf else {
        return Err(ReadError::file(path, without_brdf(bytes)));
    };
    let mut left = LeftOut::default();
    let mut readings = Vec::new();
    for row in &brdf.rows {
        match row.brdf {
            None => left.not_taken += 1,
            Some(_) if row.psi >= HORIZON || row.theta >= HORIZON => left.beyond += 1,
            Some(brdf) => readings.push(row.reading(brdf, convention)),
        }
    }
    if readings.is_empty() {
        return Err(ReadError::file(path, "has no reading above the surface"));
    }
    let azimuth = match convention.phi_zero {
        Side::Source => "azimuth 0 is the source's side",
        Side::Forward => "azimuth 0 is the forward side: azimuths are rotated by 180 deg",
    };
    let mut conversions = vec![azimuth.to_owned()];
    conversions.extend(left.notes());
    Ok(Measurements {
        source: path.display().to_string(),
        metadata: metadata(document.metadata),
        convention,
        format: Format::OpenMaterial,
        conversions,
        readings,
        ..Measurements::default()
    })
}

impl Row {
    fn reading(&self, brdf: f64, convention: Convention) -> Measurement {
        let theta = match convention.theta_positive {
            Side::Source => self.theta,
            Side::Forward => -self.theta,
        };
        let phi = match convention.phi_zero {
            Side::Source => self.phi,
            Side::Forward => self.phi + PI,
        };
        Measurement {
            wavelength_um: self.wavelength_m.map(|metres| shifted(metres, 6)),
            psi: self.psi,
            theta,
            phi,
            brdf,
            sigma: None,
        }
    }
}

/// The texts of the metadata. The name is that of the sample.
fn metadata(object: serde_json::Map<String, serde_json::Value>) -> Metadata {
    let texts = object.into_iter().filter_map(|(key, value)| match value {
        serde_json::Value::String(text) if key == "name" => Some(("sample".to_owned(), text)),
        serde_json::Value::String(text) => Some((key, text)),
        _ => None,
    });
    Metadata(texts.collect())
}

/// What a document of the standard has in place of a BRDF.
fn without_brdf(bytes: &[u8]) -> String {
    #[expect(
        clippy::zero_sized_map_values,
        reason = "the values are read to skip them"
    )]
    let object: BTreeMap<String, IgnoredAny> =
        serde_json::from_slice(without_byte_order_mark(bytes)).unwrap_or_default();
    let names = object.into_keys();
    let names = names.filter(|name| name != "metadata" && name != "$schema");
    let names: Vec<String> = names
        .take(4)
        .map(|name| format!("\"{}\"", quotable(name.as_bytes())))
        .collect();
    let found = if names.is_empty() {
        String::new()
    } else {
        format!(", but {}", names.join(", "))
    };
    format!(
        "has no BRDF{found}: expected a look-up table of OpenMATERIAL with \"brdf\" and \"lookupTable\""
    )
}

/// The error of a document, with its line and without what the program calls the place.
fn json_error(path: &Path, error: &serde_json::Error) -> ReadError {
    let message = error.to_string();
    let message = message.split(" at line ").next().unwrap_or_default();
    ReadError::Line {
        path: path.to_owned(),
        line: error.line() as u64,
        message: quotable_message(message),
        remedy: None,
    }
}

/// A message that may quote the document: printable and of limited length.
fn quotable_message(message: &str) -> String {
    const LONGEST: usize = 200;
    let printable = message.chars().filter(|c| !c.is_control());
    printable.take(LONGEST).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn document(rows: &str) -> String {
        format!(
            "{{\"metadata\": {{\"name\": \"Test paint\", \"authors\": [\"A\"]}},\n\"brdf\": {{\"wavelengths\": \
             [9.05e-07],\n\"lookupTable\": [\n{rows}\n]}}}}"
        )
    }

    const ROWS: &str = "[9.05e-07, 0.5, 0.5, 3.141592653589793, 0.3],\n[9.05e-07, 0.5, 0.25, 0.0, 0.1],\n\
                        [1.55e-06, 0.5, 1.570796, 0.0, 9],\n[1.55e-06, 0.5, 0.0, 0.0, null]";

    fn read_with(text: &str, options: &ReadOptions) -> Result<Measurements, ReadError> {
        read(Path::new("a.xompt"), text.as_bytes(), options)
    }

    fn error(text: &str) -> String {
        let read = read_with(text, &ReadOptions::default());
        read.unwrap_err().to_string()
    }

    #[test]
    fn rows_are_readings_with_azimuths_from_the_source() {
        let scan = read_with(&document(ROWS), &ReadOptions::default()).unwrap();
        let readings = scan.readings();
        assert_eq!(readings.len(), 2);
        assert_eq!(readings[0].in_plane_theta(), Some(-0.5));
        assert_eq!(readings[1].in_plane_theta(), Some(0.25));
        assert_eq!(readings[0].brdf, 0.3);
        assert_eq!(readings[0].wavelength_um, Some(0.905));
        assert_eq!(scan.metadata.get("sample"), Some("Test paint"));
        assert_eq!(
            scan.conversions,
            [
                "azimuth 0 is the source's side",
                "1 reading not taken (no value) is left out",
                "1 reading at or beyond 90 deg from the normal is left out"
            ]
        );
    }

    #[test]
    fn azimuth_zero_may_be_the_forward_side() {
        let options = ReadOptions {
            phi_zero: Some(Side::Forward),
            ..ReadOptions::default()
        };
        let scan = read_with(&document(ROWS), &options).unwrap();
        assert_eq!(scan.readings()[0].in_plane_theta(), Some(0.5));
        assert!(scan.conversions[0].contains("rotated by 180 deg"));
    }

    #[test]
    fn errors_name_line_column_and_value() {
        let with = |from: &str, to: &str| error(&document(&ROWS.replacen(from, to, 1)));
        assert_eq!(
            with("0.25", "14.3"),
            "a.xompt, line 5: column exit zenith: \"14.3\" is out of range: expected radians from 0 to pi/2"
        );
        assert!(
            with("9.05e-07", "-1").contains("line 4: column wavelength: \"-1\" is out of range")
        );
        assert!(with("3.141592653589793", "180").contains("column exit azimuth: \"180\""));
        assert!(with("1.55e-06", "1.55").contains("line 6: column wavelength: \"1.55\""));
        assert!(with("9.05e-07", "1e308").contains("line 4: column wavelength"));
        assert!(
            with("0.25, 0.0, 0.1", "0.25, 0.0")
                .contains("line 5: the row ends before the column BRDF")
        );
        assert!(with("0.0, 0.1", "0.0, 0.1, 0.2").contains("line 5: more than 5 values in a row"));
        assert!(
            with("0.25", "null").contains("line 5: column exit zenith: null: expected radians")
        );
        assert!(with("0.25", "\"x\"").contains("line 5: invalid type: string \"x\", expected f64"));
        assert!(with("0.3", "1e300").contains("line 4: column BRDF"));
        assert!(with("0.3", "1e999").contains("line 4: number out of range"));
        assert!(error(&document("[1,")).contains("line"));
        assert!(error("{").contains("line 1: EOF"));
        assert!(error(&document("")).contains("has no reading above the surface"));
    }

    #[test]
    fn other_tables_of_the_standard_are_called_by_their_names() {
        let other = |name: &str| {
            let text = format!(
                "{{\"metadata\": {{\"openMaterial3dVersion\": \"1.1.0\"}}, \"{name}\": {{}}}}"
            );
            assert!((READER.recognises)(text.as_bytes()));
            error(&text)
        };
        assert!(
            other("reflectionCoefficient").contains("has no BRDF, but \"reflectionCoefficient\"")
        );
        assert!(
            other("opticalProperties")
                .contains("but \"opticalProperties\": expected a look-up table")
        );
        let nothing = error("{\"metadata\": {\"openMaterial3dVersion\": \"1.1.0\"}}");
        assert!(nothing.contains("has no BRDF: expected"), "{nothing}");
    }

    #[test]
    fn documents_are_known_by_their_names() {
        assert!((READER.recognises)(document(ROWS).as_bytes()));
        assert!((READER.recognises)(
            format!("\u{feff} {}", document(ROWS)).as_bytes()
        ));
        assert!(!(READER.recognises)(b"{\"format\": 3, \"fits\": []}"));
        assert!(!(READER.recognises)(b"[\"brdf\", \"lookupTable\"]"));
    }

    proptest! {
        #[test]
        fn any_rows_are_read_or_refused(
            rows in proptest::collection::vec(
                proptest::collection::vec(
                    proptest::sample::select(vec!["0", "1.57", "-1", "null", "1e-7", "1e308", "3.14", "[]", "\"\""]),
                    0..7,
                ),
                0..8,
            ),
        ) {
            let rows: Vec<String> = rows.iter().map(|row| format!("[{}]", row.join(","))).collect();
            if let Ok(scan) = read_with(&document(&rows.join(",\n")), &ReadOptions::default()) {
                for reading in scan.readings() {
                    reading.validated().unwrap();
                }
            }
        }

        #[test]
        fn any_text_is_read_or_refused(text in "[\\[\\]{}\",:a-z0-9 .]{0,100}") {
            let _ = read_with(&text, &ReadOptions::default());
        }
    }
}
