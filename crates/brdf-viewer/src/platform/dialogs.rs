//! Dialogs that ask for files.

use std::path::Path;

use crate::events::EventSender;
use crate::output_kind::OutputKind;

/// File dialogs. Tests replace them by none, or by ones that answer immediately.
pub trait Dialogs {
    /// Whether file dialogs are available.
    fn available(&self) -> bool;
    /// Asks for files to open, and answers with [`Event::FilesChosen`](crate::job::Event::FilesChosen).
    fn open(&self, events: EventSender);
    /// Asks for the path of a file to write, and answers with
    /// [`Event::OutputChosen`](crate::job::Event::OutputChosen).
    fn export(&self, kind: OutputKind, suggested: &Path, events: EventSender);
}
