//! A scan and the options of its fit, validated once: everything that minimises or evaluates E
//! starts here.

use std::borrow::Cow;
use std::f64::consts::FRAC_PI_2;
use web_time::Instant;

use brdf_core::check_refractive_index;
use brdf_core::{ModelParameters, Parameters};

use super::energy::{EnergyConstraint, constrain_energy};
use super::error::FitError;
use super::first_stage::FirstStage;
use super::global_check::{Checked, check_globally};
use super::grid_search::GridSearch;
use super::options::FitOptions;
use super::relative::{RelativeFit, fit_relatively};
use super::result::{FORMAT_VERSION, Fit, OwnAndAll, Stage};
use super::robust::{RobustFit, RobustWeights, fit_robustly};
use super::solution::{Searched, Solution};
use super::start::{InitialValues, Section, initial_values};
use crate::format::in_degrees;
use crate::model::{DEFAULT_N, FixedParameters, Parameter, ReducedModel};
use crate::objective::weights::AssumedErrors;
use crate::objective::{Objective, Segment};
use crate::progress::{Cancelled, NoObserver, Observer, Phase, Progress};
use crate::scan::{Incidence, Measurements};
use crate::solver::{Method, minimise};

/// The problem of fitting one model to a scan of one wavelength.
///
/// It holds the scan, the refractive index, the model with its fixed parameters, the objective E
/// over all readings, and the readings of the first stage.
#[derive(Debug, Clone)]
pub struct FitProblem<'a> {
    measurements: &'a Measurements,
    options: &'a FitOptions,
    wavelength_um: Option<f64>,
    n: f64,
    model: ReducedModel,
    all: Objective,
    first_stage: FirstStage,
}

impl<'a> FitProblem<'a> {
    /// Validates a scan and the options, and builds the objective.
    ///
    /// A problem with too few readings for a fit is valid: E can be evaluated, and
    /// [`solve`](Self::solve) returns the error.
    ///
    /// # Errors
    ///
    /// No stage is requested; the scan has several wavelengths or no reading; no refractive index is
    /// known; an option is outside its domain; or E is not defined for these readings and weights.
    pub fn new(measurements: &'a Measurements, options: &'a FitOptions) -> Result<Self, FitError> {
        if options.stage1.or(options.stage2).is_none() {
            return Err(FitError::NoStage);
        }
        if let Some(limit) = options.energy_limit {
            check_energy_limit(limit)?;
        }
        let wavelength_um = single_wavelength(measurements)?;
        options.fixed.check(options.model)?;
        let model = options.reduced_model();
        if measurements.readings().is_empty() {
            return Err(too_few(0, model));
        }
        let n = refractive_index(measurements, options, wavelength_um)?;
        // These weigh each reading by itself.
        let relative = options.weights.errors == AssumedErrors::Relative;
        let build = if options.robust.is_some() || relative {
            Objective::new
        } else {
            Objective::condensed
        };
        let all = build(measurements, model.family(), n, &options.weights)?;
        let first_stage = FirstStage::choose(&all, measurements, options);
        Ok(Self {
            measurements,
            options,
            wavelength_um,
            n,
            model,
            all,
            first_stage,
        })
    }

    /// The refractive index: as stated, or where its fit starts.
    pub fn n(&self) -> f64 {
        self.n
    }

    /// The model with its fixed parameters.
    pub fn model(&self) -> ReducedModel {
        self.model
    }

    /// The objective over the readings that the fit is of: all, or those of stage 1 where it is
    /// alone.
    pub fn objective(&self) -> &Objective {
        self.first_stage.objective.as_ref().unwrap_or(&self.all)
    }

    /// [`objective`](Self::objective), by value.
    pub fn into_objective(self) -> Objective {
        self.first_stage.objective.unwrap_or(self.all)
    }

    /// E of eq. (5) as a fraction, over the readings that the fit is of.
    pub fn error_at(&self, parameters: &ModelParameters) -> f64 {
        self.objective().error(parameters)
    }

