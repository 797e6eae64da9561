//! The requests of the user: what a panel, a key or a dropped file asks for.

use std::path::PathBuf;

use brdf_fit::Convention;
use brdf_fit::plot::{View, Zoom};
use brdf_fit::{Model, Parameter};

use crate::output_kind::OutputKind;
use crate::state::angle_range::End;
use crate::state::fit_settings::{FitSettings, Scope, Stages};
use crate::state::id::{SampleId, ScanId};
use crate::state::interface::{ResidualKind, ResultTab};
use crate::state::parameters::EditedParameters;
use crate::state::solid::SolidView;

/// A request of the user, which `State::apply` carries out.
#[derive(Debug, Clone, PartialEq)]
pub enum Intent {
    /// Carry out a command, which has no arguments.
    Command(Command),
    /// A part of the plot is shown, or all of it.
    Zoomed(Option<Zoom>),
    /// Open files: scans, or fits as JSON.
    Open(Vec<PathBuf>),
    /// Open the content of a file: its name and its bytes.
    OpenBytes(String, Vec<u8>),
    /// Open an entry of the built-in menu.
    OpenBuiltIn(usize),
    /// Close a sample.
    Close(SampleId),
    /// Show or hide a sample.
    ShowSample(SampleId, bool),
    /// Make a sample the active one, whose parameters are edited.
    Activate(SampleId),
    /// Show another wavelength of a sample, by its index.
    Wavelength(SampleId, usize),
    /// Plot a wavelength of a sample beside the current one, or no longer.
    PlotBeside(SampleId, usize, bool),
    /// Show or hide one incidence of a sample, by its index.
    ShowIncidence(SampleId, usize, bool),
    /// Use the readings of one incidence of a sample in the fit, or leave them out.
    UseIncidence(SampleId, usize, bool),
    /// Leave readings of a scan out of the fit, or use them again if all of them are left out.
    ToggleReadings(ScanId, Vec<usize>),
    /// Use all readings of a scan.
    UseAllReadings(ScanId),
    /// Leave the readings of a scan beyond an end of its view angles out, and use those within: the new
    /// end in degrees, with the sign of the view.
    LimitAngles(ScanId, End, f64),
    /// Take a model that the last fit of the active scan was compared with, and fit it.
    UseModel(Model),
    /// Show or hide a model that the last fit of the active scan was compared with.
    ToggleModel(Model),
    /// Remove a theory that stays in the plot, by its index.
    Unpin(usize),
    /// Choose the parameter that is plotted against the wavelength.
    PlotParameter(Parameter),
    /// Choose how residuals are expressed.
    Residuals(ResidualKind),
    /// Show or hide all incidences of a sample.
    ShowAllIncidences(SampleId, bool),
    /// Set the angular convention in which files are read from now on.
    Convention(Convention),
    /// Change the view of the data.
    View(View),
    /// Change the settings of the lobe and of the surface.
    Solid(SolidView),
    /// Set the number of pixels along the picture of a surface.
    SurfaceSide(usize),
    /// Set the number of columns of readings that fit into the plot.
    PlotColumns(usize),
    /// Set the parameters of the active scan.
    SetParameters(EditedParameters),
    /// Set the model of the scans within a scope.
    Model(Model, Scope),
    /// Reset a parameter to its fitted value.
    Reset(Parameter),
    /// Change the fit settings.
    FitSettings(FitSettings),
    /// Fit the scans within a scope.
    Fit(Stages, Scope),
    /// Write a file.
    Write(OutputKind, PathBuf),
    /// Select a tab of the results.
    Tab(ResultTab),
    /// Set the text of the path field of the open dialog.
    Path(String),
    /// Plan the next readings of the current scan.
    Plan,
    /// Copy the planned readings to the clipboard.
    CopyPlan,
    /// Confirm the open dialog: open or write its path.
    Confirm,
    /// Replace the open dialog by a dialog of the system.
    Browse,
    /// Close the open dialog.
    CloseDialog,
    /// Remove a message, by its index.
    Dismiss(usize),
    /// Remove all messages.
    DismissAll,
    /// Read the file of a sample again.
    Reload(SampleId),
    /// Close samples in spite of work that is not in a file.
    CloseUnsaved(Vec<SampleId>),
}

/// An entry of a menu, with a key.
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
    /// Ask for the path of a file to write.
    Export(OutputKind),
    /// Copy the figure to the clipboard.
    CopyFigure,
    /// Copy the parameters to the clipboard.
    CopyParameters,
    /// Quit the program.
    Quit,
    /// Toggle whether the pointer chooses readings in the plot.
    ChooseReadings,
    /// Toggle whether the plot shows the limits of the fit where they are not changed.
    Limits,
    /// Keep the current theory in the plot.
    Pin,
    /// Remove all theories that stay in the plot.
    UnpinAll,
    /// Undo the last change of the parameters.
    Undo,
    /// Redo the change that was undone last.
    Redo,
    /// Reset all parameters to the fitted values.
    ResetAll,
    /// Fit the active scan in both stages.
    Fit,
    /// Fit all wavelengths of all samples.
    FitAll,
    /// Cancel the fit.
    Cancel,
    /// Toggle the logarithmic axis.
    Logarithmic,
    /// Toggle between f_r and f_r cos theta.
    TimesCosine,
    /// Toggle the residuals below the plot.
    Residuals,
    /// Show all incidences in one plot.
    Together,
    /// Show one plot for each incidence.
    Panels,
    /// Show the polar plot.
    Polar,
    /// Show the lobe of an incidence in three dimensions.
    Lobe,
    /// Show the surface under light.
    Surface,
    /// Reset the zoom of all plots.
    ResetZoom,
    /// Toggle the samples panel.
    Samples,
    /// Toggle the parameters panel.
    Parameters,
    /// Toggle the results panel.
    Results,
    /// Toggle between the dark and the light theme.
    Dark,
    /// Follow the theme of the system.
    SystemTheme,
    /// Show the version and the keys.
    About,
}
