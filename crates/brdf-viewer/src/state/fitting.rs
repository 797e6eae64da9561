//! The settings of the next fit, and the fit that is running.

use std::time::Instant;

use brdf_fit::fit::robust::Loss;
use brdf_fit::objective::weights::Weights;
use brdf_fit::progress::{Phase, Step};
use brdf_fit::report::Depth;
use brdf_fit::{FitOptions, Method, RefractiveIndex};
use serde::{Deserialize, Serialize};

use super::sample::{Knobs, SampleId, ScanId};
use crate::job::Stop;

/// Which stages of the fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stages {
    /// Stage 1 alone: the incidences up to the limit.
    First,
    /// Stage 2 alone: all readings at once.
    Second,
    /// The paper's two stages.
    Both,
}

/// Which scans are meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scope {
    /// The wavelength of the active sample that is shown.
    Wavelength,
    /// All wavelengths of the active sample.
    Sample,
    /// All wavelengths of all samples.
    All,
}

/// Weights of the readings in E.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ReadingWeights {
    /// The paper's: all alike.
    #[default]
    None,
    /// 1/sigma^2.
    Sigma,
    /// The part of the hemisphere that a reading stands for.
    SolidAngle,
}

/// Where the fit starts.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// The paper's initial values.
    #[default]
    Paper,
    /// The sliders.
    Sliders,
}

/// The settings of the next fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct FitChoice {
    /// Method of stage 1.
    pub stage1: Method,
    /// Method of stage 2.
    pub stage2: Method,
    /// Largest incidence of stage 1, in degrees.
    pub limit_deg: f64,
    /// Weights of the readings.
    pub weights: ReadingWeights,
    /// Another loss than the square.
    pub robust: Option<Loss>,
    /// Whether rho(psi) <= 1 is kept.
    pub energy: bool,
    /// Up to which incidence, in degrees.
    pub energy_limit_deg: f64,
    /// Where the fit starts.
    pub start: Start,
    /// Whether GGX and Beckmann are fitted as well.
    pub compare: bool,
}

impl Default for FitChoice {
    fn default() -> Self {
        Self {
            stage1: Method::LevenbergMarquardt,
            stage2: Method::LevenbergMarquardt,
            limit_deg: 60.0,
            weights: ReadingWeights::None,
            robust: None,
            energy: false,
            energy_limit_deg: brdf_fit::fit::energy::DEFAULT_LIMIT_DEG,
            start: Start::Paper,
            compare: false,
        }
    }
}

impl FitChoice {
    /// Whether all numbers are within their ranges, as those of a file need not be.
    pub fn is_valid(&self) -> bool {
        (0.0..=90.0).contains(&self.limit_deg) && (0.0..90.0).contains(&self.energy_limit_deg)
    }

    /// The weights of the readings, as the fit takes them.
    pub fn weights(&self) -> Weights {
        Weights {
            by_sigma: self.weights == ReadingWeights::Sigma,
            by_solid_angle: self.weights == ReadingWeights::SolidAngle,
            ..Weights::default()
        }
    }

    /// The options of the fit, as the command line would have them.
    pub fn options(&self, knobs: &Knobs, stages: Stages) -> FitOptions {
        FitOptions {
            model: knobs.model,
            refractive_index: Some(RefractiveIndex::Same(knobs.at.n)),
            weights: self.weights(),
            fixed: knobs.fixed_parameters(),
            start: (self.start == Start::Sliders).then_some(knobs.at),
            stage1: (stages != Stages::Second).then_some(self.stage1),
            stage1_limit: self.limit_deg.to_radians(),
            stage2: (stages != Stages::First).then_some(self.stage2),
            robust: self.robust,
            energy_limit: self.energy.then_some(self.energy_limit_deg.to_radians()),
            ..FitOptions::default()
        }
    }

    /// How much is worked out beside the fit.
    pub fn depth(&self) -> Depth {
        if self.compare {
            Depth::Compared
        } else {
            Depth::Assessed
        }
    }
}