    /// Where the first stage starts: the paper's initial values (section 3 of Li, Yan and Wu 2002),
    /// or the start that the options give, within the ranges of the parameters.
    pub fn start(&self) -> ModelParameters {
        let progress = Progress::new(&NoObserver, Phase::Stage1);
        match self.starting_point(&self.first_objective(), &progress) {
            Ok((_, start)) => start,
            Err(Cancelled) => unreachable!("NoObserver never cancels"),
        }
    }

    /// Fits the model: stage 1 over the incidences up to the limit, stage 2 over all (or one of the
    /// stages alone), the check against the global optimum, and the robust loss and the energy
    /// constraint where the options ask for them.
    ///
    /// Each iteration is reported to `observer`, which may cancel the fit. The result is the same in
    /// every run, except for the times.
    ///
    /// # Errors
    ///
    /// Too few readings influence the fit, all readings have one value, the constraints contradict
    /// each other, a minimiser fails, or the observer cancels.
    pub fn solve(&self, observer: &dyn Observer) -> Result<Fit, FitError> {
        self.run(observer).map(|run| run.fit)
    }

    /// [`solve`](Self::solve), with the objects that further inference starts from.
    pub(crate) fn into_solution(self, observer: &dyn Observer) -> Result<Solution, FitError> {
        let Run {
            fit,
            weighted,
            search,
            robust,
        } = self.run(observer)?;
        Ok(Solution {
            fit,
            objective: weighted.unwrap_or_else(|| self.into_objective()),
            search,
            robust,
        })
    }

    fn run(&self, observer: &dyn Observer) -> Result<Run, FitError> {
        let started = Instant::now();
        self.check_solvable()?;
        let options = self.options;
        let (own, fitted) = (self.first_objective(), self.objective());
        let first_method = options
            .stage1
            .filter(|_| self.first_stage.left_out.is_none());
        let first_phase = first_method.map_or(Phase::Stage2, |_| Phase::Stage1);
        let progress = Progress::preparing(observer, first_phase);
        let (initial, start) = self.starting_point(&own, &progress)?;
        let initial_e_percent = self.own_and_all(&own, &start);
        let stage1 = first_method
            .map(|method| self.run_stage(method, &own, start, Phase::Stage1, observer))
            .transpose()?;
        drop(own);
        let stage2_start = stage1.map_or(start, |stage| stage.parameters);
        let stage2 = options
            .stage2
            .map(|method| self.run_stage(method, &self.all, stage2_start, Phase::Stage2, observer))
            .transpose()?;
        let last = stage2.or(stage1).ok_or(FitError::NoStage)?;
        let checked = if options.global_check {
            check_globally(fitted, &last, self.model, observer)?
        } else {
            Checked::skipped(&last)
        };
        let refined = self.refine(checked.parameters, observer)?;
        let parameters = refined.parameters;

        let fit = Fit {
            format_version: FORMAT_VERSION,
            wavelength_um: self.wavelength_um,
            n: parameters.n,
            p: parameters.p,
            options: options.clone(),
            readings: fitted.count(),
            zero_weight: fitted.zero_weight(),
            parameters: parameters.parameters(),
            e_percent: 100.0 * fitted.error(&parameters),
            incidences: fitted.by_incidence(&parameters),
            initial_e_percent,
            initial,
            stage1,
            stage1_left_out: self.first_stage.left_out.clone(),
            stage2,
            global_check: checked.report,
            relative: refined.relative,
            robust: refined.robust,
            energy: refined.energy,
            seconds: started.elapsed().as_secs_f64(),
        };
        let of_check = checked.search.map(|search| Searched {
            search,
            objective: refined.weighted.is_some().then(|| fitted.clone()),
        });
        Ok(Run {
            fit,
            weighted: refined.weighted,
            search: refined.search.or(of_check),
            robust: refined.robust_weights,
        })
    }

    /// The grid search over the readings that the fit is of.
    pub(crate) fn grid_search(&self, progress: &Progress<'_>) -> Result<GridSearch, Cancelled> {
        GridSearch::new(self.objective(), self.model, progress)
    }

