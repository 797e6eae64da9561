//! The two stages of the fit, and the check against the global optimum.

pub mod energy;
pub mod grid_search;
pub mod robust;
pub mod start;

use std::borrow::Cow;
use std::f64::consts::FRAC_PI_2;
use std::time::Instant;

use brdf_core::brdf::check_refractive_index;
use brdf_core::{ModelParameters, ParameterError, Parameters};
use serde::{Deserialize, Serialize};

use crate::fit::energy::{EnergyConstraint, conserve};
use crate::fit::grid_search::{ProfilePoint, Search};
use crate::fit::robust::{Loss, RobustFit, fit_robustly};
use crate::fit::start::{InitialValues, initial_values};
use crate::format::{as_degrees, as_optional_degrees, counted, in_degrees, shortest};
use crate::model::{DEFAULT_N, FixedParameters, Model, Parameter, ReducedModel};
use crate::objective::weights::Weights;
use crate::objective::{Objective, ObjectiveError};
use crate::progress::{Cancelled, NoObserver, Observer, Phase, Progress};
use crate::scan::RefractiveIndex;
use crate::scan::{Incidence, Measurement, Measurements, up_to};
use crate::solver::{Method, Termination, minimise};

pub use crate::objective::IncidenceError;

/// Version of the JSON that [`Fit`] is written as.
pub const FORMAT_VERSION: u32 = 1;

/// A minimum counts as lower when E there is lower by more than this fraction: below it, two ways
/// of summing the same minimum differ.
const LOWER: f64 = 1e-9;

/// E below which it is nothing but rounding, as a fraction.
pub(crate) const ROUNDING: f64 = 1e-20;

/// Far more iterations than Levenberg-Marquardt takes from a point of the search.
const POLISH_ITERATIONS: u64 = 1000;

/// Settings of a fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FitOptions {
    /// The model.
    #[serde(default)]
    pub model: Model,
    /// Refractive index; `None` takes what the measurements state. Where the model has n free, the
    /// fit starts there, or from [`DEFAULT_N`] where nobody states one.
    pub refractive_index: Option<RefractiveIndex>,
    /// Weights of the readings in E.
    pub weights: Weights,
    /// Where the first stage starts; `None` takes the paper's initial values.
    pub start: Option<ModelParameters>,
    /// Method of stage 1; `None` leaves the stage out.
    pub stage1: Option<Method>,
    /// Largest incidence angle of stage 1, in radians (in JSON in degrees, `stage1_limit_deg`).
    #[serde(rename = "stage1_limit_deg", with = "as_degrees")]
    pub stage1_limit: f64,
    /// Method of stage 2; `None` fits stage 1 alone: the fit, and all that it is worth, is then of
    /// the readings up to the limit of stage 1. One stage at least is asked for.
    pub stage2: Option<Method>,
    /// Largest number of iterations of each stage.
    pub max_iterations: u64,
    /// Whether the profile search over k1 checks the result of stage 2.
    pub global_check: bool,
    /// A loss other than the square, for data with outliers; `None` is the paper's E.
    #[serde(default)]
    pub robust: Option<Loss>,
    /// Fit under rho(psi) <= 1 up to this incidence, in radians (in JSON in degrees,
    /// `energy_limit_deg`); `None` leaves the fit free.
    #[serde(default, rename = "energy_limit_deg", with = "as_optional_degrees")]
    pub energy_limit: Option<f64>,
    /// The parameters that are fixed at a value instead of being fitted; the model frees them.
    #[serde(
        default,
        rename = "held",
        skip_serializing_if = "FixedParameters::is_empty"
    )]
    pub fixed: FixedParameters,
}

impl FitOptions {
    /// The model with what is fixed of it.
    pub fn reduced_model(&self) -> ReducedModel {
        ReducedModel::new(self.model, self.fixed)
    }

    /// The parameters that are fitted, in their order: the model's free ones that are not fixed.
    pub fn free(&self) -> Vec<Parameter> {
        self.reduced_model().free().to_vec()
    }

    /// The readings that a fit is of: those up to the limit of stage 1 where that is alone.
    pub fn fitted_readings<'a>(&self, measurements: &'a Measurements) -> Cow<'a, Measurements> {
        if self.stage2.is_some() {
            Cow::Borrowed(measurements)
        } else {
            Cow::Owned(measurements.up_to(self.stage1_limit))
        }
    }

    /// What a fit is of, where that is not all readings: `psi <= 60 deg`.
    pub(crate) fn scope(&self) -> Option<String> {
        let limit = in_degrees(self.stage1_limit);
        let alone = self.stage2.is_none();
        alone.then(|| format!("psi <= {limit} deg"))
    }

    /// The same for another model, which holds what it has of the fixed parameters.
    #[must_use]
    pub fn of_model(&self, model: Model) -> Self {
        Self {
            model,
            fixed: self.fixed.within(model),
            ..self.clone()
        }
    }
}

