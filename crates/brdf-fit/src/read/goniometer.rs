//! Plain goniometer tables: incidence angles in columns, view angles in rows.
//!
//! ```text
//! # sample: Test paint
//! # wavelength_um: 0.63
//! # quantity: brdf
//! theta_deg, 10,    30,    50
//! -60,       0.010, 0.013, 0.031
//! -50,       0.010, ,      0.022
//! ```
//!
//! (The numbers are made up.) The first line that is not a comment holds the incidence zenith angles
//! psi, after a corner that is empty or not a number. Each further line holds a view zenith angle theta
//! and a reading for each incidence. All angles are in degrees; theta is signed, by default positive on the
//! source's side. Readings at or beyond 90 deg are left out and counted, as are cells that are empty, `-` or
//! `nan`. Fields are separated by tabs, semicolons, commas or spaces; a decimal comma is accepted where the
//! separator is not the comma.
//!
//! The columns may also be azimuths phi, at one incidence that `# psi_deg:` gives. They are taken for
//! azimuths where the corner or `# columns: azimuth` says so, where one is negative or above 90 deg, and
//! where all readings at theta = 0 are equal. They are taken for incidences where the corner or
//! `# columns: incidence` says so, where the readings at theta = 0 differ, and where view angles are
//! negative. Anything else is an error that asks.
//!
//! Comments are as in [`csv`](super::csv), with its keys `quantity`, `unit`, `factor`, `missing`,
//! `refractive_index`, `wavelength_um`, `wavelength_nm`, and
//! - `phi_deg`: the view azimuth phi in degrees, 0 by default, for a table outside the plane of
//!   incidence;
//! - `source_azimuth_deg`: the azimuth of the source in degrees, 0 by default, from which phi is counted;
//! - `psi_deg` and `columns`, as above.
//!
//! There is no standard for such tables: this is the common form of goniometers' spreadsheets. The
//! files of the Black Lab have another form, see [`black_lab`](super::black_lab).

use super::comments::{Comments, SOURCE_AZIMUTH, comment_of, number_of_key, stated_wavelength_um};
use super::conversion::{LeftOut, Quantity};
use super::error::{ReadError, Remedy};
use super::fields::Separator;
use super::number::{Field, is_angle, is_reading, parse_number};
use super::options::ReadOptions;
use super::reader::{Content, Reader};
use super::text::{Text, head_lines};
use crate::scan::{Convention, Format, Measurement, Measurements};

pub(super) const READER: Reader = Reader {
    format: Format::Goniometer,
    // These files have no extension of their own.
    extensions: &[],
    recognises: is_table,
    content: Content::Table(read),
};

const COLUMN: &str = "angles";
const VIEW: &str = "view";

/// # Errors
///
/// The text is not such a table.
pub(super) fn read(text: Text<'_>, options: &ReadOptions) -> Result<Measurements, ReadError> {
    if let Some((name, role)) = options.columns.first() {
        let message = format!(
            "\"{name}={role}\": the columns of a table of incidence angles have no names; a line \
             \"# columns: incidence\" or \"# columns: azimuth\" says what they are"
        );
        return Err(text.error(message).with_remedy(Some(Remedy::ColumnAngles)));
    }
    let convention = options.convention(Convention::default());
    let mut comments = Comments::declared(&text, &options.declarations)?;
    let mut table: Option<Table> = None;
    for line in text.checked_lines() {
        let (number, line) = line?;
        match (comment_of(line), &mut table) {
            (Some(comment), _) => comments.add(&text, number, comment)?,
            (None, _) if line.trim_ascii().is_empty() => {}
            (None, None) => table = Some(Table::new(&text, number, line, comments.missing())?),
            (None, Some(table)) => table.add_row(&text, number, line)?,
        }
    }
    let table = table.ok_or_else(|| text.error("has no line of incidence angles"))?;
    if table.rows.is_empty() {
        return Err(text.line_error(table.number, "no readings follow the incidence angles"));
    }
    table.measurements(&text, comments, convention)
}

