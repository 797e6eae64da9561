//! Tables of BSDF in the text that TracePro exports of a surface property.
//!
//! ```text
//! TracePro Surface Property Data
//! TracePro Release: 19 6 0
//! Name       Red paint
//! Coating    1
//! Scatter    5
//! Polarization   0
//!
//! Temperature Wavelength IncAngle AziAngle Abso_S Abso_P ...
//! 300         0.55       30       0        0.05   0.05   ...
//! Table_BSDF_Data
//! Temperature Wavelength IncAngle AziAngle ScatterBeta ScatterAzimuth BRDF  BTDF
//! 300         0.55       30       0        0.05        90             0.11  0
//! ...
//! SAVE-DATA
//! ```
//!
//! (The numbers are made up.) The columns are separated by tabs or spaces, also by several. Wavelengths are in
//! um, angles in degrees, and the BRDF is in 1/sr. `ScatterBeta` and `ScatterAzimuth` are polar coordinates
//! about the specular direction in the plane of direction cosines: with x towards the source and y across the
//! plane of incidence,
//!
//! ```text
//! x = -sin psi + beta cos a,  y = beta sin a,  sin theta = sqrt(x^2 + y^2),  phi = atan2(y, x)
//! ```
//!
//! where azimuth 0 is the source's side. **No public document says on which side it is.** Tables whose values
//! are the same from both sides, such as those that depend on `ScatterBeta` alone at azimuths all round, are
//! read as they are; the options of the reading must state the side for the others.
//!
//! The rows before `Table_BSDF_Data` (absorptance, specular reflectance, coefficients of the ABg model) are
//! not read, nor is the BTDF. Directions beyond the horizon, and the repetitions of the specular direction at
//! other azimuths, are left out and counted. Several temperatures, several azimuths of incidence (an anisotropic
//! surface), polarised properties, and properties without a table are errors.
//!
//! Sources: exports, programs and documentation in github.com/bazjo/brdf_utils, which describe the columns and
//! the coordinates by the TracePro manual; TracePro 5.0 User's Manual, "Surface Properties", by which the
//! integral of the BSDF times cos theta is the total scatter.

use std::collections::{BTreeMap, BTreeSet};

use super::conversion::{BEYOND_HORIZON, left_out};
use super::error::{ReadError, Remedy};
use super::number::{Field, is_reading, is_wavelength, parse_number};
use super::options::ReadOptions;
use super::reader::{Content, Reader};
use super::text::{Text, head_lines, words};
use crate::scan::{Convention, Format, Measurement, Measurements, Metadata, Side};

pub(super) const READER: Reader = Reader {
    format: Format::TracePro,
    // These files are called .txt.
    extensions: &[],
    recognises: |bytes| {
        let mut lines = head_lines(bytes).filter(|line| !line.trim_ascii().is_empty());
        lines.next().is_some_and(|line| line.trim_ascii() == MARK)
    },
    content: Content::Text(read),
};

const MARK: &[u8] = b"TracePro Surface Property Data";

/// The line before the names of the columns.
const TABLE: &[u8] = b"Table_BSDF_Data";

/// sin theta from here on is at the horizon: within the rounding of the seven digits of `ScatterBeta`.
const HORIZON: f64 = 1.0 - 1e-7;

/// # Errors
///
/// The text is not such a file, has no table or no reading above the surface, or the side of azimuth 0 matters
/// and is not stated.
pub(super) fn read(text: Text<'_>, options: &ReadOptions) -> Result<Measurements, ReadError> {
    if options.theta_positive == Some(Side::Forward) {
        let message = "the sign of theta cannot be chosen: the format measures directions from the specular \
                       direction";
        return Err(text.error(message));
    }
    let mut lines = text.checked_lines();
    let metadata = read_header(&text, &mut lines)?;
    let columns = Columns::read(&text, &mut lines)?;
    let mut rows = Vec::new();
    let mut has_btdf = false;
    for line in lines {
        let (number, line) = line?;
        match words(line).next() {
            None => {}
            Some(TABLE) => {
                let message = "a second table: expected a file with a single surface property";
                return Err(text.line_error(number, message));
            }
            Some(word) if parse_number(word, false).is_none() => {}
            Some(_) => {
                let row = columns.row(&text, number, line)?;
                has_btdf |= row.btdf != 0.0;
                rows.push(row);
            }
        }
    }
    check_rows(&text, columns.number, &rows, has_btdf)?;
    let side = side_of_azimuth(&text, &rows, options)?;
    let mut readings = Readings::default();
    for row in &rows {
        readings.add(row, side.unwrap_or_default());
    }
    if readings.kept.is_empty() {
        return Err(text.error("has no reading above the surface"));
    }
    Ok(Measurements {
        source: text.path.display().to_string(),
        metadata,
        convention: Convention {
            phi_zero: side.unwrap_or_default(),
            ..Convention::default()
        },
        format: Format::TracePro,
        conversions: readings.conversions(side, has_btdf),
        readings: readings.kept,
        ..Measurements::default()
    })
}