/// Levenberg-Marquardt in both stages: on the scans in `data/measured/` at n = 1.5 it reaches the
/// same optima as Nelder-Mead with 15 evaluations a stage instead of 343 (the column `eval.` of
/// `fit data/measured/*.csv --n 1.5`, with and without `--stage1 nm --stage2 nm`).
impl Default for FitOptions {
    fn default() -> Self {
        Self {
            model: Model::Three,
            refractive_index: None,
            weights: Weights::default(),
            start: None,
            stage1: Some(Method::LevenbergMarquardt),
            stage1_limit: 60_f64.to_radians(),
            stage2: Some(Method::LevenbergMarquardt),
            max_iterations: 10_000,
            global_check: true,
            robust: None,
            energy_limit: None,
            fixed: FixedParameters::none(),
        }
    }
}

/// A fit of one wavelength of a scan, with every step on the way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fit {
    /// [`FORMAT_VERSION`] of the program that wrote it.
    pub format_version: u32,
    /// Wavelength in micrometres, where the scan states one.
    pub wavelength_um: Option<f64>,
    /// Refractive index of the coating: as given, or as fitted where the model has it free.
    pub n: f64,
    /// Exponent of the facet distribution; 1 where the model has none.
    #[serde(default = "one")]
    pub p: f64,
    /// The settings of the fit.
    pub options: FitOptions,
    /// How many readings were fitted: all, or those of stage 1 where it is alone.
    pub readings: usize,
    /// How many of them have a weight of zero, and so no say.
    #[serde(rename = "weightless")]
    pub zero_weight: usize,
    /// The fitted parameters: those of the last stage, or of the lower minimum that the check found.
    pub parameters: Parameters,
    /// E over the fitted readings, in percent.
    pub e_percent: f64,
    /// E of each incidence by itself.
    pub incidences: Vec<IncidenceError>,
    /// The initial values.
    pub initial: InitialValues,
    /// E of the initial values over the readings of the first stage, and over all, in percent.
    pub initial_e_percent: OwnAndAll,
    /// Stage 1; `None` where it was left out.
    pub stage1: Option<Stage>,
    /// Why stage 1 was left out although it was asked for.
    pub stage1_left_out: Option<String>,
    /// Stage 2; `None` where stage 1 is alone.
    pub stage2: Option<Stage>,
    /// The check against the global optimum; `None` where it was left out.
    pub global_check: Option<GlobalCheck>,
    /// What another loss than the square did, where one was asked for.
    #[serde(default)]
    pub robust: Option<RobustFit>,
    /// What keeping energy did, where it was asked for.
    #[serde(default)]
    pub energy: Option<EnergyConstraint>,
    /// Time of the whole fit in seconds.
    pub seconds: f64,
}

/// E in percent over the readings of a stage, and over all readings.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OwnAndAll {
    /// Over the readings of the stage.
    pub own: f64,
    /// Over all readings.
    pub all: f64,
}

/// What one stage did.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Stage {
    /// Its method.
    pub method: Method,
    /// Where it ended.
    pub parameters: ModelParameters,
    /// E there.
    pub e_percent: OwnAndAll,
    /// How many readings it used.
    pub readings: usize,
    /// Its iterations.
    pub iterations: u64,
    /// How often it evaluated E, alone or with derivatives.
    pub evaluations: u64,
    /// Its time in seconds.
    pub seconds: f64,
    /// Why it stopped.
    #[serde(rename = "ending")]
    pub termination: Termination,
}

/// What the profile search over k1 found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GlobalCheck {
    /// Whether the last stage had missed a lower minimum, which then was taken.
    pub lower_minimum_taken: bool,
    /// E of the last stage before, over the fitted readings, in percent.
    pub stage2_e_percent: f64,
    /// The profile over k1: the lowest E at each; a single point where the model has no k1.
    pub profile: Vec<ProfilePoint>,
    /// The profile over n, where the model has it free.
    #[serde(default)]
    pub profile_n: Vec<ProfilePoint>,
    /// Its time in seconds.
    pub seconds: f64,
}

