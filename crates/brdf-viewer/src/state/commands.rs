//! The commands: their effects, when they are enabled, and the state of those that toggle something.

use brdf_fit::plot::{Layout, Quantity, Scale};

use super::fit_settings::{Scope, Stages};
use super::id::SampleId;
use super::interface::Dialog;
use super::sample::Sample;
use super::solid::{Solid, SolidView};
use super::{Effect, State};
use crate::intent::Command;
use crate::output_kind::{FigureFormat, OutputKind};

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
                let scale = self.shown_scale();
                *scale = match scale {
                    Scale::Linear => Scale::Logarithmic,
                    Scale::Logarithmic => Scale::Linear,
                }
            }
            Command::TimesCosine => {
                let quantity = self.shown_quantity();
                *quantity = match quantity {
                    Quantity::Brdf => Quantity::BrdfCosine,
                    Quantity::BrdfCosine => Quantity::Brdf,
                }
            }
            Command::Residuals => self.view.residuals ^= true,
            Command::Together => self.show_curves(Layout::Together),
            Command::Panels => self.show_curves(Layout::Panels),
            Command::Polar => self.show_curves(Layout::Polar),
            Command::Lobe => self.solid.shown = Some(Solid::Lobe),
            Command::Surface => self.solid.shown = Some(Solid::Surface),
            Command::ResetZoom => self.reset_zoom(),
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

    fn show_curves(&mut self, layout: Layout) {
        self.view.layout = layout;
        self.solid.shown = None;
    }

    /// Shows all of the plots, and the lobe and the surface as at first.
    fn reset_zoom(&mut self) {
        self.zoom_resets += 1;
        let initial = SolidView::default();
        match self.solid.shown {
            Some(Solid::Lobe) => self.solid.camera = initial.camera,
            Some(Solid::Surface) => self.solid.lamp_deg = initial.lamp_deg,
            None => {}
        }
    }

    /// The axis of what is shown.
    fn shown_scale(&mut self) -> &mut Scale {
        match self.solid.shown {
            Some(_) => &mut self.solid.scale,
            None => &mut self.view.scale,
        }
    }

    /// The quantity of what is shown.
    fn shown_quantity(&mut self) -> &mut Quantity {
        match self.solid.shown {
            Some(_) => &mut self.solid.quantity,
            None => &mut self.view.quantity,
        }
    }

    /// Whether a command is enabled.
    pub fn is_enabled(&self, command: Command) -> bool {
        let active = self.active_sample();
        let scan = active.map(Sample::scan);
        let shown = self.solid.shown;
        match command {
            Command::Close
            | Command::CopyParameters
            | Command::Pin
            | Command::Export(OutputKind::Curves) => active.is_some(),
            Command::UnpinAll => !self.ghosts.is_empty(),
            Command::CloseAll => !self.samples.is_empty(),
            // The surface consists of pixels.
            Command::Export(OutputKind::Figure(FigureFormat::Svg)) => {
                self.has_figure() && shown != Some(Solid::Surface)
            }
            Command::CopyFigure | Command::Export(OutputKind::Figure(_)) => self.has_figure(),
            Command::Export(OutputKind::Mesh) => self.derived_solid.lobe().is_some(),
            Command::Logarithmic | Command::TimesCosine => shown != Some(Solid::Surface),
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
            Command::Residuals => shown.is_none() && self.view.layout != Layout::Polar,
            Command::Limits => shown.is_none() && self.view.layout == Layout::Together,
            _ => true,
        }
    }

    /// Whether the option that a command controls is on; `None` if it controls none.
    pub fn is_on(&self, command: Command) -> Option<bool> {
        let (scale, quantity, layout) = match self.solid.shown {
            Some(_) => (self.solid.scale, self.solid.quantity, None),
            None => (self.view.scale, self.view.quantity, Some(self.view.layout)),
        };
        Some(match command {
            Command::Logarithmic => scale == Scale::Logarithmic,
            Command::TimesCosine => quantity == Quantity::BrdfCosine,
            Command::Residuals => self.view.residuals,
            Command::Together => layout == Some(Layout::Together),
            Command::Panels => layout == Some(Layout::Panels),
            Command::Polar => layout == Some(Layout::Polar),
            Command::Lobe => self.solid.shown == Some(Solid::Lobe),
            Command::Surface => self.solid.shown == Some(Solid::Surface),
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

    /// Whether there is anything to draw in a figure.
    fn has_figure(&self) -> bool {
        match self.solid.shown {
            None => self.visible().next().is_some(),
            Some(_) => self.subject().is_some(),
        }
    }

    /// Whether the theme is dark, by the choice of the user or else of the system.
    pub(super) fn is_dark(&self) -> bool {
        self.interface.dark.unwrap_or(self.system_dark)
    }
}
