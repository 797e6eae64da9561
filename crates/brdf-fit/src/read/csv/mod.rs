//! The project's own format: a table of readings as text, separated by commas, semicolons or tabs.
//!
//! | column | unit and domain | |
//! |---|---|---|
//! | `psi_deg` | deg, [0, 90) | incidence zenith angle psi |
//! | `theta_deg` | deg, (-90, 90) | view zenith angle theta, signed in the plane of incidence |
//! | `brdf_per_sr` | 1/sr | the reading, in the quantity of the comments |
//! | `wavelength_um` | um, > 0 | optional: wavelength |
//! | `phi_deg` | deg | optional: view azimuth phi from the source's azimuth; 0 where it is missing |
//! | `sigma_per_sr` | 1/sr, > 0 | optional, may be blank: standard deviation, in the quantity of the reading |
//! | `n` | 1, [1, 1e5] | optional: refractive index, one value for each wavelength |
//!
//! Columns are found by their names, in any order. Other columns are not read, but listed in
//! [`Measurements::ignored_columns`]. Lines that begin with `#` are comments: `# key: value` is kept as
//! metadata, and a comment that names the columns is the header.
//!
//! Two keys concern the readings:
//! - `# quantity:` is `brdf` (f_r, the default), `brdf_cos` (f_r cos theta, divided by cos theta) or
//!   `reflectance_factor` (pi f_r, divided by pi).
//! - `# refractive_index:` is one number, such as `1.5`, or one for each wavelength in um, such as
//!   `0.63=1.60,0.85=1.58`. The column `n` takes precedence.
//!
//! A decimal comma is accepted where the separator is not a comma, as are a byte order mark and the
//! line ends of all systems.

mod header;
mod row;

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::comments::comment_of;
use super::conversion::Quantity;
use super::error::ReadError;
use super::fields;
use super::text::{Text, read_bytes};
use crate::scan::{Convention, Measurements};
pub(super) use header::is_header;
use header::{Header, Preamble};
use row::{IndexColumn, Row};

impl Measurements {
    /// Reads a table in the model's angular convention. The [module](crate::read::csv) describes
    /// the format.
    ///
    /// # Examples
    ///
    /// ```no_run
    /// let scan = brdf_fit::Measurements::read_csv("data/measured/z307_on_aluminium.csv")?;
    /// println!("{} readings at {:?} um", scan.readings().len(), scan.wavelengths());
    /// # Ok::<(), brdf_fit::read::ReadError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// The file cannot be read or is not such a table. Errors name the file, the line, the column
    /// and the value, and state what was expected.
    pub fn read_csv(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        Self::read_csv_with(path, Convention::default())
    }

    /// Reads a table in another angular convention.
    ///
    /// # Errors
    ///
    /// As [`read_csv`](Self::read_csv).
    pub fn read_csv_with(
        path: impl AsRef<Path>,
        convention: Convention,
    ) -> Result<Self, ReadError> {
        let path = path.as_ref();
        let io = |error| ReadError::io(path, error);
        let file = File::open(path).map_err(io)?;
        let size = file.metadata().map_err(io)?.len();
        read_all(file, size, path, convention)
    }

    /// Reads the text of a table in the model's angular convention.
    ///
    /// # Examples
    ///
    /// ```
    /// let table = "psi_deg,theta_deg,brdf_per_sr\n10,-10,0.5\n10,20,0.1\n";
    /// let scan = brdf_fit::Measurements::from_reader(table.as_bytes())?;
    /// assert_eq!(scan.readings()[1].theta, 20_f64.to_radians());
    /// # Ok::<(), brdf_fit::read::ReadError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`read_csv`](Self::read_csv), with `input` for the name of the file.
    pub fn from_reader(reader: impl Read) -> Result<Self, ReadError> {
        Self::from_reader_with(reader, "input", Convention::default())
    }