/// Why a scan cannot be fitted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FitError {
    /// More than one wavelength: each has parameters of its own.
    #[error("{0} wavelengths in one fit: split them with Measurements::by_wavelength")]
    SeveralWavelengths(usize),
    /// No refractive index for the wavelength.
    #[error(
        "no refractive index{}: give it with --n 1.5 or --n 0.63=1.60,0.85=1.58, by a column n, \
         or by a line \"# refractive_index: 1.5\" in the file",
        at_wavelength(*.0)
    )]
    NoRefractiveIndex(Option<f64>),
    /// The refractive index is outside of the model's domain.
    #[error(transparent)]
    RefractiveIndex(#[from] ParameterError),
    /// The limit of rho(psi) <= 1 is no incidence.
    #[error("rho(psi) <= 1 up to {0} deg: expected a limit from 0 to below 90 deg")]
    EnergyLimit(f64),
    /// No more readings than free parameters.
    #[error(
        "{}: {} need at least {}", counted(*.count, "reading"),
        counted(*.parameters, "free parameter"), .parameters + 1
    )]
    TooFewReadings {
        /// How many there are.
        count: usize,
        /// How many parameters the model has free.
        parameters: usize,
    },
    /// All readings have one value.
    #[error(
        "all {count} readings are {value} 1/sr: such data are kD = pi times that, and say nothing \
         of k2 and k1 (a saturated detector, a constant column?)"
    )]
    AllEqual {
        /// How many there are.
        count: usize,
        /// Their value.
        value: f64,
    },
    /// E is not defined.
    #[error(transparent)]
    Objective(#[from] ObjectiveError),
    /// Neither stage is asked for.
    #[error("no stage: ask for stage 1, for stage 2, or for both")]
    NoStage,
    /// Stage 1 is asked for alone, and has no readings that could be fitted.
    #[error("stage 1 alone cannot be fitted: {0}")]
    Stage1Alone(String),
    /// A parameter is fixed that the model does not fit.
    #[error(
        "{parameter} cannot be fixed: model {model} fits {}",
        .model.free().iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
    )]
    NotFree {
        /// The parameter.
        parameter: Parameter,
        /// The model.
        model: Model,
    },
    /// A parameter is fixed outside of its range.
    #[error(
        "{parameter} = {value} cannot be fixed: expected {}", in_range(*.parameter)
    )]
    FixedOutOfRange {
        /// The parameter.
        parameter: Parameter,
        /// Where it was to be fixed.
        value: f64,
    },
    /// The fixed parameters leave no fit under rho(psi) <= 1.
    #[error(
        "with the fixed parameters rho(psi) is above 1 before {0} deg, whatever the others are"
    )]
    FixedAboveEnergy(f64),
    /// A minimiser failed.
    #[error("the minimiser failed: {0}")]
    Solver(String),
    /// A [`Observer`] has cancelled the fit.
    #[error("cancelled")]
    Cancelled,
}

impl From<Cancelled> for FitError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

/// What ended a minimiser.
impl From<argmin::core::Error> for FitError {
    fn from(error: argmin::core::Error) -> Self {
        if error.is::<Cancelled>() {
            Self::Cancelled
        } else {
            Self::Solver(error.to_string())
        }
    }
}

impl FitError {
    /// Whether the user can mend it by other arguments, the readings being what they are.
    pub fn is_usage(&self) -> bool {
        matches!(
            self,
            Self::NoRefractiveIndex(_)
                | Self::RefractiveIndex(_)
                | Self::EnergyLimit(_)
                | Self::Objective(ObjectiveError::NoSigma)
                | Self::NoStage
                | Self::Stage1Alone(_)
                | Self::NotFree { .. }
                | Self::FixedOutOfRange { .. }
                | Self::FixedAboveEnergy(_)
        )
    }
}

fn at_wavelength(wavelength_um: Option<f64>) -> String {
    wavelength_um.map_or_else(String::new, |w| format!(" at {w} um"))
}

/// The values that a parameter can take, in words.
fn in_range(parameter: Parameter) -> String {
    match parameter.range() {
        (lowest, f64::INFINITY) => format!("a number from {lowest} on"),
        (lowest, highest) => format!("one from {} to {}", shortest(lowest), shortest(highest)),
    }
}

fn one() -> f64 {
    1.0
}

impl Fit {
    /// All parameters of the model.
    pub fn at(&self) -> ModelParameters {
        ModelParameters {
            p: self.p,
            ..ModelParameters::three(self.parameters, self.n)
        }
    }

    /// The model.
    pub fn model(&self) -> Model {
        self.options.model
    }

    /// The last of its stages.
    pub fn last_stage(&self) -> Option<&Stage> {
        self.stage2.as_ref().or(self.stage1.as_ref())
    }

    /// Whether a parameter was fitted: free in the model, and not fixed.
    pub fn fits(&self, parameter: Parameter) -> bool {
        self.options.reduced_model().frees(parameter)
    }

    /// Readings that have a say, less the fitted parameters.
    pub fn degrees_of_freedom(&self) -> usize {
        (self.readings - self.zero_weight).saturating_sub(self.options.free().len())
    }
}

/// Fits a model to a scan of one wavelength: initial values, stage 1 over the incidences up to the
/// limit, stage 2 over all (or one of the stages alone), and the check against the global optimum.
///
/// The result is the same in every run, but for the times.
pub fn fit(measurements: &Measurements, options: &FitOptions) -> Result<Fit, FitError> {
    fit_observed(measurements, options, &NoObserver)
}

/// [`fit`], each step of which is told to `observer`, who can end it with [`FitError::Cancelled`].
pub fn fit_observed(
    measurements: &Measurements,
    options: &FitOptions,
    observer: &dyn Observer,
) -> Result<Fit, FitError> {
    fit_scan(measurements, options, observer).map(|fitted| fitted.fit)
}

