//! A sample with its scans, one per wavelength, and the parameters edited for each.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use brdf_core::ModelParameters;
use brdf_core::published::PublishedSample;
use brdf_fit::FitProblem;
use brdf_fit::Model;
use brdf_fit::output::resolved;
use brdf_fit::report::Report;
use brdf_fit::{FitOptions, Measurements, RefractiveIndex};

use super::convergence::ConvergencePoint;
use super::history::Change;
use super::id::{SampleId, ScanId};
use super::parameters::EditedParameters;

/// Incidence angles of a theory without readings, in degrees: those of the paper's scans.
const THEORY_PSI_DEG: [f64; 5] = [15.0, 30.0, 45.0, 60.0, 75.0];

/// The largest number of visible incidences of a new sample. More curves are hard to distinguish.
const MOST_INITIALLY_VISIBLE: usize = 8;

/// The content of a source that was opened.
#[derive(Debug)]
pub struct Opened {
    /// The source: the path of a file, or the name of a built-in sample.
    pub source: String,
    /// The file of the readings, if they come from one.
    pub file: Option<PathBuf>,
    /// One scan per wavelength.
    pub scans: Vec<Scan>,
}

/// An open sample.
#[derive(Debug, Clone)]
pub struct Sample {
    /// The identifier.
    pub id: SampleId,
    /// The short name.
    pub name: String,
    /// The source: the path of a scan or of a fit as JSON, or the name of a built-in sample.
    pub source: String,
    /// The file of the readings, if they come from one.
    pub file: Option<PathBuf>,
    /// The number of samples that were opened from the same source.
    pub samples_in_source: usize,
    /// The description given in the file.
    pub description: String,
    /// The colour family.
    pub family: usize,
    /// Whether the sample is visible in the plot.
    pub visible: bool,
    /// One scan per wavelength; never empty.
    pub scans: Vec<Scan>,
    /// The index of the current scan.
    pub current: usize,
}

/// The readings of one wavelength, with the parameters of the theory.
#[derive(Debug, Clone)]
pub struct Scan {
    /// The readings; empty if there is only a theory.
    pub measurements: Arc<Measurements>,
    /// The incidences in ascending order.
    pub incidences: Vec<Incidence>,
    /// The azimuths of the planes that contain readings, in radians.
    pub planes: Vec<f64>,
    /// The current parameters.
    pub parameters: EditedParameters,
    /// The parameters after the last finished change, to which undo returns.
    pub committed: EditedParameters,
    /// The parameters before any fit.
    pub initial: EditedParameters,
    /// The report of the last successful fit.
    pub last_fit: Option<Arc<Report>>,
    /// The iterations of its stages.
    pub convergence: Vec<ConvergencePoint>,
    /// The error message of a later fit, if that has failed.
    pub fit_error: Option<String>,
}

/// One incidence of a scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Incidence {
    /// Incidence angle psi in radians.
    pub psi: f64,
    /// Number of readings.
    pub readings: usize,
    /// Whether the incidence is visible in the plot.
    pub visible: bool,
}

impl Scan {
    /// A scan with the paper's initial values as its parameters.
    pub fn new(measurements: Measurements) -> Self {
        let parameters = initial_parameters(&measurements);
        let incidences: Vec<(f64, usize)> = measurements
            .incidences()
            .iter()
            .map(|incidence| (incidence.psi, incidence.readings.len()))
            .collect();
        let planes = measurements.planes();
        Self::with_parameters(measurements, &incidences, planes, parameters)
    }

    /// The theory of a row of Table 1 of the paper, without readings.
    pub fn published(row: &PublishedSample) -> Self {
        // Without readings the default is never needed: only readings can be refused.
        let mut measurements =
            Measurements::new(published_name(row), Vec::new()).unwrap_or_default();
        measurements.refractive_index = Some(RefractiveIndex::Same(row.n));
        let values = ModelParameters::three(row.parameters, row.n);
        let parameters = EditedParameters::new(Model::Three, values);
        let incidences = THEORY_PSI_DEG.map(|psi_deg| (psi_deg.to_radians(), 0));
        Self::with_parameters(measurements, &incidences, Vec::new(), parameters)
    }

    fn with_parameters(
        measurements: Measurements,
        incidences: &[(f64, usize)],
        planes: Vec<f64>,
        parameters: EditedParameters,
    ) -> Self {
        let count = incidences.len();
        let visible_count = MOST_INITIALLY_VISIBLE.min(count);
        // Evenly spaced from the first to the last incidence.
        let visible: Vec<usize> = (0..visible_count)
            .map(|i| i * (count - 1) / (visible_count - 1).max(1))
            .collect();
        let incidences = incidences.iter().enumerate();
        let incidences = incidences.map(|(i, &(psi, readings))| Incidence {
            psi,
            readings,
            visible: visible.contains(&i),
        });
        Self {
            incidences: incidences.collect(),
            measurements: Arc::new(measurements),
            planes,
            parameters,
            committed: parameters,
            initial: parameters,
            last_fit: None,
            convergence: Vec::new(),
            fit_error: None,
        }
    }

