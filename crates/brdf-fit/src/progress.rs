//! Observing a fit while it runs, and cancelling it.

use std::fmt;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

use brdf_core::ModelParameters;
use serde::{Deserialize, Serialize};

/// A phase of a fit and its report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// Stage 1, including its initial values.
    Stage1,
    /// Stage 2, including the initial values if there is no stage 1.
    Stage2,
    /// The check against the global optimum.
    GlobalCheck,
    /// The fit of relative errors.
    Relative,
    /// The fit with a robust loss.
    Robust,
    /// The fit under the energy constraint rho(psi) <= 1.
    Energy,
    /// Intervals of the parameters, and warnings.
    Uncertainty,
    /// Cross-validation, sensitivity and the model hierarchy. If the scan chooses the model, this phase
    /// also comes first.
    Assessment,
}

impl fmt::Display for Phase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Stage1 => "stage 1",
            Self::Stage2 => "stage 2",
            Self::GlobalCheck => "global check",
            Self::Relative => "relative fit",
            Self::Robust => "robust fit",
            Self::Energy => "energy",
            Self::Uncertainty => "uncertainty",
            Self::Assessment => "assessment",
        })
    }
}

/// What is done a known number of times in a phase.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Task {
    /// The prediction of incidences from a fit of the other incidences.
    CrossValidation,
    /// The fit of a model of the comparison, with its own cross-validation.
    Model,
}

impl fmt::Display for Task {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::CrossValidation => "cross-validation",
            Self::Model => "model",
        })
    }
}

/// A part of a phase that begins. It is shown as `cross-validation 3 of 5`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Part {
    /// What is done.
    pub task: Task,
    /// The number of this part, from 1.
    pub number: usize,
    /// The number of all such parts.
    pub count: usize,
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} of {}", self.task, self.number, self.count)
    }
}

/// One step of a phase.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// The phase.
    pub phase: Phase,
    /// The iteration within the phase, from 0. In the stages, 0 is the start and the following ones
    /// are the iterations of the minimiser; in the other phases, each pass of the main loop counts.
    pub iteration: u64,
    /// The part of the phase that begins with this step, where parts are counted. Models are fitted on
    /// several threads, and beside the cross-validation.
    pub part: Option<Part>,
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
pub(crate) struct Progress<'a> {
    observer: &'a dyn Observer,
    phase: Phase,
    next: AtomicU64,
    /// The increment of the count for each step.
    stride: u64,
}

impl<'a> Progress<'a> {
    /// A phase that has not reported a step.
    pub(crate) fn new(observer: &'a dyn Observer, phase: Phase) -> Self {
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
        self.notify(None, None)
    }

    /// Reports one more step, with which a part begins.
    pub(crate) fn begin_part(&self, part: Part) -> Result<(), Cancelled> {
        self.notify(Some(part), None)
    }

    /// Reports one more step, with the current parameters and E as a fraction.
    pub(crate) fn advance_to(&self, error: f64, at: &ModelParameters) -> Result<(), Cancelled> {
        // The refits of the last phases are not states of the fit itself.
        let shown = !matches!(self.phase, Phase::Uncertainty | Phase::Assessment);
        self.notify(None, shown.then_some((error, at)))
    }

    fn notify(
        &self,
        part: Option<Part>,
        at: Option<(f64, &ModelParameters)>,
    ) -> Result<(), Cancelled> {
        let step = Step {
            phase: self.phase,
            iteration: self.next.fetch_add(self.stride, Ordering::Relaxed),
            part,
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