/// A fit with what it was made with.
pub(crate) struct Fitted {
    pub(crate) fit: Fit,
    /// The objective over all readings that was minimised, weights of a robust loss included.
    pub(crate) objective: Objective,
    /// The search of the global check.
    pub(crate) search: Option<Search>,
}

/// [`fit_observed`], with what it was made with.
pub(crate) fn fit_scan(
    measurements: &Measurements,
    options: &FitOptions,
    observer: &dyn Observer,
) -> Result<Fitted, FitError> {
    let started = Instant::now();
    if options.stage1.or(options.stage2).is_none() {
        return Err(FitError::NoStage);
    }
    if let Some(limit) = options
        .energy_limit
        .filter(|l| !(0.0..FRAC_PI_2).contains(l))
    {
        return Err(FitError::EnergyLimit(in_degrees(limit)));
    }
    let readings = measurements.readings();
    let wavelength_um = single_wavelength(measurements)?;
    options.fixed.check(options.model)?;
    let model = options.reduced_model();
    check_readings(measurements, model)?;
    let n = refractive_index(measurements, options, wavelength_um)?;

    // A robust loss looks at each reading.
    let all = match options.robust {
        None => Objective::condensed(measurements, model.family(), n, &options.weights)?,
        Some(_) => Objective::new(measurements, model.family(), n, &options.weights)?,
    };
    let incidences = measurements.incidences();
    let first = FirstStage::choose(&all, &incidences, options);
    if let (None, Some(reason)) = (options.stage2, &first.left_out) {
        return Err(FitError::Stage1Alone(reason.clone()));
    }
    let own = first.objective.as_ref().unwrap_or(&all);
    let fitted = options.stage2.map_or(own, |_| &all);
    let (count, zero_weight) = (fitted.count(), fitted.zero_weight());
    if !fitted.suffices_for(model.free()) {
        return Err(too_few(count - zero_weight, model));
    }
    let method1 = options.stage1.filter(|_| first.left_out.is_none());
    let before = Progress::before(observer, method1.map_or(Phase::Stage2, |_| Phase::Stage1));
    let (initial, start) = starting_point(readings, first.incidences, n, own, options, &before)?;

    let stage = |method, phase, own, start| {
        let progress = Progress::new(observer, phase);
        run(method, own, &all, start, options, &progress)
    };
    let stage1 = method1
        .map(|method| stage(method, Phase::Stage1, own, start))
        .transpose()?;
    let stage2_start = stage1.map_or(start, |stage| stage.parameters);
    let stage2 = options
        .stage2
        .map(|method| stage(method, Phase::Stage2, &all, stage2_start))
        .transpose()?;
    let last = stage2.or(stage1).ok_or(FitError::NoStage)?;
    let checked = check_globally(fitted, last, options, observer)?;
    let after = after_the_stages(fitted, checked.parameters, options, observer)?;
    let parameters = after.parameters;

    let fit = Fit {
        format_version: FORMAT_VERSION,
        wavelength_um,
        n: parameters.n,
        p: parameters.p,
        options: options.clone(),
        readings: count,
        zero_weight,
        parameters: parameters.parameters(),
        e_percent: 100.0 * fitted.error(&parameters),
        incidences: fitted.by_incidence(&parameters),
        initial_e_percent: own_and_all(own, &all, &start),
        initial,
        stage1,
        stage1_left_out: first.left_out,
        stage2,
        global_check: checked.report,
        robust: after.robust,
        energy: after.energy,
        seconds: started.elapsed().as_secs_f64(),
    };
    let alone = first.objective.filter(|_| options.stage2.is_none());
    Ok(Fitted {
        fit,
        objective: after.weighted.or(alone).unwrap_or(all),
        search: checked.search,
    })
}

/// What comes after the paper's stages, where it is asked for.
struct After {
    parameters: ModelParameters,
    /// The objective with the weights of a robust loss.
    weighted: Option<Objective>,
    robust: Option<RobustFit>,
    energy: Option<EnergyConstraint>,
}

fn after_the_stages(
    all: &Objective,
    parameters: ModelParameters,
    options: &FitOptions,
    observer: &dyn Observer,
) -> Result<After, FitError> {
    let mut after = After {
        parameters,
        weighted: None,
        robust: None,
        energy: None,
    };
    if let Some(loss) = options.robust {
        let progress = Progress::begin(observer, Phase::Robust)?;
        let (at, weighted, robust) = fit_robustly(
            all,
            loss,
            parameters,
            options.reduced_model().free(),
            &progress,
        )?;
        (after.parameters, after.weighted, after.robust) = (at, Some(weighted), Some(robust));
    }
    if let Some(limit) = options.energy_limit {
        let objective = after.weighted.as_ref().unwrap_or(all);
        let free = after.parameters;
        let progress = Progress::begin(observer, Phase::Energy)?;
        after.parameters = conserve(objective, options.reduced_model(), &free, limit, &progress)?;
        after.energy = Some(EnergyConstraint {
            limit_deg: in_degrees(limit),
            free,
            free_e_percent: 100.0 * all.error(&free),
            binding: after.parameters != free,
        });
    }
    Ok(after)
}

