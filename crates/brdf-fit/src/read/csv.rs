//! Tables of readings as text: separated by commas, semicolons or tabs.
//!
//! | column | unit | |
//! |---|---|---|
//! | `psi_deg` | deg, [0, 90) | incidence zenith angle |
//! | `theta_deg` | deg, (-90, 90) | view zenith angle, signed in the plane of incidence |
//! | `brdf_per_sr` | 1/sr | the reading, in the quantity of the header |
//! | `wavelength_um` | um, > 0 | optional |
//! | `phi_deg` | deg | optional, 0 where it is missing |
//! | `sigma_per_sr` | 1/sr, > 0 | optional, also in single rows; in the same quantity as the reading |
//! | `n` | [1, 1e5] | optional, one value for each wavelength |
//!
//! Columns are found by their names, in any order; others are left out and listed. Lines that
//! begin with `#` are comments; `# key: value` is kept as metadata, and a comment that names the
//! columns is the header. `# quantity:` may be `brdf`
//! (f_r, also where nothing is said), `brdf_cos` (f_r cos theta) or `reflectance_factor` (pi f_r)
//! and is converted once, here. `# refractive_index: 1.5` or `0.63=1.60,0.85=1.58` gives n.
//! A decimal comma is understood where the separator is not a comma. A byte order mark and the
//! line ends of any system are understood.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use brdf_core::check_refractive_index;

use super::text::{
    Field, Quantity, Said, Text, comment_of, is_deviation, is_reading, read_bytes, shown,
};
use super::{ReadError, fields};
use crate::scan::Convention;
use crate::scan::RefractiveIndex;
use crate::scan::{Measurement, Measurements};

impl Measurements {
    /// Reads a file in the model's convention.
    ///
    /// Errors name the file, the line, the column and the value, and say what was expected.
    pub fn read_csv(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        Self::read_csv_with(path, Convention::default())
    }

    /// Reads a file in another angular convention.
    pub fn read_csv_with(
        path: impl AsRef<Path>,
        convention: Convention,
    ) -> Result<Self, ReadError> {
        let path = path.as_ref();
        let io = |error| ReadError::Io {
            path: path.to_owned(),
            error,
        };
        let file = File::open(path).map_err(io)?;
        let size = file.metadata().map_err(io)?.len();
        from(file, size, path, convention)
    }

    /// Reads from anything that yields the text of such a file, in the model's convention.
    pub fn from_reader(reader: impl Read) -> Result<Self, ReadError> {
        Self::from_reader_with(reader, "input", Convention::default())
    }

    /// Reads from anything that yields the text of such a file; `name` stands for the file in
    /// errors and reports.
    pub fn from_reader_with(
        reader: impl Read,
        name: &str,
        convention: Convention,
    ) -> Result<Self, ReadError> {
        from(reader, 0, Path::new(name), convention)
    }
}

fn from(
    reader: impl Read,
    expected_size: u64,
    path: &Path,
    convention: Convention,
) -> Result<Measurements, ReadError> {
    let bytes = read_bytes(Vec::new(), reader, expected_size).map_err(|error| ReadError::Io {
        path: path.to_owned(),
        error,
    })?;
    read(Text::new(path, &bytes)?, convention)
}

pub(super) fn read(text: Text<'_>, convention: Convention) -> Result<Measurements, ReadError> {
    let input = Input { text };
    let preamble = input.preamble()?;
    input.measurements(preamble, convention)
}

/// Whether this is the line that names the columns.
pub(super) fn is_header(line: &[u8]) -> bool {
    names_the_columns(comment_of(line).unwrap_or(line))
}

/// The text of a table.
struct Input<'a> {
    text: Text<'a>,
}

/// What the comments and the header line say.
struct Preamble<'a> {
    said: Said,
    header: Header<'a>,
    /// Lines after the header: as many readings at the most.
    lines_after: usize,
}

