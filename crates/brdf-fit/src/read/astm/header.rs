//! The lines before the rows: keys with values, and the names of the columns.

use crate::read::angles::AngleUnit;
use crate::read::comments;
use crate::read::conversion::{Kind, Quantity};
use crate::read::error::ReadError;
use crate::read::names::quantity_named;
use crate::read::number::{Field, is_angle, micrometres};
use crate::read::options::ReadOptions;
use crate::read::text::Text;
use crate::scan::{Convention, Metadata, RefractiveIndex, Side};

/// The names of the angles of source (i) and view (s).
const ANGLES: [&str; 4] = ["theta_i", "phi_i", "theta_s", "phi_s"];

/// The content of a column.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Column {
    /// An angle, by its index in [`ANGLES`].
    Angle(usize),
    /// A value, at the wavelength in micrometres that the name of the column gives.
    Value(Option<f64>),
    /// The standard deviation of the value.
    Sigma,
    /// Not read.
    Unused,
}

/// The lines before the rows.
pub(super) struct Header {
    /// The number of the line `VARS`.
    number: u64,
    pub(super) metadata: Metadata,
    pub(super) names: Vec<String>,
    pub(super) columns: Vec<Column>,
    /// Angles that are the same in all rows, by their index in [`ANGLES`], in the file's unit.
    pub(super) given: [Option<f64>; 4],
    pub(super) unit: Option<AngleUnit>,
    pub(super) quantity: Quantity,
    /// Whether a key gives the quantity.
    states_quantity: bool,
    wavelength_um: Option<f64>,
    pub(super) refractive_index: Option<RefractiveIndex>,
    /// The number of rows that the file states.
    count: Option<f64>,
    /// Sentences that report conversions.
    pub(super) conversions: Vec<String>,
}

impl Header {
    /// Reads up to the line `VARS`.
    ///
    /// # Errors
    ///
    /// A key or a column is not valid, or there is no line `VARS`.
    pub(super) fn read<'a>(
        text: &Text<'_>,
        lines: &mut impl Iterator<Item = Result<(u64, &'a [u8]), ReadError>>,
    ) -> Result<Self, ReadError> {
        let mut header = Self {
            number: 0,
            metadata: Metadata::default(),
            names: Vec::new(),
            columns: Vec::new(),
            given: [None; 4],
            unit: None,
            quantity: Quantity::BRDF,
            states_quantity: false,
            wavelength_um: None,
            refractive_index: None,
            count: None,
            conversions: Vec::new(),
        };
        for line in lines {
            let (number, line) = line?;
            let Some((key, value)) = key_and_value(line) else {
                continue;
            };
            if key == "vars" {
                header.number = number;
                header.take_columns(text, &value)?;
                return Ok(header);
            }
            header.take_key(text, number, key, value)?;
        }
        Err(text
            .error("has no line VARS: expected one with theta_i, theta_s and a column of values"))
    }

    fn take_key(
        &mut self,
        text: &Text<'_>,
        line: u64,
        key: String,
        value: String,
    ) -> Result<(), ReadError> {
        let field = Field::plain(value.as_bytes());
        match key.as_str() {
            "theta_i" | "phi_i" | "theta_s" | "phi_s" => {
                let angle = text.number(line, &key, &field, "expected an angle", is_angle)?;
                let index = ANGLES.iter().position(|name| *name == key);
                if let Some(given) = index.and_then(|index| self.given.get_mut(index)) {
                    *given = Some(angle);
                }
            }
            "angle_unit" | "angle_units" => self.unit = Some(unit_of(text, line, &value)?),
            "num_points" | "data_points" => {
                let expected = "expected the number of rows";
                let accepts = |n: f64| n >= 0.0 && n.fract() == 0.0;
                self.count = Some(text.number(line, &key, &field, expected, accepts)?);
            }
            "wavelength" => self.wavelength_um = Some(wavelength_of(text, line, &value)?),
            "quantity" | "meas_name" => {
                if let Some(quantity) = quantity_of(text, line, &value)? {
                    self.quantity = quantity;
                    self.states_quantity = true;
                }
            }
            "refractive_index" => {
                let index = value
                    .parse()
                    .map_err(|error| text.line_error(line, format!("refractive_index: {error}")))?;
                self.refractive_index = Some(index);
            }
            "sample_name" => self.metadata.0.push(("sample".to_owned(), value.clone())),
            _ => {}
        }
        self.metadata.0.push((key, value));
        Ok(())
    }

    fn take_columns(&mut self, text: &Text<'_>, names: &str) -> Result<(), ReadError> {
        self.names = if names.contains(',') {
            names
                .split(',')
                .map(|name| name.trim().to_owned())
                .collect()
        } else {
            names.split_whitespace().map(str::to_owned).collect()
        };
        self.columns = self.names.iter().map(|name| Column::named(name)).collect();
        self.take_colours(text)?;
        self.take_only_value(text)?;
        self.check_columns(text)
    }