/// Where the first stage of a fit starts: the paper's initial values, or the start of the options.
pub fn starting_values(
    measurements: &Measurements,
    options: &FitOptions,
) -> Result<ModelParameters, FitError> {
    let wavelength_um = single_wavelength(measurements)?;
    let n = refractive_index(measurements, options, wavelength_um)?;
    let all = Objective::condensed(measurements, options.model.family(), n, &options.weights)?;
    let incidences = measurements.incidences();
    let first = FirstStage::choose(&all, &incidences, options);
    let own = first.objective.as_ref().unwrap_or(&all);
    let progress = Progress::new(&NoObserver, Phase::Stage1);
    let (_, start) = starting_point(
        measurements.readings(),
        first.incidences,
        n,
        own,
        options,
        &progress,
    )?;
    Ok(start)
}

/// The initial values, and the start of the first stage: they with what the model has besides.
fn starting_point(
    readings: &[Measurement],
    incidences: &[Incidence],
    n: f64,
    own: &Objective,
    options: &FitOptions,
    progress: &Progress<'_>,
) -> Result<(InitialValues, ModelParameters), Cancelled> {
    let model = options.reduced_model();
    let Some(given) = options.start else {
        let mut initial = initial_values(readings, incidences, n, own, progress)?;
        initial.parameters = at_fixed_values(&options.fixed, initial.parameters);
        let start = ModelParameters::three(initial.parameters, n);
        return Ok((initial, model.start(start)));
    };
    let initial = InitialValues {
        parameters: at_fixed_values(&options.fixed, given.parameters()),
        weights: None,
        width: None,
    };
    let n = if model.frees(Parameter::N) {
        given.n
    } else {
        n
    };
    Ok((initial, model.start(ModelParameters { n, ..given })))
}

/// The weights and the width with the values that they are fixed at.
fn at_fixed_values(fixed: &FixedParameters, at: Parameters) -> Parameters {
    Parameters {
        k2: fixed.get(Parameter::K2).unwrap_or(at.k2),
        kd: fixed.get(Parameter::Kd).unwrap_or(at.kd),
        k1: fixed.get(Parameter::K1).unwrap_or(at.k1),
    }
}

/// The refractive index that is fixed, or that the options or the measurements state, or the usual one where it is
/// only a start.
fn refractive_index(
    measurements: &Measurements,
    options: &FitOptions,
    wavelength_um: Option<f64>,
) -> Result<f64, FitError> {
    let stated = options.fixed.get(Parameter::N).or_else(|| {
        let index = options.refractive_index.as_ref();
        index
            .or(measurements.refractive_index.as_ref())
            .and_then(|index| index.at(wavelength_um))
    });
    // It is where n starts, or nothing depends on it.
    let needed = !options.model.frees(Parameter::N) && options.model.frees(Parameter::K2);
    let usual = (!needed).then_some(DEFAULT_N);
    let n = stated
        .or(usual)
        .ok_or(FitError::NoRefractiveIndex(wavelength_um))?;
    Ok(check_refractive_index(n)?)
}

fn too_few(count: usize, model: ReducedModel) -> FitError {
    FitError::TooFewReadings {
        count,
        parameters: model.free().len(),
    }
}

fn single_wavelength(measurements: &Measurements) -> Result<Option<f64>, FitError> {
    match measurements.wavelengths().as_slice() {
        [] => Ok(None),
        [wavelength] => Ok(*wavelength),
        several => Err(FitError::SeveralWavelengths(several.len())),
    }
}

fn check_readings(measurements: &Measurements, model: ReducedModel) -> Result<(), FitError> {
    let readings = measurements.readings();
    if readings.len() <= model.free().len() {
        return Err(too_few(readings.len(), model));
    }
    let value = readings[0].brdf;
    // Of kD alone they say everything.
    let undetermined = model.free() != [Parameter::Kd];
    if undetermined && value != 0.0 && readings.iter().all(|reading| reading.brdf == value) {
        return Err(FitError::AllEqual {
            count: readings.len(),
            value,
        });
    }
    Ok(())
}

/// The readings of stage 1, or why there are none.
struct FirstStage<'a> {
    incidences: &'a [Incidence],
    /// `None` where they are all readings.
    objective: Option<Objective>,
    left_out: Option<String>,
}

