//! The scans of a file, one for each wavelength. The channels of a MERL table stay in the file
//! until their readings are needed: one channel takes 70 MB of memory.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use super::detect;
use super::error::ReadError;
use super::merl::{self, Channel, Table};
use super::options::ReadOptions;
use crate::scan::Measurements;

/// The readings of one wavelength of a file, which are read when they are needed.
#[derive(Debug, Clone, PartialEq)]
#[allow(
    clippy::large_enum_variant,
    reason = "there is one for each wavelength, and nearly all are loaded; on 32 bits it is no lint"
)]
pub enum LazyScan {
    /// The readings are in memory.
    Loaded(Measurements),
    /// The readings are a channel of a MERL table, still in its file.
    MerlChannel {
        /// The file of the table.
        path: PathBuf,
        /// The channel of the table.
        channel: Channel,
    },
}

impl LazyScan {
    /// Opens a file: its scans in ascending order of wavelength.
    ///
    /// Text files, and MERL tables of which [`ReadOptions::sample`] keeps a part, are read at once.
    /// Of other MERL tables only the header is read.
    ///
    /// # Errors
    ///
    /// As [`Measurements::read`]; errors in the values of a MERL table that stays in its file are
    /// returned by [`measurements`](Self::measurements) and [`plotted`](Self::plotted) instead.
    pub fn open(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Vec<Self>, ReadError> {
        let path = path.as_ref();
        if !detect::is_merl_file(path, options) {
            let scans = Measurements::read(path, options)?.by_wavelength();
            return Ok(scans.into_iter().map(Self::Loaded).collect());
        }
        let table = Table::open(path)?;
        if options.sample.is_some() {
            let channels = merl::channels(table, options)?;
            return channels.map(|channel| Ok(Self::Loaded(channel?))).collect();
        }
        table.check_options(options)?;
        let channels = Channel::ALL.into_iter().rev();
        let scan = |channel| Self::MerlChannel {
            path: path.to_owned(),
            channel,
        };
        Ok(channels.map(scan).collect())
    }

    /// All readings of the scan, from memory or from the file.
    ///
    /// # Errors
    ///
    /// The MERL table can no longer be read, or one of its values is not a finite number.
    pub fn measurements(&self) -> Result<Cow<'_, Measurements>, ReadError> {
        match self {
            Self::Loaded(measurements) => Ok(Cow::Borrowed(measurements)),
            Self::MerlChannel { path, channel } => {
                Table::open(path)?.channel(*channel).map(Cow::Owned)
            }
        }
    }

    /// [`measurements`](Self::measurements), by value.
    ///
    /// # Errors
    ///
    /// As [`measurements`](Self::measurements).
    pub fn into_measurements(self) -> Result<Measurements, ReadError> {
        match self {
            Self::Loaded(measurements) => Ok(measurements),
            Self::MerlChannel { path, channel } => Table::open(path)?.channel(channel),
        }
    }

    /// The readings that figures show: all readings of a scan in memory, and of a MERL channel
    /// those of a scan in the plane of incidence ([`Table::in_plane_scan`]).
    ///
    /// # Errors
    ///
    /// As [`measurements`](Self::measurements).
    pub fn plotted(&self) -> Result<Cow<'_, Measurements>, ReadError> {
        match self {
            Self::Loaded(measurements) => Ok(Cow::Borrowed(measurements)),
            Self::MerlChannel { path, channel } => {
                Table::open(path)?.in_plane_scan(*channel).map(Cow::Owned)
            }
        }
    }

    /// Whether the readings are still in the file.
    pub fn is_in_file(&self) -> bool {
        matches!(self, Self::MerlChannel { .. })
    }

    /// The path of the file.
    pub fn source(&self) -> Cow<'_, str> {
        match self {
            Self::Loaded(measurements) => Cow::Borrowed(&measurements.source),
            Self::MerlChannel { path, .. } => path.to_string_lossy(),
        }
    }

    /// The wavelength in micrometres; `None` where the file does not state one.
    pub fn wavelength_um(&self) -> Option<f64> {
        match self {
            Self::Loaded(measurements) => measurements.wavelengths().first().copied().flatten(),
            Self::MerlChannel { channel, .. } => Some(channel.wavelength_um()),
        }
    }
}
