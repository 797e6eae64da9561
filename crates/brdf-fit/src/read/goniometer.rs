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
//! and a reading for each incidence. All angles are in degrees, psi in [0, 90), theta in (-90, 90) and
//! signed, by default positive on the source's side. A cell that is empty, `-` or `nan` is a reading that
//! was not taken. Fields are separated by tabs, semicolons, commas or spaces; a decimal comma is accepted
//! where the separator is not the comma.
//!
//! Comments are as in [`csv`](super::csv), with the keys
//! - `quantity`: `brdf` (f_r in 1/sr, the default), `brdf_cos` (f_r cos theta, divided by cos theta) or
//!   `reflectance_factor` (pi f_r, divided by pi);
//! - `refractive_index`, as there;
//! - `wavelength_um`: the wavelength in um;
//! - `phi_deg`: the view azimuth phi in degrees, 0 by default, for a table outside the plane of
//!   incidence.
//!
//! There is no standard for such tables: this is the common form of goniometers' spreadsheets. The
//! files of the Black Lab have another form, see [`black_lab`](super::black_lab).

use super::comments::{Comments, comment_of, number_of_key};
use super::conversion::{Quantity, left_out};
use super::error::ReadError;
use super::fields;
use super::number::{Field, is_angle, is_reading, is_wavelength, parse_number};
use super::text::{Text, lines};
use crate::scan::{Convention, Format, Measurement, Measurements};

const PSI: &str = "incidence";
const THETA: &str = "view";
const EXPECTED_PSI: &str = "expected degrees from 0 to below 90";
const EXPECTED_THETA: &str = "expected degrees between -90 and 90";

/// # Errors
///
/// The text is not such a table.
pub(super) fn read(text: Text<'_>, convention: Convention) -> Result<Measurements, ReadError> {
    let mut comments = Comments::default();
    let mut table: Option<Table> = None;
    for line in text.checked_lines() {
        let (number, line) = line?;
        match (comment_of(line), &mut table) {
            (Some(comment), _) => comments.add(&text, number, comment)?,
            (None, _) if line.trim_ascii().is_empty() => {}
            (None, None) => table = Some(Table::new(&text, number, line)?),
            (None, Some(table)) => table.add_row(&text, number, line)?,
        }
    }
    let table = table.ok_or_else(|| text.error("has no line of incidence angles"))?;
    if table.cells.is_empty() {
        return Err(text.line_error(table.number, "no readings follow the incidence angles"));
    }
    table.measurements(&text, comments, convention)
}

/// Whether a text begins with such a table.
pub(super) fn is_table(head: &[u8]) -> bool {
    let is_row = |line: &&[u8]| comment_of(line).is_none() && !line.trim_ascii().is_empty();
    let mut rows = lines(head).map(|(_, line)| line).filter(is_row);
    let (Some(header), Some(first)) = (rows.next(), rows.next()) else {
        return false;
    };
    let Some(separator) = Separator::of(header) else {
        return false;
    };
    let fields = separator.fields(first).unwrap_or_default();
    let theta = fields.first();
    theta.is_some_and(|theta| parse_number(theta, separator.decimal_comma()).is_some())
}

/// The separator of the fields.
#[derive(Clone, Copy)]
enum Separator {
    Byte(u8),
    Spaces,
}

impl Separator {
    /// The separator by which a line is a corner and numbers.
    fn of(header: &[u8]) -> Option<Self> {
        let all = [b'\t', b';', b','].map(Self::Byte);
        let mut all = all.into_iter().chain([Self::Spaces]);
        all.find(|separator| {
            let fields = separator.fields(header).unwrap_or_default();
            let number = |field: &[u8]| parse_number(field, separator.decimal_comma()).is_some();
            match fields.as_slice() {
                [corner, incidences @ ..] if !incidences.is_empty() => {
                    !number(corner) && incidences.iter().all(|field| number(field))
                }
                _ => false,
            }
        })
    }

    fn decimal_comma(self) -> bool {
        !matches!(self, Self::Byte(b','))
    }

    /// The fields of a line, without blank fields at its end.
    ///
    /// # Errors
    ///
    /// A quote is not closed, or text follows a closing quote.
    fn fields(self, line: &[u8]) -> Result<Vec<&[u8]>, &'static str> {
        let mut found = Vec::new();
        match self {
            Self::Byte(byte) => fields::split(line, byte, &mut found)?,
            Self::Spaces => found.extend(
                line.split(u8::is_ascii_whitespace)
                    .filter(|f| !f.is_empty()),
            ),
        }
        while found.len() > 1
            && found
                .last()
                .is_some_and(|field| field.trim_ascii().is_empty())
        {
            found.pop();
        }
        Ok(found)
    }
}

/// The table as it is in the file.
struct Table {
    /// The number of the line of incidence angles.
    number: u64,
    separator: Separator,
    psi_deg: Vec<f64>,
    /// Incidence and view angle in degrees and the reading, in the order of the file.
    cells: Vec<[f64; 3]>,
    not_taken: usize,
}