    /// Of X, Y and Z, Y is the value; R, G and B are refused.
    fn take_colours(&mut self, text: &Text<'_>) -> Result<(), ReadError> {
        let position = |name: &str| self.names.iter().position(|other| other == name);
        if let (Some(_), Some(_), Some(_)) = (position("R"), position("G"), position("B")) {
            let message = "R, G and B are display colours: expected wavelengths such as 400nm, one \
                           BRDF, or X, Y and Z, of which Y is read";
            return Err(text.line_error(self.number, message));
        }
        if let (Some(_), Some(y), Some(_)) = (position("X"), position("Y"), position("Z")) {
            self.columns[y] = Column::Value(None);
            let sentence = "of X, Y and Z, Y is read: the BRDF weighted by the luminous efficiency";
            self.conversions.push(sentence.to_owned());
        }
        Ok(())
    }

    /// Where no column is known as a value, the only column that is left is the value. The name of the
    /// value may also name its quantity.
    fn take_only_value(&mut self, text: &Text<'_>) -> Result<(), ReadError> {
        let unused = |column: &Column| *column == Column::Unused;
        let is_value = |column: &Column| matches!(column, Column::Value(_));
        if !self.columns.iter().any(is_value) {
            let mut left = (0..self.columns.len()).filter(|&i| unused(&self.columns[i]));
            if let (Some(only), None) = (left.next(), left.next()) {
                self.columns[only] = Column::Value(None);
                let name = &self.names[only];
                if quantity_of(text, self.number, name)?.is_none() && !self.states_quantity {
                    let message = format!(
                        "the quantity of the column {name} is not known: expected a name such as BRDF, \
                         CCBRDF, REFLECTANCE_FACTOR, R% or LOG_BRDF, or a line QUANTITY with one"
                    );
                    return Err(text.line_error(self.number, message));
                }
            }
        }
        let value = self
            .columns
            .iter()
            .position(|column| *column == Column::Value(None));
        let Some(name) = value.map(|index| &self.names[index]) else {
            return Ok(());
        };
        // A column that is called BRDF may have another quantity that a key has given.
        let named = quantity_of(text, self.number, name)?;
        if let Some(quantity) = named.filter(|quantity| *quantity != Quantity::BRDF) {
            self.quantity = quantity;
        }
        Ok(())
    }

    fn check_columns(&self, text: &Text<'_>) -> Result<(), ReadError> {
        let has = |column: &Column| self.columns.iter().filter(|other| *other == column).count();
        let problem = |message: String| Err(text.line_error(self.number, message));
        for (index, name) in ANGLES.iter().enumerate() {
            let found = has(&Column::Angle(index));
            if found > 1 {
                return problem(format!("column {name} is given twice"));
            }
            if found == 0 && self.given[index].is_none() && name.starts_with("theta") {
                return problem(format!(
                    "missing column {name}: expected theta_i, theta_s and a column of values"
                ));
            }
        }
        let values = self
            .columns
            .iter()
            .filter(|c| matches!(c, Column::Value(_)))
            .count();
        if values == 0 {
            return problem(
                "no column of values: expected BRDF or wavelengths such as 400nm".to_owned(),
            );
        }
        let without_wavelength = has(&Column::Value(None));
        if without_wavelength > 1 || (without_wavelength == 1 && values > 1) {
            return problem(
                "several columns of values, without wavelengths: expected names such as 400nm"
                    .to_owned(),
            );
        }
        if has(&Column::Sigma) > 0 && values > 1 {
            return problem(
                "one column sigma for several wavelengths: expected a single column of values"
                    .to_owned(),
            );
        }
        Ok(())
    }

    /// The angular convention of the file. Where phi_i is not given, the coordinates are those of the
    /// beam, with phi_s = 0 on the forward side.
    ///
    /// # Errors
    ///
    /// The options set another side of positive theta.
    pub(super) fn convention(
        &self,
        text: &Text<'_>,
        options: &ReadOptions,
    ) -> Result<Convention, ReadError> {
        let phi_i = 1;
        let given = self.given[phi_i].is_some() || self.columns.contains(&Column::Angle(phi_i));
        let of_format = Convention {
            theta_positive: Side::Source,
            phi_zero: if given { Side::Source } else { Side::Forward },
        };
        let theta_only = ReadOptions {
            phi_zero: None,
            ..options.clone()
        };
        let why = "theta_s counts towards phi_s; give the side of azimuth zero instead";
        theta_only.fixed_convention(text.path, of_format, why)?;
        Ok(options.convention(of_format))
    }

    /// # Errors
    ///
    /// There are no rows, or another number of them than the file states.
    pub(super) fn check_count(&self, text: &Text<'_>, found: usize) -> Result<(), ReadError> {
        match self.count {
            _ if found == 0 => Err(text.line_error(self.number, "no rows follow VARS")),
            Some(count) if count != found as f64 => {
                let message =
                    format!("{found} rows follow: expected {count}, as the header states");
                Err(text.line_error(self.number, message))
            }
            _ => Ok(()),
        }
    }