/// Whether a text begins with such a table.
fn is_table(head: &[u8]) -> bool {
    let is_row = |line: &&[u8]| comment_of(line).is_none() && !line.trim_ascii().is_empty();
    let mut rows = head_lines(head).filter(is_row);
    let (Some(header), Some(first)) = (rows.next(), rows.next()) else {
        return false;
    };
    let Some(separator) = separator_of(header) else {
        return false;
    };
    let fields = fields(separator, first).unwrap_or_default();
    let theta = fields.first();
    theta.is_some_and(|theta| parse_number(theta, decimal_comma(separator)).is_some())
}

/// The separator by which a line is a corner and numbers.
fn separator_of(header: &[u8]) -> Option<Separator> {
    Separator::ALL.into_iter().find(|separator| {
        let fields = fields(*separator, header).unwrap_or_default();
        let number = |field: &[u8]| parse_number(field, decimal_comma(*separator)).is_some();
        match fields.as_slice() {
            [corner, incidences @ ..] if !incidences.is_empty() => {
                !number(corner) && incidences.iter().all(|field| number(field))
            }
            _ => false,
        }
    })
}

fn decimal_comma(separator: Separator) -> bool {
    separator != Separator::Byte(b',')
}

/// The fields of a line, without blank fields at its end.
///
/// # Errors
///
/// A quote is not closed, or text follows a closing quote.
fn fields(separator: Separator, line: &[u8]) -> Result<Vec<&[u8]>, &'static str> {
    let mut found = Vec::new();
    separator.split(line, &mut found)?;
    while found.len() > 1
        && found
            .last()
            .is_some_and(|field| field.trim_ascii().is_empty())
    {
        found.pop();
    }
    Ok(found)
}

/// What the columns of a table are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Columns {
    Incidences,
    Azimuths,
}

impl Columns {
    fn named(name: &str) -> Option<Self> {
        match name {
            "incidence" | "psi_deg" => Some(Self::Incidences),
            "azimuth" | "phi_deg" => Some(Self::Azimuths),
            _ => None,
        }
    }

    /// What the corner above the view angles says of the columns.
    fn of_corner(corner: &[u8]) -> Option<Self> {
        let corner = String::from_utf8_lossy(corner).to_lowercase();
        let has = |words: &[&str]| words.iter().any(|word| corner.contains(word));
        match (
            has(&["psi", "incid", "aoi", "theta_i", "ψ"]),
            has(&["phi", "azim", "φ", "ϕ"]),
        ) {
            (true, false) => Some(Self::Incidences),
            (false, true) => Some(Self::Azimuths),
            _ => None,
        }
    }
}

/// The table as it is in the file.
struct Table {
    /// The number of the line above the columns.
    number: u64,
    separator: Separator,
    corner: Option<Columns>,
    /// The angle of each column in degrees.
    columns_deg: Vec<f64>,
    /// The view angle of each row in degrees, and its readings.
    rows: Vec<(f64, Vec<Option<f64>>)>,
    missing: Option<f64>,
}

impl Table {
    fn new(
        text: &Text<'_>,
        number: u64,
        line: &[u8],
        missing: Option<f64>,
    ) -> Result<Self, ReadError> {
        let Some(separator) = separator_of(line) else {
            let message = "expected a corner and incidence angles in degrees, such as \
                           \"theta_deg, 10, 30, 50\"";
            return Err(text.line_error(number, message));
        };
        let fields = fields(separator, line);
        let fields = fields.map_err(|message| text.line_error(number, message))?;
        let column = |field: &&[u8]| {
            let field = Field {
                text: field,
                decimal_comma: decimal_comma(separator),
            };
            text.number(number, COLUMN, &field, "expected degrees", is_angle)
        };
        let columns_deg = fields.iter().skip(1).map(column);
        Ok(Self {
            number,
            separator,
            corner: Columns::of_corner(fields[0]),
            columns_deg: columns_deg.collect::<Result<_, _>>()?,
            rows: Vec::new(),
            missing,
        })
    }

