//! The cheapest evaluator that a scene can do with.

use std::time::Instant;

use serde::Serialize;

use super::cost::{TIMED, cost};
use super::domain::Azimuth;
use super::probe::{Errors, Probe};
use super::requirements::Scene;
use crate::evaluator::{
    Double, Evaluator, FittedFresnel, InPlaneTable, IncidenceTable, IsotropicTable, Lambertian,
    Single, SpecularOnly, TableError,
};
use crate::family::AnyBrdf;

/// Points at which the errors are looked for.
const PROBED: usize = 1 << 17;

/// An evaluator is taken if the largest error seen is within this part of the tolerance: among more
/// points, a larger one will be found.
const PART_OF_TOLERANCE: f64 = 0.7;

/// What a table is built to.
const TABLE_PART: f64 = 0.5;

/// Points by which the cost on all cores is measured: too many for the caches.
const TIMED_ON_ALL: usize = 1_000_000;

/// What the polynomial of the Fresnel factor may take of the tolerance.
const FRESNEL_PART: f64 = 0.4;

/// Tables are not tried where all evaluations together take less than this, in nanoseconds: it is
/// what the smallest of them costs to be made.
const WORTH_A_TABLE: f64 = 1e6;

/// What was measured of an evaluator, or why it was not.
#[derive(Debug, Clone, Serialize)]
pub struct Candidate {
    /// What it is called.
    pub name: &'static str,
    /// What it errs by over the domain, where it could be made.
    pub errors: Option<Errors>,
    /// What an evaluation costs by one thread, in nanoseconds, with arrays in the caches.
    pub nanoseconds: Option<f64>,
    /// What it costs by all threads, with arrays in memory; measured in a [`Survey`] only.
    pub nanoseconds_all_threads: Option<f64>,
    /// What it cost to be made, in seconds.
    pub build_seconds: f64,
    /// Its memory, in bytes.
    pub bytes: usize,
    /// Why it was not taken; `None` of the one that was.
    pub refusal: Option<Refusal>,
}

/// Why an evaluator was not taken.
#[derive(Debug, Clone, PartialEq, thiserror::Error, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Refusal {
    /// Its error is too large.
    #[error("errs by up to {error:.1e}: allowed are {allowed:.1e}")]
    Error {
        /// The largest relative error that was seen.
        error: f64,
        /// What was allowed, somewhat less than the tolerance.
        allowed: f64,
    },
    /// It cannot be made within the memory.
    #[error("{0}")]
    Table(String),
    /// It is not for this BRDF or domain.
    #[error("{0}")]
    Unfit(&'static str),
    /// Another one costs less.
    #[error("costs {times:.2} times as much, the making included")]
    Cost {
        /// Its cost over that of the one that was taken.
        times: f64,
    },
    /// There are too few evaluations for it to be made.
    #[error("takes longer to be made than all evaluations by another")]
    Making,
}

impl From<TableError> for Refusal {
    fn from(error: TableError) -> Self {
        Self::Table(error.to_string())
    }
}

/// No evaluator is within the tolerance.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "no evaluator is within the relative tolerance {tolerance:e}: the best, {best}, errs by {reached:.1e}"
)]
pub struct PlanError {
    /// What was asked for.
    pub tolerance: f64,
    /// The most accurate evaluator.
    pub best: &'static str,
    /// Its largest relative error.
    pub reached: f64,
}

/// The choice for a scene, on the machine at hand.
#[derive(Debug)]
pub struct Plan {
    /// The evaluator.
    pub evaluator: Box<dyn Evaluator>,
    /// All that were looked at, with what was measured of them.
    pub candidates: Vec<Candidate>,
}

impl Plan {
    /// Makes and measures the evaluators of a BRDF for a scene, and takes the cheapest one within its
    /// tolerance and memory: cost is the time of one evaluation by one core, plus the share in the
    /// time of making.
    ///
    /// Takes some tens of milliseconds, more where large tables are tried.
    ///
    /// Errors: none is within the tolerance.
    pub fn new(brdf: &AnyBrdf, scene: &Scene) -> Result<Self, PlanError> {
        let mut trial = Trial::new(brdf, scene, None);
        trial.formulas();
        trial.tables();
        trial.decide().1
    }

    /// What was measured of the evaluator that was taken.
    pub fn chosen(&self) -> Option<&Candidate> {
        self.candidates.iter().find(|c| c.refusal.is_none())
    }
}

/// All that can be measured of the evaluators for a scene: of those too that a [`Plan`] does not try.
#[derive(Debug)]
pub struct Survey {
    /// All evaluators.
    pub candidates: Vec<Candidate>,
    /// What would be chosen.
    pub chosen: Result<&'static str, PlanError>,
}