    /// E over the readings of the first stage.
    fn first_objective(&self) -> Cow<'_, Objective> {
        let FirstStage {
            part, objective, ..
        } = &self.first_stage;
        match (part, objective) {
            (None, _) => Cow::Borrowed(&self.all),
            (Some(_), Some(own)) => Cow::Borrowed(own),
            (Some(count), None) => match self.all.subset(|i| i < *count) {
                Ok(own) => Cow::Owned(own),
                Err(_) => unreachable!("E is defined for the readings of the stage"),
            },
        }
    }

    /// Checks that the readings suffice for the stages that the options ask for.
    fn check_solvable(&self) -> Result<(), FitError> {
        self.check_readings()?;
        if let (None, Some(reason)) = (self.options.stage2, &self.first_stage.left_out) {
            return Err(FitError::Stage1Alone(reason.clone()));
        }
        self.check_count()
    }

    /// Checks that more readings influence E than parameters are free.
    pub(crate) fn check_count(&self) -> Result<(), FitError> {
        let fitted = self.objective();
        if fitted.suffices_for(self.model.free()) {
            return Ok(());
        }
        Err(too_few(fitted.count() - fitted.zero_weight(), self.model))
    }

    fn check_readings(&self) -> Result<(), FitError> {
        let readings = self.measurements.readings();
        let free = self.model.free();
        if readings.len() <= free.len() {
            return Err(too_few(readings.len(), self.model));
        }
        let value = readings[0].brdf;
        // Equal readings determine kD alone.
        let undetermined = free != [Parameter::Kd];
        if undetermined && value != 0.0 && readings.iter().all(|reading| reading.brdf == value) {
            return Err(FitError::AllEqual {
                count: readings.len(),
                value,
            });
        }
        Ok(())
    }

    /// The initial values, and the start of the first stage: the initial values completed by the
    /// further parameters of the model.
    fn starting_point(
        &self,
        objective: &Objective,
        progress: &Progress<'_>,
    ) -> Result<(InitialValues, ModelParameters), Cancelled> {
        let fixed = &self.options.fixed;
        let Some(given) = self.options.start else {
            let readings = self.measurements.readings();
            let sections: Vec<Section> = if objective.readings().is_empty() {
                let incidences = self.first_stage.incidences.iter();
                let section = |incidence: &Incidence| {
                    Section::new(incidence.psi, &incidence.readings, readings)
                };
                incidences.map(section).collect()
            } else {
                let segments = objective.segments().iter();
                let section = |segment: &Segment| {
                    let own = &objective.readings()[segment.rows.clone()];
                    Section::new(segment.psi, own, readings)
                };
                segments.map(section).collect()
            };
            let mut initial = initial_values(&sections, self.n, objective, progress)?;
            initial.parameters = with_fixed(fixed, initial.parameters);
            let start = ModelParameters::three(initial.parameters, self.n);
            return Ok((initial, self.model.start(start)));
        };
        let initial = InitialValues {
            parameters: with_fixed(fixed, given.parameters()),
            weights: None,
            width: None,
        };
        let n = if self.model.frees(Parameter::N) {
            given.n
        } else {
            self.n
        };
        Ok((initial, self.model.start(ModelParameters { n, ..given })))
    }

    fn run_stage(
        &self,
        method: Method,
        own: &Objective,
        start: ModelParameters,
        phase: Phase,
        observer: &dyn Observer,
    ) -> Result<Stage, FitError> {
        let started = Instant::now();
        let progress = Progress::new(observer, phase);
        let most = self.options.max_iterations;
        let minimum = minimise(own, method, start, self.model.free(), most, &progress)?;
        Ok(Stage {
            method,
            parameters: minimum.parameters,
            e_percent: self.own_and_all(own, &minimum.parameters),
            readings: own.count(),
            iterations: minimum.iterations,
            evaluations: minimum.evaluations,
            seconds: started.elapsed().as_secs_f64(),
            termination: minimum.termination,
        })
    }

    fn own_and_all(&self, own: &Objective, parameters: &ModelParameters) -> OwnAndAll {
        OwnAndAll {
            own: 100.0 * own.error(parameters),
            all: 100.0 * self.all.error(parameters),
        }
    }

    /// What follows the paper's two stages where the options ask for it.
    fn refine(
        &self,
        parameters: ModelParameters,
        observer: &dyn Observer,
    ) -> Result<Refined, FitError> {
        let mut refined = Refined {
            parameters,
            weighted: None,
            relative: None,
            search: None,
            robust: None,
            robust_weights: None,
            energy: None,
        };
        if self.options.weights.errors == AssumedErrors::Relative {
            let progress = Progress::begin(observer, Phase::Relative)?;
            let found = fit_relatively(self.objective(), self.model, &progress)?;
            refined.relative = Some(RelativeFit {
                least_squares: parameters,
                least_squares_e_percent: 100.0 * self.objective().error(&parameters),
            });
            refined.parameters = found.at;
            refined.weighted = Some(found.objective);
            refined.search = Some(Searched {
                search: found.search,
                objective: Some(found.searched),
            });
        }
        if let Some(loss) = self.options.robust {
            let progress = Progress::begin(observer, Phase::Robust)?;
            let (at, weighted, robust, weights) = fit_robustly(
                refined.weighted.as_ref().unwrap_or(self.objective()),
                loss,
                refined.parameters,
                self.model.free(),
                &progress,
            )?;
            (refined.parameters, refined.weighted) = (at, Some(weighted));
            (refined.robust, refined.robust_weights) = (Some(robust), Some(weights));
        }
        if let Some(limit) = self.options.energy_limit {
            let objective = refined.weighted.as_ref().unwrap_or(self.objective());
            let free = refined.parameters;
            let progress = Progress::begin(observer, Phase::Energy)?;
            refined.parameters = constrain_energy(objective, self.model, &free, limit, &progress)?;
            refined.energy = Some(EnergyConstraint {
                limit_deg: in_degrees(limit),
                free,
                free_e_percent: 100.0 * self.objective().error(&free),
                binding: refined.parameters != free,
            });
        }
        Ok(refined)
    }
}

