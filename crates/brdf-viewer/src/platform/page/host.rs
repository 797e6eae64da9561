//! A tab of a browser.

use egui::Key;

use crate::intent::Command;
use crate::platform::Host;

/// A page.
#[derive(Debug)]
pub enum Page {}

impl Host for Page {
    const NOTE: Option<&'static str> =
        Some("Files are read by this page on your machine. They never leave it.");

    /// A page has no paths, and ends with its tab.
    fn offers(command: Command) -> bool {
        !matches!(command, Command::OpenPath | Command::Quit)
    }

    /// Browsers keep the keys of their tabs and windows.
    fn has_key(command: Command) -> bool {
        let kept = [
            Key::W,
            Key::Q,
            Key::Num1,
            Key::Num2,
            Key::Num3,
            Key::Num4,
            Key::Num5,
        ];
        let key = command.key().map(|shortcut| shortcut.logical_key);
        key.is_none_or(|key| !kept.contains(&key))
    }
}
