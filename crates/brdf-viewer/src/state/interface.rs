//! The visible panels, the open dialog and the messages.

use serde::{Deserialize, Serialize};

use crate::output_kind::OutputKind;

/// A tab of the results.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ResultTab {
    /// The tables that the command line prints.
    #[default]
    Tables,
    /// E against iteration.
    Convergence,
    /// The profile of E over k1.
    Profile,
    /// The hemispherical reflectance.
    Reflectance,
}

impl ResultTab {
    /// All tabs.
    pub const ALL: [Self; 4] = [
        Self::Tables,
        Self::Convergence,
        Self::Profile,
        Self::Reflectance,
    ];

    /// Whether the tab depends on the current parameters, and not only on the last fit.
    pub fn shows_current_parameters(self) -> bool {
        matches!(self, Self::Profile | Self::Reflectance)
    }

    /// The title.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tables => "Tables",
            Self::Convergence => "E against iteration",
            Self::Profile => "Profile of k1",
            Self::Reflectance => "Reflectance",
        }
    }
}

/// The theme and the visible panels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Interface {
    /// Whether the theme is dark; `None` follows the system.
    pub dark: Option<bool>,
    /// Whether the samples panel is visible.
    pub samples: bool,
    /// Whether the parameters panel is visible.
    pub parameters: bool,
    /// Whether the results panel is visible.
    pub results: bool,
    /// The selected tab of the results.
    pub tab: ResultTab,
}

impl Default for Interface {
    fn default() -> Self {
        Self {
            dark: None,
            samples: true,
            parameters: true,
            results: true,
            tab: ResultTab::Tables,
        }
    }
}

/// The open dialog.
#[derive(Debug, Clone, PartialEq)]
pub enum Dialog {
    /// Asks for the path of a file to open.
    Open {
        /// The path as entered so far.
        path: String,
    },
    /// Asks for the path of a file to write.
    Export {
        /// The kind of the file.
        kind: OutputKind,
        /// The path as entered so far.
        path: String,
    },
    /// Shows the version and the keys.
    About,
}

/// The severity of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    /// An operation failed.
    Error,
    /// Information that needs no action.
    Note,
}

/// A message to the user.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    /// The severity.
    pub severity: Severity,
    /// The text.
    pub text: String,
}