/// The line that names the columns.
struct Header<'a> {
    /// Its number, from 1.
    number: u64,
    /// Its text, without a leading `#`.
    line: &'a [u8],
    separator: u8,
}

impl<'a> Header<'a> {
    fn new(number: u64, line: &'a [u8]) -> Self {
        Self {
            number,
            line,
            separator: separator_of(line),
        }
    }
}

impl<'a> Input<'a> {
    /// Looks at each line once: its length, what the comments say, and which is the header.
    fn preamble(&self) -> Result<Preamble<'a>, ReadError> {
        let mut said = Said::default();
        let mut header = None;
        let mut lines_after = 0;
        for (number, line) in self.text.lines() {
            self.text.check_length(number, line)?;
            match comment_of(line) {
                Some(comment) if header.is_none() && names_the_columns(comment) => {
                    header = Some(Header::new(number, comment));
                }
                Some(comment) => said
                    .add(&String::from_utf8_lossy(comment))
                    .map_err(|message| self.text.line_error(number, message))?,
                None if header.is_some() => lines_after += 1,
                None if line.trim_ascii().is_empty() || line.starts_with(b"sep=") => {}
                None => header = Some(Header::new(number, line)),
            }
        }
        let header = header.ok_or_else(|| {
            let message = "has no header: expected a line with psi_deg, theta_deg and brdf_per_sr";
            self.text.error(message)
        })?;
        Ok(Preamble {
            said,
            header,
            lines_after,
        })
    }

    fn measurements(
        &self,
        preamble: Preamble<'a>,
        convention: Convention,
    ) -> Result<Measurements, ReadError> {
        let Header {
            number: header_number,
            line: header_line,
            separator,
        } = preamble.header;
        let mut fields = Vec::new();
        let columns = fields::split(header_line, separator, &mut fields)
            .map_err(str::to_owned)
            .and_then(|()| Columns::find(&fields))
            .map_err(|message| self.text.line_error(header_number, message))?;
        let quantity = preamble.said.quantity.unwrap_or(Quantity::Brdf);
        let mut readings = Vec::with_capacity(preamble.lines_after);
        let mut indices = IndexColumn::default();
        for (number, line) in self
            .text
            .lines()
            .skip_while(|(number, _)| *number <= header_number)
        {
            if comment_of(line).is_some() {
                continue;
            }
            fields::split(line, separator, &mut fields)
                .map_err(|message| self.text.line_error(number, message.to_owned()))?;
            if fields.iter().all(|field| field.trim_ascii().is_empty()) {
                continue;
            }
            let row = Row {
                input: self,
                line: number,
                fields: &fields,
                decimal_comma: separator != b',',
            };
            row.check_length(columns.count)?;
            let reading = row.reading(&columns, quantity, convention)?;
            if let Some(column) = columns.n {
                indices.add(&row, column, reading.wavelength_um)?;
            }
            readings.push(reading);
        }
        if readings.is_empty() {
            let message = "no readings follow the header".to_owned();
            return Err(self.text.line_error(header_number, message));
        }
        Ok(Measurements {
            source: self.text.path.display().to_string(),
            metadata: preamble.said.metadata,
            refractive_index: indices
                .refractive_index()
                .or(preamble.said.refractive_index),
            ignored_columns: columns.ignored,
            convention,
            conversions: quantity.conversion().into_iter().collect(),
            readings,
            ..Measurements::default()
        })
    }
}

/// Whether a comment is a header behind a `#`, as some programs write it.
fn names_the_columns(comment: &[u8]) -> bool {
    let comment = String::from_utf8_lossy(comment).to_lowercase();
    [PSI, THETA, BRDF].iter().all(|name| comment.contains(name))
}

/// The separator between the known columns: that which makes the most of them, a comma of equals.
fn separator_of(header: &[u8]) -> u8 {
    let known = |separator: u8| {
        let fields = header.split(move |&byte| byte == separator);
        fields
            .filter(|field| KNOWN.contains(&column_name(field).as_str()))
            .count()
    };
    let separators = *b"\t;,";
    separators
        .into_iter()
        .max_by_key(|&separator| known(separator))
        .unwrap_or(b',')
}