    /// The wavelength in micrometres of each column of values.
    pub(super) fn wavelengths(&self) -> impl Iterator<Item = Option<f64>> {
        self.columns.iter().filter_map(|column| match column {
            Column::Value(wavelength) => Some(wavelength.or(self.wavelength_um)),
            _ => None,
        })
    }

    /// The names of the columns that are not read.
    pub(super) fn unused(&self) -> Vec<String> {
        let named = self.names.iter().zip(&self.columns);
        let unused = named.filter(|(_, column)| **column == Column::Unused);
        unused.map(|(name, _)| name.clone()).collect()
    }
}

impl Column {
    fn named(name: &str) -> Self {
        let lower = name.to_lowercase();
        let as_s = lower.replace("_r", "_s");
        if let Some(index) = ANGLES.iter().position(|angle| *angle == as_s) {
            return Self::Angle(index);
        }
        let wavelength_um = lower
            .strip_suffix("nm")
            .and_then(|number| micrometres(number.as_bytes()));
        match lower.as_str() {
            "brdf" | "bsdf" | "brdf_cos" | "dsf" | "ars" | "brf" => Self::Value(None),
            "sigma" => Self::Sigma,
            _ if wavelength_um.is_some() => Self::Value(wavelength_um),
            _ => Self::Unused,
        }
    }
}

/// The key of a line in lower case and its value; of a comment only those of `key: value`.
fn key_and_value(line: &[u8]) -> Option<(String, String)> {
    let line = String::from_utf8_lossy(line);
    if let Some(comment) = line.trim_start().strip_prefix('#') {
        return comments::key_and_value(comment).filter(|(key, _)| key != "vars");
    }
    let line = line.trim();
    let (key, value) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    let value = value.trim().trim_matches('"');
    (!key.is_empty()).then(|| (key.trim_end_matches(':').to_lowercase(), value.to_owned()))
}

fn unit_of(text: &Text<'_>, line: u64, value: &str) -> Result<AngleUnit, ReadError> {
    match value.to_lowercase().as_str() {
        "deg" | "degree" | "degrees" => Ok(AngleUnit::Degrees),
        "rad" | "radian" | "radians" => Ok(AngleUnit::Radians),
        _ => {
            let message = "is not an angle unit: expected deg or rad";
            Err(text.value_error(line, "angle_unit", value.as_bytes(), message))
        }
    }
}

/// The wavelength in micrometres. Without a unit, numbers below 100 are in um and others in nm.
fn wavelength_of(text: &Text<'_>, line: u64, value: &str) -> Result<f64, ReadError> {
    let lower = value.to_lowercase();
    let lower = lower.trim();
    let nm = lower
        .strip_suffix("nm")
        .and_then(|nm| micrometres(nm.as_bytes()));
    let um = ["um", "\u{b5}m", "\u{3bc}m", "microns", "micron"];
    let um = um.iter().find_map(|unit| lower.strip_suffix(unit));
    let number = |text: &str| {
        text.trim()
            .parse::<f64>()
            .ok()
            .filter(|n| *n > 0.0 && n.is_finite())
    };
    let bare = || match number(lower)? {
        um if um < 100.0 => Some(um),
        _ => micrometres(lower.as_bytes()),
    };
    nm.or_else(|| um.and_then(number))
        .or_else(bare)
        .ok_or_else(|| {
            let message = "is not a wavelength: expected one such as 0.6328 um or 632.8 nm";
            text.value_error(line, "wavelength", value.as_bytes(), message)
        })
}

/// The quantity that a name contains; `None` where it contains none.
///
/// # Errors
///
/// The name is that of a BTDF.
fn quantity_of(text: &Text<'_>, line: u64, name: &str) -> Result<Option<Quantity>, ReadError> {
    let lower = name.to_lowercase();
    let mut parts = lower.split(|c: char| !c.is_alphanumeric());
    let has = |word: &str| parts.clone().any(|part| part == word);
    if has("btdf") {
        let message = "BTDF: the model describes reflection, expected a BRDF";
        return Err(text.line_error(line, message));
    }
    if has("dsf") || has("ars") || has("cos") || parts.any(|part| part.starts_with("cosine")) {
        return Ok(Some(Quantity::of(Kind::BrdfCos)));
    }
    if let Some(quantity) = quantity_named(name) {
        return Ok(Some(quantity));
    }
    let mut parts = lower.split(|c: char| !c.is_alphanumeric());
    Ok(parts.find_map(|part| match part {
        // Cornell calls the column of a BRDF without wavelengths so.
        "brdf" | "bsdf" | "integrated" => Some(Quantity::BRDF),
        "brf" => Some(Quantity::of(Kind::ReflectanceFactor)),
        _ => None,
    }))
}
