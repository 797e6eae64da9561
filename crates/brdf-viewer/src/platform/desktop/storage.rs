//! A file that keeps the settings.

use std::io;
use std::path::{Path, PathBuf};

use brdf_fit::output::write_file;

use crate::platform::{SaveError, Storage};

/// A file that keeps the settings and the session. The files of the session stay where they are.
#[derive(Debug)]
pub struct SettingsFile(PathBuf);

impl SettingsFile {
    /// The file with a path. It is created with its folder when settings are written.
    pub fn new(path: PathBuf) -> Self {
        Self(path)
    }
}

impl Storage for SettingsFile {
    fn name(&self) -> String {
        self.0.display().to_string()
    }

    fn read(&self) -> io::Result<Option<String>> {
        match std::fs::read_to_string(&self.0) {
            Ok(text) => Ok(Some(text)),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// The file is replaced only when it is complete.
    fn write(&self, text: &str, _: &[&Path]) -> Result<Vec<String>, SaveError> {
        if let Some(folder) = self.0.parent() {
            std::fs::create_dir_all(folder).map_err(|error| SaveError::Folder {
                folder: folder.to_owned(),
                error,
            })?;
        }
        write_file(&self.0, |writer| writer.write_all(text.as_bytes()))?;
        Ok(Vec::new())
    }

    /// Renames the file.
    fn set_aside(&self) -> io::Result<String> {
        let aside = self.0.with_extension("damaged");
        std::fs::rename(&self.0, &aside)?;
        Ok(aside.display().to_string())
    }
}
