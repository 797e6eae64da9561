//! A table of readings as text, with a row for each pair of directions.
//!
//! The project's own names of the columns are
//!
//! | column | unit and domain | |
//! |---|---|---|
//! | `psi_deg` | deg | incidence zenith angle psi |
//! | `theta_deg` | deg | view zenith angle theta, signed in the plane of incidence |
//! | `brdf_per_sr` | 1/sr | the reading, in the quantity of the comments |
//! | `wavelength_um` | um, > 0 | optional: wavelength |
//! | `phi_deg` | deg | optional: view azimuth phi from the source's azimuth; 0 where it is missing |
//! | `sigma_per_sr` | 1/sr, > 0 | optional, may be blank: standard deviation, in the quantity of the reading |
//! | `n` | 1, [1, 1e5] | optional: refractive index, one value for each wavelength |
//!
//! Columns are found by their names, in any order, and other usual names are understood: `Incident angle`,
//! `AOI (deg)`, `theta_i [rad]`, `mu_in` (a cosine), `theta_r`, `phi_i` and `phi_r`, `Wavelength (nm)`,
//! `R%`, `log10_brdf`, `BRDF (dB)`. `brdf_s` and `brdf_p` are averaged to the unpolarised reading; `signal`
//! and `reference`, the signal of a white standard, are divided to the reflectance factor. Columns that are
//! named by a wavelength (`450nm`) hold the readings at that wavelength. What was understood is reported in
//! [`Measurements::conversions`]. [`ReadOptions::columns`](super::ReadOptions::columns) says what a column
//! is whose name does not.
//!
//! A column of another name is not used, and is listed in [`Measurements::ignored_columns`]; where it
//! differs between readings of the same directions and wavelength, it is an error, because readings of
//! different samples or polarisations must not be pooled.
//!
//! Fields are separated by tabs, semicolons, commas or spaces. Lines before the header that are no header
//! are skipped and counted. Lines that begin with `#` are comments: `# key: value` is kept as metadata, and
//! a comment that names the columns is the header. These keys concern the readings:
//!
//! - `quantity` is `brdf` (f_r, the default), `brdf_cos` (f_r cos theta, divided by cos theta),
//!   `reflectance_factor` (pi f_r, divided by pi), `reflectance_factor_percent`, `log10_brdf` or `brdf_db`.
//! - `unit` is `1/sr`, `percent`, `log10` or `dB`; `factor` multiplies the values.
//! - `missing` is the number that stands for a reading that was not taken.
//! - `psi_deg`, `phi_deg`, `source_azimuth_deg`, `wavelength_um` and `wavelength_nm` serve as the column of
//!   that name. A file of a pab goniophotometer has `#intheta 30`, `#inphi 180` and the names of the columns
//!   behind `#format:` (pab advanced technologies; read by the Radiance tools of the same firm).
//! - `polarisation` is `s` or `p`: of `brdf_s` and `brdf_p` that one is taken.
//! - `refractive_index` is one number, such as `1.5`, or one for each wavelength in um, such as
//!   `0.63=1.60,0.85=1.58`. The column `n` takes precedence.
//!
//! [`ReadOptions::declarations`](super::ReadOptions::declarations) states such keys in place of the file.
//!
//! Readings that were not taken (blank, `-`, `NaN`, `n/a`) and those at or beyond 90 deg are left out and
//! counted. A negative incidence angle is on the other side of the normal: the view angle is mirrored. A
//! decimal comma, the minus sign of typesetting and the exponent of Fortran (`1.1D-01`) are read, as are a
//! byte order mark and the line ends of all systems.

mod header;
mod row;

use std::collections::HashMap;
use std::fs::File;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Read;
use std::path::Path;

use super::comments::{Comments, SOURCE_AZIMUTH, comment_of, number_of_key};
use super::conversion::{BEYOND_HORIZON, Kind, NOT_TAKEN, Quantity, left_out};
use super::error::ReadError;
use super::names::{AngleForm, LengthUnit, Role};
use super::number::{is_angle, is_wavelength};
use super::options::ReadOptions;
use super::text::{Text, read_bytes};
use crate::scan::{Convention, Measurement, Measurements};
pub(super) use header::is_header;
use header::{Header, Preamble, Readings, Roles};
use row::{Found, IndexColumn, Reader, Row};

