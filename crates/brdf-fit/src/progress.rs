//! Observing a fit while it runs, and cancelling it.

use std::fmt;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

use brdf_core::ModelParameters;

/// A phase of a fit and its report.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Stage 1, including its initial values.
    Stage1,
    /// Stage 2, including the initial values if there is no stage 1.
    Stage2,
    /// The check against the global optimum.
    GlobalCheck,
    /// The fit with a robust loss.
    Robust,
    /// The fit under the energy constraint rho(psi) <= 1.
    Energy,
    /// Intervals of the parameters, and warnings.
    Uncertainty,
    /// Cross-validation, bootstrap and the model hierarchy. If the scan chooses the model, this phase
    /// also comes first.
    Assessment,
}

impl fmt::Display for Phase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Stage1 => "stage 1",
            Self::Stage2 => "stage 2",
            Self::GlobalCheck => "global check",
            Self::Robust => "robust fit",
            Self::Energy => "energy",
            Self::Uncertainty => "uncertainty",
            Self::Assessment => "assessment",
        })
    }
}

/// One step of a phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// The phase.
    pub phase: Phase,
    /// The iteration within the phase, from 0. In the stages, 0 is the start and the following ones
    /// are the iterations of the minimiser; in the other phases, each pass of the main loop counts.
    pub iteration: u64,
    /// E in percent, over the readings of the phase and with their weights; `None` for a step that
    /// does not evaluate E.
    pub e_percent: Option<f64>,
    /// The current parameters; `None` if `e_percent` is `None`.
    pub parameters: Option<ModelParameters>,
}

/// Receives the steps of a fit, and may cancel it.
///
/// The steps of a phase arrive in order, except for [`Phase::Energy`] and [`Phase::Assessment`],
/// which run on several threads. They are frequent (each width of a search, each iteration of a
/// minimiser), so that an observer should return at once.
pub trait Observer: Sync {
    /// Receives a step. [`ControlFlow::Break`] cancels the fit: it ends before its next step with
    /// [`FitError::Cancelled`](crate::FitError::Cancelled).
    fn step(&self, step: &Step) -> ControlFlow<()>;
}

/// No observer: nothing is reported, and nothing is cancelled.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct NoObserver;

impl Observer for NoObserver {
    fn step(&self, _: &Step) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// An [`Observer`] cancelled the fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

/// Counts the steps of one phase and reports them to an observer.
///
/// It is an observer itself: each step of a fit within the phase, such as that of a candidate of the
/// model hierarchy, is one step of the phase.
pub struct Progress<'a> {
    observer: &'a dyn Observer,
    phase: Phase,
    next: AtomicU64,
    /// The increment of the count for each step.
    stride: u64,
}

impl<'a> Progress<'a> {
    /// A phase that has not reported a step.
    pub fn new(observer: &'a dyn Observer, phase: Phase) -> Self {
        Self {
            observer,
            phase,
            next: AtomicU64::new(0),
            stride: 1,
        }
    }

    /// A phase that begins now: reports its step 0, without numbers.
    pub(crate) fn begin(observer: &'a dyn Observer, phase: Phase) -> Result<Self, Cancelled> {
        let progress = Self::new(observer, phase);
        progress.advance()?;
        Ok(progress)
    }

    /// The preparation of a phase: all its steps are reported as step 0, without numbers.
    pub(crate) fn preparing(observer: &'a dyn Observer, phase: Phase) -> Self {
        Self {
            stride: 0,
            ..Self::new(observer, phase)
        }
    }

    /// Reports one more step, without numbers.
    pub(crate) fn advance(&self) -> Result<(), Cancelled> {
        self.notify(None)
    }

    /// Reports one more step, with the current parameters and E as a fraction.
    pub(crate) fn advance_to(&self, error: f64, at: &ModelParameters) -> Result<(), Cancelled> {
        // The refits of the last phases are not states of the fit itself.
        let shown = !matches!(self.phase, Phase::Uncertainty | Phase::Assessment);
        self.notify(shown.then_some((error, at)))
    }

    fn notify(&self, at: Option<(f64, &ModelParameters)>) -> Result<(), Cancelled> {
        let step = Step {
            phase: self.phase,
            iteration: self.next.fetch_add(self.stride, Ordering::Relaxed),
            e_percent: at.map(|(error, _)| 100.0 * error),
            parameters: at.map(|(_, parameters)| *parameters),
        };
        match self.observer.step(&step) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(Cancelled),
        }
    }
}

