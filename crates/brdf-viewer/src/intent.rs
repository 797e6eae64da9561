//! What a panel, a key or a dropped file asks for.

use std::path::PathBuf;

use brdf_fit::model::{Model, Parameter};
use brdf_fit::plot::View;
use brdf_fit::scan::Convention;

use crate::state::fitting::{FitChoice, Scope, Stages};
use crate::state::interface::ResultTab;
use crate::state::sample::{Knobs, SampleId};

/// A wish of the user. [`State::apply`](crate::state::State::apply) carries it out.
#[derive(Debug, Clone, PartialEq)]
pub enum Intent {
    /// One of the commands that need no more to be said.
    Do(Command),
    /// Open files: scans, or fits as JSON.
    Open(Vec<PathBuf>),
    /// Open a file that is already here: its name and its bytes.
    OpenBytes(String, Vec<u8>),
    /// Open an entry of the built-in menu.
    OpenBuiltIn(usize),
    /// Close a sample.
    Close(SampleId),
    /// Show or hide a sample.
    ShowSample(SampleId, bool),
    /// Turn the parameters of this sample from now on.
    Activate(SampleId),
    /// Show another wavelength of a sample.
    Wavelength(SampleId, usize),
    /// Show or hide one incidence of a sample.
    ShowIncidence(SampleId, usize, bool),
    /// Show all incidences of a sample, or none.
    ShowAllIncidences(SampleId, bool),
    /// Read files in another angular convention from now on.
    Convention(Convention),
    /// Look at the data in another way.
    View(View),
    /// Other parameters of the active sample.
    Turn(Knobs),
    /// Another model of some scans.
    Model(Model, Scope),
    /// A parameter back to its fitted value.
    Reset(Parameter),
    /// Other settings of the fit.
    FitChoice(FitChoice),
    /// Fit.
    Fit(Stages, Scope),
    /// Write something to a file.
    Write(Export, PathBuf),
    /// The table of the results.
    Tab(ResultTab),
    /// Another text in the box of the dialog that is open.
    Path(String),
    /// What the dialog that is open says is done: open, or write, the path in its box.
    Confirm,
    /// Look for the path in a dialog of the system.
    Browse,
    /// Close the dialog that is open.
    CloseDialog,
    /// Take a message away.
    Dismiss(usize),
}

/// What can be written to a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Export {
    /// The figure, for print.
    Figure(Picture),
    /// Theory and readings.
    Curves,
    /// The fit, which `fit --again` and the viewer read.
    Fit,
}

/// The format of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Picture {
    /// Lines that print at any size.
    Svg,
    /// Pixels.
    Png,
}

impl Export {
    /// The extension of its file.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Figure(Picture::Svg) => "svg",
            Self::Figure(Picture::Png) => "png",
            Self::Curves => "csv",
            Self::Fit => "json",
        }
    }

    /// What it is, in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Figure(Picture::Svg) => "figure as SVG",
            Self::Figure(Picture::Png) => "figure as PNG",
            Self::Curves => "theory and readings as CSV",
            Self::Fit => "fit as JSON",
        }
    }
}

/// A command without anything more to say: an entry of a menu, most of them with a key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// Ask for files to open.
    Open,
    /// Ask for the path of a file to open.
    OpenPath,
    /// Close the active sample.
    Close,
    /// Close all samples.
    CloseAll,
    /// Ask where to write something.
    Export(Export),
    /// The parameters to the clipboard.
    CopyParameters,
    /// Leave.
    Quit,
    /// Take back the last change of the parameters.
    Undo,
    /// Do it again.
    Redo,
    /// All parameters back to the fitted ones.
    ResetAll,
    /// Fit the active sample in both stages.
    Fit,
    /// Fit all wavelengths of all samples.
    FitAll,
    /// Stop the fit.
    Cancel,
    /// Linear or logarithmic.
    Logarithmic,
    /// f_r or f_r cos theta.
    TimesCosine,
    /// Residuals below.
    Residuals,
    /// All incidences in one plot.
    Together,
    /// One plot for each incidence.
    Panels,
    /// The polar form.
    Polar,
    /// Everything that is to be seen back into view.
    ResetZoom,
    /// The samples at the left.
    Samples,
    /// The parameters at the right.
    Parameters,
    /// The results below.
    Results,
    /// Dark or light.
    Dark,
    /// Dark or light as the system says.
    SystemTheme,
    /// What this is.
    About,
}