/// Angles without a unit, all of which are below this, may be radians: a little above pi/2.
const MAY_BE_RADIANS: f64 = 1.6;

/// Wavelengths without a unit are in nm from this number on, and in um below.
const LEAST_NANOMETRES: f64 = 100.0;

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
    let options = ReadOptions {
        theta_positive: Some(convention.theta_positive),
        phi_zero: Some(convention.phi_zero),
        ..ReadOptions::default()
    };
    read(Text::new(path, &bytes)?, &options)
}

/// # Errors
///
/// The text is not a table of readings.
pub(super) fn read(text: Text<'_>, options: &ReadOptions) -> Result<Measurements, ReadError> {
    let Preamble {
        comments,
        header,
        lines_after,
        skipped,
    } = Preamble::read(&text, options)?;
    let reader = reader(&text, &header, &comments, options)?;
    let mut found = Found::default();
    found.readings.reserve(lines_after);
    let mut indices = IndexColumn::default();
    let mut unknown = UnknownColumns::new(&reader.roles);
    for_each_row(&text, &header, |row| {
        row.check_length()?;
        let before = found.readings.len();
        reader.add(row, &mut found)?;
        let added = &found.readings[before..];
        if let (Some(column), Some(first)) = (reader.roles.n, added.first()) {
            indices.add(row, column, first.wavelength_um)?;
        }
        unknown.add(row, added.len());
        Ok(())
    })?;
    check_found(&text, &header, &reader, &mut found)?;
    unknown.check(&text, &header, &found)?;
    let conversions = conversions(&header, &reader, &found, skipped);
    Ok(Measurements {
        source: text.path.display().to_string(),
        metadata: comments.metadata,
        refractive_index: indices.refractive_index().or(comments.refractive_index),
        ignored_columns: header.names_without_use(),
        convention: reader.convention,
        conversions,
        readings: found.readings,
        ..Measurements::default()
    })
}

/// How the rows are read, from the header and the comments.
fn reader(
    text: &Text<'_>,
    header: &Header,
    comments: &Comments,
    options: &ReadOptions,
) -> Result<Reader, ReadError> {
    let roles = header.roles(text)?;
    let of_header = |message: String| text.line_error(header.number, message);
    let values = comments
        .values(quantity(header, &roles))
        .map_err(of_header)?;
    let number =
        |key, expected, accepts| number_of_key(text, &comments.metadata, key, expected, accepts);
    let micrometres = number(
        "wavelength_um",
        "expected micrometres above 0",
        is_wavelength,
    )?;
    let nanometres = number(
        "wavelength_nm",
        "expected nanometres above 0",
        is_wavelength,
    )?;
    let psi_deg = number("psi_deg", "expected degrees between -90 and 90", |x| {
        x.abs() < 90.0
    })?;
    if roles.psi.is_none() && psi_deg.is_none() {
        let message = format!(
            "no column for the incidence angle (psi_deg), and no line \"# psi_deg: 30\": {}",
            header.understood()
        );
        return Err(of_header(message));
    }
    let polarisation = match comments.metadata.get("polarisation") {
        None | Some("unpolarised" | "mean") => None,
        Some("s") => Some(0),
        Some("p") => Some(1),
        Some(other) => {
            let message = format!("polarisation: \"{other}\": expected s, p or mean");
            return Err(text.error(message));
        }
    };
    Ok(Reader {
        values,
        convention: options.convention(Convention::default()),
        missing: comments.missing(),
        polarisation,
        psi_deg,
        phi_deg: number("phi_deg", "expected degrees", is_angle)?,
        source_azimuth_deg: number(SOURCE_AZIMUTH, "expected degrees", is_angle)?,
        wavelength_um: micrometres.or(nanometres.map(|nm| nm / 1000.0)),
        roles,
    })
}