impl Observer for Progress<'_> {
    fn step(&self, _: &Step) -> ControlFlow<()> {
        match self.advance() {
            Ok(()) => ControlFlow::Continue(()),
            Err(Cancelled) => ControlFlow::Break(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use brdf_core::Parameters;

    use super::*;
    use crate::fit::robust::Loss;
    use crate::fit::{Fit, FitError, FitOptions, Stage, fit, fit_observed};
    use crate::report::{Depth, ModelChoice, Report};
    use crate::scan::synthetic::scan;
    use crate::solver::Method;
    use crate::{Measurements, RefractiveIndex};

    const PHASES: [Phase; 7] = [
        Phase::Stage1,
        Phase::Stage2,
        Phase::GlobalCheck,
        Phase::Robust,
        Phase::Energy,
        Phase::Uncertainty,
        Phase::Assessment,
    ];

    /// Keeps all steps, and cancels at one of them.
    #[derive(Default)]
    struct Recorder {
        steps: Mutex<Vec<Step>>,
        cancel_at: Option<(Phase, u64)>,
    }

    impl Observer for Recorder {
        fn step(&self, step: &Step) -> ControlFlow<()> {
            self.steps.lock().unwrap().push(*step);
            if self.cancel_at == Some((step.phase, step.iteration)) {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        }
    }

    impl Recorder {
        fn of(&self, phase: Phase) -> Vec<Step> {
            let steps = self.steps.lock().unwrap();
            steps.iter().filter(|s| s.phase == phase).copied().collect()
        }
    }

    /// A surface that would make light, with 2 % of ripple.
    fn bright() -> Measurements {
        let truth = Parameters::new(0.156, 0.584, 1.338).unwrap();
        let mut readings = scan(truth, 1.5).readings().to_vec();
        for (i, reading) in readings.iter_mut().enumerate() {
            reading.brdf *= 1.0 + 0.02 * (2.4 * i as f64).sin();
        }
        Measurements::new("test", readings).unwrap()
    }

    fn options() -> FitOptions {
        FitOptions {
            refractive_index: Some(RefractiveIndex::Same(1.5)),
            ..FitOptions::default()
        }
    }

    /// The options that every phase needs.
    fn everything() -> FitOptions {
        FitOptions {
            robust: Some(Loss::Tukey),
            energy_limit: Some(80_f64.to_radians()),
            ..options()
        }
    }

    fn without_times(mut fit: Fit) -> Fit {
        fit.seconds = 0.0;
        let stages = [fit.stage1.as_mut(), fit.stage2.as_mut()];
        stages.into_iter().flatten().for_each(|s| s.seconds = 0.0);
        fit.global_check.iter_mut().for_each(|c| c.seconds = 0.0);
        fit
    }

    #[test]
    fn every_iteration_of_both_stages_is_told_from_the_start_on() {
        for method in [Method::LevenbergMarquardt, Method::NelderMead] {
            let (observer, options) = (
                Recorder::default(),
                FitOptions {
                    stage1: Some(method),
                    stage2: Some(method),
                    ..options()
                },
            );
            let fit = fit_observed(&bright(), &options, &observer).unwrap();
            let check = |phase, stage: &Stage, start: f64| {
                let steps = observer.of(phase);
                let told = steps.iter().map(|step| step.iteration);
                assert!(told.eq(0..=stage.iterations), "{method} {phase}");
                let e: Vec<f64> = steps.iter().map(|step| step.e_percent.unwrap()).collect();
                assert!(e.is_sorted_by(|a, b| b <= a), "{method} {phase}: {e:?}");
                assert!((e[0] / start - 1.0).abs() < 1e-6 || method == Method::NelderMead);
                assert!((e[e.len() - 1] / stage.e_percent.own - 1.0).abs() < 1e-9);
                let last = steps[steps.len() - 1].parameters.unwrap();
                assert!((last.k1 / stage.parameters.k1 - 1.0).abs() < 1e-6);
            };
            let first = fit.stage1.unwrap();
            check(Phase::Stage1, &first, fit.initial_e_percent.own);
            check(Phase::Stage2, &fit.stage2.unwrap(), first.e_percent.all);
        }
    }

    #[test]
    fn phases_come_one_after_another_and_change_no_number() {
        let (observer, scan, options) = (Recorder::default(), bright(), everything());
        let given = ModelChoice::Given;
        let (watched, error) = Report::observed(&scan, &options, given, Depth::Assessed, &observer);
        assert_eq!(error, None);
        let (plain, _) = Report::new(&scan, &options, Depth::Assessed);
        let fits = [&watched, &plain].map(|report| without_times(report.fit.clone().unwrap()));
        assert_eq!(fits[0], fits[1]);
        assert_eq!(watched.uncertainty, plain.uncertainty);
        assert_eq!(watched.assessment, plain.assessment);
        let mut phases: Vec<Phase> = Vec::new();
        for step in observer.steps.lock().unwrap().iter() {
            if phases.last() != Some(&step.phase) {
                phases.push(step.phase);
            }
        }
        assert_eq!(phases, PHASES);
    }

    #[test]
    fn a_fit_can_be_cancelled_in_every_phase_at_its_first_step_and_later() {
        for phase in PHASES {
            for iteration in [0, 2] {
                let observer = Recorder {
                    cancel_at: Some((phase, iteration)),
                    ..Recorder::default()
                };
                let (report, error) = Report::observed(
                    &bright(),
                    &everything(),
                    ModelChoice::Given,
                    Depth::Assessed,
                    &observer,
                );
                assert_eq!(error, Some(FitError::Cancelled), "{phase} {iteration}");
                assert_eq!(report.error.as_deref(), Some("cancelled"));
                let steps = observer.of(phase);
                let after = steps.iter().filter(|step| step.iteration > iteration);
                // Other threads may be at a step of their own.
                let on_threads = matches!(phase, Phase::Energy | Phase::Assessment);
                assert!(on_threads || after.count() == 0, "{phase}");
            }
        }
    }

    #[test]
    fn the_choice_of_a_model_can_be_cancelled() {
        let observer = Recorder {
            cancel_at: Some((Phase::Assessment, 40)),
            ..Recorder::default()
        };
        let auto = ModelChoice::Auto;
        let (report, error) = Report::observed(&bright(), &options(), auto, Depth::Fit, &observer);
        assert_eq!((report.fit, error), (None, Some(FitError::Cancelled)));
        assert!(fit(&bright(), &options()).is_ok());
    }

    #[test]
    fn phases_have_words() {
        assert_eq!(
            PHASES.map(|phase| phase.to_string())[..3],
            ["stage 1", "stage 2", "global check"]
        );
    }
}