/// The metadata of the lines up to the table.
///
/// # Errors
///
/// There is no table, or the property is of polarised light.
fn read_header<'a>(
    text: &Text<'_>,
    lines: &mut impl Iterator<Item = Result<(u64, &'a [u8]), ReadError>>,
) -> Result<Metadata, ReadError> {
    let mut metadata = Metadata::default();
    for line in lines {
        let (number, line) = line?;
        if line.trim_ascii() == TABLE {
            return Ok(metadata);
        }
        let line = String::from_utf8_lossy(line);
        let Some((key, value)) = line.split_once(char::is_whitespace) else {
            continue;
        };
        match (key, value.trim()) {
            (_, "") => {}
            ("Name", name) => metadata.0.push(("sample".to_owned(), name.to_owned())),
            ("Catalog" | "Description", value) => {
                metadata.0.push((key.to_lowercase(), value.to_owned()));
            }
            ("Polarization", value) if parse_number(value.as_bytes(), false) != Some(0.0) => {
                let message = "the property is of polarised light, of which no table can be read: expected \
                               Polarization 0";
                return Err(text.line_error(number, message));
            }
            _ => {}
        }
    }
    Err(text.error(
        "has no table of a BSDF, but coefficients of a scatter model at most: expected a line \
         Table_BSDF_Data and readings",
    ))
}

/// The names of the columns.
struct Columns {
    /// The number of their line.
    number: u64,
    names: Vec<String>,
}

/// A row of the table, with angles in degrees.
struct Row {
    temperature: f64,
    wavelength_um: f64,
    psi_deg: f64,
    source_azimuth_deg: f64,
    beta: f64,
    azimuth_deg: f64,
    brdf: f64,
    btdf: f64,
}

impl Columns {
    fn read<'a>(
        text: &Text<'_>,
        lines: &mut impl Iterator<Item = Result<(u64, &'a [u8]), ReadError>>,
    ) -> Result<Self, ReadError> {
        const NEEDED: [&str; 5] = [
            "Wavelength",
            "IncAngle",
            "ScatterBeta",
            "ScatterAzimuth",
            "BRDF",
        ];
        let line =
            lines.find(|line| !matches!(line, Ok((_, line)) if line.trim_ascii().is_empty()));
        let line = line.transpose()?;
        let Some((number, line)) = line else {
            return Err(text.error("ends after Table_BSDF_Data: expected names of columns"));
        };
        let names: Vec<String> = words(line)
            .map(|name| String::from_utf8_lossy(name).into_owned())
            .collect();
        let missing = NEEDED
            .iter()
            .find(|needed| !names.iter().any(|name| name == *needed));
        match missing {
            None => Ok(Self { number, names }),
            Some(missing) => {
                let expected = NEEDED.join(", ");
                let message = format!("no column {missing}: expected {expected}");
                Err(text.line_error(number, message))
            }
        }
    }

