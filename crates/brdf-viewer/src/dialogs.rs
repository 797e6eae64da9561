//! The system's dialogs for files, on threads of their own: they may stay open for hours.

use std::path::{Path, PathBuf};
use std::thread;

use brdf_fit::scan::Format;

use crate::intent::Export;
use crate::job::Event;
use crate::worker::Events;

/// Dialogs for files. In the tests there are none, or ones that answer by themselves.
pub trait Dialogs {
    /// Whether there are any.
    fn available(&self) -> bool;
    /// Asks for files to open.
    fn open(&self, events: Events);
    /// Asks where to write.
    fn export(&self, what: Export, suggested: &Path, events: Events);
}

/// Those of the system.
#[derive(Debug, Default)]
pub struct Native;

impl Dialogs for Native {
    fn available(&self) -> bool {
        !cfg!(target_os = "linux") || has_portal() || has_zenity()
    }

    fn open(&self, events: Events) {
        thread::spawn(move || {
            let dialog = rfd::FileDialog::new()
                .set_title("Open scans or fits")
                .add_filter("Scans and fits", &extensions())
                .add_filter("All files", &["*"]);
            // No answer is a dialog that was closed.
            if let Some(paths) = dialog.pick_files() {
                events.send(Event::Chosen(paths));
            }
        });
    }

    fn export(&self, what: Export, suggested: &Path, events: Events) {
        let name = suggested
            .file_name()
            .map(|name| name.to_string_lossy().into_owned());
        thread::spawn(move || {
            let dialog = rfd::FileDialog::new()
                .set_title(format!("Write {}", what.name()))
                .set_file_name(name.unwrap_or_default())
                .add_filter(what.name(), &[what.extension()]);
            if let Some(path) = dialog.save_file() {
                events.send(Event::ChosenExport(what, path));
            }
        });
    }
}

/// Those of scans in any format, of text without one of its own, and of fits.
fn extensions() -> Vec<&'static str> {
    let formats = Format::NAMED.into_iter();
    let of_formats = formats.flat_map(|(format, _)| format.extensions().iter().copied());
    of_formats.chain(["txt", "dat", "json"]).collect()
}

/// Whether there is a session bus, on which a desktop offers its dialogs.
fn has_portal() -> bool {
    let runtime = std::env::var_os("XDG_RUNTIME_DIR").map(PathBuf::from);
    std::env::var_os("DBUS_SESSION_BUS_ADDRESS").is_some()
        || runtime.is_some_and(|folder| folder.join("bus").exists())
}

fn has_zenity() -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|folder| folder.join("zenity").is_file())
}
