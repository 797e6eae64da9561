//! Where settings and session are kept.

use std::fmt::Debug;
use std::io;
use std::path::{Path, PathBuf};

use brdf_fit::output;

/// A place that keeps the settings and the session.
pub trait Storage: Debug {
    /// Its name in messages.
    fn name(&self) -> String;

    /// The text that was written last; `None` in the first session.
    ///
    /// # Errors
    ///
    /// The place cannot be read.
    fn read(&self) -> io::Result<Option<String>>;

    /// Replaces the text, and returns what the user must know, such as that a file of the session is not
    /// kept. `files` are those that the next session needs.
    ///
    /// # Errors
    ///
    /// The text cannot be written.
    fn write(&self, text: &str, files: &[&Path]) -> Result<Vec<String>, SaveError>;

    /// Moves a damaged text aside, so that it is not lost, and returns where it is.
    ///
    /// # Errors
    ///
    /// The text cannot be moved.
    fn set_aside(&self) -> io::Result<String>;
}

/// Why the settings cannot be saved.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SaveError {
    /// The folder cannot be created.
    #[error("{}: {error}", folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// The error of the system.
        error: io::Error,
    },
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] output::WriteError),
    /// The browser keeps no more.
    #[error("the browser keeps nothing more for this page: {0}")]
    Browser(String),
}
