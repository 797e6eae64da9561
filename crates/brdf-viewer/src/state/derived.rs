//! The values derived from data, view and parameters: curves, E, reflectances and ranges of angles.
//!
//! Each is cached with the values that it depends on, and computed again only if these have
//! changed. The selection of readings does not depend on the parameters, and nothing here depends
//! on the pointer.

use std::collections::{BTreeSet, HashMap};

use brdf_core::{Family, Geometry, ModelParameters, check_refractive_index};
use brdf_fit::DEFAULT_N;
use brdf_fit::FitProblem;
use brdf_fit::Measurements;
use brdf_fit::Uncertainty;
use brdf_fit::Weights;
use brdf_fit::plot::{Curve, Layout, Quantity, Scale, Selection, View, curves};
use brdf_fit::{FitError, FitOptions, RefractiveIndex};
use brdf_fit::{IncidenceError, Objective};

use super::angle_range::AngleRange;
use super::fit_settings::{FitSettings, ReadingWeights};
use super::ghost::Ghost;
use super::id::{SampleId, ScanId};
use super::parameters::EditedParameters;
use super::sample::{Sample, Scan};

/// A value with the key from which it was computed.
#[derive(Debug, Clone)]
pub(super) struct Cached<K, V>(Option<(K, V)>);

impl<K: PartialEq, V> Cached<K, V> {
    /// The value for a key, computed unless the cached one has this key.
    pub(super) fn get(&mut self, key: K, compute: impl FnOnce(&K) -> V) -> &V {
        if !self.has(&key) {
            self.0 = None;
        }
        let (_, value) = self.0.get_or_insert_with(|| {
            let value = compute(&key);
            (key, value)
        });
        value
    }

    /// Whether the cached value is that of a key.
    pub(super) fn has(&self, key: &K) -> bool {
        self.0.as_ref().is_some_and(|(cached, _)| cached == key)
    }

    /// The cached value.
    pub(super) fn last(&self) -> Option<&V> {
        self.0.as_ref().map(|(_, value)| value)
    }
}

impl<K, V> Default for Cached<K, V> {
    fn default() -> Self {
        Self(None)
    }
}

/// E of the current parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct RelativeErrors {
    /// E over all readings, in percent.
    pub e_percent: f64,
    /// E of each incidence.
    pub incidences: Vec<IncidenceError>,
}

impl RelativeErrors {
    /// E of the incidence at an angle in radians, in percent.
    pub fn of_incidence(&self, psi: f64) -> Option<f64> {
        let psi_deg = psi.to_degrees();
        let mut incidences = self.incidences.iter();
        let found = incidences.find(|incidence| (incidence.psi_deg - psi_deg).abs() < 1e-6)?;
        found.e_percent
    }
}

/// Why E is not available.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoRelativeErrors {
    /// The scan has no readings.
    #[error("no readings")]
    NoReadings,
    /// E is not defined for the readings.
    #[error(transparent)]
    Problem(#[from] FitError),
}

/// The hemispherical reflectance against the incidence angle in degrees.
pub type Reflectances = Vec<[f64; 2]>;

/// Indices of the incidence angles of the reflectances.
const PSI_INDICES: std::ops::RangeInclusive<u8> = 0..=17;

/// Step of these angles, in degrees.
const PSI_STEP_DEG: f64 = 5.0;

/// Relative tolerance of the reflectances, below the resolution of a screen.
const TOLERANCE: f64 = 1e-4;

/// The view, the visible incidence angles and the number of columns of a plot.
type SelectionKey = (View, Vec<f64>, usize);
/// In addition, whether the curves have a band of uncertainty.
type CurvesKey = (SelectionKey, Quantity, EditedParameters, bool);

/// The family of models, the weights, and the readings that are left out.
type ObjectiveKey = (Family, ReadingWeights, BTreeSet<usize>);

/// The view, the visible incidence angles and the parameters of a ghost.
type GhostKey = (View, Vec<f64>, EditedParameters);