    fn add_row(&mut self, text: &Text<'_>, number: u64, line: &[u8]) -> Result<(), ReadError> {
        let fields = fields(self.separator, line);
        let fields = fields.map_err(|message| text.line_error(number, message))?;
        let decimal_comma = decimal_comma(self.separator);
        let (found, expected) = (fields.len(), self.columns_deg.len() + 1);
        if found > expected {
            let message = format!("{found} fields: expected {expected}, one for each column");
            return Err(text.line_error(number, message));
        }
        let field = |column: usize| Field {
            text: fields.get(column).copied().unwrap_or_default(),
            decimal_comma,
        };
        let theta_deg = text.number(number, VIEW, &field(0), "expected degrees", is_angle)?;
        let cell = |(i, column_deg): (usize, &f64)| {
            let name = format!("of {column_deg} deg");
            text.reading(number, &name, &field(i + 1), self.missing)
        };
        let cells = self.columns_deg.iter().enumerate().map(cell);
        let cells = cells.collect::<Result<_, ReadError>>()?;
        self.rows.push((theta_deg, cells));
        Ok(())
    }

    /// What the columns are, by their corner or by the numbers; `None` where neither says it.
    ///
    /// Incidences are from 0 to below 90 deg. At theta = 0 the direction does not depend on the azimuth,
    /// so that all azimuths have one reading, but incidences have not. Negative view angles are those of a
    /// scan through both sides, for which no table has azimuths.
    fn columns(&self) -> Option<Columns> {
        let beyond = |angle: &f64| !(0.0..=90.0).contains(angle);
        if self.corner.is_some() {
            return self.corner;
        }
        if self.columns_deg.iter().any(beyond) {
            return Some(Columns::Azimuths);
        }
        let normal = self.rows.iter().find(|(theta_deg, _)| *theta_deg == 0.0);
        let normal: Vec<f64> = normal
            .map(|(_, cells)| cells.iter().copied().flatten().collect())
            .unwrap_or_default();
        if let [first, others @ ..] = normal.as_slice()
            && others.len() >= 2
        {
            let same = |other: &f64| (other - first).abs() <= 1e-9 * first.abs();
            return Some(if others.iter().all(same) {
                Columns::Azimuths
            } else {
                Columns::Incidences
            });
        }
        let one_column = self.columns_deg.len() == 1;
        let both_sides = self.rows.iter().any(|(theta_deg, _)| *theta_deg < 0.0);
        (one_column || both_sides).then_some(Columns::Incidences)
    }

