//! A sample with its scans, one per wavelength, and the parameters edited for each.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use brdf_core::ModelParameters;
use brdf_core::published::PublishedSample;
use brdf_fit::Convention;
use brdf_fit::FitProblem;
use brdf_fit::output::resolved;
use brdf_fit::planning::MeasurementPlan;
use brdf_fit::read::LazyScan;
use brdf_fit::report::Report;
use brdf_fit::{FitOptions, Measurements, RefractiveIndex};
use brdf_fit::{Model, Parameter};

use super::convergence::ConvergencePoint;
use super::history::{Change, Edited};
use super::id::{SampleId, ScanId};
use super::parameters::EditedParameters;
use crate::platform::Files;
use crate::platform::current::CurrentFiles;

/// Incidence angles of a theory without readings, in degrees: those of the paper's scans.
const THEORY_PSI_DEG: [f64; 5] = [15.0, 30.0, 45.0, 60.0, 75.0];

/// Up to this number, all incidences of a new sample are visible.
const MOST_VISIBLE: usize = 20;

/// Of more incidences this number is visible at first, because more curves are hard to distinguish.
const VISIBLE_OF_MANY: usize = 8;

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
    /// When the file of the readings was last changed, as it was opened.
    pub modified: Option<SystemTime>,
    /// Whether the file has changed since.
    pub has_changed_on_disk: bool,
    /// The angular convention that was asked for when it was opened.
    pub convention: Convention,
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
    /// The indices of the readings that the user has left out.
    left_out: BTreeSet<usize>,
    /// The readings without those.
    used: Arc<Measurements>,
    /// The channel of a table of which all bins are fitted; `measurements` are then those that are
    /// shown.
    pub table: Option<LazyScan>,
    /// Whether the scan is plotted beside the current one of its sample.
    pub is_beside: bool,
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
    /// The plan of its next readings, with the readings that it was made from.
    pub plan: Option<(Arc<Measurements>, Box<MeasurementPlan>)>,
    /// Whether a fit that the user has asked for, or a choice of readings, is not in a file.
    pub has_unsaved_work: bool,
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

