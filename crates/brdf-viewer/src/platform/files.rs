//! The files that are read and written.

use std::path::Path;
use std::time::SystemTime;

use brdf_fit::output;
use brdf_fit::read::{LazyScan, ReadError, ReadOptions};
use brdf_fit::report::{Document, DocumentError};
use egui::DroppedFileHandle;

use crate::events::EventSender;
use crate::intent::Intent;

/// Reads and writes files.
pub trait Files {
    /// Where the scan of a fit is expected, for the message that it is missing.
    const PLACE_OF_SCANS: &'static str;

    /// Whether a path leads to a folder, a pipe or a device.
    fn is_special(path: &Path) -> bool;

    /// Whether a path leads to a file.
    fn is_file(path: &Path) -> bool;

    /// When a file was last changed.
    fn modified(path: &Path) -> Option<SystemTime>;

    /// Opens a scan, one for each wavelength.
    ///
    /// # Errors
    ///
    /// The file cannot be read, or is not a scan.
    fn scans(path: &Path, options: &ReadOptions) -> Result<Vec<LazyScan>, ReadError>;

    /// Reads a document of fits.
    ///
    /// # Errors
    ///
    /// The file cannot be read, or is not a document of fits.
    fn document(path: &Path) -> Result<Document, DocumentError>;

    /// Writes a file. It is replaced only when it is complete.
    ///
    /// # Errors
    ///
    /// The file cannot be written.
    fn write(path: &Path, bytes: &[u8]) -> Result<(), WriteError>;

    /// Takes files that were dropped onto the window: those that can be opened at once are returned,
    /// others follow as [`Event::FilesChosen`](crate::job::Event::FilesChosen).
    fn take_dropped(files: Vec<DroppedFileHandle>, events: EventSender) -> Vec<Intent>;
}

/// Why a file cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The system refuses it.
    #[error(transparent)]
    System(#[from] output::WriteError),
    /// The browser refuses it.
    #[error("{file}: cannot be downloaded: {message}")]
    Browser {
        /// The name of the file.
        file: String,
        /// The message of the browser.
        message: String,
    },
}