    /// Reads the text of a table in another angular convention. `name` stands for the path of the
    /// file in errors and reports.
    ///
    /// # Errors
    ///
    /// As [`read_csv`](Self::read_csv).
    pub fn from_reader_with(
        reader: impl Read,
        name: &str,
        convention: Convention,
    ) -> Result<Self, ReadError> {
        read_all(reader, 0, Path::new(name), convention)
    }
}

fn read_all(
    reader: impl Read,
    expected_size: u64,
    path: &Path,
    convention: Convention,
) -> Result<Measurements, ReadError> {
    let bytes = read_bytes(Vec::new(), reader, expected_size)
        .map_err(|error| ReadError::io(path, error))?;
    read(Text::new(path, &bytes)?, convention)
}

/// # Errors
///
/// The text is not a table of readings.
pub(super) fn read(text: Text<'_>, convention: Convention) -> Result<Measurements, ReadError> {
    let Preamble {
        comments,
        header,
        lines_after,
    } = Preamble::read(&text)?;
    let columns = header.columns(&text)?;
    let quantity = comments.quantity.unwrap_or(Quantity::Brdf);
    let mut readings = Vec::with_capacity(lines_after);
    let mut indices = IndexColumn::default();
    for_each_row(&text, &header, |row| {
        row.check_length(columns.count)?;
        let reading = row.reading(&columns, quantity, convention)?;
        if let Some(column) = columns.n {
            indices.add(row, column, reading.wavelength_um)?;
        }
        readings.push(reading);
        Ok(())
    })?;
    if readings.is_empty() {
        return Err(text.line_error(header.number, "no readings follow the header"));
    }
    Ok(Measurements {
        source: text.path.display().to_string(),
        metadata: comments.metadata,
        refractive_index: indices.refractive_index().or(comments.refractive_index),
        ignored_columns: columns.ignored,
        convention,
        conversions: quantity.conversion().into_iter().collect(),
        readings,
        ..Measurements::default()
    })
}

/// Splits each line after the header that is neither blank nor a comment.
fn for_each_row(
    text: &Text<'_>,
    header: &Header<'_>,
    mut take: impl FnMut(&Row<'_>) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let mut fields = Vec::new();
    let lines = text.lines();
    for (number, line) in lines.skip_while(|(number, _)| *number <= header.number) {
        if comment_of(line).is_some() {
            continue;
        }
        fields::split(line, header.separator, &mut fields)
            .map_err(|message| text.line_error(number, message))?;
        if fields.iter().all(|field| field.trim_ascii().is_empty()) {
            continue;
        }
        take(&Row {
            text,
            line: number,
            fields: &fields,
            decimal_comma: header.separator != b',',
        })?;
    }
    Ok(())
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
    fn separators_and_line_ends_of_all_systems_are_accepted() {
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
    fn metadata_is_kept_anywhere_in_the_file() {
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
    fn errors_in_optional_columns_name_the_column() {
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
    fn a_text_that_is_not_a_table_is_refused() {
        assert!(error("").contains("is empty"));
        assert!(error(" \n\n").contains("is empty"));
        assert!(error("# only: comments\n").contains("no header"));
        assert!(error(HEADER).contains("line 1: no readings follow the header"));
        assert!(error("psi_deg,theta_deg\n1,2\n").contains("missing column brdf_per_sr"));
        assert!(error("a;b\n1;2\n").contains("found \"a;b\""));
        assert!(
            error("psi_deg,psi_deg,theta_deg,brdf_per_sr\n").contains("psi_deg is given twice")
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
    fn comments_between_rows_hide_no_row_with_any_line_end() {
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
    fn the_separator_is_the_one_that_separates_known_columns() {
        let scan = scan("psi_deg;theta_deg;brdf_per_sr;\"note, a, b, c, d\"\n1;2;3;x\n");
        assert_eq!(scan.ignored_columns, ["note, a, b, c, d"]);
    }

    #[test]
    fn contradictions_between_comments_are_errors() {
        let with = |comments: &str| error(format!("{comments}\n{HEADER}1,2,3\n"));
        let twice = with("# quantity: brdf_cos\n# quantity: brdf");
        assert!(twice.contains("line 2: quantity is given twice"), "{twice}");
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