/// A fit with the objects that it was made with.
struct Run {
    fit: Fit,
    /// The objective with the weights of relative errors and of a robust loss.
    weighted: Option<Objective>,
    search: Option<Searched>,
    robust: Option<RobustWeights>,
}

/// The result of the weights of relative errors, the robust loss and the energy constraint.
struct Refined {
    parameters: ModelParameters,
    /// The objective with the weights of relative errors and of a robust loss.
    weighted: Option<Objective>,
    relative: Option<RelativeFit>,
    search: Option<Searched>,
    robust: Option<RobustFit>,
    robust_weights: Option<RobustWeights>,
    energy: Option<EnergyConstraint>,
}

/// The weights and the width, with the values of those that are fixed.
fn with_fixed(fixed: &FixedParameters, at: Parameters) -> Parameters {
    Parameters {
        k2: fixed.get(Parameter::K2).unwrap_or(at.k2),
        kd: fixed.get(Parameter::Kd).unwrap_or(at.kd),
        k1: fixed.get(Parameter::K1).unwrap_or(at.k1),
    }
}

/// The refractive index: fixed, stated by the options, or stated by the measurements; the default
/// where it is only a start, or where nothing depends on it.
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
    let needed = !options.model.frees(Parameter::N) && options.model.frees(Parameter::K2);
    let default = (!needed).then_some(DEFAULT_N);
    let n = stated
        .or(default)
        .ok_or(FitError::NoRefractiveIndex(wavelength_um))?;
    Ok(check_refractive_index(n)?)
}

fn check_energy_limit(limit: f64) -> Result<(), FitError> {
    if (0.0..FRAC_PI_2).contains(&limit) {
        Ok(())
    } else {
        Err(FitError::EnergyLimit(in_degrees(limit)))
    }
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