/// The view, and the readings that are left out.
type AnglesKey = (View, BTreeSet<usize>);

/// The values derived from one scan.
#[derive(Debug, Clone, Default)]
struct DerivedScan {
    selection: Cached<SelectionKey, Selection>,
    curves: Cached<CurvesKey, Vec<Curve>>,
    objective: Cached<ObjectiveKey, Result<Objective, NoRelativeErrors>>,
    errors: Cached<(EditedParameters, ObjectiveKey), Result<RelativeErrors, NoRelativeErrors>>,
    reflectance: Cached<(Family, ModelParameters), Reflectances>,
    angles: Cached<AnglesKey, Option<AngleRange>>,
}

/// The values derived from all scans.
#[derive(Debug, Clone, Default)]
pub struct Derived {
    scans: HashMap<ScanId, DerivedScan>,
    ghosts: Vec<Cached<GhostKey, Vec<Curve>>>,
}

impl Derived {
    /// The curves of a scan, one per visible incidence.
    pub fn curves(&self, scan: ScanId) -> &[Curve] {
        let curves = self.scans.get(&scan).and_then(|scan| scan.curves.last());
        curves.map_or(&[], Vec::as_slice)
    }

    /// The curves of a ghost, by its index: one per visible incidence of its sample.
    pub fn ghost(&self, index: usize) -> &[Curve] {
        let curves = self.ghosts.get(index).and_then(Cached::last);
        curves.map_or(&[], Vec::as_slice)
    }

    /// Updates the curves of the ghosts.
    pub fn refresh_ghosts(&mut self, ghosts: &[Ghost], samples: &[Sample], view: &View) {
        self.ghosts.resize_with(ghosts.len(), Cached::default);
        let view = without_axes(view);
        for (cached, ghost) in self.ghosts.iter_mut().zip(ghosts) {
            let sample = samples.iter().find(|sample| sample.id == ghost.sample);
            let psi = sample.map_or_else(Vec::new, |sample| sample.scan().visible_psi());
            cached.get((view, psi, ghost.parameters), |(view, psi, parameters)| {
                let none = Measurements::default();
                let selection = Selection::of(&none, view, Some(psi), 1);
                let brdf = parameters.brdf();
                brdf.map_or_else(Vec::new, |brdf| {
                    curves(&none, &selection, &brdf, None, view)
                })
            });
        }
    }

    /// The visible readings of a scan.
    pub fn selection(&self, scan: ScanId) -> Option<&Selection> {
        self.scans.get(&scan)?.selection.last()
    }

    /// E of a scan, or why it is not available. `None` if the scan has not been evaluated.
    pub fn errors(&self, scan: ScanId) -> Option<Result<&RelativeErrors, NoRelativeErrors>> {
        let errors = self.scans.get(&scan)?.errors.last()?;
        Some(errors.as_ref().map_err(Clone::clone))
    }

    /// The view angles of a scan; `None` where no reading in the plane is used.
    pub fn angle_range(&self, scan: ScanId) -> Option<&AngleRange> {
        self.scans.get(&scan)?.angles.last()?.as_ref()
    }

    /// The reflectances of the theory of a scan.
    pub fn reflectance(&self, scan: ScanId) -> &[[f64; 2]] {
        let rho = self.scans.get(&scan).and_then(|s| s.reflectance.last());
        rho.map_or(&[], Vec::as_slice)
    }

    /// Updates the curves of the visible samples, and E and the reflectances of the active one.
    /// `columns` is the number of columns of readings that fit into the plot.
    pub fn refresh(
        &mut self,
        samples: &[Sample],
        active: Option<SampleId>,
        view: &View,
        columns: usize,
        settings: &FitSettings,
    ) {
        let is_open = |id: &ScanId| samples.iter().any(|sample| sample.id == id.sample);
        self.scans.retain(|id, _| is_open(id));
        for sample in samples.iter().filter(|sample| sample.visible) {
            for (wavelength, scan) in sample.plotted() {
                let derived = self.scans.entry(sample.id_of(wavelength)).or_default();
                derived.refresh_curves(scan, view, columns);
            }
        }
        let mut active = samples.iter().filter(|sample| Some(sample.id) == active);
        if let Some(sample) = active.next() {
            let derived = self.scans.entry(sample.scan_id()).or_default();
            let weights = settings.objective_weights();
            derived.refresh_errors(sample.scan(), settings.weights, &weights);
            derived.refresh_reflectance(&sample.scan().parameters);
            derived.refresh_angles(sample.scan(), view);
        }
    }
}