impl Survey {
    /// Makes and measures all evaluators of a BRDF for a scene, by one thread and by all of the
    /// current rayon pool. Takes a second or so.
    pub fn new(brdf: &AnyBrdf, scene: &Scene) -> Self {
        let many = Probe::new(brdf, &scene.domain, scene.coordinates, TIMED_ON_ALL, 2);
        let mut trial = Trial::new(brdf, scene, Some(many));
        trial.formulas();
        trial.tables();
        let (candidates, plan) = trial.decide();
        Self {
            candidates,
            chosen: plan.map(|plan| plan.evaluator.name()),
        }
    }
}

/// An evaluator, if it could be made, with what was measured of it.
type Tried = (Option<Box<dyn Evaluator>>, Candidate);

struct Trial<'a> {
    brdf: &'a AnyBrdf,
    scene: &'a Scene,
    probe: Probe,
    timed: Probe,
    /// For the cost on all cores, where that is asked for: then every evaluator is tried.
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

    fn formulas(&mut self) {
        let brdf = *self.brdf;
        let least_cos_gamma = self.scene.domain.largest_facet_angle().cos();
        let tolerance = FRESNEL_PART * self.scene.tolerance;
        self.offer("lambertian", || Ok(Lambertian::new(brdf.parameters().kd)));
        self.offer("specular-only", || Ok(SpecularOnly::new(&brdf)));
        self.offer("f32-fitted-fresnel", || {
            FittedFresnel::new(brdf, least_cos_gamma, tolerance)
                .ok_or(Refusal::Unfit("no polynomial is within the tolerance"))
        });
        self.offer("f32", || Ok(Single::new(brdf)));
        self.offer("exact", || Ok(Double::new(brdf)));
    }

    fn tables(&mut self) {
        let (brdf, Scene { domain, .. }) = (*self.brdf, *self.scene);
        let (incidence, largest_view) = (domain.incidence(), domain.view().1);
        let tolerance = TABLE_PART * self.scene.tolerance;
        let limit = self.scene.memory_limit;
        let in_plane = domain.azimuth() == Azimuth::InPlane;
        let all_evaluations = self.least_cost() * self.scene.evaluations;
        let worth = self.many.is_some() || all_evaluations > WORTH_A_TABLE;
        let fit = move |fits: bool, words| match (worth, fits) {
            (_, false) => Err(Refusal::Unfit(words)),
            (false, _) => Err(Refusal::Making),
            _ => Ok(()),
        };
        self.offer("table-incidence", || {
            fit(
                in_plane && incidence.0 == incidence.1,
                "is for one incidence in plane",
            )?;
            Ok(IncidenceTable::new(
                &brdf,
                incidence.0,
                largest_view,
                tolerance,
                limit,
            )?)
        });
        self.offer("table-in-plane", || {
            fit(
                in_plane && incidence.0 < incidence.1,
                "is for several incidences in plane",
            )?;
            Ok(InPlaneTable::new(
                &brdf,
                incidence,
                largest_view,
                tolerance,
                limit,
            )?)
        });
        self.offer("table-isotropic", || {
            fit(
                largest_view + incidence.1 > 0.0,
                "is for more than one direction",
            )?;
            Ok(IsotropicTable::new(brdf, &domain, tolerance, limit)?)
        });
    }

    /// Makes and measures an evaluator.
    fn offer<E: Evaluator + 'static>(
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
            bytes: 0,
            refusal: None,
        };
        let evaluator = match made {
            Ok(evaluator) => {
                candidate.errors = Some(self.probe.errors(&evaluator));
                candidate.nanoseconds = Some(cost(&evaluator, &self.timed));
                candidate.nanoseconds_all_threads =
                    self.many.as_ref().map(|many| cost(&evaluator, many));
                candidate.bytes = evaluator.bytes();
                Some(Box::new(evaluator) as Box<dyn Evaluator>)
            }
            Err(refusal) => {
                candidate.refusal = Some(refusal);
                None
            }
        };
        self.tried.push((evaluator, candidate));
    }

    /// The largest error that is allowed.
    fn allowed(&self) -> f64 {
        PART_OF_TOLERANCE * self.scene.tolerance
    }

    /// What an evaluation costs, in nanoseconds, if the evaluator is within the tolerance.
    fn cost_of(&self, candidate: &Candidate) -> Option<f64> {
        let (errors, nanoseconds) = (candidate.errors?, candidate.nanoseconds?);
        let making = 1e9 * candidate.build_seconds / self.scene.evaluations.max(1.0);
        (errors.max <= self.allowed()).then_some(nanoseconds + making)
    }

    fn least_cost(&self) -> f64 {
        let costs = self.tried.iter().filter_map(|(_, c)| self.cost_of(c));
        costs.fold(f64::INFINITY, f64::min)
    }

    /// What was measured, with the reasons, and the choice.
    fn decide(mut self) -> (Vec<Candidate>, Result<Plan, PlanError>) {
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