/// Which readings of an incidence a fit uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Usage {
    /// All.
    All,
    /// Some of them.
    Some,
    /// None.
    None,
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
        let visible_count = if count > MOST_VISIBLE {
            VISIBLE_OF_MANY
        } else {
            count
        };
        // Evenly spaced from the first to the last incidence.
        let visible: Vec<usize> = (0..visible_count)
            .map(|i| i * (count - 1) / (visible_count - 1).max(1))
            .collect();
        let measurements = Arc::new(measurements);
        let incidences = incidences.iter().enumerate();
        let incidences = incidences.map(|(i, &(psi, readings))| Incidence {
            psi,
            readings,
            visible: visible.contains(&i),
        });
        Self {
            incidences: incidences.collect(),
            used: Arc::clone(&measurements),
            measurements,
            left_out: BTreeSet::new(),
            table: None,
            is_beside: false,
            planes,
            parameters,
            committed: parameters,
            initial: parameters,
            last_fit: None,
            convergence: Vec::new(),
            fit_error: None,
            plan: None,
            has_unsaved_work: false,
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
        self.keep_fit(report);
    }

    /// Stores a fit, and leaves the current parameters as they are.
    pub fn keep_fit(&mut self, report: Report) {
        self.last_fit = Some(Arc::new(report));
        self.fit_error = None;
    }

    /// Whether the user has changed the parameters since they were initial or fitted.
    pub fn is_edited(&self) -> bool {
        let fitted = self.fitted_parameters();
        (self.parameters.model, self.parameters.values) != (fitted.model, fitted.values)
    }

    /// Whether n is a default value, because the file does not state one.
    pub fn assumes_n(&self) -> bool {
        self.reading_count() > 0
            && self.measurements.refractive_index.is_none()
            && !self.parameters.model.frees(Parameter::N)
            && self.parameters.values.n == brdf_fit::DEFAULT_N
    }

    /// The indices of the incidences that are hidden.
    pub fn hidden_incidences(&self) -> BTreeSet<usize> {
        let all = self.incidences.iter().enumerate();
        let hidden = all.filter(|(_, incidence)| !incidence.visible);
        hidden.map(|(i, _)| i).collect()
    }

    /// The indices of the readings that the user has left out.
    pub fn left_out(&self) -> &BTreeSet<usize> {
        &self.left_out
    }

    /// Leaves readings out, in place of those that were left out before. Indices that the scan does
    /// not have are ignored.
    pub fn leave_out(&mut self, readings: BTreeSet<usize>) {
        let count = self.reading_count();
        self.left_out = readings.into_iter().filter(|i| *i < count).collect();
        self.used = if self.left_out.is_empty() {
            Arc::clone(&self.measurements)
        } else {
            let left_out: Vec<usize> = self.left_out.iter().copied().collect();
            Arc::new(self.measurements.without(&left_out))
        };
    }

    /// Which readings of each incidence a fit uses.
    pub fn usage_of_incidences(&self) -> Vec<Usage> {
        if self.left_out.is_empty() {
            return vec![Usage::All; self.incidences.len()];
        }
        let incidences = self.measurements.incidences();
        let usage = |incidence: &brdf_fit::Incidence| {
            let readings = incidence.readings.iter();
            let left_out = readings.filter(|i| self.left_out.contains(i)).count();
            match left_out {
                0 => Usage::All,
                count if count == incidence.readings.len() => Usage::None,
                _ => Usage::Some,
            }
        };
        incidences.iter().map(usage).collect()
    }

    /// The readings that a fit uses.
    pub fn used(&self) -> &Arc<Measurements> {
        &self.used
    }

    /// The number of readings that a fit uses.
    pub fn used_count(&self) -> usize {
        self.used.readings().len()
    }

    /// The ratio of the largest to the smallest reading above zero; 1 without any.
    pub fn dynamic_range(&self) -> f64 {
        let brdf = self
            .measurements
            .readings()
            .iter()
            .map(|reading| reading.brdf);
        let (least, most) = brdf
            .filter(|brdf| *brdf > 0.0)
            .fold((f64::INFINITY, 0.0_f64), |(least, most), brdf| {
                (least.min(brdf), most.max(brdf))
            });
        if most > 0.0 { most / least } else { 1.0 }
    }

    /// Ends a change of the parameters, and returns it if they differ from the committed ones.
    /// `id` identifies this scan.
    pub fn commit(&mut self, id: ScanId) -> Option<Change> {
        let before = std::mem::replace(&mut self.committed, self.parameters);
        (before != self.parameters).then_some(Change {
            scan: id,
            before: Edited::Parameters(before),
            after: Edited::Parameters(self.parameters),
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

    /// The last fit, if the current parameters and the choice of readings are those of the fit.
    pub fn current_fit(&self) -> Option<&Arc<Report>> {
        let report = self.last_fit.as_ref()?;
        let fit = report.fit.as_ref()?;
        let is_unchanged =
            fit.model() == self.parameters.model && fit.at() == self.parameters.values;
        (is_unchanged && self.uses_readings_of(report)).then_some(report)
    }

    /// Whether the readings that are used are those of a fit.
    pub fn uses_readings_of(&self, report: &Report) -> bool {
        self.left_out.iter().eq(&report.left_out)
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
            convention: Convention::default(),
            modified: opened.file.as_deref().and_then(CurrentFiles::modified),
            has_changed_on_disk: false,
            file: opened.file,
            samples_in_source,
            family,
            visible: true,
            scans: opened.scans,
            current: 0,
        }
    }

    /// Whether a fit that the user has asked for, or a choice of readings, is not in a file.
    pub fn has_unsaved_work(&self) -> bool {
        self.scans.iter().any(|scan| scan.has_unsaved_work)
    }

    /// Notes whether the file of the readings has changed since it was opened.
    pub fn check_file(&mut self) {
        let now = self.file.as_deref().and_then(CurrentFiles::modified);
        self.has_changed_on_disk = now.is_some() && now != self.modified;
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

    /// The scans that are plotted, with their indices: the current one, and those beside it.
    pub fn plotted(&self) -> impl Iterator<Item = (usize, &Scan)> {
        let current = std::iter::once((self.current, self.scan()));
        let all = self.scans.iter().enumerate();
        current.chain(all.filter(|(i, scan)| scan.is_beside && *i != self.current))
    }

    /// The name of a scan in a plot: that of the sample, with the wavelength where several are plotted.
    pub fn name_of(&self, scan: &Scan) -> String {
        match scan.wavelength_um() {
            Some(um) if self.plotted().count() > 1 => format!("{}, {um} µm", self.name),
            _ => self.name.clone(),
        }
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

    /// The identifier of a scan, by the index of its wavelength.
    pub fn id_of(&self, wavelength: usize) -> ScanId {
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
