//! The roles of the columns of a table: which column holds what.

use super::header::Column;
use crate::read::names::{AngleForm, LengthUnit, Polarisation, Role};

/// A column of angles, with its unit.
pub(super) type AngleColumn = (usize, AngleForm);

/// The position of each quantity in a row.
pub(super) struct Roles {
    pub(super) psi: Option<AngleColumn>,
    pub(super) theta: AngleColumn,
    pub(super) source_azimuth: Option<AngleColumn>,
    pub(super) view_azimuth: Option<AngleColumn>,
    pub(super) wavelength: Option<(usize, LengthUnit)>,
    pub(super) sigma: Option<usize>,
    pub(super) n: Option<usize>,
    pub(super) readings: Readings,
    /// The columns that are not used and are not labels: they may separate readings of one geometry.
    pub(super) unknown: Vec<usize>,
}

/// What a row of a table is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rows {
    /// Readings and their angles.
    Readings,
    /// Angles alone.
    Angles,
}

/// The columns of the readings.
pub(super) enum Readings {
    /// One reading a row.
    One(usize),
    /// A reading with each polarisation, s first.
    Polarised(usize, usize),
    /// The signal of the sample and that of the white standard.
    Ratio(usize, usize),
    /// A reading at each wavelength in um.
    Channels(Vec<(usize, f64)>),
    /// The rows are angles alone.
    None,
}

impl Roles {
    /// # Errors
    ///
    /// Two columns have one role, there is no view angle, or the reading is given in several ways.
    pub(super) fn of(columns: &[Column], rows: Rows) -> Result<Self, String> {
        let columns = Columns(columns);
        // "s" is the scatter where the incidence has its own column, and the source where the view has.
        let s_is_source = columns.all(|role| matches!(role, Role::Psi(_))).is_empty();
        let psi = columns.angle(|role| {
            matches!(role, Role::Psi(_)) || s_is_source && matches!(role, Role::ThetaS(_))
        })?;
        let theta = columns.angle(|role| {
            matches!(role, Role::Theta(_)) || !s_is_source && matches!(role, Role::ThetaS(_))
        })?;
        let source_azimuth = columns.angle(|role| {
            matches!(role, Role::SourceAzimuth(_)) || s_is_source && matches!(role, Role::PhiS(_))
        })?;
        let view_azimuth = columns.angle(|role| {
            matches!(role, Role::ViewAzimuth(_)) || !s_is_source && matches!(role, Role::PhiS(_))
        })?;
        let wavelength = columns.wavelength()?;
        let readings = match rows {
            Rows::Angles => Readings::None,
            Rows::Readings => columns.readings()?,
        };
        if let (Readings::Channels(_), Some((i, _))) = (&readings, wavelength) {
            return Err(format!(
                "\"{}\" is a wavelength, and the readings have a column for each wavelength",
                columns.0[i].name
            ));
        }
        let sigma = columns.one(|role| *role == Role::Sigma)?;
        let may_have_sigma = matches!(readings, Readings::One(_) | Readings::None);
        if let (Some(i), false) = (sigma, may_have_sigma) {
            return Err(format!(
                "\"{}\" is a standard deviation, which is read beside a single column of readings only: \
                 say that it is to be ignored, or choose one column",
                columns.0[i].name
            ));
        }
        Ok(Self {
            psi,
            theta: theta.ok_or("no column for the view angle (theta_deg)")?,
            source_azimuth,
            view_azimuth,
            wavelength,
            sigma,
            n: columns.one(|role| *role == Role::Index)?,
            readings,
            unknown: columns.unknown(),
        })
    }
}

/// The columns of a header.
#[derive(Clone, Copy)]
struct Columns<'a>(&'a [Column]);

impl Columns<'_> {
    /// The columns with a role.
    fn all(self, wanted: impl Fn(&Role) -> bool) -> Vec<usize> {
        let columns = self.0.iter().enumerate();
        let found = columns.filter(|(_, column)| column.role.as_ref().is_some_and(&wanted));
        found.map(|(i, _)| i).collect()
    }

    /// The column with a role.
    ///
    /// # Errors
    ///
    /// There are several.
    fn one(self, wanted: impl Fn(&Role) -> bool) -> Result<Option<usize>, String> {
        match self.all(wanted)[..] {
            [] => Ok(None),
            [only] => Ok(Some(only)),
            [first, second, ..] => {
                let (first, second) = (&self.0[first], &self.0[second]);
                let words = first.role.map(Role::in_words).unwrap_or_default();
                Err(format!(
                    "the {words} is given twice, by \"{}\" and by \"{}\"",
                    first.name, second.name
                ))
            }
        }
    }

    fn angle(self, wanted: impl Fn(&Role) -> bool) -> Result<Option<AngleColumn>, String> {
        let found = self.one(wanted)?;
        Ok(found.and_then(|i| match self.0[i].role? {
            Role::Psi(form)
            | Role::Theta(form)
            | Role::ThetaS(form)
            | Role::SourceAzimuth(form)
            | Role::ViewAzimuth(form)
            | Role::PhiS(form) => Some((i, form)),
            _ => None,
        }))
    }

    fn wavelength(self) -> Result<Option<(usize, LengthUnit)>, String> {
        let found = self.one(|role| matches!(role, Role::Wavelength(_)))?;
        Ok(found.and_then(|i| match self.0[i].role? {
            Role::Wavelength(unit) => Some((i, unit)),
            _ => None,
        }))
    }

    /// # Errors
    ///
    /// The reading is given in several ways, or in none.
    fn readings(self) -> Result<Readings, String> {
        let value = self.one(|role| matches!(role, Role::Value(_)))?;
        let polarised = self.all(|role| matches!(role, Role::Polarised(..)));
        let signal = self.one(|role| *role == Role::Signal)?;
        let reference = self.one(|role| *role == Role::Reference)?;
        let channels = self.channels();
        match (
            value,
            &polarised[..],
            signal.zip(reference),
            channels.is_empty(),
        ) {
            (Some(value), [], None, true) => Ok(Readings::One(value)),
            (None, [first, second], None, true) => self.polarised_pair(*first, *second),
            (None, [], Some((signal, reference)), true) => Ok(Readings::Ratio(signal, reference)),
            (None, [], None, false) => Ok(Readings::Channels(channels)),
            _ => Err(
                "the reading is given in several ways: expected one column, a column for each \
                 wavelength, brdf_s and brdf_p, or signal and reference"
                    .to_owned(),
            ),
        }
    }

    fn channels(self) -> Vec<(usize, f64)> {
        let columns = self.0.iter().enumerate();
        let channel = |(i, column): (usize, &Column)| match column.role? {
            Role::Channel(um) => Some((i, um)),
            _ => None,
        };
        columns.filter_map(channel).collect()
    }

    fn polarised_pair(self, first: usize, second: usize) -> Result<Readings, String> {
        let is_s = |i: usize| matches!(self.0[i].role, Some(Role::Polarised(Polarisation::S, _)));
        match (is_s(first), is_s(second)) {
            (true, false) => Ok(Readings::Polarised(first, second)),
            (false, true) => Ok(Readings::Polarised(second, first)),
            _ => Err("one polarisation is given twice: expected brdf_s and brdf_p".to_owned()),
        }
    }

    fn unknown(self) -> Vec<usize> {
        let is_unknown = |&i: &usize| self.0[i].role.is_none() && !self.0[i].name.is_empty();
        (0..self.0.len()).filter(is_unknown).collect()
    }
}