/// The quantity of the readings by the names of their columns.
fn quantity(header: &Header, roles: &Roles) -> Quantity {
    match roles.readings {
        Readings::One(column) => match header.columns[column].role {
            Some(Role::Value(quantity)) => quantity,
            _ => Quantity::BRDF,
        },
        Readings::Ratio(..) => Quantity::of(Kind::ReflectanceFactor),
        Readings::Polarised(..) | Readings::Channels(_) => Quantity::BRDF,
    }
}

/// Splits each line after the header that is neither blank nor a comment.
fn for_each_row(
    text: &Text<'_>,
    header: &Header,
    mut take: impl FnMut(&Row<'_>) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let mut fields = Vec::new();
    let lines = text.lines();
    for (number, line) in lines.skip_while(|(number, _)| *number <= header.number) {
        if comment_of(line).is_some() {
            continue;
        }
        let split = header.separator.split(line, &mut fields);
        split.map_err(|message| text.line_error(number, message))?;
        if fields.iter().all(|field| field.trim_ascii().is_empty()) {
            continue;
        }
        take(&Row {
            text,
            line: number,
            fields: &fields,
            columns: &header.columns,
        })?;
    }
    Ok(())
}

/// Checks that there are readings and that their units are known, and converts wavelengths of which the
/// header does not state the unit.
fn check_found(
    text: &Text<'_>,
    header: &Header,
    reader: &Reader,
    found: &mut Found,
) -> Result<(), ReadError> {
    let problem = |message: String| Err(text.line_error(header.number, message));
    if found.readings.is_empty() {
        return problem(match (found.beyond, found.not_taken) {
            (0, 0) => "no readings follow the header".to_owned(),
            (0, count) => format!("none of the {count} readings was taken: every value is blank"),
            (count, _) => format!(
                "all {count} readings are at or beyond 90 deg from the normal: are zenith angles and \
                 azimuths exchanged? {}",
                header.understood()
            ),
        });
    }
    let roles = &reader.roles;
    let zeniths = roles.psi.into_iter().chain([roles.theta]);
    let mut unstated = zeniths.filter(|(_, form)| *form == AngleForm::Unstated);
    let may_be_radians = found.largest_angle > 0.0 && found.largest_angle < MAY_BE_RADIANS;
    if let Some((column, _)) = unstated.next().filter(|_| may_be_radians) {
        let name = &header.columns[column].name;
        return problem(format!(
            "the unit of the angles is not known, and all are below {MAY_BE_RADIANS}: expected names with \
             a unit, such as \"{name}_rad\" or \"{name}_deg\""
        ));
    }
    if let Some((column, LengthUnit::Unstated)) = roles.wavelength {
        let wavelengths = || {
            found
                .readings
                .iter()
                .filter_map(|reading| reading.wavelength_um)
        };
        if wavelengths().all(|wavelength| wavelength >= LEAST_NANOMETRES) {
            for reading in &mut found.readings {
                reading.wavelength_um = reading.wavelength_um.map(|nm| nm / 1000.0);
            }
        } else if !wavelengths().all(|wavelength| wavelength < LEAST_NANOMETRES) {
            let name = &header.columns[column].name;
            return problem(format!(
                "the unit of \"{name}\" is not known: expected \"{name}_um\" or \"{name}_nm\""
            ));
        }
    }
    Ok(())
}

/// The sentences that report what was understood, converted and left out.
fn conversions(header: &Header, reader: &Reader, found: &Found, skipped: usize) -> Vec<String> {
    let mut all: Vec<String> = header.sentence().into_iter().collect();
    if let Some((_, LengthUnit::Unstated)) = reader.roles.wavelength {
        let um = found
            .readings
            .iter()
            .find_map(|reading| reading.wavelength_um);
        all.extend(um.map(|um| format!("wavelengths are taken so that the first is {um} um")));
    }
    match (&reader.roles.readings, reader.polarisation) {
        (Readings::Ratio(..), _) => {
            all.push("signal / reference is taken as the reflectance factor".to_owned());
        }
        (Readings::Polarised(..), None) => {
            all.push("the mean of s and p is taken as the unpolarised reading".to_owned());
        }
        (Readings::Polarised(..), Some(0)) => all.push("s-polarised readings alone".to_owned()),
        (Readings::Polarised(..), Some(_)) => all.push("p-polarised readings alone".to_owned()),
        (Readings::Channels(channels), _) => {
            let count = channels.len();
            let quantity = reader.values.quantity;
            all.push(format!("{count} columns of wavelengths hold {quantity}"));
        }
        (Readings::One(_), _) => {}
    }
    all.extend(reader.values.conversions());
    if found.mirrored > 0 {
        let count = found.mirrored;
        all.push(format!(
            "{count} rows have a negative incidence angle: it is on the other side of the normal"
        ));
    }
    all.extend(left_out(found.not_taken, NOT_TAKEN));
    all.extend(left_out(found.beyond, BEYOND_HORIZON));
    match skipped {
        0 => {}
        1 => all.push("1 line of text above the header is skipped".to_owned()),
        count => all.push(format!(
            "{count} lines of text above the header are skipped"
        )),
    }
    if found.largest_angle > 0.5 && found.largest_angle < MAY_BE_RADIANS {
        all.push(format!(
            "all zenith angles are below {MAY_BE_RADIANS} deg: if they are radians, name the columns \
             psi_rad and theta_rad"
        ));
    }
    all
}

/// The content of the columns that are not used, of which each row keeps a hash.
struct UnknownColumns<'a> {
    columns: &'a [usize],
    /// The line and the hash of each reading.
    rows: Vec<(u64, u64)>,
}

