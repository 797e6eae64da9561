//! Dispatches intents of the user and events of the worker to the operations of the state.

use std::collections::BTreeSet;

use super::{Effect, State};
use crate::intent::Intent;
use crate::job::Event;

impl State {
    /// Carries out requests of the user.
    pub fn apply_all(&mut self, intents: Vec<Intent>) {
        for intent in intents {
            self.apply(intent);
        }
    }

    /// Carries out a request of the user.
    pub fn apply(&mut self, intent: Intent) {
        match intent {
            Intent::Command(command) => self.command(command),
            Intent::Zoomed(zoom) => self.zoom = zoom,
            Intent::Open(paths) => self.open(paths),
            Intent::OpenBytes(name, bytes) => self.open_bytes(name, bytes),
            Intent::OpenBuiltIn(entry) => self.open_built_in(entry),
            Intent::Close(id) => self.ask_to_close(vec![id]),
            Intent::ShowSample(id, visible) => self.change(id, |s| s.visible = visible),
            Intent::Activate(id) => self.activate(id),
            Intent::Wavelength(id, wavelength) => self.select_wavelength(id, wavelength),
            Intent::PlotBeside(id, wavelength, beside) => self.change(id, |sample| {
                if let Some(scan) = sample.scans.get_mut(wavelength) {
                    scan.is_beside = beside;
                }
            }),
            Intent::ShowIncidence(id, i, visible) => self.change(id, |sample| {
                if let Some(incidence) = sample.scan_mut().incidences.get_mut(i) {
                    incidence.visible = visible;
                }
            }),
            Intent::ShowAllIncidences(id, visible) => self.change(id, |sample| {
                for incidence in &mut sample.scan_mut().incidences {
                    incidence.visible = visible;
                }
            }),
            Intent::UseIncidence(id, i, used) => self.use_incidence(id, i, used),
            Intent::ToggleReadings(id, readings) => self.toggle_readings(id, &readings),
            Intent::UseAllReadings(id) => self.leave_out(id, BTreeSet::new()),
            Intent::LimitAngles(id, end, to_deg) => self.limit_angles(id, end, to_deg),
            Intent::ToggleModel(model) => self.toggle_model(model),
            Intent::Unpin(i) => {
                if i < self.ghosts.len() {
                    self.remove_ghost(i);
                }
            }
            Intent::PlotParameter(parameter) => self.interface.parameter = parameter,
            Intent::Residuals(kind) => self.interface.residuals = kind,
            Intent::UseModel(model) => self.take_model(model),
            Intent::Convention(convention) => self.convention = convention,
            Intent::View(view) => self.view = view,
            Intent::Solid(solid) => self.solid = solid,
            Intent::SurfaceSide(side) => self.surface_side = side,
            Intent::PlotColumns(columns) => self.columns = columns,
            Intent::SetParameters(parameters) => self.set_parameters(parameters),
            Intent::Model(model, scope) => self.set_model(model, scope),
            Intent::Reset(parameter) => self.reset(parameter),
            Intent::FitSettings(settings) => self.fit_settings = settings,
            Intent::Fit(stages, scope) => self.fit(stages, scope),
            Intent::Write(kind, path) => self.write(kind, path),
            Intent::Tab(tab) => self.interface.tab = tab,
            Intent::Plan => self.plan(),
            Intent::CopyPlan => self.copy_plan(),
            Intent::Path(text) => self.set_path(text),
            Intent::Confirm => self.confirm(),
            Intent::Browse => self.browse(),
            Intent::CloseDialog => self.dialog = None,
            Intent::DismissAll => self.messages.clear(),
            Intent::Reload(id) => self.reload(id),
            Intent::CloseUnsaved(samples) => {
                self.dialog = None;
                for id in samples {
                    self.close(id);
                }
            }
            Intent::Dismiss(i) => {
                if i < self.messages.len() {
                    self.messages.remove(i);
                }
            }
        }
    }

    /// Takes over an event of the worker or of a dialog.
    pub fn take_event(&mut self, event: Event) {
        match event {
            Event::Opened(file, opened) => {
                self.files_being_read = self.files_being_read.saturating_sub(1);
                self.add_opened(file, opened);
            }
            Event::OpenFailed(error) => {
                self.files_being_read = self.files_being_read.saturating_sub(1);
                self.report_error(error);
            }
            Event::FilesChosen(paths) => self.open(paths),
            Event::OutputChosen(kind, path) => self.write(kind, path),
            Event::Step(scan, step) => {
                if let Some(run) = &mut self.fit_run {
                    run.record(scan, &step);
                }
            }
            Event::Found(scan, report) => self.take_found(scan, *report),
            Event::Fitted(scan, report) => self.take_report(scan, *report),
            Event::FitAborted(scan, error) => self.take_fit_error(scan, error),
            Event::FitsEnded(run) => self.end_run(run),
            Event::Written(path, saved) => {
                for id in saved {
                    self.change(id, |sample| {
                        for scan in &mut sample.scans {
                            scan.has_unsaved_work = false;
                        }
                    });
                }
                self.status = format!("{} written", path.display());
            }
            Event::Drawn(image) => {
                "figure copied".clone_into(&mut self.status);
                self.effects.push(Effect::CopyImage(image));
            }
            Event::WriteFailed(error) => self.report_error(error),
            Event::Planned(scan, readings, plan) => self.take_plan(scan, readings, plan),
        }
    }
}
