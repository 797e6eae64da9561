//! The fastest evaluator that meets the requirements of a scene.

use web_time::Instant;

use super::cost::{TIMED, cost};
use super::probe::{Errors, Probe};
use super::requirements::Scene;
use crate::evaluator::{Double, Evaluator, FittedFresnel, Lambertian, Single, SpecularOnly};
use crate::family::AnyBrdf;

/// The number of points at which the errors are measured.
const PROBED: usize = 1 << 17;

/// The part of the tolerance that the largest measured error may reach. Among more points there are
/// larger errors.
const PART_OF_TOLERANCE: f64 = 0.7;

/// The number of points at which the cost on all threads is measured, too many for the caches.
const TIMED_ON_ALL: usize = 1_000_000;

/// The part of the tolerance that the polynomial of the Fresnel factor may use.
const FRESNEL_PART: f64 = 0.4;

/// The measurements of an evaluator and the reason why it was not chosen.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Candidate {
    /// The name of the evaluator.
    pub name: &'static str,
    /// The errors over the domain, or `None` if there is no such evaluator for the BRDF.
    pub errors: Option<Errors>,
    /// The time of one evaluation on one thread, in nanoseconds, with arrays in the caches.
    pub nanoseconds: Option<f64>,
    /// The time of one evaluation on all threads, in nanoseconds, with arrays in memory; measured in a
    /// [`Survey`] only.
    pub nanoseconds_all_threads: Option<f64>,
    /// The time that making the evaluator took, in seconds.
    pub build_seconds: f64,
    /// The reason why it was not chosen; `None` for the chosen evaluator.
    pub refusal: Option<Refusal>,
}

/// The reason why an evaluator was not chosen.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Refusal {
    /// The error is too large.
    #[error("maximum error {error:.1e} exceeds {allowed:.1e}")]
    Error {
        /// The largest relative error that was measured.
        error: f64,
        /// The largest relative error that is accepted, somewhat less than the tolerance.
        allowed: f64,
    },
    /// There is no such evaluator for this BRDF.
    #[error("{0}")]
    Unfit(&'static str),
    /// Another evaluator is faster.
    #[error("takes {times:.2} times as long, including the time of making it")]
    Cost {
        /// The cost relative to that of the chosen evaluator.
        times: f64,
    },
}

/// No evaluator is within the tolerance.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "no evaluator is within the relative tolerance {tolerance:e}: the most accurate, {best}, has a maximum error of {reached:.1e}"
)]
pub struct PlanError {
    /// The relative tolerance of the scene.
    pub tolerance: f64,
    /// The name of the most accurate evaluator.
    pub best: &'static str,
    /// The largest relative error of that evaluator.
    pub reached: f64,
}

/// The evaluator of a BRDF that is chosen for a scene on the present machine.
#[derive(Debug)]
pub struct Plan {
    /// The chosen evaluator.
    pub evaluator: Box<dyn Evaluator>,
    /// All evaluators that were considered, with their measurements.
    pub candidates: Vec<Candidate>,
}

impl Plan {
    /// Makes and measures the evaluators of a BRDF for a scene and chooses the one of the least cost
    /// within its tolerance. The cost is the time of one evaluation on one thread plus the time of
    /// making the evaluator divided by the number of evaluations.
    ///
    /// This takes some tens of milliseconds.
    ///
    /// # Errors
    ///
    /// [`PlanError`] if no evaluator is within the tolerance.
    pub fn new(brdf: &AnyBrdf, scene: &Scene) -> Result<Self, PlanError> {
        let mut trial = Trial::new(brdf, scene, None);
        trial.measure_all();
        trial.choose().1
    }

    /// The measurements of the chosen evaluator.
    pub fn chosen(&self) -> Option<&Candidate> {
        self.candidates.iter().find(|c| c.refusal.is_none())
    }
}

/// The measurements of all evaluators for a scene, including those on all threads.
#[derive(Debug)]
pub struct Survey {
    /// The measurements of all evaluators.
    pub candidates: Vec<Candidate>,
    /// The name of the evaluator that a [`Plan`] chooses.
    pub chosen: Result<&'static str, PlanError>,
}

impl Survey {
    /// Makes and measures all evaluators of a BRDF for a scene, on one thread and on all threads of
    /// the current rayon pool. This takes about a second.
    pub fn new(brdf: &AnyBrdf, scene: &Scene) -> Self {
        let many = Probe::new(brdf, &scene.domain, scene.coordinates, TIMED_ON_ALL, 2);
        let mut trial = Trial::new(brdf, scene, Some(many));
        trial.measure_all();
        let (candidates, plan) = trial.choose();
        Self {
            candidates,
            chosen: plan.map(|plan| plan.evaluator.name()),
        }
    }
}

/// An evaluator, if there is one for the BRDF, with its measurements.
type Tried = (Option<Box<dyn Evaluator>>, Candidate);