/// The name of a column as it stands in the header.
fn column_name(field: &[u8]) -> String {
    let name = String::from_utf8_lossy(field);
    name.trim_matches(|c: char| c.is_ascii_whitespace() || c == '"')
        .to_lowercase()
}

/// Where each quantity stands in a row.
struct Columns {
    count: usize,
    psi: usize,
    theta: usize,
    brdf: usize,
    wavelength: Option<usize>,
    phi: Option<usize>,
    sigma: Option<usize>,
    n: Option<usize>,
    ignored: Vec<String>,
}

const WAVELENGTH: &str = "wavelength_um";
const PSI: &str = "psi_deg";
const THETA: &str = "theta_deg";
const PHI: &str = "phi_deg";
const BRDF: &str = "brdf_per_sr";
const SIGMA: &str = "sigma_per_sr";
const INDEX: &str = "n";
const KNOWN: [&str; 7] = [WAVELENGTH, PSI, THETA, PHI, BRDF, SIGMA, INDEX];

impl Columns {
    fn find(header: &[&[u8]]) -> Result<Self, String> {
        let names: Vec<String> = header.iter().map(|field| column_name(field)).collect();
        let twice = |name: &&&str| names.iter().filter(|other| other == *name).count() > 1;
        if let Some(name) = KNOWN.iter().find(twice) {
            return Err(format!("column {name} stands there twice"));
        }
        let position = |name: &str| names.iter().position(|n| n == name);
        let missing: Vec<&str> = [PSI, THETA, BRDF]
            .into_iter()
            .filter(|name| position(name).is_none())
            .collect();
        let (Some(psi), Some(theta), Some(brdf)) = (position(PSI), position(THETA), position(BRDF))
        else {
            return Err(format!(
                "missing column {}: expected a header with psi_deg, theta_deg and brdf_per_sr, found \"{}\"",
                missing.join(" and "),
                shown(names.join(", ").as_bytes()),
            ));
        };
        Ok(Self {
            count: names.len(),
            psi,
            theta,
            brdf,
            wavelength: position(WAVELENGTH),
            phi: position(PHI),
            sigma: position(SIGMA),
            n: position(INDEX),
            ignored: names
                .iter()
                .filter(|name| !name.is_empty() && !KNOWN.contains(&name.as_str()))
                .cloned()
                .collect(),
        })
    }
}

/// One line of readings.
struct Row<'a> {
    input: &'a Input<'a>,
    line: u64,
    fields: &'a [&'a [u8]],
    decimal_comma: bool,
}

impl Row<'_> {
    fn check_length(&self, expected: usize) -> Result<(), ReadError> {
        let surplus = self
            .fields
            .iter()
            .skip(expected)
            .any(|field| !field.trim_ascii().is_empty());
        if surplus {
            let found = self.fields.len();
            let message = format!("{found} fields: expected {expected}, as in the header");
            return Err(self.input.text.line_error(self.line, message));
        }
        Ok(())
    }

    fn reading(
        &self,
        columns: &Columns,
        quantity: Quantity,
        convention: Convention,
    ) -> Result<Measurement, ReadError> {
        let positive = |x: f64| x > 0.0;
        let optional = |column: Option<usize>, name, expected, accepts: fn(f64) -> bool| {
            column
                .map(|column| self.value(column, name, expected, accepts))
                .transpose()
        };
        let wavelength_um = optional(
            columns.wavelength,
            WAVELENGTH,
            "expected micrometres above 0",
            positive,
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
        // A reading may have no standard deviation although others have one.
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

    /// The number in a column, if `accepts` holds for it.
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
        self.input
            .text
            .number(self.line, name, &field, expected, accepts)
    }
}

