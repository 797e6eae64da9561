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
//! A reading with a percent sign, `5 %`, is 0.05 in a column of reflectance factors and 5 in one in percent.
//!
//! Readings that were not taken (blank, `-`, `NaN`, `n/a`) and those at or beyond 90 deg are left out and
//! counted. A negative incidence angle is on the other side of the normal: the view angle is mirrored. A
//! decimal comma, the minus sign of typesetting and the exponent of Fortran (`1.1D-01`) are read, as are a
//! byte order mark and the line ends of all systems.

mod angles;
mod header;
mod roles;
mod row;

use std::collections::HashMap;
use std::fs::File;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Read;
use std::path::Path;

use super::comments::{Comments, SOURCE_AZIMUTH, comment_of, number_of_key, stated_wavelength_um};
use super::conversion::{Kind, Quantity};
use super::error::ReadError;
use super::names::{AngleForm, LengthUnit, Role};
use super::number::is_angle;
use super::options::ReadOptions;
use super::reader::{Content, Reader};
use super::text::{Text, head_lines, read_bytes};
use crate::scan::{Convention, Format, Measurement, Measurements};
pub use angles::AngleTable;
use header::{Header, Preamble, is_header};
use roles::{Readings, Roles, Rows};
use row::{Found, IndexColumn, Row, RowReader};

pub(super) const READER: Reader = Reader {
    format: Format::Csv,
    extensions: &["csv", "tsv"],
    recognises: |bytes| has_header(bytes, &[]),
    content: Content::Table(read),
};

/// Whether a text begins with a table whose header names angles and readings, with the names of columns
/// that are `renamed`.
pub(super) fn has_header(head: &[u8], renamed: &[(String, String)]) -> bool {
    head_lines(head).any(|line| is_header(line, renamed))
}

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
    let bytes = read_bytes(Vec::new(), reader, expected_size, true)
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
    } = Preamble::read(&text, Rows::Readings, options)?;
    let reader = reader(&text, &header, &comments, Rows::Readings, options)?;
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
    rows: Rows,
    options: &ReadOptions,
) -> Result<RowReader, ReadError> {
    let roles = header.roles(text, rows)?;
    let of_header = |message: String| text.line_error(header.number, message);
    let values = comments
        .values(quantity(header, &roles))
        .map_err(of_header)?;
    let number =
        |key, expected, accepts| number_of_key(text, &comments.metadata, key, expected, accepts);
    let psi_deg = number("psi_deg", "expected degrees between -90 and 90", |x| {
        x.abs() < 90.0
    })?;
    if roles.psi.is_none() && psi_deg.is_none() {
        let problem = "no column for the incidence angle (psi_deg), and no line \"# psi_deg: 30\":";
        return Err(header.unclear(text, problem));
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
    Ok(RowReader {
        values,
        convention: options.convention(Convention::default()),
        missing: comments.missing(),
        polarisation,
        psi_deg,
        phi_deg: number("phi_deg", "expected degrees", is_angle)?,
        source_azimuth_deg: number(SOURCE_AZIMUTH, "expected degrees", is_angle)?,
        wavelength_um: stated_wavelength_um(text, &comments.metadata)?,
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
        Readings::Polarised(..) | Readings::Channels(_) | Readings::None => Quantity::BRDF,
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
            is_cut_off: fields.len() < header.columns.len() && text.ends_within(line),
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
    reader: &RowReader,
    found: &mut Found,
) -> Result<(), ReadError> {
    let problem = |message: String| Err(text.line_error(header.number, message));
    if found.readings.is_empty() {
        return match (found.left.beyond, found.left.not_taken) {
            (0, 0) => problem("no readings follow the header".to_owned()),
            (0, count) => problem(format!(
                "none of the {count} readings was taken: every value is blank"
            )),
            (count, _) => {
                let problem = format!(
                    "all {count} readings are at or beyond 90 deg from the normal: are zenith angles and \
                     azimuths exchanged?"
                );
                Err(header.unclear(text, &problem))
            }
        };
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
fn conversions(header: &Header, reader: &RowReader, found: &Found, skipped: usize) -> Vec<String> {
    let mut all: Vec<String> = header.sentence().into_iter().collect();
    if let Some((_, LengthUnit::Unstated)) = reader.roles.wavelength {
        let um = found
            .readings
            .iter()
            .find_map(|reading| reading.wavelength_um);
        all.extend(um.map(|um| {
            format!("the header states no unit of wavelength: the first one is read as {um} um")
        }));
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
        (Readings::One(_) | Readings::None, _) => {}
    }
    all.extend(reader.values.conversions());
    if found.mirrored > 0 {
        let count = found.mirrored;
        all.push(format!(
            "{count} rows have a negative incidence angle: it is on the other side of the normal"
        ));
    }
    all.extend(found.left.notes());
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
mod tests;