impl Table {
    fn new(text: &Text<'_>, number: u64, line: &[u8]) -> Result<Self, ReadError> {
        let Some(separator) = Separator::of(line) else {
            let message = "expected a corner and incidence angles in degrees, such as \
                           \"theta_deg, 10, 30, 50\"";
            return Err(text.line_error(number, message));
        };
        let fields = separator.fields(line);
        let fields = fields.map_err(|message| text.line_error(number, message))?;
        let psi = |field: &&[u8]| {
            let field = Field {
                text: field,
                decimal_comma: separator.decimal_comma(),
            };
            let accepts = |psi: f64| (0.0..90.0).contains(&psi);
            text.number(number, PSI, &field, EXPECTED_PSI, accepts)
        };
        let psi_deg = fields.iter().skip(1).map(psi);
        Ok(Self {
            number,
            separator,
            psi_deg: psi_deg.collect::<Result<_, _>>()?,
            cells: Vec::new(),
            not_taken: 0,
        })
    }

    fn add_row(&mut self, text: &Text<'_>, number: u64, line: &[u8]) -> Result<(), ReadError> {
        let fields = self.separator.fields(line);
        let fields = fields.map_err(|message| text.line_error(number, message))?;
        let decimal_comma = self.separator.decimal_comma();
        let (found, expected) = (fields.len(), self.psi_deg.len() + 1);
        if found > expected {
            let message = format!("{found} fields: expected {expected}, one for each column");
            return Err(text.line_error(number, message));
        }
        let field = |column: usize| Field {
            text: fields.get(column).copied().unwrap_or_default(),
            decimal_comma,
        };
        let accepts = |theta: f64| theta.abs() < 90.0;
        let theta_deg = text.number(number, THETA, &field(0), EXPECTED_THETA, accepts)?;
        for (i, &psi_deg) in self.psi_deg.iter().enumerate() {
            let cell = field(i + 1);
            if was_not_taken(cell.text) {
                self.not_taken += 1;
                continue;
            }
            let name = format!("incidence {psi_deg}");
            let reading = text.number(number, &name, &cell, "expected a reading", is_reading)?;
            self.cells.push([psi_deg, theta_deg, reading]);
        }
        Ok(())
    }

    fn measurements(
        self,
        text: &Text<'_>,
        comments: Comments,
        convention: Convention,
    ) -> Result<Measurements, ReadError> {
        let number = |key, expected, accepts| {
            number_of_key(text, &comments.metadata, key, expected, accepts)
        };
        let expected = "expected micrometres above 0";
        let wavelength_um = number("wavelength_um", expected, is_wavelength)?;
        let phi_deg = number("phi_deg", "expected degrees", is_angle)?.unwrap_or(0.0);
        let quantity = comments.quantity.unwrap_or(Quantity::Brdf);
        let reading = |[psi_deg, theta_deg, reading]: [f64; 3]| {
            let (theta, phi) = convention.in_model(theta_deg, phi_deg);
            Measurement {
                wavelength_um,
                psi: psi_deg.to_radians(),
                theta,
                phi,
                brdf: quantity.to_brdf(reading, theta),
                sigma: None,
            }
        };
        let mut conversions: Vec<String> = quantity.conversion().into_iter().collect();
        conversions.extend(left_out(self.not_taken, "not taken (empty cells)"));
        Ok(Measurements {
            source: text.path.display().to_string(),
            metadata: comments.metadata,
            refractive_index: comments.refractive_index,
            convention,
            format: Format::Goniometer,
            conversions,
            readings: self.cells.into_iter().map(reading).collect(),
            ..Measurements::default()
        })
    }
}

fn was_not_taken(field: &[u8]) -> bool {
    let field = field.trim_ascii();
    field.is_empty() || field == b"-" || field.eq_ignore_ascii_case(b"nan")
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::scan::Side;

    const TWO: &str = "# wavelength_um: 0.63\n# refractive_index: 1.5\n\n\
                       theta_deg,10,30\n-60,0.1,0.2\n20,,0.4\n";

    fn read_as(content: &str, convention: Convention) -> Result<Measurements, ReadError> {
        read(
            Text::new(Path::new("a.txt"), content.as_bytes())?,
            convention,
        )
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
            ["1 reading not taken (empty cells) is left out"]
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
        assert!(error("t,10,95\n").contains("column incidence: \"95\" is out of range"));
        assert!(error("t,10\n91,0.1\n").contains("line 2, column view: \"91\" is out of range"));
        assert!(error("t,10\n1,0.1,2\n").contains("line 2: 3 fields: expected 2"));
        assert!(error("t,10\n1,x\n").contains("column incidence 10: \"x\" is not a number"));
        assert!(error("t,10\n").contains("line 1: no readings follow"));
        assert!(error("# a: b\n").contains("has no line of incidence angles"));
        assert!(error("# wavelength_um: red\nt,10\n1,1\n").contains("wavelength_um: \"red\""));
        let twice = "# phi_deg: 1\n# phi_deg: 2\nt,10\n1,1\n";
        assert!(error(twice).contains("phi_deg is given twice"));
    }

    #[test]
    fn a_table_of_numbers_alone_is_not_recognised() {
        assert!(!is_table(b"1,2,3\n4,5,6\n"));
        assert!(!is_table(b"theta,10,30\n"));
        assert!(!is_table(b"a,b\n1,2\n"));
    }
}