    fn measurements(
        self,
        text: &Text<'_>,
        comments: Comments,
        convention: Convention,
    ) -> Result<Measurements, ReadError> {
        let problem = |message: String| text.line_error(self.number, message);
        let stated = match comments.metadata.get("columns") {
            None => None,
            Some(name) => Some(Columns::named(name).ok_or_else(|| {
                text.error(format!(
                    "columns: \"{name}\": expected incidence or azimuth"
                ))
            })?),
        };
        let columns = stated.or_else(|| self.columns()).ok_or_else(|| {
            problem(
                "the angles of the columns may be incidences or azimuths: expected a line \"# columns: \
                 incidence\" or \"# columns: azimuth\" in the file"
                    .to_owned(),
            )
            .with_remedy(Some(Remedy::ColumnAngles))
        })?;
        let number = |key, expected, accepts| {
            number_of_key(text, &comments.metadata, key, expected, accepts)
        };
        let wavelength_um = stated_wavelength_um(text, &comments.metadata)?;
        let phi_deg = number("phi_deg", "expected degrees", is_angle)?.unwrap_or(0.0);
        let source_deg = number(SOURCE_AZIMUTH, "expected degrees", is_angle)?.unwrap_or(0.0);
        let expected = "expected degrees from 0 to below 90";
        let psi_deg = number("psi_deg", expected, |psi| (0.0..90.0).contains(&psi))?;
        if columns == Columns::Azimuths && psi_deg.is_none() {
            return Err(problem(
                "the columns are azimuths, and the incidence angle is not given: expected a line such as \
                 \"# psi_deg: 30\" in the file"
                    .to_owned(),
            )
            .with_remedy(Some(Remedy::Incidence)));
        }
        let values = comments.values(Quantity::BRDF).map_err(problem)?;
        let mut left = LeftOut::default();
        let mut readings = Vec::new();
        for (theta_deg, cells) in &self.rows {
            for (&column_deg, cell) in self.columns_deg.iter().zip(cells) {
                let (psi_deg, phi_deg) = match columns {
                    Columns::Incidences => (column_deg, phi_deg),
                    Columns::Azimuths => (psi_deg.unwrap_or(0.0), column_deg),
                };
                let Some(reading) = *cell else {
                    left.not_taken += 1;
                    continue;
                };
                if !(0.0..90.0).contains(&psi_deg) || theta_deg.abs() >= 90.0 {
                    left.beyond += 1;
                    continue;
                }
                let (theta, phi) = convention.in_model(*theta_deg, phi_deg - source_deg);
                let brdf = values.to_brdf(reading, theta);
                if !is_reading(brdf) {
                    let message =
                        format!("\"{reading}\" is out of range: f_r would be {brdf:e} 1/sr");
                    return Err(problem(message));
                }
                readings.push(Measurement {
                    wavelength_um,
                    psi: psi_deg.to_radians(),
                    theta,
                    phi,
                    brdf,
                    sigma: None,
                });
            }
        }
        if readings.is_empty() {
            return Err(problem("no readings above the surface follow".to_owned()));
        }
        let mut conversions = values.conversions();
        if columns == Columns::Azimuths {
            conversions.push("the columns are azimuths".to_owned());
        }
        conversions.extend(left.notes());
        Ok(Measurements {
            source: text.path.display().to_string(),
            metadata: comments.metadata,
            refractive_index: comments.refractive_index,
            convention,
            format: Format::Goniometer,
            conversions,
            readings,
            ..Measurements::default()
        })
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::scan::Side;

    const TWO: &str = "# wavelength_um: 0.63\n# refractive_index: 1.5\n\n\
                       theta_deg,10,30\n-60,0.1,0.2\n20,,0.4\n";

    fn read_as(content: &str, convention: Convention) -> Result<Measurements, ReadError> {
        let options = ReadOptions {
            theta_positive: Some(convention.theta_positive),
            ..ReadOptions::default()
        };
        read(Text::new(Path::new("a.txt"), content.as_bytes())?, &options)
    }

    fn scan(content: &str) -> Measurements {
        read_as(content, Convention::default()).unwrap()
    }

    fn error(content: &str) -> String {
        let read = read_as(content, Convention::default());
        read.unwrap_err().to_string()
    }

    fn cells(scan: &Measurements) -> Vec<(f64, f64, f64)> {
        let readings = scan.readings().iter();
        readings
            .map(|r| {
                (
                    r.psi.to_degrees().round(),
                    r.theta.to_degrees().round(),
                    r.brdf,
                )
            })
            .collect()
    }

    #[test]
    fn each_cell_is_a_reading_and_empty_cells_are_counted() {
        let scan = scan(TWO);
        let expected = [(10.0, -60.0, 0.1), (30.0, -60.0, 0.2), (30.0, 20.0, 0.4)];
        assert_eq!(cells(&scan), expected);
        assert_eq!(scan.wavelengths(), [Some(0.63)]);
        assert_eq!(scan.refractive_index.unwrap().at(Some(0.63)), Some(1.5));
        assert_eq!(
            scan.conversions,
            ["1 reading not taken (no value) is left out"]
        );
    }

    #[test]
    fn fields_are_separated_by_tabs_semicolons_commas_or_spaces() {
        let expected = cells(&scan(TWO));
        for text in [
            "\t10\t30\n-60\t0,1\t0,2\n20\t\t0,4\n",
            "view;10;30\n-60;0,1;0,2\n20;-;0,4;\n",
            "theta 10 30\n-60 0.1 0.2\n20 NaN 0.4\n",
        ] {
            assert!(is_table(text.as_bytes()), "{text:?}");
            assert_eq!(cells(&scan(text)), expected, "{text:?}");
        }
    }

    #[test]
    fn other_conventions_planes_and_quantities_are_converted_once() {
        let forward = Convention {
            theta_positive: Side::Forward,
            ..Convention::default()
        };
        let scan = read_as("t,10\n60,0.5\n", forward).unwrap();
        assert_eq!(scan.readings()[0].theta, -60_f64.to_radians());
        let across = "# phi_deg: 90\n# quantity: brdf_cos\nt,10\n60,0.5\n";
        let across = read_as(across, Convention::default()).unwrap();
        assert_eq!(across.readings()[0].phi, 90_f64.to_radians());
        assert!((across.readings()[0].brdf - 1.0).abs() < 1e-15);
        assert!(across.conversions[0].contains("divided by cos theta"));
    }

    #[test]
    fn errors_name_line_column_and_value() {
        assert!(error("1,2,3\n").contains("line 1: expected a corner and incidence angles"));
        assert!(error("t,10,95\n1,2,3\n").contains("the columns are azimuths"));
        assert!(error("t,10\n91,0.1\n").contains("no readings above the surface"));
        assert!(error("t,10\n1,0.1,2\n").contains("line 2: 3 fields: expected 2"));
        assert!(error("t,10\n1,x\n").contains("column of 10 deg: \"x\" is not a number"));
        assert!(error("t,10\n").contains("line 1: no readings follow"));
        assert!(error("# a: b\n").contains("has no line of incidence angles"));
        assert!(error("# wavelength_um: red\nt,10\n1,1\n").contains("wavelength_um: \"red\""));
        let twice = "# phi_deg: 1\n# phi_deg: 2\nt,10\n1,1\n";
        assert!(error(twice).contains("phi_deg is given twice"));
    }

    #[test]
    fn azimuths_are_never_taken_for_incidences() {
        for evident in [
            "x,-90,0,90\n0,1,1,1\n10,1,2,3\n",
            "x,0,15,30\n0,1,1,1\n10,1,2,3\n",
            "theta\\phi,0,15\n10,1,2\n",
        ] {
            assert!(
                error(evident).contains("the columns are azimuths"),
                "{evident}"
            );
            let scan = scan(&format!("# psi_deg: 30\n{evident}"));
            assert!(
                scan.readings()
                    .iter()
                    .all(|reading| reading.psi == 30_f64.to_radians())
            );
        }
        assert!(error("x,10,30\n10,1,2\n20,1,2\n").contains("incidences or azimuths"));
        for evident in [
            "x,10,30,50\n0,1,2,3\n",
            "psi,10,30\n10,1,2\n",
            "x,10,30\n-10,1,2\n",
        ] {
            assert_eq!(cells(&scan(evident))[0].0, 10.0, "{evident}");
        }
    }

    #[test]
    fn azimuths_are_counted_from_that_of_the_source() {
        let scan = scan("# phi_deg: 210\n# source_azimuth_deg: 180\nt,10\n-5,1\n");
        assert_eq!(scan.readings()[0].phi, 30_f64.to_radians());
    }

    #[test]
    fn columns_without_names_cannot_be_renamed() {
        let options = ReadOptions {
            columns: vec![("a".to_owned(), "psi_deg".to_owned())],
            ..ReadOptions::default()
        };
        let text = Text::new(Path::new("a.txt"), TWO.as_bytes()).unwrap();
        let error = read(text, &options).unwrap_err();
        assert!(
            error.to_string().contains("\"a=psi_deg\": the columns"),
            "{error}"
        );
        assert_eq!(error.remedy(), Some(Remedy::ColumnAngles));
    }

    #[test]
    fn readings_at_the_horizon_are_left_out_and_counted() {
        let scan = scan("psi,10,90\n-90,0,0\n20,0.1,0\n");
        assert_eq!(scan.readings().len(), 1);
        assert_eq!(
            scan.conversions,
            ["3 readings at or beyond 90 deg from the normal are left out"]
        );
    }

    #[test]
    fn a_table_of_numbers_alone_is_not_recognised() {
        assert!(!is_table(b"1,2,3\n4,5,6\n"));
        assert!(!is_table(b"theta,10,30\n"));
        assert!(!is_table(b"a,b\n1,2\n"));
    }
}
