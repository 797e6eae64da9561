//! Ghosts: theories that stay in the plot as dashed lines, to compare others with them.

use brdf_fit::Model;

use super::State;
use super::id::{SampleId, ScanId};
use super::parameters::EditedParameters;
use super::sample::Scan;
use super::solid::Beside;

/// A theory that stays in the plot, at the incidences of its sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Ghost {
    /// Its name: the model and the wavelength.
    pub name: String,
    /// The sample.
    pub sample: SampleId,
    /// The model of a comparison that it shows; `None` for parameters that were pinned.
    pub model: Option<(ScanId, Model)>,
    /// The parameters.
    pub parameters: EditedParameters,
}

impl State {
    /// Pins the current theory of the active sample.
    pub(super) fn pin(&mut self) {
        let Some(sample) = self.active_sample() else {
            return;
        };
        let parameters = sample.scan().parameters;
        let name = named(&parameters.model.to_string(), sample.scan());
        let count = self
            .ghosts
            .iter()
            .filter(|ghost| ghost.name == name)
            .count();
        let name = match count {
            0 => name,
            _ => format!("{name} ({})", count + 1),
        };
        self.ghosts.push(Ghost {
            name,
            sample: sample.id,
            model: None,
            parameters,
        });
    }

    /// Shows or hides a model that the last fit of the active scan was compared with.
    pub(super) fn toggle_model(&mut self, model: Model) {
        let Some(sample) = self.active_sample() else {
            return;
        };
        let key = Some((sample.scan_id(), model));
        if self.ghosts.iter().any(|ghost| ghost.model == key) {
            self.ghosts.retain(|ghost| ghost.model != key);
            return;
        }
        let scan = sample.scan();
        let report = scan.last_fit.as_ref();
        let assessment = report.and_then(|report| report.assessment.as_ref());
        let mut candidates = assessment.iter().flat_map(|a| &a.models);
        let Some(candidate) = candidates.find(|candidate| candidate.model == model) else {
            return;
        };
        let ghost = Ghost {
            name: named(&model.to_string(), scan),
            sample: sample.id,
            model: key,
            parameters: EditedParameters::new(model, candidate.parameters),
        };
        self.ghosts.push(ghost);
    }

    /// Removes a ghost, by its index.
    pub(super) fn remove_ghost(&mut self, index: usize) {
        self.ghosts.remove(index);
        // The others have other indices now.
        if matches!(self.solid.beside, Beside::Ghost(_)) {
            self.solid.beside = Beside::Automatic;
        }
    }

    /// Whether a model of the comparison of the active scan is shown.
    pub fn shows_model(&self, model: Model) -> bool {
        let key = self.active_sample().map(|sample| (sample.scan_id(), model));
        self.ghosts
            .iter()
            .any(|ghost| ghost.model.is_some() && ghost.model == key)
    }
}

fn named(model: &str, scan: &Scan) -> String {
    let wavelength = scan.wavelength_um();
    wavelength.map_or_else(|| model.to_owned(), |um| format!("{model}, {um} µm"))
}
