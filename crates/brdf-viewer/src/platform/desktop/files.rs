//! The files of the system.

use std::path::Path;
use std::time::SystemTime;

use brdf_fit::output::write_file;
use brdf_fit::read::{LazyScan, ReadError, ReadOptions};
use brdf_fit::report::{Document, DocumentError};
use egui::DroppedFileHandle;

use crate::events::EventSender;
use crate::intent::Intent;
use crate::platform::{Files, WriteError};

/// The files of the system.
#[derive(Debug)]
pub enum NativeFiles {}

impl Files for NativeFiles {
    const PLACE_OF_SCANS: &'static str =
        "at the path given in the fit, or in the folder of the fit";

    fn is_special(path: &Path) -> bool {
        path.exists() && !path.is_file()
    }

    fn is_file(path: &Path) -> bool {
        path.is_file()
    }

    fn modified(path: &Path) -> Option<SystemTime> {
        path.metadata().ok()?.modified().ok()
    }

    fn scans(path: &Path, options: &ReadOptions) -> Result<Vec<LazyScan>, ReadError> {
        LazyScan::open(path, options)
    }

    fn document(path: &Path) -> Result<Document, DocumentError> {
        Document::read(path)
    }

    fn write(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
        write_file(path, |writer| writer.write_all(bytes))?;
        Ok(())
    }

    /// A file with an absolute path is read by the worker; others come with their content.
    fn take_dropped(files: Vec<DroppedFileHandle>, _: EventSender) -> Vec<Intent> {
        let intents = files.iter().map(|file| {
            let path = file.path().to_owned();
            match file.bytes() {
                Ok(bytes) if !path.is_absolute() => {
                    Intent::OpenBytes(path.display().to_string(), bytes)
                }
                _ => Intent::Open(vec![path]),
            }
        });
        intents.collect()
    }
}
