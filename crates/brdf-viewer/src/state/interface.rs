//! The visible panels, the open dialog and the messages.

use brdf_fit::Parameter;
use brdf_fit::plot::Reading;
use serde::{Deserialize, Serialize};

use super::id::SampleId;
use crate::output_kind::OutputKind;

/// A tab of the results.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ResultTab {
    /// What was read, how well the model describes it, and the parameters.
    #[default]
    Summary,
    /// The models that the fit was compared with.
    Models,
    /// The fits of all wavelengths.
    Wavelengths,
    /// The residuals against the reading.
    Residuals,
    /// The profile of E over k1.
    Profile,
    /// The hemispherical reflectance.
    Reflectance,
    /// E against iteration.
    Convergence,
    /// The readings to take next.
    Plan,
    /// Everything that the command line prints.
    #[serde(alias = "tables")]
    Report,
}

impl ResultTab {
    /// All tabs.
    pub const ALL: [Self; 9] = [
        Self::Summary,
        Self::Models,
        Self::Wavelengths,
        Self::Residuals,
        Self::Profile,
        Self::Reflectance,
        Self::Convergence,
        Self::Plan,
        Self::Report,
    ];

    /// The title.
    pub fn name(self) -> &'static str {
        match self {
            Self::Summary => "Summary",
            Self::Models => "Models",
            Self::Wavelengths => "Wavelengths",
            Self::Residuals => "Residuals",
            Self::Profile => "Profile",
            Self::Reflectance => "Reflectance",
            Self::Convergence => "Iterations",
            Self::Plan => "Plan",
            Self::Report => "Report",
        }
    }
}

/// How residuals are expressed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ResidualKind {
    /// Measured minus theory, in the unit of the plot.
    #[default]
    Absolute,
    /// Measured minus theory in percent of the theory.
    Relative,
    /// Measured minus theory in standard deviations: of the reading where the file states one, else
    /// of all residuals that are shown.
    InSigma,
}

impl ResidualKind {
    /// All kinds.
    pub const ALL: [Self; 3] = [Self::Absolute, Self::Relative, Self::InSigma];

    /// The name of the axis.
    pub fn axis_name(self) -> &'static str {
        match self {
            Self::Absolute => "measured - theory",
            Self::Relative => "measured / theory - 1, %",
            Self::InSigma => "(measured - theory) / σ",
        }
    }

    /// The residual of a reading; `None` where it is not defined. `rms` is that of all residuals.
    pub fn of(self, reading: &Reading, rms: f64) -> Option<f64> {
        let residual = reading.residual();
        let value = match self {
            Self::Absolute => residual,
            Self::Relative => 100.0 * residual / reading.theory,
            Self::InSigma => residual / reading.sigma.unwrap_or(rms),
        };
        value.is_finite().then_some(value)
    }
}

/// The theme and the visible panels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is shown or hidden by itself"
)]
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
    /// How residuals are expressed.
    pub residuals: ResidualKind,
    /// The parameter that is plotted against the wavelength.
    pub parameter: Parameter,
    /// Whether the plot shows the limits of the fit where they are not changed.
    pub limits: bool,
}

impl Default for Interface {
    fn default() -> Self {
        Self {
            dark: None,
            samples: true,
            parameters: true,
            results: true,
            tab: ResultTab::Summary,
            residuals: ResidualKind::Absolute,
            parameter: Parameter::K1,
            limits: false,
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
    /// Asks whether samples are closed in spite of work that is not in a file.
    Close {
        /// The samples.
        samples: Vec<SampleId>,
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