/// The refractive index of each wavelength, from the column n.
#[derive(Default)]
struct IndexColumn {
    /// By the bits of the wavelength: those of positive numbers are in their order.
    by_wavelength: BTreeMap<Option<u64>, f64>,
}

impl IndexColumn {
    fn add(
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
            .input
            .text
            .value_error(row.line, INDEX, value.as_bytes(), message))
    }

    fn refractive_index(&self) -> Option<RefractiveIndex> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scan::Side;

    fn scan(text: &str) -> Measurements {
        Measurements::from_reader(text.as_bytes()).unwrap()
    }

    fn error(text: impl AsRef<[u8]>) -> String {
        Measurements::from_reader(text.as_ref())
            .unwrap_err()
            .to_string()
    }

    const HEADER: &str = "psi_deg,theta_deg,brdf_per_sr\n";

    #[test]
    fn columns_come_in_any_order() {
        let text = "n,sigma_per_sr,brdf_per_sr,phi_deg,theta_deg,psi_deg,wavelength_um,comment\n\
                    1.6,0.01,0.25,90,20,10,0.63,first\n";
        let scan = scan(text);
        let reading = scan.readings()[0];
        assert_eq!(reading.wavelength_um, Some(0.63));
        assert_eq!(reading.psi, 10_f64.to_radians());
        assert_eq!(reading.theta, 20_f64.to_radians());
        assert_eq!(reading.phi, 90_f64.to_radians());
        assert_eq!(reading.brdf, 0.25);
        assert_eq!(reading.sigma, Some(0.01));
        assert_eq!(scan.refractive_index.unwrap().at(Some(0.63)), Some(1.6));
        assert_eq!(scan.ignored_columns, ["comment"]);
    }

    #[test]
    fn separators_and_line_ends_of_any_system_are_understood() {
        let expected = scan("psi_deg,theta_deg,brdf_per_sr\n10,-20.5,0.25\n30,0,0.5\n");
        for text in [
            "psi_deg;theta_deg;brdf_per_sr\n10;-20.5;0.25\n30;0;0.5\n",
            "psi_deg;theta_deg;brdf_per_sr\n10;-20,5;0,25\n30;0;0,5\n",
            "psi_deg\ttheta_deg\tbrdf_per_sr\n10\t-20,5\t2,5e-1\n30\t0\t0.5\n",
            "\u{feff}psi_deg,theta_deg,brdf_per_sr\r\n10,-20.5,0.25\r\n30,0,0.5",
            "psi_deg,theta_deg,brdf_per_sr\r10,-20.5,0.25\r30,0,0.5\r",
            "sep=;\nPSI_DEG; Theta_deg ;\"brdf_per_sr\"\n\n10; -20.5 ;\"0,25\"\n;;\n30;0;0.5;;\n",
        ] {
            assert_eq!(scan(text).readings(), expected.readings(), "{text:?}");
        }
    }

    #[test]
    fn metadata_is_kept_wherever_it_stands() {
        let text = "# sample: Paint, black\n# plain words\n\"# licence: MIT\",,\n\
                    psi_deg,theta_deg,brdf_per_sr\n10,20,0.1\n# Note: late\n11,20,0.1\n";
        let scan = scan(text);
        assert_eq!(scan.metadata.get("sample"), Some("Paint, black"));
        assert_eq!(scan.metadata.get("licence"), Some("MIT"));
        assert_eq!(scan.metadata.get("note"), Some("late"));
        assert_eq!(scan.readings().len(), 2);
    }

    #[test]
    fn quantities_are_converted_once() {
        let rows = "psi_deg,theta_deg,brdf_per_sr,sigma_per_sr\n10,60,0.5,0.1\n";
        let reading =
            |quantity: &str| scan(&format!("# quantity: {quantity}\n{rows}")).readings()[0];
        assert_eq!(reading("brdf").brdf, 0.5);
        assert!((reading("brdf_cos").brdf - 1.0).abs() < 1e-15);
        assert!((reading("brdf_cos").sigma.unwrap() - 0.2).abs() < 1e-15);
        assert!((reading("reflectance_factor").brdf - 0.5 / std::f64::consts::PI).abs() < 1e-16);
    }

    #[test]
    fn other_conventions_are_converted_once() {
        let read = |text: &str, theta_positive, phi_zero| {
            let convention = Convention {
                theta_positive,
                phi_zero,
            };
            Measurements::from_reader_with(text.as_bytes(), "test", convention)
                .unwrap()
                .readings()[0]
        };
        let in_plane = format!("{HEADER}10,20,0.1\n");
        let mirror_side = read(&in_plane, Side::Forward, Side::Source);
        assert_eq!(mirror_side.in_plane_theta(), Some(-20_f64.to_radians()));
        let text = "psi_deg,theta_deg,phi_deg,brdf_per_sr\n10,20,0,0.1\n";
        let mirror_side = read(text, Side::Source, Side::Forward);
        assert_eq!(mirror_side.in_plane_theta(), Some(-20_f64.to_radians()));
    }

    #[test]
    fn the_refractive_index_of_the_header_is_read() {
        let text = format!("# refractive_index: 0.63=1.6,0.85=1.58\n{HEADER}10,20,0.1\n");
        assert_eq!(
            scan(&text).refractive_index.unwrap().at(Some(0.85)),
            Some(1.58)
        );
    }

    #[test]
    fn errors_name_line_column_value_and_what_was_expected() {
        let row = |row: &str| error(format!("# sample: x\n{HEADER}10,20,0.1\n{row}\n"));
        assert_eq!(
            row("abc,0,0.1"),
            "input, line 4, column psi_deg: \"abc\" is not a number: expected degrees from 0 to below 90"
        );
        assert_eq!(
            row("90,0,0.1"),
            "input, line 4, column psi_deg: \"90\" is out of range: expected degrees from 0 to below 90"
        );
        assert!(row("-1,0,0.1").contains("\"-1\" is out of range"));
        assert!(row("0,-90,0.1").contains("column theta_deg: \"-90\" is out of range"));
        assert!(row("0,0,NaN").contains("column brdf_per_sr: \"NaN\" is not a finite number"));
        assert!(row("0,0,-inf").contains("\"-inf\" is not a finite number"));
        assert!(row("0,0").contains("column brdf_per_sr: \"\" is missing"));
        assert!(row("0,0,0.1,7").contains("line 4: 4 fields: expected 3"));
        assert!(row("0;0;0,1").contains("column psi_deg"));
        assert!(row("0,0,\"0,1\"").contains("\"0,1\" is not a number"));
    }

    #[test]
    fn errors_in_optional_columns_are_named() {
        let with = |column: &str, value: &str| {
            error(format!(
                "psi_deg,theta_deg,brdf_per_sr,{column}\n10,20,0.1,{value}\n"
            ))
        };
        assert!(with("wavelength_um", "-0.6").contains("column wavelength_um: \"-0.6\""));
        assert!(with("sigma_per_sr", "0").contains("column sigma_per_sr: \"0\""));
        assert!(with("phi_deg", "x").contains("column phi_deg: \"x\""));
        assert!(with("n", "0.9").contains("column n: \"0.9\" is out of range"));
        let two = error("n,psi_deg,theta_deg,brdf_per_sr\n1.5,1,2,3\n1.6,1,2,3\n");
        assert!(
            two.contains("line 3, column n: \"1.6\" differs from 1.5"),
            "{two}"
        );
    }

    #[test]
    fn what_is_no_table_is_said_to_be_none() {
        assert!(error("").contains("is empty"));
        assert!(error(" \n\n").contains("is empty"));
        assert!(error("# only: comments\n").contains("no header"));
        assert!(error(HEADER).contains("line 1: no readings follow the header"));
        assert!(error("psi_deg,theta_deg\n1,2\n").contains("missing column brdf_per_sr"));
        assert!(error("a;b\n1;2\n").contains("found \"a;b\""));
        assert!(
            error("psi_deg,psi_deg,theta_deg,brdf_per_sr\n").contains("psi_deg stands there twice")
        );
        assert!(error([0x7f, b'E', b'L', b'F', 0, 1]).contains("is binary data"));
        assert!(error(b"\xff\xfep\0").contains("UTF-16"));
        assert!(
            error(format!("# quantity: btdf\n{HEADER}1,2,3\n"))
                .contains("line 1: quantity: \"btdf\"")
        );
        assert!(error(format!("# refractive_index: 0.5\n{HEADER}1,2,3\n")).contains("n = 0.5"));
    }

    #[test]
    fn an_endless_line_is_refused_before_it_fills_the_memory() {
        let endless = std::io::repeat(b'7');
        let message = Measurements::from_reader(endless).unwrap_err().to_string();
        assert!(
            message.contains("line 1: the line is longer than 65536 bytes"),
            "{message}"
        );
        let later = format!("{HEADER}1,2,{}\n", "3".repeat(100_000));
        assert!(error(later).contains("line 2: the line is longer"));
    }

    #[test]
    fn a_stray_quote_is_an_error_of_its_line_in_any_column() {
        let message = error(format!("{HEADER}1,2,\"3\n4,5,6\n"));
        assert!(
            message.contains("line 2: a quote is not closed"),
            "{message}"
        );
        let text = "psi_deg,theta_deg,brdf_per_sr,note\n1,2,3,a\n1,2,3,\"5 inch\n1,2,3,x\"\n";
        assert!(error(text).contains("line 3: a quote is not closed"));
    }

    #[test]
    fn comments_between_rows_swallow_nothing_whatever_the_line_ends() {
        for end in ["\n", "\r", "\r\n"] {
            let text = [
                "# a: b",
                "psi_deg,theta_deg,brdf_per_sr",
                "1,2,3",
                "# c",
                "",
                "4,5,6",
                "7,8,9",
            ];
            assert_eq!(scan(&text.join(end)).readings().len(), 3, "{end:?}");
            let bad = [text.as_slice(), &["x,8,9"]].concat().join(end);
            assert!(error(bad).contains("line 8, column psi_deg"), "{end:?}");
        }
    }

    #[test]
    fn a_header_behind_a_comment_sign_is_a_header() {
        let scan = scan("# psi_deg,theta_deg,brdf_per_sr\n1,2,3\n4,5,6\n");
        assert_eq!(scan.readings().len(), 2);
    }

    #[test]
    fn the_separator_is_the_one_that_makes_columns() {
        let scan = scan("psi_deg;theta_deg;brdf_per_sr;\"note, a, b, c, d\"\n1;2;3;x\n");
        assert_eq!(scan.ignored_columns, ["note, a, b, c, d"]);
    }

    #[test]
    fn contradictions_of_the_header_are_errors() {
        let with = |comments: &str| error(format!("{comments}\n{HEADER}1,2,3\n"));
        let twice = with("# quantity: brdf_cos\n# quantity: brdf");
        assert!(
            twice.contains("line 2: quantity stands there twice"),
            "{twice}"
        );
        assert!(with("# quantity = btdf").contains("quantity: \"btdf\" is not known"));
        let text = format!("# quantity = brdf_cos\n{HEADER}1,60,0.5\n");
        assert!((scan(&text).readings()[0].brdf - 1.0).abs() < 1e-15);
    }

    #[test]
    fn a_missing_standard_deviation_is_none() {
        let scan =
            scan("psi_deg,theta_deg,brdf_per_sr,sigma_per_sr\n1,2,3,0.1\n1,2,3,\n1,2,3\n\u{1a}");
        let sigmas: Vec<_> = scan.readings().iter().map(|r| r.sigma).collect();
        assert_eq!(sigmas, [Some(0.1), None, None]);
    }
}
