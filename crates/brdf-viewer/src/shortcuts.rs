//! The names and keys of the commands, and the menus that contain them.

use egui::{Key, KeyboardShortcut, Modifiers, Popup};

use crate::intent::Command;
use crate::output_kind::{FigureFormat, OutputKind};
use crate::platform::Host;
use crate::platform::current::CurrentHost;

const NONE: Modifiers = Modifiers::NONE;
const COMMAND: Modifiers = Modifiers::COMMAND;
const SHIFTED: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// A menu.
pub struct Menu {
    /// The title.
    pub title: &'static str,
    /// The entries; `None` is a separator.
    pub entries: &'static [Option<Command>],
}

/// The menus. The menu of built-in samples is placed between the first and the second one.
pub const MENUS: [Menu; 5] = [
    Menu {
        title: "File",
        entries: &[
            Some(Command::Open),
            Some(Command::OpenPath),
            Some(Command::Close),
            Some(Command::CloseAll),
            None,
            Some(Command::Export(OutputKind::Figure(FigureFormat::Svg))),
            Some(Command::Export(OutputKind::Figure(FigureFormat::Png))),
            Some(Command::Export(OutputKind::Mesh)),
            Some(Command::Export(OutputKind::Curves)),
            Some(Command::Export(OutputKind::Fit)),
            None,
            Some(Command::Quit),
        ],
    },
    Menu {
        title: "Edit",
        entries: &[
            Some(Command::Undo),
            Some(Command::Redo),
            Some(Command::ResetAll),
            None,
            Some(Command::ChooseReadings),
            Some(Command::Limits),
            None,
            Some(Command::Pin),
            Some(Command::UnpinAll),
            None,
            Some(Command::CopyFigure),
            Some(Command::CopyParameters),
        ],
    },
    Menu {
        title: "View",
        entries: &[
            Some(Command::Logarithmic),
            Some(Command::TimesCosine),
            Some(Command::Residuals),
            None,
            Some(Command::Together),
            Some(Command::Panels),
            Some(Command::Polar),
            Some(Command::Lobe),
            Some(Command::Surface),
            None,
            Some(Command::ResetZoom),
            None,
            Some(Command::Samples),
            Some(Command::Parameters),
            Some(Command::Results),
            Some(Command::Dark),
            Some(Command::SystemTheme),
        ],
    },
    Menu {
        title: "Fit",
        entries: &[
            Some(Command::Fit),
            Some(Command::FitAll),
            Some(Command::Cancel),
        ],
    },
    Menu {
        title: "Help",
        entries: &[Some(Command::About)],
    },
];