/// A view as far as readings and curves depend on it: neither on the axes nor on the layout.
fn without_axes(view: &View) -> View {
    View {
        scale: Scale::default(),
        layout: Layout::default(),
        residuals: false,
        ..*view
    }
}

/// A view as far as the choice of readings depends on it.
fn plane_of(view: &View) -> View {
    View {
        quantity: Quantity::default(),
        ..without_axes(view)
    }
}

impl DerivedScan {
    fn refresh_curves(&mut self, scan: &Scan, view: &View, columns: usize) {
        let view = without_axes(view);
        let key = (plane_of(&view), scan.visible_psi(), columns);
        let selection = self.selection.get(key.clone(), |(view, psi, columns)| {
            Selection::of(&scan.measurements, view, Some(psi), *columns)
        });
        let report = scan.current_fit();
        let uncertainty = report.and_then(|report| report.uncertainty.as_ref());
        let key = (key, view.quantity, scan.parameters, uncertainty.is_some());
        self.curves.get(key, |_| {
            let Some(brdf) = scan.parameters.brdf() else {
                return Vec::new();
            };
            let band = |uncertainty: &Uncertainty, at: &Geometry| uncertainty.band(&brdf, at);
            let sigma = uncertainty.map(|u| move |at: &Geometry| band(u, at));
            let sigma = sigma
                .as_ref()
                .map(|sigma| sigma as &dyn Fn(&Geometry) -> f64);
            curves(&scan.measurements, selection, &brdf, sigma, &view)
        });
    }

    fn refresh_errors(&mut self, scan: &Scan, reading_weights: ReadingWeights, weights: &Weights) {
        let parameters = scan.parameters;
        let family = parameters.model.family();
        let key = (family, reading_weights, scan.left_out().clone());
        let objective = self.objective.get(key.clone(), |_| {
            if scan.used_count() == 0 {
                return Err(NoRelativeErrors::NoReadings);
            }
            let n = check_refractive_index(parameters.values.n).unwrap_or(DEFAULT_N);
            let options = FitOptions {
                model: parameters.model,
                refractive_index: Some(RefractiveIndex::Same(n)),
                weights: weights.clone(),
                ..FitOptions::default()
            };
            Ok(FitProblem::new(scan.used(), &options)?.into_objective())
        });
        self.errors.get((parameters, key), |_| {
            let objective = objective.as_ref().map_err(Clone::clone)?;
            let (error, incidences) = objective.error_and_by_incidence(&parameters.values);
            Ok(RelativeErrors {
                e_percent: 100.0 * error,
                incidences,
            })
        });
    }

    fn refresh_angles(&mut self, scan: &Scan, view: &View) {
        let key = (plane_of(view), scan.left_out().clone());
        self.angles.get(key, |(view, left_out)| {
            AngleRange::new(&scan.measurements, left_out, view)
        });
    }

    fn refresh_reflectance(&mut self, parameters: &EditedParameters) {
        let key = (parameters.model.family(), parameters.values);
        self.reflectance.get(key, |_| reflectance(parameters));
    }
}

fn reflectance(parameters: &EditedParameters) -> Reflectances {
    let Some(brdf) = parameters.brdf() else {
        return Vec::new();
    };
    PSI_INDICES
        .filter_map(|i| {
            let psi_deg = f64::from(i) * PSI_STEP_DEG;
            let rho = brdf.hemispherical_reflectance(psi_deg.to_radians(), TOLERANCE);
            Some([psi_deg, rho.ok()?])
        })
        .collect()
}