    /// Wavelength in micrometres, if the scan states one.
    pub fn wavelength_um(&self) -> Option<f64> {
        self.measurements.readings().first()?.wavelength_um
    }

    /// Stores a fit, and makes its parameters the current ones.
    pub fn adopt_fit(&mut self, report: Report) {
        if let Some(fit) = &report.fit {
            self.parameters.model = fit.model();
            self.parameters.values = fit.at();
        }
        self.last_fit = Some(Arc::new(report));
        self.fit_error = None;
    }

    /// Ends a change of the parameters, and returns it if they differ from the committed ones.
    /// `id` identifies this scan.
    pub fn commit(&mut self, id: ScanId) -> Option<Change> {
        let before = std::mem::replace(&mut self.committed, self.parameters);
        (before != self.parameters).then_some(Change {
            scan: id,
            before,
            after: self.parameters,
        })
    }

    /// The parameters of the last fit, or the initial ones without a fit. Fixed parameters stay
    /// fixed.
    pub fn fitted_parameters(&self) -> EditedParameters {
        let fit = self.last_fit.as_ref();
        let fit = fit.and_then(|report| report.fit.as_ref());
        let initial = (self.initial.model, self.initial.values);
        let (model, values) = fit.map_or(initial, |fit| (fit.model(), fit.at()));
        EditedParameters {
            model,
            values,
            fixed: self.parameters.fixed,
        }
    }

    /// The last fit, if the current parameters are those of the fit.
    pub fn current_fit(&self) -> Option<&Arc<Report>> {
        let report = self.last_fit.as_ref()?;
        let fit = report.fit.as_ref()?;
        let is_unchanged =
            fit.model() == self.parameters.model && fit.at() == self.parameters.values;
        is_unchanged.then_some(report)
    }

    /// The visible incidence angles, in radians.
    pub fn visible_psi(&self) -> Vec<f64> {
        let visible = self.incidences.iter().filter(|incidence| incidence.visible);
        visible.map(|incidence| incidence.psi).collect()
    }

    /// The number of readings.
    pub fn reading_count(&self) -> usize {
        self.measurements.readings().len()
    }
}

impl Sample {
    /// A sample in a colour family, opened from a source with `samples_in_source` samples.
    pub fn new(id: SampleId, opened: Opened, family: usize, samples_in_source: usize) -> Self {
        let first = opened.scans.first().map(|scan| &*scan.measurements);
        let name = first.map_or(opened.source.as_str(), |first| &first.source);
        let description = first.and_then(|first| first.metadata.get("sample"));
        Self {
            id,
            name: short_name(name),
            description: description.unwrap_or_default().to_owned(),
            source: opened.source,
            file: opened.file,
            samples_in_source,
            family,
            visible: true,
            scans: opened.scans,
            current: 0,
        }
    }

    /// Whether the readings come from the file at a resolved path.
    pub fn has_readings_from(&self, resolved_path: &Path) -> bool {
        self.file
            .as_ref()
            .is_some_and(|file| resolved(file) == *resolved_path)
    }

    /// Whether the sample was opened from the file at a resolved path.
    pub fn was_opened_from(&self, resolved_path: &Path) -> bool {
        resolved(Path::new(&self.source)) == *resolved_path
    }

    /// Whether any wavelength has a fit.
    pub fn is_fitted(&self) -> bool {
        self.scans.iter().any(|scan| scan.last_fit.is_some())
    }

    /// The current scan.
    pub fn scan(&self) -> &Scan {
        &self.scans[self.current]
    }

    /// The current scan.
    pub fn scan_mut(&mut self) -> &mut Scan {
        &mut self.scans[self.current]
    }

    /// The identifier of the current scan.
    pub fn scan_id(&self) -> ScanId {
        self.id_of(self.current)
    }

    /// The identifiers of all scans.
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

/// The name of a row of Table 1.
pub fn published_name(row: &PublishedSample) -> String {
    format!("Table 1, {} at {} um", row.sample, row.wavelength_um)
}

/// The name of a file, without its folder and a usual extension.
fn short_name(source: &str) -> String {
    let path = Path::new(source);
    let has_usual_extension = path
        .extension()
        .is_some_and(|e| ["csv", "txt", "dat", "tsv"].iter().any(|usual| e == *usual));
    let name = if has_usual_extension {
        path.file_stem()
    } else {
        path.file_name()
    };
    name.map_or_else(
        || source.to_owned(),
        |name| name.to_string_lossy().into_owned(),
    )
}

/// The paper's initial values, with the refractive index of the file or else the default one.
fn initial_parameters(measurements: &Measurements) -> EditedParameters {
    let options = FitOptions {
        refractive_index: measurements
            .refractive_index
            .is_none()
            .then_some(RefractiveIndex::Same(brdf_fit::DEFAULT_N)),
        ..FitOptions::default()
    };
    let values = FitProblem::new(measurements, &options).map(|problem| problem.start());
    let values = values.unwrap_or(ModelParameters {
        k2: 0.0,
        kd: 0.1,
        k1: 0.3,
        n: brdf_fit::DEFAULT_N,
        p: 1.0,
    });
    EditedParameters::new(Model::Three, values)
}
