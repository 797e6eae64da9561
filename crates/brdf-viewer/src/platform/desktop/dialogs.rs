//! The file dialogs of the system. Each runs on its own thread, because it may stay open for long.

use std::path::{Path, PathBuf};
use std::thread;

use crate::events::EventSender;
use crate::job::Event;
use crate::output_kind::OutputKind;
use crate::platform::Dialogs;
use crate::worker::extensions;

/// The file dialogs of the system.
#[derive(Debug, Default)]
pub struct NativeDialogs;

impl Dialogs for NativeDialogs {
    fn available(&self) -> bool {
        !cfg!(target_os = "linux") || has_portal() || has_zenity()
    }

    fn open(&self, events: EventSender) {
        thread::spawn(move || {
            let dialog = rfd::FileDialog::new()
                .set_title("Open scans or fits")
                .add_filter("Scans and fits", &extensions())
                .add_filter("All files", &["*"]);
            // `None` means that the dialog was cancelled.
            if let Some(paths) = dialog.pick_files() {
                events.send(Event::FilesChosen(paths));
            }
        });
    }

    fn export(&self, kind: OutputKind, suggested: &Path, events: EventSender) {
        let name = suggested
            .file_name()
            .map(|name| name.to_string_lossy().into_owned());
        thread::spawn(move || {
            let dialog = rfd::FileDialog::new()
                .set_title(format!("Save {}", kind.name()))
                .set_file_name(name.unwrap_or_default())
                .add_filter(kind.name(), &[kind.extension()]);
            if let Some(path) = dialog.save_file() {
                events.send(Event::OutputChosen(kind, path));
            }
        });
    }
}

/// Whether there is a session bus, through which desktops provide their dialogs.
fn has_portal() -> bool {
    let runtime = std::env::var_os("XDG_RUNTIME_DIR").map(PathBuf::from);
    std::env::var_os("DBUS_SESSION_BUS_ADDRESS").is_some()
        || runtime.is_some_and(|folder| folder.join("bus").exists())
}

fn has_zenity() -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|folder| folder.join("zenity").is_file())
}
