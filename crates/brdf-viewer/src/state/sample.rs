//! A sample: its scans, one for each wavelength, with the parameters that are turned.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use brdf_core::published::PublishedSample;
use brdf_core::{AnyBrdf, ModelParameters};
use brdf_fit::model::{FixedParameters, Model, Parameter};
use brdf_fit::output::resolved;
use brdf_fit::report::Report;
use brdf_fit::{FitOptions, Measurements, RefractiveIndex};

use super::fitting::Point;
use crate::job::Opened;

/// Which sample, as long as it is open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SampleId(pub u64);

/// Which wavelength of which sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ScanId {
    /// The sample.
    pub sample: SampleId,
    /// The place of the wavelength among its scans.
    pub wavelength: usize,
}

/// The incidences of theory without readings, in degrees: those of the paper's scans.
const THEORY_PSI_DEG: [f64; 5] = [15.0, 30.0, 45.0, 60.0, 75.0];

/// So many incidences of a new sample are shown; more cannot be told apart.
const FIRST_SHOWN: usize = 8;

/// A sample that is open.
#[derive(Debug, Clone)]
pub struct Sample {
    /// Which.
    pub id: SampleId,
    /// Its short name.
    pub name: String,
    /// What was opened: the path of a scan or of a fit as JSON, or what the built-in menu says.
    pub source: String,
    /// The file of its readings, where they are from one.
    pub file: Option<PathBuf>,
    /// How many samples its source has.
    pub siblings: usize,
    /// What the file says it is.
    pub description: String,
    /// Its family of colours.
    pub family: usize,
    /// Whether it is shown.
    pub visible: bool,
    /// One for each wavelength; never empty.
    pub scans: Vec<Scan>,
    /// The place of the one that is shown.
    pub current: usize,
}

/// The readings of one wavelength, and the theory beside them.
#[derive(Debug, Clone)]
pub struct Scan {
    /// The readings; none where only the theory is known.
    pub measurements: Arc<Measurements>,
    /// Its incidences, ascending.
    pub incidences: Vec<Incidence>,
    /// The azimuths of the planes that hold readings, in radians.
    pub planes: Vec<f64>,
    /// The parameters as they are turned.
    pub knobs: Knobs,
    /// The parameters after the last finished change: what undoing starts from.
    pub settled: Knobs,
    /// The parameters before any fit.
    pub loaded: Knobs,
    /// The last fit.
    pub fitted: Option<Arc<Report>>,
    /// The iterations of its stages.
    pub steps: Vec<Point>,
    /// Why there was no fit after it.
    pub failure: Option<String>,
}

/// One incidence of a scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Incidence {
    /// Incidence angle psi in radians.
    pub psi: f64,
    /// How many readings there are.
    pub readings: usize,
    /// Whether it is shown.
    pub shown: bool,
}

/// What can be turned: the model, its parameters, and which of them a fit shall hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knobs {
    /// The model.
    pub model: Model,
    /// Its parameters.
    pub at: ModelParameters,
    /// Which parameters a fit holds, in the order of [`Parameter::ALL`].
    pub fixed: [bool; 5],
}

impl Knobs {
    /// Whether a fit holds a parameter.
    pub fn holds(&self, parameter: Parameter) -> bool {
        self.fixed[parameter as usize]
    }

    /// The parameters that a fit holds, with their values: those that the model would fit.
    pub fn fixed_parameters(&self) -> FixedParameters {
        let held = self.model.free().iter().filter(|p| self.holds(**p));
        held.fold(FixedParameters::none(), |held, p| {
            held.with(*p, p.of(&self.at))
        })
    }

    /// The BRDF; `None` where a parameter is outside its domain.
    pub fn brdf(&self) -> Option<AnyBrdf> {
        AnyBrdf::new(self.model.family(), &self.at).ok()
    }

    /// The parameters that the model has: those that it fits, and n where it reflects.
    pub fn parameters(&self) -> Vec<Parameter> {
        let needs_n = self.model.frees(Parameter::K2);
        Parameter::ALL
            .into_iter()
            .filter(|p| self.model.frees(*p) || (*p == Parameter::N && needs_n))
            .collect()
    }
}

impl Scan {
    /// A scan with the paper's initial values for its parameters.
    pub fn new(measurements: Measurements) -> Self {
        let knobs = first_knobs(&measurements);
        let incidences: Vec<(f64, usize)> = measurements
            .incidences()
            .iter()
            .map(|incidence| (incidence.psi, incidence.readings.len()))
            .collect();
        let planes = measurements.planes();
        Self::with(measurements, &incidences, planes, knobs)
    }

    /// The theory of a row of Table 1, without readings.
    pub fn published(row: &PublishedSample) -> Self {
        // No reading, and so none that could be refused.
        let mut measurements =
            Measurements::new(published_name(row), Vec::new()).unwrap_or_default();
        measurements.refractive_index = Some(RefractiveIndex::Same(row.n));
        let knobs = Knobs {
            model: Model::Three,
            at: ModelParameters::three(row.parameters, row.n),
            fixed: [false; 5],
        };
        let incidences = THEORY_PSI_DEG.map(|psi_deg| (psi_deg.to_radians(), 0));
        Self::with(measurements, &incidences, Vec::new(), knobs)
    }