/// One step of a stage, for the curve of E.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// The stage.
    pub phase: Phase,
    /// Its iteration.
    pub iteration: u64,
    /// E in percent over the readings of the stage.
    pub e_percent: f64,
}

/// Where a run is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// It runs.
    Running,
    /// It was asked to stop.
    Cancelling,
    /// It was stopped.
    Cancelled,
    /// It is done.
    Done,
}

/// The fits that the worker makes, or has made last.
#[derive(Debug, Clone)]
pub struct FitRun {
    queue: Vec<Queued>,
    /// Why some failed.
    pub failed: Vec<String>,
    /// The scan of the fit that runs, or ran last.
    pub scan: ScanId,
    /// What it does.
    pub phase: Option<Phase>,
    /// Every iteration of its stages.
    pub points: Vec<Point>,
    /// Where it is.
    pub progress: Progress,
    /// When it was started.
    pub started: Instant,
}

/// One of these fits.
#[derive(Debug, Clone)]
struct Queued {
    scan: ScanId,
    stop: Stop,
    ended: bool,
}

impl FitRun {
    /// A run that has just been asked for; `None` of no scan.
    pub fn new(scans: &[ScanId]) -> Option<Self> {
        let queued = |&scan: &ScanId| Queued {
            scan,
            stop: Stop::default(),
            ended: false,
        };
        Some(Self {
            queue: scans.iter().map(queued).collect(),
            failed: Vec::new(),
            scan: *scans.first()?,
            phase: None,
            points: Vec::new(),
            progress: Progress::Running,
            started: Instant::now(),
        })
    }

    /// What ends the fit of each scan.
    pub fn stops(&self) -> impl Iterator<Item = (ScanId, Stop)> {
        let all = self.queue.iter();
        all.map(|queued| (queued.scan, queued.stop.clone()))
    }

    /// How many fits there are.
    pub fn jobs(&self) -> usize {
        self.queue.len()
    }

    /// How many have ended, well or not.
    pub fn done(&self) -> usize {
        self.queue.iter().filter(|queued| queued.ended).count()
    }

    /// How many fits have succeeded.
    pub fn fitted(&self) -> usize {
        self.done() - self.failed.len()
    }

    /// Whether the worker is still at it.
    pub fn is_running(&self) -> bool {
        matches!(self.progress, Progress::Running | Progress::Cancelling)
    }

    /// Ends all fits.
    pub fn cancel(&mut self) {
        self.progress = Progress::Cancelling;
        for queued in &self.queue {
            queued.stop.ask();
        }
    }

    /// Ends the fits of a sample that is closed. The others go on.
    pub fn leave_out(&mut self, sample: SampleId) {
        self.queue.retain(|queued| {
            let gone = queued.scan.sample == sample && !queued.ended;
            if gone {
                queued.stop.ask();
            }
            !gone
        });
    }

    /// Takes over a step of the fit of a scan.
    pub fn step(&mut self, scan: ScanId, step: &Step) {
        if !self.queue.iter().any(|queued| queued.scan == scan) {
            return;
        }
        if scan != self.scan {
            self.scan = scan;
            self.points.clear();
        }
        self.phase = Some(step.phase);
        if let Some(e_percent) = step.e_percent {
            self.points.push(Point {
                phase: step.phase,
                iteration: step.iteration,
                e_percent,
            });
        }
    }

    /// Takes over that the fit of a scan has ended, or why it has failed; its iterations. `None`
    /// where the run is not of this scan, or no longer.
    pub fn end(&mut self, scan: ScanId, failure: Option<&str>) -> Option<Vec<Point>> {
        let mut queue = self.queue.iter_mut();
        let queued = queue.find(|queued| queued.scan == scan && !queued.ended)?;
        queued.ended = true;
        self.failed.extend(failure.map(str::to_owned));
        Some(if self.scan == scan {
            std::mem::take(&mut self.points)
        } else {
            Vec::new()
        })
    }
}
