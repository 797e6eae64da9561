//! What of the window is shown, and what it asks.

use serde::{Deserialize, Serialize};

use crate::intent::Export;

/// A table or a picture of the results.
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
    /// Hemispherical reflectance.
    Reflectance,
}

impl ResultTab {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::Tables,
        Self::Convergence,
        Self::Profile,
        Self::Reflectance,
    ];

    /// Whether it follows the parameters as they are turned; the others are of the last fit.
    pub fn follows(self) -> bool {
        matches!(self, Self::Profile | Self::Reflectance)
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tables => "Tables",
            Self::Convergence => "E against iteration",
            Self::Profile => "Profile of k1",
            Self::Reflectance => "Reflectance",
        }
    }
}

/// What of the window is shown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Interface {
    /// Dark or light; `None` is what the system says.
    pub dark: Option<bool>,
    /// Whether the samples are shown.
    pub samples: bool,
    /// Whether the parameters are shown.
    pub parameters: bool,
    /// Whether the results are shown.
    pub results: bool,
    /// What of the results.
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

/// The dialog that is open.
#[derive(Debug, Clone, PartialEq)]
pub enum Dialog {
    /// The path of a file to open.
    Open {
        /// The path so far.
        path: String,
    },
    /// The path of a file to write.
    Export {
        /// What to write.
        what: Export,
        /// The path so far.
        path: String,
    },
    /// What this is, and the keys.
    About,
}

/// How bad a message is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    /// Something did not work.
    Error,
    /// Something to know.
    Note,
}

/// Something that the user is told.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    /// How bad it is.
    pub severity: Severity,
    /// The words.
    pub text: String,
}