impl Command {
    /// The name in the menu.
    pub fn name(self) -> &'static str {
        match self {
            Self::Open => "Open...",
            Self::OpenPath => "Open path...",
            Self::Close => "Close sample",
            Self::CloseAll => "Close all samples",
            Self::Export(OutputKind::Figure(FigureFormat::Svg)) => "Export figure as SVG...",
            Self::Export(OutputKind::Figure(FigureFormat::Png)) => "Export figure as PNG...",
            Self::Export(OutputKind::Mesh) => "Export lobe as OBJ...",
            Self::Export(OutputKind::Curves) => "Export theory and readings as CSV...",
            Self::Export(OutputKind::Fit) => "Save fit as JSON...",
            Self::CopyFigure => "Copy figure",
            Self::CopyParameters => "Copy parameter table",
            Self::Quit => "Quit",
            Self::ChooseReadings => "Choose readings in the plot",
            Self::Limits => "Limits of the fit in the plot",
            Self::Pin => "Pin curves",
            Self::UnpinAll => "Unpin all curves",
            Self::Undo => "Undo",
            Self::Redo => "Redo",
            Self::ResetAll => "Reset parameters to fitted values",
            Self::Fit => "Fit both stages",
            Self::FitAll => "Fit all samples and wavelengths",
            Self::Cancel => "Cancel fit",
            Self::Logarithmic => "Logarithmic BRDF axis",
            Self::TimesCosine => "BRDF times cos theta",
            Self::Residuals => "Residuals below the plot",
            Self::Together => "All incidences in one plot",
            Self::Panels => "One plot for each incidence",
            Self::Polar => "Polar plot",
            Self::Lobe => "Lobe in three dimensions",
            Self::Surface => "Surface under light",
            Self::ResetZoom => "Reset zoom",
            Self::Samples => "Samples panel",
            Self::Parameters => "Parameters panel",
            Self::Results => "Results panel",
            Self::Dark => "Dark theme",
            Self::SystemTheme => "Theme of the system",
            Self::About => "About and keyboard shortcuts",
        }
    }

    /// The key, where it reaches the program.
    pub fn shortcut(self) -> Option<KeyboardShortcut> {
        let reaches = CurrentHost::offers(self) && CurrentHost::has_key(self);
        self.key().filter(|_| reaches)
    }

    /// The key.
    pub fn key(self) -> Option<KeyboardShortcut> {
        let (modifiers, key) = match self {
            Self::Open => (COMMAND, Key::O),
            Self::OpenPath => (SHIFTED, Key::O),
            Self::Close => (COMMAND, Key::W),
            Self::CloseAll => (SHIFTED, Key::W),
            Self::Export(OutputKind::Figure(FigureFormat::Svg)) => (COMMAND, Key::E),
            Self::Export(OutputKind::Figure(FigureFormat::Png)) => (SHIFTED, Key::E),
            Self::Export(OutputKind::Mesh) => (SHIFTED, Key::M),
            Self::Export(OutputKind::Curves) => (SHIFTED, Key::S),
            Self::Export(OutputKind::Fit) => (COMMAND, Key::S),
            Self::CopyFigure => (SHIFTED, Key::F),
            Self::CopyParameters => (SHIFTED, Key::C),
            Self::Quit => (COMMAND, Key::Q),
            Self::ChooseReadings => (COMMAND, Key::R),
            Self::Limits => (COMMAND, Key::M),
            Self::Pin => (COMMAND, Key::P),
            Self::UnpinAll => (SHIFTED, Key::P),
            Self::Undo => (COMMAND, Key::Z),
            Self::Redo => (SHIFTED, Key::Z),
            Self::ResetAll => (COMMAND, Key::Backspace),
            Self::Fit => (NONE, Key::F5),
            Self::FitAll => (Modifiers::SHIFT, Key::F5),
            Self::Cancel => (NONE, Key::Escape),
            Self::Logarithmic => (COMMAND, Key::L),
            Self::TimesCosine => (COMMAND, Key::K),
            Self::Residuals => (COMMAND, Key::D),
            Self::Together => (COMMAND, Key::Num1),
            Self::Panels => (COMMAND, Key::Num2),
            Self::Polar => (COMMAND, Key::Num3),
            Self::Lobe => (COMMAND, Key::Num4),
            Self::Surface => (COMMAND, Key::Num5),
            Self::ResetZoom => (NONE, Key::Home),
            Self::Samples => (NONE, Key::F6),
            Self::Parameters => (NONE, Key::F7),
            Self::Results => (NONE, Key::F8),
            Self::Dark => (NONE, Key::F9),
            Self::SystemTheme => (Modifiers::SHIFT, Key::F9),
            Self::About => (NONE, Key::F1),
        };
        Some(KeyboardShortcut::new(modifiers, key))
    }

    /// Whether the key has another meaning while a text is edited.
    fn belongs_to_text(self) -> bool {
        matches!(
            self,
            Self::Undo | Self::Redo | Self::ResetAll | Self::Cancel | Self::ResetZoom
        )
    }
}

/// Whether a key alone, or together with Ctrl or Command, is one of the program and not of a text. `name` is that of
/// browsers. Keys that browsers use as well, such as F5, are taken from them.
pub fn is_key_of_program(name: &str, command: bool) -> bool {
    let Some(key) = Key::from_name(name).or_else(|| Key::from_name(&name.to_uppercase())) else {
        return false;
    };
    let commands = MENUS.iter().flat_map(|menu| menu.entries.iter().flatten());
    let mut shortcuts = commands
        .filter(|command| !command.belongs_to_text())
        .filter_map(|command| command.shortcut());
    shortcuts.any(|shortcut| {
        let takes_command = shortcut.modifiers.command || shortcut.modifiers.ctrl;
        shortcut.logical_key == key && takes_command == command
    })
}

/// The commands whose keys were pressed.
pub fn pressed(ctx: &egui::Context) -> Vec<Command> {
    let editing = ctx.text_edit_focused();
    // Escape only closes a menu if one is open.
    let closes_popup = |command: Command| command == Command::Cancel && Popup::is_any_open(ctx);
    // A key with Shift is tested before the same key without it, which would match as well.
    let mut all: Vec<(Command, KeyboardShortcut)> = MENUS
        .iter()
        .flat_map(|menu| menu.entries.iter().copied().flatten())
        .filter_map(|command| Some((command, command.shortcut()?)))
        .filter(|(command, _)| !(editing && command.belongs_to_text()))
        .filter(|(command, _)| !closes_popup(*command))
        .collect();
    all.sort_by_key(|(_, shortcut)| !shortcut.modifiers.shift);
    ctx.input_mut(|input| {
        all.into_iter()
            .filter(|(_, shortcut)| input.consume_shortcut(shortcut))
            .map(|(command, _)| command)
            .collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_of_the_program_are_told_from_those_of_texts() {
        for (name, command, expected) in [
            ("F5", false, true),
            ("F5", true, false),
            ("e", true, true),
            ("E", true, true),
            ("e", false, false),
            ("z", true, false),
            ("F12", false, false),
            ("Dead", true, false),
        ] {
            assert_eq!(is_key_of_program(name, command), expected, "{name}");
        }
    }
}
