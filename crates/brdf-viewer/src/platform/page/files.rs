//! The files of a page: those that were brought are read, what is written is downloaded.

use std::collections::BTreeSet;
use std::future::Future;
use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};
use std::pin::Pin;
use std::rc::Rc;
use std::time::SystemTime;

use brdf_fit::Measurements;
use brdf_fit::read::{LazyScan, ReadError, ReadOptions};
use brdf_fit::report::{Document, DocumentError};
use egui::DroppedFileHandle;
use wasm_bindgen_futures::spawn_local;

use super::{browser, folder};
use crate::events::EventSender;
use crate::intent::Intent;
use crate::job::Event;
use crate::platform::{Files, WriteError};

/// The largest file that a page opens, in bytes. A fit takes several times as much memory, of which a page
/// has at most 4 GiB; a MERL table has 34 MB.
const MOST_BYTES: usize = 16 << 20;

/// The files of a page.
#[derive(Debug)]
pub enum PageFiles {}

impl Files for PageFiles {
    const PLACE_OF_SCANS: &'static str =
        "to be dropped or chosen together with the fit: a page cannot read folders";

    fn is_special(_: &Path) -> bool {
        false
    }

    fn is_file(path: &Path) -> bool {
        folder::content(path).is_some()
    }

    /// A brought file is a copy, which does not change.
    fn modified(_: &Path) -> Option<SystemTime> {
        None
    }

    fn scans(path: &Path, options: &ReadOptions) -> Result<Vec<LazyScan>, ReadError> {
        let content = content(path).map_err(|error| ReadError::Io {
            path: path.to_owned(),
            error,
        })?;
        let all = Measurements::from_bytes(&path.display().to_string(), &content, options)?;
        let scans = all.by_wavelength().into_iter();
        Ok(scans.map(LazyScan::Loaded).collect())
    }

    fn document(path: &Path) -> Result<Document, DocumentError> {
        let content = content(path).map_err(|error| DocumentError::Io {
            path: path.to_owned(),
            error,
        })?;
        Document::from_bytes(path, &content)
    }

    fn write(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
        let file = path.file_name().unwrap_or_default().to_string_lossy();
        browser::download(&file, bytes).map_err(|message| WriteError::Browser {
            file: file.into_owned(),
            message,
        })
    }

    fn take_dropped(files: Vec<DroppedFileHandle>, events: EventSender) -> Vec<Intent> {
        if !files.is_empty() {
            let brought = |file: DroppedFileHandle| Brought {
                name: file.path().display().to_string(),
                content: Box::pin(async move { file.bytes_async().await }),
            };
            bring(files.into_iter().map(brought).collect(), events);
        }
        Vec::new()
    }
}

fn content(path: &Path) -> Result<Rc<[u8]>, Error> {
    let missing =
        "the browser does not have it any more: expected it to be dropped or chosen again";
    let content = folder::content(path).ok_or_else(|| Error::new(ErrorKind::NotFound, missing))?;
    if content.len() > MOST_BYTES {
        let message = format!(
            "it has {} MB: expected at most {} MB in a page (the viewer of the desktop and \
             the command `fit` read larger files)",
            content.len() >> 20,
            MOST_BYTES >> 20
        );
        return Err(Error::new(ErrorKind::FileTooLarge, message));
    }
    Ok(content)
}

/// A file that the user dropped or chose.
pub(super) struct Brought {
    /// Its name.
    pub(super) name: String,
    /// Its bytes, or the message of the browser.
    pub(super) content: Pin<Box<dyn Future<Output = Result<Vec<u8>, String>>>>,
}

/// Copies files into the folder of the page, and sends which of them are to be opened: all but the scans that
/// belong to a fit among them, which are opened with it.
pub(super) fn bring(files: Vec<Brought>, events: EventSender) {
    spawn_local(async move {
        let mut paths = Vec::new();
        for file in files {
            match file.content.await {
                Ok(bytes) => paths.push(folder::add(&file.name, &bytes)),
                Err(error) => {
                    let message = format!("{}: cannot be read: {error}", file.name);
                    events.send(Event::OpenFailed(message));
                }
            }
        }
        let scans = scans_of_fits(&paths);
        paths.retain(|path| !scans.contains(path));
        events.send(Event::FilesChosen(paths));
    });
}

/// The names of the scans that the fits among files name.
fn scans_of_fits(paths: &[PathBuf]) -> BTreeSet<PathBuf> {
    let mut scans = BTreeSet::new();
    for path in paths {
        if path
            .extension()
            .is_none_or(|e| !e.eq_ignore_ascii_case("json"))
        {
            continue;
        }
        // What is wrong with a document is said when it is opened.
        let Ok(document) = PageFiles::document(path) else {
            continue;
        };
        for report in &document.reports {
            let named = std::iter::once(&report.file).chain(&report.read_settings.joined);
            scans.extend(named.filter_map(|scan| Path::new(scan).file_name().map(PathBuf::from)));
        }
    }
    scans
}