impl<'a> FirstStage<'a> {
    fn choose(all: &Objective, incidences: &'a [Incidence], options: &FitOptions) -> Self {
        let chosen = up_to(incidences, options.stage1_limit);
        let readings: usize = chosen
            .iter()
            .map(|incidence| incidence.readings.len())
            .sum();
        let everything = |left_out| Self {
            incidences,
            objective: None,
            left_out,
        };
        if options.stage1.is_none() || readings == all.count() {
            return everything(None);
        }
        if readings <= options.reduced_model().free().len() {
            let limit_deg = in_degrees(options.stage1_limit);
            let count = counted(readings, "reading");
            return everything(Some(format!("{count} up to {limit_deg} deg")));
        }
        match all.subset(|i| i < chosen.len()) {
            Ok(objective) => Self {
                incidences: chosen,
                objective: Some(objective),
                left_out: None,
            },
            Err(error) => everything(Some(error.to_string())),
        }
    }
}

fn run(
    method: Method,
    own: &Objective,
    all: &Objective,
    start: ModelParameters,
    options: &FitOptions,
    progress: &Progress<'_>,
) -> Result<Stage, FitError> {
    let started = Instant::now();
    let model = options.reduced_model();
    let most = options.max_iterations;
    let minimum = minimise(own, method, start, model.free(), most, progress)?;
    Ok(Stage {
        method,
        parameters: minimum.parameters,
        e_percent: own_and_all(own, all, &minimum.parameters),
        readings: own.count(),
        iterations: minimum.iterations,
        evaluations: minimum.evaluations,
        seconds: started.elapsed().as_secs_f64(),
        termination: minimum.termination,
    })
}

fn own_and_all(own: &Objective, all: &Objective, parameters: &ModelParameters) -> OwnAndAll {
    OwnAndAll {
        own: 100.0 * own.error(parameters),
        all: 100.0 * all.error(parameters),
    }
}

/// The minimum next to a point, whatever the options say of methods and iterations.
pub(crate) fn polish(
    objective: &Objective,
    from: ModelParameters,
    free: &[Parameter],
    progress: &Progress<'_>,
) -> Result<ModelParameters, FitError> {
    let method = Method::LevenbergMarquardt;
    minimise(objective, method, from, free, POLISH_ITERATIONS, progress)
        .map(|minimum| minimum.parameters)
}

/// What the global check came to; the parameters are those of the last stage where it is left out.
struct Checked {
    parameters: ModelParameters,
    report: Option<GlobalCheck>,
    search: Option<Search>,
}