    fn row(&self, text: &Text<'_>, number: u64, line: &[u8]) -> Result<Row, ReadError> {
        let fields: Vec<&[u8]> = words(line).collect();
        if fields.len() != self.names.len() {
            let (found, expected) = (fields.len(), self.names.len());
            let message = format!("{found} fields: expected {expected}, one for each column");
            return Err(text.line_error(number, message));
        }
        let value = |name: &str, expected: &str, accepts: fn(f64) -> bool| {
            let column = self.names.iter().position(|other| other == name);
            let field = column.and_then(|column| fields.get(column));
            let number = field
                .map(|field| text.number(number, name, &Field::plain(field), expected, accepts));
            number.unwrap_or(Ok(0.0))
        };
        let degrees = |x: f64| x.abs() <= 360.0;
        Ok(Row {
            temperature: value("Temperature", "expected a temperature", |_| true)?,
            wavelength_um: value("Wavelength", "expected micrometres above 0", is_wavelength)?,
            psi_deg: value("IncAngle", "expected degrees from 0 to 90", |x| {
                (0.0..=90.0).contains(&x)
            })?,
            source_azimuth_deg: value("AziAngle", "expected degrees", degrees)?,
            beta: value("ScatterBeta", "expected a distance from 0 to 2", |x| {
                (0.0..=2.0).contains(&x)
            })?,
            azimuth_deg: value("ScatterAzimuth", "expected degrees", degrees)?,
            brdf: value("BRDF", "expected a value in 1/sr", is_reading)?,
            btdf: value("BTDF", "expected a value in 1/sr", is_reading)?,
        })
    }
}

/// # Errors
///
/// There are no rows, or they are not of the reflection of one isotropic sample.
fn check_rows(text: &Text<'_>, line: u64, rows: &[Row], has_btdf: bool) -> Result<(), ReadError> {
    let count = |value: fn(&Row) -> f64| {
        let values = rows.iter().map(|row| value(row).to_bits());
        values.collect::<BTreeSet<u64>>().len()
    };
    let temperatures = count(|row| row.temperature);
    let azimuths = count(|row| row.source_azimuth_deg);
    let message = if rows.is_empty() {
        "no readings follow the names of the columns".to_owned()
    } else if temperatures > 1 {
        format!("{temperatures} temperatures: expected the table of one")
    } else if azimuths > 1 {
        format!(
            "{azimuths} azimuths of incidence (AziAngle): the surface is anisotropic, which the model cannot \
             follow; expected one"
        )
    } else if has_btdf && rows.iter().all(|row| row.brdf == 0.0) {
        "every BRDF is 0: the table is of transmission, which the model does not describe"
            .to_owned()
    } else {
        return Ok(());
    };
    Err(text.line_error(line, message))
}

/// The side of azimuth 0; `None` where the values are the same from both sides.
///
/// # Errors
///
/// The values differ, and the options do not state the side.
fn side_of_azimuth(
    text: &Text<'_>,
    rows: &[Row],
    options: &ReadOptions,
) -> Result<Option<Side>, ReadError> {
    if is_same_from_both_sides(rows) {
        return Ok(None);
    }
    options.phi_zero.map(Some).ok_or_else(|| {
        text.error(
            "the format does not state on which side ScatterAzimuth is 0, and the values depend on it: \
             expected the side of azimuth 0 in the options of the reading, source or forward",
        )
        .with_remedy(Some(Remedy::PhiZero))
    })
}

/// Whether each value is the same at the azimuths a and 180 deg - a.
fn is_same_from_both_sides(rows: &[Row]) -> bool {
    // Hundredths of a degree and the bits of the other numbers are exact keys.
    let key = |row: &Row, azimuth_deg: f64| {
        let turn = (100.0 * azimuth_deg.rem_euclid(360.0)).round() % 36_000.0;
        [row.wavelength_um, row.psi_deg, row.beta, turn + 0.0].map(f64::to_bits)
    };
    let values: BTreeMap<_, f64> = rows
        .iter()
        .map(|row| (key(row, row.azimuth_deg), row.brdf))
        .collect();
    rows.iter().filter(|row| row.beta > 0.0).all(|row| {
        let other = values.get(&key(row, 180.0 - row.azimuth_deg));
        other == Some(&row.brdf)
    })
}

/// The readings of the rows, with the numbers of those that are left out.
#[derive(Default)]
struct Readings {
    kept: Vec<Measurement>,
    /// The specular direction of the last row with one: wavelength, incidence and value.
    specular: Option<(f64, f64, f64)>,
    beyond: usize,
    repeated: usize,
}

impl Readings {
    fn add(&mut self, row: &Row, side: Side) {
        let specular = (row.wavelength_um, row.psi_deg, row.brdf);
        if row.beta == 0.0 {
            if self.specular == Some(specular) {
                self.repeated += 1;
                return;
            }
            self.specular = Some(specular);
        }
        let psi = row.psi_deg.to_radians();
        let azimuth = row.azimuth_deg.to_radians();
        let away = match side {
            Side::Source => 1.0,
            Side::Forward => -1.0,
        };
        let x = away * row.beta * azimuth.cos() - psi.sin();
        let y = row.beta * azimuth.sin();
        let sine = x.hypot(y);
        if row.psi_deg >= 90.0 || sine >= HORIZON {
            self.beyond += 1;
            return;
        }
        self.kept.push(Measurement {
            wavelength_um: Some(row.wavelength_um),
            psi,
            theta: sine.asin(),
            phi: y.atan2(x),
            brdf: row.brdf,
            sigma: None,
        });
    }