impl<'a> UnknownColumns<'a> {
    fn new(roles: &'a Roles) -> Self {
        Self {
            columns: &roles.unknown,
            rows: Vec::new(),
        }
    }

    fn add(&mut self, row: &Row<'_>, readings: usize) {
        if self.columns.is_empty() {
            return;
        }
        let mut hasher = DefaultHasher::new();
        for &column in self.columns {
            row.fields
                .get(column)
                .copied()
                .unwrap_or_default()
                .hash(&mut hasher);
        }
        let row = (row.line, hasher.finish());
        self.rows.extend(std::iter::repeat_n(row, readings));
    }

    /// # Errors
    ///
    /// The columns differ between readings of the same directions and wavelength.
    fn check(&self, text: &Text<'_>, header: &Header, found: &Found) -> Result<(), ReadError> {
        let mut first = HashMap::new();
        for ((line, hash), reading) in self.rows.iter().zip(&found.readings) {
            let (before, other) = *first.entry(geometry_key(reading)).or_insert((line, hash));
            if other == hash {
                continue;
            }
            let names = self
                .columns
                .iter()
                .map(|&i| format!("\"{}\"", header.columns[i].name));
            let names: Vec<_> = names.collect();
            let message = format!(
                "{} differs between the readings of the same directions on lines {} and {}: split the file, \
                 or say that the column is a label, such as \"{}=ignore\"",
                names.join(", "),
                before,
                line,
                header.columns[self.columns[0]].name,
            );
            return Err(text.line_error(header.number, message));
        }
        Ok(())
    }
}