struct Trial<'a> {
    brdf: &'a AnyBrdf,
    scene: &'a Scene,
    probe: Probe,
    timed: Probe,
    /// The points for the cost on all threads, if that is measured.
    many: Option<Probe>,
    tried: Vec<Tried>,
}

impl<'a> Trial<'a> {
    fn new(brdf: &'a AnyBrdf, scene: &'a Scene, many: Option<Probe>) -> Self {
        let probe = |count| Probe::new(brdf, &scene.domain, scene.coordinates, count, 1);
        Self {
            brdf,
            scene,
            probe: probe(PROBED),
            timed: probe(TIMED),
            many,
            tried: Vec::new(),
        }
    }

    fn measure_all(&mut self) {
        let brdf = *self.brdf;
        let least_cos_gamma = self.scene.domain.largest_facet_angle().cos();
        let tolerance = FRESNEL_PART * self.scene.tolerance;
        self.try_candidate("lambertian", || Ok(Lambertian::new(brdf.parameters().kd)));
        self.try_candidate("specular-only", || Ok(SpecularOnly::new(&brdf)));
        self.try_candidate("f32-fitted-fresnel", || {
            FittedFresnel::new(brdf, least_cos_gamma, tolerance)
                .ok_or(Refusal::Unfit("no polynomial is within the tolerance"))
        });
        self.try_candidate("f32", || Ok(Single::new(brdf)));
        self.try_candidate("f64", || Ok(Double::new(brdf)));
    }

    /// Makes and measures an evaluator.
    fn try_candidate<E: Evaluator + 'static>(
        &mut self,
        name: &'static str,
        make: impl FnOnce() -> Result<E, Refusal>,
    ) {
        let start = Instant::now();
        let made = make();
        let mut candidate = Candidate {
            name,
            errors: None,
            nanoseconds: None,
            nanoseconds_all_threads: None,
            build_seconds: start.elapsed().as_secs_f64(),
            refusal: None,
        };
        let evaluator = match made {
            Ok(evaluator) => {
                candidate.errors = Some(self.probe.errors(&evaluator));
                candidate.nanoseconds = Some(cost(&evaluator, &self.timed));
                candidate.nanoseconds_all_threads =
                    self.many.as_ref().map(|many| cost(&evaluator, many));
                Some(Box::new(evaluator) as Box<dyn Evaluator>)
            }
            Err(refusal) => {
                candidate.refusal = Some(refusal);
                None
            }
        };
        self.tried.push((evaluator, candidate));
    }

    /// The largest error that is accepted.
    fn allowed(&self) -> f64 {
        PART_OF_TOLERANCE * self.scene.tolerance
    }

    /// The cost of an evaluation in nanoseconds, if the evaluator is within the tolerance.
    fn cost_of(&self, candidate: &Candidate) -> Option<f64> {
        let (errors, nanoseconds) = (candidate.errors?, candidate.nanoseconds?);
        let making = 1e9 * candidate.build_seconds / self.scene.evaluations.max(1.0);
        (errors.max <= self.allowed()).then_some(nanoseconds + making)
    }

    fn least_cost(&self) -> f64 {
        let costs = self.tried.iter().filter_map(|(_, c)| self.cost_of(c));
        costs.fold(f64::INFINITY, f64::min)
    }

    /// The measurements of all evaluators, with the reasons, and the choice.
    fn choose(mut self) -> (Vec<Candidate>, Result<Plan, PlanError>) {
        let least = self.least_cost();
        let allowed = self.allowed();
        let costs: Vec<Option<f64>> = self.tried.iter().map(|(_, c)| self.cost_of(c)).collect();
        let mut chosen = None;
        for ((evaluator, candidate), cost) in self.tried.iter_mut().zip(costs) {
            candidate.refusal = match (cost, candidate.errors) {
                (Some(cost), _) if cost == least && chosen.is_none() => {
                    chosen = evaluator.take();
                    None
                }
                (Some(cost), _) => Some(Refusal::Cost {
                    times: cost / least,
                }),
                (None, Some(errors)) => Some(Refusal::Error {
                    error: errors.max,
                    allowed,
                }),
                (None, None) => candidate.refusal.take(),
            };
        }
        let candidates: Vec<Candidate> = self.tried.into_iter().map(|(_, c)| c).collect();
        let plan = match chosen {
            Some(evaluator) => Ok(Plan {
                evaluator,
                candidates: candidates.clone(),
            }),
            None => Err(failure(self.scene.tolerance, &candidates)),
        };
        (candidates, plan)
    }
}

fn failure(tolerance: f64, candidates: &[Candidate]) -> PlanError {
    let reached = candidates
        .iter()
        .filter_map(|c| Some((c.name, c.errors?.max)));
    let (best, reached) = reached
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or(("none", f64::INFINITY));
    PlanError {
        tolerance,
        best,
        reached,
    }
}