/// Looks for a minimum below that of the last stage, and takes it where there is one.
fn check_globally(
    objective: &Objective,
    last: Stage,
    options: &FitOptions,
    observer: &dyn Observer,
) -> Result<Checked, FitError> {
    let mut parameters = last.parameters;
    if !options.global_check {
        return Ok(Checked {
            parameters,
            report: None,
            search: None,
        });
    }
    let started = Instant::now();
    let progress = Progress::begin(observer, Phase::GlobalCheck)?;
    let model = options.reduced_model();
    let search = Search::new(objective, model, &progress)?;
    let profile = search.whole();
    for minimum in profile.minima() {
        // The minimum that was found is in this valley, and not above its grid point.
        let here = objective.error(&parameters);
        if profile.is_next_to(&minimum, &parameters) && here <= objective.error(&minimum.parameters)
        {
            continue;
        }
        let polished = polish(objective, minimum.parameters, model.free(), &progress)?;
        if objective.error(&polished) < here * (1.0 - LOWER) - ROUNDING {
            parameters = polished;
        }
    }
    let report = GlobalCheck {
        lower_minimum_taken: parameters != last.parameters,
        stage2_e_percent: last.e_percent.own,
        profile: profile.along(Parameter::K1),
        profile_n: if model.frees(Parameter::N) {
            profile.along(Parameter::N)
        } else {
            Vec::new()
        },
        seconds: started.elapsed().as_secs_f64(),
    };
    Ok(Checked {
        parameters,
        report: Some(report),
        search: Some(search),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{Depth, Picture, Report, html, report_figures};
    use crate::scan::synthetic::scan;

    fn truth() -> Parameters {
        Parameters::new(0.3, 0.1, 0.2).unwrap()
    }

    fn options() -> FitOptions {
        FitOptions {
            refractive_index: Some(RefractiveIndex::Same(1.5)),
            ..FitOptions::default()
        }
    }

    /// The scan without the incidences that `keep` refuses.
    fn scan_with(keep: impl Fn(&Measurement) -> bool) -> Measurements {
        let all = scan(truth(), 1.5);
        let readings = all.readings().iter().copied().filter(keep).collect();
        Measurements::new("test", readings).unwrap()
    }

    #[test]
    fn stage_1_uses_the_incidences_up_to_its_limit_and_stage_2_all() {
        let fit = fit(&scan(truth(), 1.5), &options()).unwrap();
        let up_to_60: usize = fit
            .incidences
            .iter()
            .filter(|i| i.psi_deg <= 60.0)
            .map(|i| i.readings)
            .sum();
        assert_eq!(fit.stage1.unwrap().readings, up_to_60);
        assert_eq!(fit.stage2.unwrap().readings, fit.readings);
        assert!(up_to_60 < fit.readings);
    }

    #[test]
    fn stage_1_without_readings_is_left_out_and_says_why() {
        let fit = fit(&scan_with(|r| r.psi > 1.1), &options()).unwrap();
        assert_eq!(fit.stage1, None);
        assert_eq!(
            fit.stage1_left_out.as_deref(),
            Some("0 readings up to 60 deg")
        );
    }

    #[test]
    fn a_given_start_is_where_the_first_stage_starts() {
        let start = ModelParameters::three(Parameters::new(1.0, 1.0, 1.0).unwrap(), 1.5);
        let fit = fit(
            &scan(truth(), 1.5),
            &FitOptions {
                start: Some(start),
                ..options()
            },
        )
        .unwrap();
        assert_eq!(fit.initial.parameters, start.parameters());
        assert_eq!(fit.initial.weights, None);
    }

    #[test]
    fn a_minimum_that_stage_2_missed_is_taken() {
        let hurried = FitOptions {
            start: Some(ModelParameters::three(
                Parameters::new(1.0, 1.0, 1.0).unwrap(),
                1.5,
            )),
            max_iterations: 1,
            ..options()
        };
        let fit = fit(&scan(truth(), 1.5), &hurried).unwrap();
        let check = fit.global_check.unwrap();
        assert!(check.lower_minimum_taken && check.stage2_e_percent > fit.e_percent);
        assert!((fit.parameters.k1 / 0.2 - 1.0).abs() < 1e-5);
    }

    #[test]
    fn the_size_of_the_readings_does_not_matter() {
        for size in [1e-20, 1e20] {
            let mut readings = scan(truth(), 1.5).readings().to_vec();
            for (i, reading) in readings.iter_mut().enumerate() {
                reading.brdf *= size * (1.0 + 0.1 * (i as f64).sin());
            }
            let scan = Measurements::new("test", readings).unwrap();
            let fit = fit(&scan, &options()).unwrap();
            assert!((fit.parameters.k1 / 0.2 - 1.0).abs() < 0.1);
            assert!((fit.parameters.k2 / (0.3 * size) - 1.0).abs() < 0.1);
            let report = Report::new(&scan, &options(), Depth::Fit).0;
            assert_eq!(report.warnings.len(), usize::from(size > 1.0));
        }
    }

    #[test]
    fn readings_that_weigh_nothing_are_counted_and_do_not_count() {
        let mut options = options();
        options.weights.g1 = "0=1,5=0".parse().unwrap();
        let found = fit(&scan(truth(), 1.5), &options).unwrap();
        assert_eq!(
            found.readings - found.zero_weight,
            found.incidences[0].readings
        );
        options.weights.g1 = "0=0,1=0".parse().unwrap();
        let scan = scan_with(|r| r.psi > 0.1);
        assert_eq!(
            fit(&scan, &options),
            Err(FitError::Objective(ObjectiveError::AllZero))
        );
    }

    #[test]
    fn several_wavelengths_are_refused() {
        let mut readings = scan(truth(), 1.5).readings().to_vec();
        readings[0].wavelength_um = Some(0.5);
        readings[1].wavelength_um = Some(0.6);
        let several = Measurements::new("test", readings).unwrap();
        assert_eq!(
            fit(&several, &options()),
            Err(FitError::SeveralWavelengths(3))
        );
    }

    #[test]
    fn the_refractive_index_of_the_options_goes_before_that_of_the_file() {
        let mut scan = scan(truth(), 1.5);
        assert_eq!(
            fit(&scan, &FitOptions::default()),
            Err(FitError::NoRefractiveIndex(None))
        );
        scan.refractive_index = Some(RefractiveIndex::Same(1.7));
        assert_eq!(fit(&scan, &FitOptions::default()).unwrap().n, 1.7);
        assert_eq!(fit(&scan, &options()).unwrap().n, 1.5);
    }

    #[test]
    fn the_json_reads_back() {
        let fit = fit(&scan(truth(), 1.5), &options()).unwrap();
        let json = serde_json::to_string(&fit).unwrap();
        assert!(json.contains("\"stage1_limit_deg\":60.0"));
        let back: Fit = serde_json::from_str(&json).unwrap();
        assert!(back == fit, "the numbers differ");
    }

    fn alone() -> FitOptions {
        FitOptions {
            stage2: None,
            ..options()
        }
    }

    fn rippled() -> Measurements {
        let mut readings = scan(truth(), 1.5).readings().to_vec();
        for (i, reading) in readings.iter_mut().enumerate() {
            reading.brdf *= 1.0 + 0.05 * (2.4 * i as f64).sin();
        }
        Measurements::new("test", readings).unwrap()
    }

    /// All of it is that of a scan that ends at the limit.
    #[test]
    fn stage_1_alone_is_the_fit_of_a_scan_that_ends_at_its_limit() {
        let (whole, options) = (rippled(), alone());
        let shorter = whole.up_to(options.stage1_limit);
        let (report, error) = Report::new(&whole, &options, Depth::Assessed);
        assert_eq!(error, None);
        let (expected, _) = Report::new(&shorter, &self::options(), Depth::Assessed);
        let fit = report.fit.as_ref().unwrap();
        let short_fit = expected.fit.as_ref().unwrap();
        let same = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-6, "{a} {b}");
        assert_eq!((fit.readings, fit.stage2), (shorter.readings().len(), None));
        assert_eq!(fit.incidences.len(), short_fit.incidences.len());
        same(fit.e_percent, short_fit.e_percent);
        same(fit.parameters.k1, short_fit.parameters.k1);
        let check = fit.global_check.as_ref().unwrap();
        assert!(!check.lower_minimum_taken);
        same(check.stage2_e_percent, fit.e_percent);
        let errors = |report: &Report| {
            let covariance = &report.uncertainty.as_ref().unwrap().covariance;
            [covariance[0][0], covariance[2][2]]
        };
        same(errors(&report)[0], errors(&expected)[0]);
        same(errors(&report)[1], errors(&expected)[1]);
        let assessed = [&report, &expected].map(|r| r.assessment.as_ref().unwrap());
        assert_eq!(assessed[0].readings, assessed[1].readings);
        for (a, b) in assessed[0].models.iter().zip(&assessed[1].models) {
            same(a.e_percent, b.e_percent);
            same(
                a.predicted_e_percent.unwrap(),
                b.predicted_e_percent.unwrap(),
            );
        }
        assert_eq!(report.warnings.len(), expected.warnings.len());
        // E over all readings is told of the stage alone.
        let stage = fit.stage1.unwrap();
        let family = options.model.family();
        let all = Objective::new(&whole, family, 1.5, &options.weights).unwrap();
        same(stage.e_percent.all, 100.0 * all.error(&stage.parameters));
        assert!(stage.e_percent.all != stage.e_percent.own);
    }

    #[test]
    fn what_was_fitted_of_stage_1_alone_is_said() {
        let (report, _) = Report::new(&rippled(), &alone(), Depth::Fit);
        assert_eq!(report.status(), "ok (stage 1 alone)");
        let (text, readings) = (report.text(), report.fit.as_ref().unwrap().readings);
        let line =
            format!("stage 1 alone: all results below are for psi <= 60 deg, {readings} readings");
        assert!(text.contains(&line) && !text.contains("stage 2"), "{text}");
        let figures = report_figures(&rippled(), &report).unwrap();
        let said = |f: &crate::plot::Figure| f.caption.contains("fitted to psi <= 60 deg alone");
        assert!(figures.iter().all(said));
        let pictures: Vec<Picture> = figures.iter().map(Picture::from).collect();
        let page = html(&[(&report, &pictures)]);
        assert!(page.contains("stage 1 alone, psi &lt;= 60 deg"));
    }

    #[test]
    fn stages_that_cannot_be_are_errors_of_usage() {
        let none = FitOptions {
            stage1: None,
            ..alone()
        };
        assert_eq!(fit(&rippled(), &none), Err(FitError::NoStage));
        let steep = scan_with(|r| r.psi > 1.1);
        let error = fit(&steep, &alone()).unwrap_err();
        assert!(error.is_usage() && FitError::NoStage.is_usage());
        assert!(
            error.to_string().contains("0 readings up to 60 deg"),
            "{error}"
        );
    }

    #[test]
    fn options_from_elsewhere_are_checked() {
        let with = |n: f64, limit_deg: f64| FitOptions {
            refractive_index: Some(RefractiveIndex::Same(n)),
            energy_limit: Some(limit_deg.to_radians()),
            ..options()
        };
        for (options, message) in [
            (with(0.5, 80.0), "refractive index n = 0.5"),
            (with(f64::NAN, 80.0), "refractive index n = NaN"),
            (with(1.5, 95.0), "up to 95 deg"),
            (with(1.5, -5.0), "up to -5 deg"),
        ] {
            let error = fit(&rippled(), &options).unwrap_err();
            assert!(
                error.is_usage() && error.to_string().contains(message),
                "{error}"
            );
        }
    }

    /// Written before stage 2 could be left out.
    #[test]
    fn the_json_of_two_stages_is_what_it_was() {
        let fit = fit(&rippled(), &options()).unwrap();
        let json = serde_json::to_value(&fit).unwrap();
        assert_eq!(json["options"]["stage2"], "levenberg-marquardt");
        assert!(json["stage2"]["iterations"].is_u64());
        let alone = serde_json::to_value(super::fit(&rippled(), &alone()).unwrap()).unwrap();
        assert!(alone["stage2"].is_null() && alone["options"]["stage2"].is_null());
        let back: Fit = serde_json::from_value(alone).unwrap();
        assert_eq!((back.stage2, back.options.stage2), (None, None));
    }
}