/// What readings of the same directions and wavelength have in common.
fn geometry_key(reading: &Measurement) -> [u64; 4] {
    let wavelength = reading.wavelength_um.map_or(0, f64::to_bits);
    [
        wavelength,
        reading.psi.to_bits(),
        reading.theta.to_bits(),
        reading.phi.to_bits(),
    ]
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
            "input, line 4, column psi_deg: \"abc\" is not a number: expected the incidence angle in degrees"
        );
        assert!(row("1e10,0,0.1").contains("column psi_deg: \"1e10\" is out of range"));
        assert!(row("0,0,-inf").contains("\"-inf\" is not a finite number"));
        assert!(row("0").contains("column theta_deg: \"\" is missing"));
        assert!(row("0,0,0.1,7").contains("line 4: 4 fields: expected 3"));
        assert!(row("0;0;0,1").contains("column psi_deg"));
        assert!(row("0,0,-999").contains("# missing: -999"));
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
        let no_reading = error("psi_deg,theta_deg,x\n1,2,3\n");
        assert!(
            no_reading.contains("no column for the reading (brdf_per_sr)")
                && no_reading.contains("\"psi_deg\" is incidence angle in deg, ")
                && no_reading.contains("\"x\" is not known"),
            "{no_reading}"
        );
        assert!(error("a;b\n1;2\n").contains("has no header"));
        assert!(error("psi_deg,psi_deg,theta_deg,brdf_per_sr\n").contains("in deg is given twice"));
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

    /// The reading of psi = 10, theta = -20 deg and f_r = 0.25 in one row, and another in a second one.
    fn first(text: &str) -> Measurement {
        scan(text).readings()[0]
    }

    #[test]
    fn other_names_units_and_quantities_give_the_same_reading() {
        let expected = first("psi_deg,theta_deg,brdf_per_sr\n10,-20,0.25\n30,0,0.5\n");
        for text in [
            "Incident angle,Measure_angle,BRDF (1/sr)\n10,-20,0.25\n30,0,0.5\n",
            "AOI (deg)\ttheta_r\tf_r\n10\t-20\t0.25\n30\t0\t0.5\n",
            "theta_i theta_s  brdf\n10  -20  2.5D-01\n30 0 0.5\n",
            "Printed by Lab 3\n\npsi_deg,theta_deg,brdf_per_sr\n10,\u{2212}20,0.25\n30,0,0.5\n",
            "psi_deg,theta_deg,brdf_per_sr\n\"10\",\"-20\",\"0,25\"\n30,0,0.5\n",
            "psi_rad,theta_rad,brdf\n0.17453292519943295,-0.3490658503988659,0.25\n1,0,0.5\n",
            "psi_deg,theta_deg,R%\n10,-20,78.53981633974483\n30,0,1\n",
            "psi_deg,theta_deg,log10_brdf\n10,-20,-0.6020599913279624\n30,0,1\n",
            "# unit: dB\npsi_deg,theta_deg,brdf\n10,-20,-6.020599913279624\n30,0,1\n",
            "# factor: 0.1\npsi_deg,theta_deg,brdf\n10,-20,2.5\n30,0,1\n",
            "# psi_deg: 10\ntheta_deg,brdf_per_sr\n-20,0.25\n0,0.5\n",
            "psi_deg,theta_deg,brdf_s,brdf_p\n10,-20,0.2,0.3\n30,0,1,1\n",
            "psi_deg,theta_deg,signal,reference\n10,-20,7.853981633974483,10\n30,0,1,1\n",
            "psi_deg,theta_deg,brdf_per_sr\n-10,20,0.25\n30,0,0.5\n",
            "phi_i,theta_i,phi_r,theta_r,brdf\n90,10,270,20,0.25\n0,30,0,0,0.5\n",
            "mu_in,mu_out,cosdphi,brdf\n0.984807753012208,0.9396926207859084,-1,0.25\n0.5,1,1,0.5\n",
        ] {
            let found = first(text);
            let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
            assert!(
                near(found.psi, expected.psi)
                    && near(found.in_plane_theta().unwrap(), expected.theta)
                    && near(found.brdf, 0.25),
                "{text}: {found:?}"
            );
        }
    }

    #[test]
    fn wavelengths_are_read_from_columns_names_and_comments() {
        for (text, expected) in [
            (
                "psi_deg,theta_deg,450nm,0.65 um\n1,2,3,4\n",
                vec![Some(0.45), Some(0.65)],
            ),
            (
                "wavelength_nm,psi_deg,theta_deg,brdf\n630.79,1,2,3\n",
                vec![Some(0.63079)],
            ),
            (
                "Wavelength,psi_deg,theta_deg,brdf\n450,1,2,3\n",
                vec![Some(0.45)],
            ),
            (
                "lambda,psi_deg,theta_deg,brdf\n10.6,1,2,3\n",
                vec![Some(10.6)],
            ),
            (
                "# wavelength_nm: 532\npsi_deg,theta_deg,brdf\n1,2,3\n",
                vec![Some(0.532)],
            ),
        ] {
            assert_eq!(scan(text).wavelengths(), expected, "{text}");
        }
        let both = error("wavelength,psi_deg,theta_deg,brdf\n0.5,1,2,3\n500,1,2,3\n");
        assert!(
            both.contains("the unit of \"wavelength\" is not known"),
            "{both}"
        );
    }

    #[test]
    fn what_is_ambiguous_is_an_error() {
        let radians = error("theta_i,theta_r,brdf\n0.5,0.2,3\n");
        assert!(
            radians.contains("\"theta_i_rad\" or \"theta_i_deg\""),
            "{radians}"
        );
        let exchanged = error("phi_i,theta_i,phi_o,theta_o,brdf\n75,-180,-80,0,1\n");
        assert!(exchanged.contains("azimuths exchanged?"), "{exchanged}");
        let percent = error("# unit: percent\npsi_deg,theta_deg,brdf\n1,2,3\n");
        assert!(
            percent.contains("quantity: reflectance_factor"),
            "{percent}"
        );
        let twice = error("# quantity: brdf_cos\npsi_deg,theta_deg,R%\n1,2,3\n");
        assert!(twice.contains("the values are f_r cos theta"), "{twice}");
        let several = error("psi_deg,theta_deg,brdf,450nm\n1,2,3,4\n");
        assert!(several.contains("in several ways"), "{several}");
    }

    #[test]
    fn readings_of_different_samples_are_not_pooled() {
        let table = "psi_deg,theta_deg,brdf,paint\n1,2,3,red\n1,3,3,blue\n1,2,4,blue\n";
        let message = error(table);
        assert!(
            message.contains("\"paint\" differs") && message.contains("lines 2 and 4"),
            "{message}"
        );
        assert_eq!(scan(&table.replace("paint", "repeat")).readings().len(), 3);
        let label = ReadOptions {
            columns: vec![("Paint".to_owned(), "ignore".to_owned())],
            ..ReadOptions::default()
        };
        let scan = Measurements::from_bytes("a.csv", table.as_bytes(), &label).unwrap();
        assert_eq!(scan.readings().len(), 3);
        assert_eq!(scan.ignored_columns, ["paint"]);
    }

    #[test]
    fn options_say_what_columns_are_and_what_comments_lack() {
        let table = "# quantity: brdf\na,b,c\n10,60,50\n";
        let named = |pairs: &[(&str, &str)]| {
            pairs
                .iter()
                .map(|(a, b)| ((*a).to_owned(), (*b).to_owned()))
                .collect()
        };
        let options = ReadOptions {
            columns: named(&[("a", "psi_deg"), ("b", "theta_deg"), ("c", "brdf")]),
            declarations: named(&[("quantity", "brdf_cos"), ("factor", "0.01")]),
            ..ReadOptions::default()
        };
        let scan = Measurements::from_bytes("a.csv", table.as_bytes(), &options).unwrap();
        assert!((scan.readings()[0].brdf - 1.0).abs() < 1e-14);
        for (columns, expected) in [
            (&[("d", "psi_deg")][..], "no column \"d\""),
            (&[("a", "angle")], "the role \"angle\""),
        ] {
            let options = ReadOptions {
                columns: [named(columns), options.columns.clone()].concat(),
                ..options.clone()
            };
            let read = Measurements::from_bytes("a.csv", table.as_bytes(), &options);
            let message = read.unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }

    #[test]
    fn readings_that_were_not_taken_or_are_below_the_horizon_are_counted() {
        let scan = scan(
            "# missing: -1\npsi_deg,theta_deg,brdf\n10,-90,0\n10,-80,NaN\n10,0,\n10,1,-1\n10,2,3\n",
        );
        assert_eq!(scan.readings().len(), 1);
        assert_eq!(
            scan.conversions[1..],
            [
                "3 readings not taken (no value) are left out",
                "1 reading at or beyond 90 deg from the normal is left out"
            ]
        );
    }

    #[test]
    fn a_missing_standard_deviation_is_none() {
        let scan =
            scan("psi_deg,theta_deg,brdf_per_sr,sigma_per_sr\n1,2,3,0.1\n1,2,3,\n1,2,3\n\u{1a}");
        let sigmas: Vec<_> = scan.readings().iter().map(|r| r.sigma).collect();
        assert_eq!(sigmas, [Some(0.1), None, None]);
    }
}
