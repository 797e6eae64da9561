//! The commands: their effects, when they are enabled, and the state of those that toggle something.

use brdf_fit::plot::{Layout, Quantity, Scale};

use super::fit_settings::{Scope, Stages};
use super::id::SampleId;
use super::interface::Dialog;
use super::sample::Sample;
use super::{Effect, State};
use crate::intent::Command;
use crate::output_kind::OutputKind;

impl State {
    pub(super) fn command(&mut self, command: Command) {
        if !self.is_enabled(command) {
            return;
        }
        match command {
            Command::Open => self.effects.push(Effect::AskOpen),
            Command::OpenPath => self.ask_path(),
            Command::Close => {
                if let Some(id) = self.active {
                    self.ask_to_close(vec![id]);
                }
            }
            Command::CloseAll => {
                let all: Vec<SampleId> = self.samples.iter().map(|sample| sample.id).collect();
                self.ask_to_close(all);
            }
            Command::Export(kind) => {
                let path = self.suggested_path(kind);
                self.effects.push(Effect::AskExport(kind, path));
            }
            Command::CopyFigure => self.copy_figure(),
            Command::CopyParameters => self.copy_parameters(),
            Command::Quit => self.effects.push(Effect::Quit),
            Command::Pin => self.pin(),
            Command::UnpinAll => self.ghosts.clear(),
            Command::Undo => self.undo(),
            Command::Redo => self.redo(),
            Command::ResetAll => self.reset_all(),
            Command::Fit => self.fit(Stages::Both, Scope::Wavelength),
            Command::FitAll => self.fit(Stages::Both, Scope::All),
            Command::Cancel => self.cancel(),
            Command::About => self.dialog = Some(Dialog::About),
            view => self.change_view(view),
        }
    }

    /// Carries out a command that changes the view or the window.
    fn change_view(&mut self, command: Command) {
        match command {
            Command::Logarithmic => {
                self.view.scale = match self.view.scale {
                    Scale::Linear => Scale::Logarithmic,
                    Scale::Logarithmic => Scale::Linear,
                }
            }
            Command::TimesCosine => {
                self.view.quantity = match self.view.quantity {
                    Quantity::Brdf => Quantity::BrdfCosine,
                    Quantity::BrdfCosine => Quantity::Brdf,
                }
            }
            Command::Residuals => self.view.residuals ^= true,
            Command::Together => self.view.layout = Layout::Together,
            Command::Panels => self.view.layout = Layout::Panels,
            Command::Polar => self.view.layout = Layout::Polar,
            Command::ResetZoom => self.zoom_resets += 1,
            Command::Samples => self.interface.samples ^= true,
            Command::Parameters => self.interface.parameters ^= true,
            Command::Results => self.interface.results ^= true,
            Command::ChooseReadings => self.choosing ^= true,
            Command::Limits => self.interface.limits ^= true,
            Command::Dark => self.interface.dark = Some(!self.is_dark()),
            Command::SystemTheme => self.interface.dark = None,
            _ => {}
        }
    }

    /// Whether a command is enabled.
    pub fn is_enabled(&self, command: Command) -> bool {
        let active = self.active_sample();
        let scan = active.map(Sample::scan);
        match command {
            Command::Close
            | Command::CopyParameters
            | Command::Pin
            | Command::Export(OutputKind::Curves) => active.is_some(),
            Command::UnpinAll => !self.ghosts.is_empty(),
            Command::CloseAll => !self.samples.is_empty(),
            Command::CopyFigure | Command::Export(OutputKind::Figure(_)) => {
                self.visible().next().is_some()
            }
            Command::Export(OutputKind::Fit) => active.is_some_and(Sample::is_fitted),
            Command::Undo => self.history.can_undo(),
            Command::Redo => self.history.can_redo(),
            Command::ResetAll => {
                scan.is_some_and(|scan| scan.fitted_parameters() != scan.parameters)
            }
            Command::Fit => {
                !self.is_fitting_on_request() && scan.is_some_and(|scan| scan.used_count() > 0)
            }
            Command::FitAll => {
                !self.is_fitting_on_request() && !self.scans_to_fit(Scope::All).is_empty()
            }
            Command::Cancel => self.is_fitting(),
            Command::Residuals => self.view.layout != Layout::Polar,
            Command::Limits => self.view.layout == Layout::Together,
            _ => true,
        }
    }

    /// Whether the option that a command controls is on; `None` if it controls none.
    pub fn is_on(&self, command: Command) -> Option<bool> {
        Some(match command {
            Command::Logarithmic => self.view.scale == Scale::Logarithmic,
            Command::TimesCosine => self.view.quantity == Quantity::BrdfCosine,
            Command::Residuals => self.view.residuals,
            Command::Together => self.view.layout == Layout::Together,
            Command::Panels => self.view.layout == Layout::Panels,
            Command::Polar => self.view.layout == Layout::Polar,
            Command::ChooseReadings => self.choosing,
            Command::Limits => self.interface.limits,
            Command::Samples => self.interface.samples,
            Command::Parameters => self.interface.parameters,
            Command::Results => self.interface.results,
            Command::Dark => self.is_dark(),
            Command::SystemTheme => self.interface.dark.is_none(),
            _ => return None,
        })
    }

    /// Whether the theme is dark, by the choice of the user or else of the system.
    pub(super) fn is_dark(&self) -> bool {
        self.interface.dark.unwrap_or(self.system_dark)
    }
}