    fn conversions(&self, side: Option<Side>, has_btdf: bool) -> Vec<String> {
        let coordinates = "distances from the specular direction in direction cosines are converted to view angles";
        let side = match side {
            None => {
                "the values are the same from both sides, so that the zero of the azimuth does not matter"
            }
            Some(Side::Source) => "azimuth 0 is the source's side, as stated",
            Some(Side::Forward) => "azimuth 0 is the forward side, as stated",
        };
        let mut conversions = vec![coordinates.to_owned(), side.to_owned()];
        if has_btdf {
            conversions.push("the BTDF is not read".to_owned());
        }
        conversions.extend(left_out(self.beyond, BEYOND_HORIZON));
        conversions.extend(left_out(
            self.repeated,
            "of the specular direction at another azimuth",
        ));
        conversions
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use proptest::prelude::*;

    use super::*;

    /// A table at an incidence of 30 deg, whose sine is 0.5. The columns are separated as TracePro does it.
    fn table(rows: &str) -> String {
        format!(
            "TracePro Surface Property Data\nTracePro Release: 19 6 0\n\nName\tTest paint\nCatalog\tOurs\n\
             Description\t\nScatter    5\nPolarization\t0\n\nTemperature\tWavelength\tIncAngle\n300\t0.55\t30\n\
             Table_BSDF_Data\nTemperature\tWavelength\tIncAngle\tAziAngle\tScatterBeta\tScatterAzimuth\tBRDF\tBTDF\n\
             {rows}\nSAVE-DATA\n"
        )
    }

    fn row(beta: f64, azimuth: f64, brdf: f64) -> String {
        format!("300\t\t\t0.55\t\t30\t0\t{beta}\t\t{azimuth}\t{brdf}\t0\t\n")
    }

    fn read_with(text: &str, phi_zero: Option<Side>) -> Result<Measurements, ReadError> {
        let options = ReadOptions {
            phi_zero,
            ..ReadOptions::default()
        };
        read(Text::new(Path::new("a.txt"), text.as_bytes())?, &options)
    }

    fn error(text: &str) -> String {
        read_with(text, None).unwrap_err().to_string()
    }

    fn in_plane(scan: &Measurements) -> Vec<(f64, f64)> {
        let readings = scan.readings().iter();
        readings
            .map(|r| {
                let theta = r.in_plane_theta().unwrap().to_degrees();
                ((1e6 * theta).round() / 1e6, r.brdf)
            })
            .collect()
    }

    #[test]
    fn distances_from_the_specular_direction_are_converted_to_angles() {
        let rows = row(0.0, 0.0, 0.5)
            + &row(0.0, 180.0, 0.5)
            + &row(1.0, 0.0, 0.1)
            + &row(0.5, 0.0, 0.2)
            + &row(1.5, 0.0, 0.0)
            + &row(0.25, 180.0, 0.3);
        let scan = read_with(&table(&rows), Some(Side::Source)).unwrap();
        let forward = 0.75_f64.asin().to_degrees();
        let forward = (1e6 * forward).round() / 1e6;
        let expected = [(-30.0, 0.5), (30.0, 0.1), (0.0, 0.2), (-forward, 0.3)];
        assert_eq!(in_plane(&scan), expected);
        assert_eq!(scan.wavelengths(), [Some(0.55)]);
        assert_eq!(scan.metadata.get("sample"), Some("Test paint"));
        assert_eq!(scan.convention.phi_zero, Side::Source);
        let left_out = &scan.conversions[2..];
        assert_eq!(
            left_out,
            [
                "1 reading at or beyond 90 deg from the normal is left out",
                "1 reading of the specular direction at another azimuth is left out"
            ]
        );
        // From the other side, the same rows lie on the forward side.
        let scan = read_with(&table(&rows), Some(Side::Forward)).unwrap();
        let source = (1e6 * 0.25_f64.asin().to_degrees()).round() / 1e6;
        assert_eq!(in_plane(&scan), [(-30.0, 0.5), (-source, 0.3)]);
    }

    #[test]
    fn the_side_of_azimuth_zero_is_asked_where_it_matters() {
        let all_round = |value: fn(i32) -> f64| {
            let rows = (0..12).map(|i| row(0.1, 30.0 * f64::from(i), value(i)));
            table(&rows.collect::<String>())
        };
        let scan = read_with(&all_round(|_| 0.2), None).unwrap();
        assert_eq!(scan.readings().len(), 12);
        assert!(scan.conversions[1].contains("does not matter"));
        let asked = error(&all_round(|i| if i == 0 { 0.3 } else { 0.2 }));
        assert!(
            asked.contains("does not state on which side ScatterAzimuth is 0"),
            "{asked}"
        );
        // A single azimuth has no counterpart.
        assert!(error(&table(&row(0.1, 0.0, 0.2))).contains("on which side"));
    }

    #[test]
    fn other_properties_are_errors_that_say_what_they_are() {
        let rows = row(0.1, 90.0, 0.2);
        let with = |from: &str, to: &str| {
            let text = table(&rows);
            assert!(text.contains(from), "{from}");
            error(&text.replacen(from, to, 1))
        };
        assert_eq!(
            with("Polarization\t0", "Polarization\t1"),
            "a.txt, line 8: the property is of polarised light, of which no table can be read: expected \
             Polarization 0"
        );
        assert!(with("Table_BSDF_Data", "").contains("has no table of a BSDF"));
        assert!(with("ScatterBeta", "Beta").contains("line 13: no column ScatterBeta"));
        assert!(with("\t0.2\t", "\tx\t").contains("line 14, column BRDF: \"x\" is not a number"));
        assert!(
            with("\t30\t0\t", "\t95\t0\t")
                .contains("line 14, column IncAngle: \"95\" is out of range")
        );
        assert!(
            with("\t0.1\t", "\t2.5\t")
                .contains("line 14, column ScatterBeta: \"2.5\" is out of range")
        );
        assert!(with("\t0\t\n", "\n").contains("line 14: 7 fields: expected 8"));
        assert!(with("SAVE-DATA", "Table_BSDF_Data").contains("a second table"));
        assert!(error(&table("")).contains("line 13: no readings follow"));
        let two = |other: String| error(&table(&(row(0.1, 90.0, 0.2) + &other)));
        assert!(two(row(0.1, 90.0, 0.2).replacen("300", "77", 1)).contains("2 temperatures"));
        assert!(
            two(row(0.1, 90.0, 0.2).replacen("30\t0\t", "30\t45\t", 1)).contains("anisotropic")
        );
        let through = row(0.1, 90.0, 0.0).replace("\t0\t\n", "\t0.5\t\n");
        assert!(error(&table(&through)).contains("the table is of transmission"));
        let both = row(0.1, 90.0, 0.2).replace("\t0\t\n", "\t0.5\t\n");
        let scan = read_with(&table(&both), None).unwrap();
        assert!(
            scan.conversions
                .contains(&"the BTDF is not read".to_owned())
        );
    }

    #[test]
    fn the_format_is_known_by_its_first_line() {
        assert!((READER.recognises)(table("").as_bytes()));
        assert!(!(READER.recognises)(b"TracePro Material Property Data\n"));
    }

    proptest! {
        #[test]
        fn any_rows_are_read_or_refused(rows in "([0-9.e \t\n-]|nan|inf|SAVE-DATA){0,200}") {
            for side in [None, Some(Side::Source), Some(Side::Forward)] {
                if let Ok(scan) = read_with(&table(&rows), side) {
                    for reading in scan.readings() {
                        reading.validated().unwrap();
                    }
                }
            }
        }

        #[test]
        fn the_distance_is_that_from_the_specular_direction(
            beta in 0.01..0.4_f64,
            azimuth in 0.0..360.0_f64,
        ) {
            let scan = read_with(&table(&row(beta, azimuth, 0.2)), Some(Side::Source)).unwrap();
            let reading = scan.readings()[0];
            let (x, y) = (reading.theta.sin() * reading.phi.cos(), reading.theta.sin() * reading.phi.sin());
            prop_assert!(((x + 0.5).hypot(y) - beta).abs() < 1e-12);
        }
    }
}
