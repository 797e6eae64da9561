//! The scans of a file, one for each wavelength, read when they are needed: a table's channels hold
//! more than is good to have in memory at once.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use super::merl::{self, Channel, Table};
use super::{ReadError, ReadOptions};
use crate::scan::Measurements;

/// The readings of one wavelength of a file.
#[derive(Debug, Clone, PartialEq)]
pub enum Scan {
    /// At hand.
    Read(Measurements),
    /// A channel of a MERL table, still in its file.
    Channel {
        /// The file.
        path: PathBuf,
        /// The channel.
        channel: Channel,
    },
}

impl Scan {
    /// The scans of a file, in ascending order of wavelength.
    ///
    /// Errors: what [`Measurements::read`] says; of a table of which all readings are wanted, what
    /// is wrong with its header alone.
    pub fn of_file(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Vec<Self>, ReadError> {
        let path = path.as_ref();
        if !merl::is_table(path, options) {
            let scans = Measurements::read(path, options)?.by_wavelength();
            return Ok(scans.into_iter().map(Self::Read).collect());
        }
        let table = Table::open(path)?;
        if options.sample.is_some() {
            let channels = merl::channels(table, options)?;
            return channels.map(|channel| Ok(Self::Read(channel?))).collect();
        }
        table.check(options)?;
        let channels = Channel::ALL.into_iter().rev();
        let scan = |channel| Self::Channel {
            path: path.to_owned(),
            channel,
        };
        Ok(channels.map(scan).collect())
    }

    /// All readings.
    pub fn measurements(&self) -> Result<Cow<'_, Measurements>, ReadError> {
        match self {
            Self::Read(measurements) => Ok(Cow::Borrowed(measurements)),
            Self::Channel { path, channel } => Table::open(path)?.channel(*channel).map(Cow::Owned),
        }
    }

    /// The readings that pictures show: all of a scan, and of a table those that a goniometer would
    /// have taken.
    pub fn pictured(&self) -> Result<Cow<'_, Measurements>, ReadError> {
        match self {
            Self::Read(measurements) => Ok(Cow::Borrowed(measurements)),
            Self::Channel { path, channel } => Table::open(path)?.scan(*channel).map(Cow::Owned),
        }
    }

    /// Whether the readings are still in the file.
    pub fn is_in_file(&self) -> bool {
        matches!(self, Self::Channel { .. })
    }

    /// The file.
    pub fn source(&self) -> Cow<'_, str> {
        match self {
            Self::Read(measurements) => Cow::Borrowed(&measurements.source),
            Self::Channel { path, .. } => path.to_string_lossy(),
        }
    }

    /// The wavelength in micrometres, where the file states one.
    pub fn wavelength_um(&self) -> Option<f64> {
        match self {
            Self::Read(measurements) => measurements.wavelengths().first().copied().flatten(),
            Self::Channel { channel, .. } => Some(channel.wavelength_um()),
        }
    }
}