    fn with(
        measurements: Measurements,
        incidences: &[(f64, usize)],
        planes: Vec<f64>,
        knobs: Knobs,
    ) -> Self {
        let count = incidences.len();
        let few = FIRST_SHOWN.min(count);
        // Evenly from the first to the last, all of them where they are few.
        let first: Vec<usize> = (0..few)
            .map(|i| i * (count - 1) / (few - 1).max(1))
            .collect();
        let incidences = incidences.iter().enumerate();
        let incidences = incidences.map(|(i, &(psi, readings))| Incidence {
            psi,
            readings,
            shown: first.contains(&i),
        });
        Self {
            incidences: incidences.collect(),
            measurements: Arc::new(measurements),
            planes,
            knobs,
            settled: knobs,
            loaded: knobs,
            fitted: None,
            steps: Vec::new(),
            failure: None,
        }
    }

    /// Wavelength in micrometres, where the scan states one.
    pub fn wavelength_um(&self) -> Option<f64> {
        self.measurements.readings().first()?.wavelength_um
    }

    /// Takes over a fit: its parameters are the ones that are turned from now on.
    pub fn take(&mut self, report: Report) {
        if let Some(fit) = &report.fit {
            self.knobs.model = fit.model();
            self.knobs.at = fit.at();
        }
        self.fitted = Some(Arc::new(report));
        self.failure = None;
    }

    /// The parameters of the last fit; those before any fit where there is none. What is held is no
    /// parameter and stays as it is.
    pub fn fitted_knobs(&self) -> Knobs {
        let fit = self.fitted.as_ref().and_then(|report| report.fit.as_ref());
        let loaded = (self.loaded.model, self.loaded.at);
        let (model, at) = fit.map_or(loaded, |fit| (fit.model(), fit.at()));
        Knobs {
            model,
            at,
            fixed: self.knobs.fixed,
        }
    }

    /// The last fit, where the parameters are still its own.
    pub fn fit_shown(&self) -> Option<&Arc<Report>> {
        let report = self.fitted.as_ref()?;
        let fit = report.fit.as_ref()?;
        let same = fit.model() == self.knobs.model && fit.at() == self.knobs.at;
        same.then_some(report)
    }

    /// The angles of the incidences that are shown, in radians.
    pub fn shown_psi(&self) -> Vec<f64> {
        let shown = self.incidences.iter().filter(|incidence| incidence.shown);
        shown.map(|incidence| incidence.psi).collect()
    }

    /// How many readings there are.
    pub fn readings(&self) -> usize {
        self.measurements.readings().len()
    }
}

impl Sample {
    /// A sample that was opened as one of so many.
    pub fn new(id: SampleId, opened: Opened, family: usize, siblings: usize) -> Self {
        let first = opened.scans.first().map(|scan| &*scan.measurements);
        let name = first.map_or(opened.source.as_str(), |first| &first.source);
        let description = first.and_then(|first| first.metadata.get("sample"));
        Self {
            id,
            name: short_name(name),
            description: description.unwrap_or_default().to_owned(),
            source: opened.source,
            file: opened.file,
            siblings,
            family,
            visible: true,
            scans: opened.scans,
            current: 0,
        }
    }

    /// Whether its readings are from the file at a resolved path.
    pub fn is_scan_at(&self, target: &Path) -> bool {
        self.file
            .as_ref()
            .is_some_and(|file| resolved(file) == *target)
    }

    /// Whether a file at a resolved path is what was opened.
    pub fn is_from(&self, target: &Path) -> bool {
        resolved(Path::new(&self.source)) == *target
    }

    /// Whether any of its wavelengths is fitted.
    pub fn is_fitted(&self) -> bool {
        self.scans.iter().any(|scan| scan.fitted.is_some())
    }

    /// The scan that is shown.
    pub fn scan(&self) -> &Scan {
        &self.scans[self.current]
    }

    /// The scan that is shown.
    pub fn scan_mut(&mut self) -> &mut Scan {
        &mut self.scans[self.current]
    }

    /// Which scan is shown.
    pub fn scan_id(&self) -> ScanId {
        self.id_of(self.current)
    }

    /// All of its scans.
    pub fn scan_ids(&self) -> impl Iterator<Item = ScanId> {
        (0..self.scans.len()).map(|wavelength| self.id_of(wavelength))
    }

    fn id_of(&self, wavelength: usize) -> ScanId {
        ScanId {
            sample: self.id,
            wavelength,
        }
    }
}

/// What a row of Table 1 is called.
pub fn published_name(row: &PublishedSample) -> String {
    format!("Table 1, {} at {} um", row.sample, row.wavelength_um)
}

/// The name of a file without folder and extension.
fn short_name(source: &str) -> String {
    let path = Path::new(source);
    let known = path
        .extension()
        .is_some_and(|e| ["csv", "txt", "dat", "tsv"].iter().any(|known| e == *known));
    let name = if known {
        path.file_stem()
    } else {
        path.file_name()
    };
    name.map_or_else(
        || source.to_owned(),
        |name| name.to_string_lossy().into_owned(),
    )
}

/// Where the parameters of a new scan stand: the paper's initial values, at the refractive index of
/// the file or the usual one.
fn first_knobs(measurements: &Measurements) -> Knobs {
    let options = FitOptions {
        refractive_index: measurements
            .refractive_index
            .is_none()
            .then_some(RefractiveIndex::Same(brdf_fit::model::DEFAULT_N)),
        ..FitOptions::default()
    };
    let at = brdf_fit::fit::starting_values(measurements, &options).unwrap_or(ModelParameters {
        k2: 0.0,
        kd: 0.1,
        k1: 0.3,
        n: brdf_fit::model::DEFAULT_N,
        p: 1.0,
    });
    Knobs {
        model: Model::Three,
        at,
        fixed: [false; 5],
    }
}
