//! What follows from data, view and parameters: the curves, E and the reflectance.
//!
//! Each is worked out when what it depends on has changed, and not in every frame: the choice of
//! readings does not depend on the parameters, the curves do not depend on the mouse.

use std::collections::HashMap;

use brdf_core::{Family, Geometry, ModelParameters};
use brdf_fit::objective::IncidenceError;
use brdf_fit::objective::Objective;
use brdf_fit::plot::{Curve, Layout, Quantity, Scale, Selection, View, curves};

use super::State;
use super::fitting::ReadingWeights;
use super::sample::{Knobs, Sample, ScanId};

/// A value with what it was worked out from.
#[derive(Debug, Clone)]
struct Kept<K, V>(Option<(K, V)>);

impl<K: PartialEq, V> Kept<K, V> {
    /// The value for a key: the one that is there, or a new one.
    fn of(&mut self, key: K, value: impl FnOnce(&K) -> V) -> &V {
        let fresh = self.0.as_ref().is_some_and(|(kept, _)| *kept == key);
        if !fresh {
            self.0 = None;
        }
        let (_, value) = self.0.get_or_insert_with(|| {
            let value = value(&key);
            (key, value)
        });
        value
    }

    fn last(&self) -> Option<&V> {
        self.0.as_ref().map(|(_, value)| value)
    }
}

impl<K, V> Default for Kept<K, V> {
    fn default() -> Self {
        Self(None)
    }
}

/// E of the parameters as they are turned.
#[derive(Debug, Clone, PartialEq)]
pub struct Errors {
    /// Over all readings, in percent.
    pub e_percent: f64,
    /// Of each incidence by itself.
    pub incidences: Vec<IncidenceError>,
}

/// The hemispherical reflectance over the incidence angle in degrees.
pub type Reflectances = Vec<[f64; 2]>;

/// Incidence angles of the reflectance, in degrees.
const PSI_DEG: std::ops::RangeInclusive<u8> = 0..=17;

/// Step of these angles in degrees.
const PSI_STEP_DEG: f64 = 5.0;

/// Relative tolerance of the reflectances: finer than a screen shows.
const TOLERANCE: f64 = 1e-4;

type SelectionKey = (View, Vec<f64>, usize);
type CurvesKey = (SelectionKey, Quantity, Knobs, bool);

/// What is shown of one scan.
#[derive(Debug, Clone, Default)]
struct ShownScan {
    selection: Kept<SelectionKey, Selection>,
    curves: Kept<CurvesKey, Vec<Curve>>,
    objective: Kept<(Family, ReadingWeights), Result<Objective, String>>,
    errors: Kept<(Knobs, ReadingWeights), Result<Errors, String>>,
    reflectance: Kept<(Family, ModelParameters), Reflectances>,
}

/// What is shown of all scans.
#[derive(Debug, Clone, Default)]
pub struct Shown {
    scans: HashMap<ScanId, ShownScan>,
}

impl Shown {
    /// The curves of a scan, one for each of its incidences that are shown.
    pub fn curves(&self, scan: ScanId) -> &[Curve] {
        let curves = self.scans.get(&scan).and_then(|scan| scan.curves.last());
        curves.map_or(&[], Vec::as_slice)
    }

    /// The readings of a scan that are shown.
    pub fn selection(&self, scan: ScanId) -> Option<&Selection> {
        self.scans.get(&scan)?.selection.last()
    }

    /// E of a scan, or why there is none.
    pub fn errors(&self, scan: ScanId) -> Option<Result<&Errors, &str>> {
        let errors = self.scans.get(&scan)?.errors.last()?;
        Some(errors.as_ref().map_err(String::as_str))
    }

    /// The reflectance of the theory of a scan.
    pub fn reflectance(&self, scan: ScanId) -> &[[f64; 2]] {
        let rho = self.scans.get(&scan).and_then(|s| s.reflectance.last());
        rho.map_or(&[], Vec::as_slice)
    }
}

impl State {
    /// Works out what has changed since the last time.
    pub fn refresh(&mut self) {
        let Self { samples, shown, .. } = self;
        let is_open = |id: &ScanId| samples.iter().any(|sample| sample.id == id.sample);
        shown.scans.retain(|id, _| is_open(id));
        for sample in samples.iter().filter(|sample| sample.visible) {
            let shown = shown.scans.entry(sample.scan_id()).or_default();
            shown.refresh_curves(sample, &self.view, self.columns);
        }
        let mut active = samples
            .iter()
            .filter(|sample| Some(sample.id) == self.active);
        if let Some(sample) = active.next() {
            let shown = shown.scans.entry(sample.scan_id()).or_default();
            shown.refresh_errors(sample, self.choice.weights, &self.choice.weights());
            shown.refresh_reflectance(sample);
        }
    }
}

impl ShownScan {
    fn refresh_curves(&mut self, sample: &Sample, view: &View, columns: usize) {
        let scan = sample.scan();
        // Of the view, what the readings and the curves depend on: axes and arrangement are drawn.
        let view = View {
            scale: Scale::default(),
            layout: Layout::default(),
            residuals: false,
            ..*view
        };
        let plane = View {
            quantity: Quantity::default(),
            ..view
        };
        let key = (plane, scan.shown_psi(), columns);
        let selection = self.selection.of(key.clone(), |(view, psi, columns)| {
            Selection::of(&scan.measurements, view, Some(psi), *columns)
        });
        let report = scan.fit_shown();
        let uncertainty = report.and_then(|report| report.uncertainty.as_ref());
        let key = (key, view.quantity, scan.knobs, uncertainty.is_some());
        self.curves.of(key, |_| {
            let Some(brdf) = scan.knobs.brdf() else {
                return Vec::new();
            };
            let band = |uncertainty: &brdf_fit::inference::Uncertainty, at: &Geometry| {
                uncertainty.band(&brdf, at)
            };
            let sigma = uncertainty.map(|u| move |at: &Geometry| band(u, at));
            let sigma = sigma
                .as_ref()
                .map(|sigma| sigma as &dyn Fn(&Geometry) -> f64);
            curves(&scan.measurements, selection, &brdf, sigma, &view)
        });
    }

    fn refresh_errors(
        &mut self,
        sample: &Sample,
        reading_weights: ReadingWeights,
        weights: &brdf_fit::objective::weights::Weights,
    ) {
        let scan = sample.scan();
        let (knobs, family) = (scan.knobs, scan.knobs.model.family());
        let objective = self.objective.of((family, reading_weights), |_| {
            if scan.readings() == 0 {
                return Err("no readings".to_owned());
            }
            Objective::new(&scan.measurements, family, knobs.at.n, weights)
                .map_err(|error| error.to_string())
        });
        self.errors.of((knobs, reading_weights), |_| {
            let objective = objective.as_ref().map_err(Clone::clone)?;
            let (error, incidences) = objective.error_and_by_incidence(&knobs.at);
            Ok(Errors {
                e_percent: 100.0 * error,
                incidences,
            })
        });
    }

    fn refresh_reflectance(&mut self, sample: &Sample) {
        let knobs = sample.scan().knobs;
        self.reflectance
            .of((knobs.model.family(), knobs.at), |_| reflectance(&knobs));
    }
}

fn reflectance(knobs: &Knobs) -> Reflectances {
    let Some(brdf) = knobs.brdf() else {
        return Vec::new();
    };
    PSI_DEG
        .filter_map(|i| {
            let psi_deg = f64::from(i) * PSI_STEP_DEG;
            let rho = brdf.hemispherical_reflectance(psi_deg.to_radians(), TOLERANCE);
            Some([psi_deg, rho.ok()?])
        })
        .collect()
}
