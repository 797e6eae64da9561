//! The trade-off of evaluation: the time and the errors of each way to evaluate a BRDF, over the
//! directions of a scene and on the present machine.

use std::fmt::Write as _;
use std::io;

use brdf_core::AnyBrdf;
use brdf_core::evaluator::vector_unit;
use brdf_core::scene::{
    Azimuth, Candidate, Coordinates, Probe, Scene, Survey, TIMED, cost_of_single_values,
};
use serde::Serialize;

use super::pareto::pareto;
use crate::format::{counted, in_degrees};
#[cfg(feature = "plot")]
use crate::plot::{Figure, TradePoint, trade_picture};

/// The name of [`AnyBrdf::value`] called point after point.
pub const SINGLE_VALUES: &str = "value";

/// A comparison of the ways to evaluate a BRDF for a scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EvaluatorTradeoff {
    /// The name of the surface.
    pub of: String,
    /// The BRDF.
    pub brdf: AnyBrdf,
    /// The scene.
    pub scene: Scene,
    /// The widest vectors that the processor offers.
    pub vector_unit: &'static str,
    /// The number of threads of the pool.
    pub threads: usize,
    /// The evaluators that were measured.
    pub evaluators: Vec<MeasuredEvaluator>,
    /// The evaluators that do not exist for this BRDF.
    pub not_made: Vec<NotMade>,
    /// The name of the evaluator that the plan chooses; `None` if none is within the tolerance.
    pub plan: Option<&'static str>,
    /// The reason why there is no plan.
    pub no_plan: Option<String>,
}

/// The measurements of one evaluator. Errors are relative to the values of single points.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeasuredEvaluator {
    /// The name of the evaluator.
    pub name: &'static str,
    /// The time on one thread, with arrays in the caches.
    pub ns_per_evaluation: f64,
    /// The time on all threads, with arrays in memory; `None` for single values.
    pub ns_per_evaluation_all_threads: Option<f64>,
    /// The time of single values divided by that of the evaluator, on one thread.
    pub times_as_fast: f64,
    /// The largest error.
    pub max_relative_error: f64,
    /// The 99th percentile of the errors.
    pub p99_relative_error: f64,
    /// The root mean square of the errors.
    pub rms_relative_error: f64,
    /// The time that making the evaluator took.
    pub build_seconds: f64,
    /// Whether no other evaluator is faster without a larger error.
    pub pareto: bool,
    /// The reason why the plan does not choose it; `None` for the chosen evaluator.
    pub refusal: Option<String>,
}

/// An evaluator that was not measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NotMade {
    /// The name of the evaluator.
    pub name: &'static str,
    /// The reason.
    pub reason: String,
}

/// The columns of [`write_evaluator_tradeoff`].
pub const EVALUATOR_TRADEOFF_COLUMNS: [&str; 10] = [
    "name",
    "ns_per_evaluation",
    "ns_per_evaluation_all_threads",
    "times_as_fast",
    "max_relative_error",
    "p99_relative_error",
    "rms_relative_error",
    "build_seconds",
    "pareto",
    "plan",
];

/// Measures every evaluator of a BRDF for a scene. This takes about a second.
pub fn evaluator_tradeoff(of: &str, brdf: &AnyBrdf, scene: &Scene) -> EvaluatorTradeoff {
    let survey = Survey::new(brdf, scene);
    let probe = Probe::new(brdf, &scene.domain, scene.coordinates, TIMED, 1);
    let single = cost_of_single_values(brdf, &probe);
    let mut evaluators = vec![single_values(single)];
    let mut not_made = Vec::new();
    for candidate in &survey.candidates {
        match measured(candidate, single) {
            Some(evaluator) => evaluators.push(evaluator),
            None => not_made.push(NotMade {
                name: candidate.name,
                reason: reason(candidate).unwrap_or_default(),
            }),
        }
    }
    let choices: Vec<(f64, f64)> = evaluators
        .iter()
        .map(|e| (e.ns_per_evaluation, e.max_relative_error))
        .collect();
    for (evaluator, on_front) in evaluators.iter_mut().zip(pareto(&choices)) {
        evaluator.pareto = on_front;
    }
    EvaluatorTradeoff {
        of: of.to_owned(),
        brdf: *brdf,
        scene: *scene,
        vector_unit: vector_unit(),
        threads: rayon::current_num_threads(),
        evaluators,
        not_made,
        plan: survey.chosen.ok(),
        no_plan: survey.chosen.err().map(|error| error.to_string()),
    }
}

/// The single values, which are the reference and have no error.
fn single_values(nanoseconds: f64) -> MeasuredEvaluator {
    MeasuredEvaluator {
        name: SINGLE_VALUES,
        ns_per_evaluation: nanoseconds,
        ns_per_evaluation_all_threads: None,
        times_as_fast: 1.0,
        max_relative_error: 0.0,
        p99_relative_error: 0.0,
        rms_relative_error: 0.0,
        build_seconds: 0.0,
        pareto: false,
        refusal: Some("is the reference, one point after the other".to_owned()),
    }
}

fn measured(candidate: &Candidate, single: f64) -> Option<MeasuredEvaluator> {
    let (errors, nanoseconds) = (candidate.errors?, candidate.nanoseconds?);
    Some(MeasuredEvaluator {
        name: candidate.name,
        ns_per_evaluation: nanoseconds,
        ns_per_evaluation_all_threads: candidate.nanoseconds_all_threads,
        times_as_fast: single / nanoseconds,
        max_relative_error: errors.max,
        p99_relative_error: errors.p99,
        rms_relative_error: errors.rms,
        build_seconds: candidate.build_seconds,
        pareto: false,
        refusal: reason(candidate),
    })
}

fn reason(candidate: &Candidate) -> Option<String> {
    candidate.refusal.as_ref().map(ToString::to_string)
}

impl EvaluatorTradeoff {
    /// The measurements as a table of text.
    pub fn text(&self) -> String {
        let mut text = self.heading();
        let _ = writeln!(
            text,
            "  {:<20}{:>8}{:>9}{:>8}{:>10}{:>10}{:>10}{:>10}",
            "", "ns", "ns, all", "times", "max", "99 %", "rms", "made in"
        );
        let _ = writeln!(
            text,
            "  {:<20}{:>8}{:>9}{:>8}{:>10}{:>10}{:>10}{:>10}",
            "", "1 thread", "threads", "as fast", "error", "error", "error", "ms"
        );
        for evaluator in &self.evaluators {
            text += &self.line(evaluator);
        }
        for NotMade { name, reason } in &self.not_made {
            let _ = writeln!(text, "  {name:<20}  {reason}");
        }
        text += "  (*: Pareto front, none is faster with no larger error; errors relative, against \
                 single values; times as fast\n  as single values; 1 thread: arrays in the caches, \
                 all threads: a million points in memory)\n";
        match (self.plan, &self.no_plan) {
            (Some(plan), _) => {
                let _ = writeln!(text, "  plan: {plan}");
            }
            (None, Some(error)) => {
                let _ = writeln!(text, "  no plan: {error}");
            }
            (None, None) => {}
        }
        text
    }

    fn heading(&self) -> String {
        let Scene {
            domain,
            coordinates,
            tolerance,
            evaluations,
        } = self.scene;
        let at = self.brdf.model_parameters();
        let range = |(from, to): (f64, f64)| format!("{} ... {}", in_degrees(from), in_degrees(to));
        let azimuth = match domain.azimuth() {
            Azimuth::InPlane => "in plane",
            Azimuth::Full => "all azimuths",
        };
        let coordinates = match coordinates {
            Coordinates::Cosines => "cosines",
            Coordinates::Angles => "angles",
            Coordinates::Directions => "directions",
        };
        format!(
            "{}: k2 {}, kD {}, k1 {}, n {}, p {}\n  incidence {} deg, view {} deg, {azimuth}, given \
             as {coordinates}\n  tolerance {tolerance:e}, {evaluations:e} evaluations\n  {} vectors, {}\n\n",
            self.of,
            at.k2,
            at.kd,
            at.k1,
            at.n,
            at.p,
            range(domain.incidence()),
            range(domain.view()),
            self.vector_unit,
            counted(self.threads, "thread"),
        )
    }

    fn line(&self, evaluator: &MeasuredEvaluator) -> String {
        let front = if evaluator.pareto { "*" } else { " " };
        let all = evaluator.ns_per_evaluation_all_threads;
        let mut line = format!(
            "{front} {:<20}{:>8.2}{:>9}{:>8.2}{:>10}{:>10}{:>10}{:>10.2}",
            evaluator.name,
            evaluator.ns_per_evaluation,
            all.map_or_else(String::new, |ns| format!("{ns:.2}")),
            evaluator.times_as_fast,
            error(evaluator.max_relative_error),
            error(evaluator.p99_relative_error),
            error(evaluator.rms_relative_error),
            1e3 * evaluator.build_seconds,
        );
        if self.plan == Some(evaluator.name) {
            line += "  <- plan";
        }
        line + "\n"
    }

    /// The plot of error against time, both logarithmic, in which the choice of the plan is marked.
    #[cfg(feature = "plot")]
    pub fn figure(&self) -> Figure {
        let point = |evaluator: &MeasuredEvaluator| TradePoint {
            label: evaluator.name.to_owned(),
            x: evaluator.ns_per_evaluation,
            y: evaluator.max_relative_error,
            pareto: evaluator.pareto,
            chosen: self.plan == Some(evaluator.name),
        };
        let points: Vec<TradePoint> = self.evaluators.iter().map(point).collect();
        trade_picture(
            &points,
            "time of an evaluation on one thread / ns",
            "largest relative error",
            &self.of,
        )
    }
}

fn error(error: f64) -> String {
    if error == 0.0 {
        "0".to_owned()
    } else {
        format!("{error:.1e}")
    }
}

/// Writes a comparison as CSV, with one line for each evaluator that was measured.
///
/// # Errors
///
/// The error of the writer.
pub fn write_evaluator_tradeoff(
    trade: &EvaluatorTradeoff,
    writer: impl io::Write,
) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(writer);
    csv.write_record(EVALUATOR_TRADEOFF_COLUMNS)?;
    for e in &trade.evaluators {
        let all = e.ns_per_evaluation_all_threads;
        csv.write_record([
            e.name.to_owned(),
            e.ns_per_evaluation.to_string(),
            all.map_or_else(String::new, |ns| ns.to_string()),
            e.times_as_fast.to_string(),
            e.max_relative_error.to_string(),
            e.p99_relative_error.to_string(),
            e.rms_relative_error.to_string(),
            e.build_seconds.to_string(),
            e.pareto.to_string(),
            (trade.plan == Some(e.name)).to_string(),
        ])?;
    }
    csv.flush()
}

#[cfg(test)]
mod tests {
    use brdf_core::scene::Domain;
    use brdf_core::{Parameters, ThreeParameterBrdf};

    use super::*;

    fn trade(tolerance: f64) -> EvaluatorTradeoff {
        let parameters = Parameters::new(0.3, 0.1, 0.2).unwrap();
        let brdf = ThreeParameterBrdf::new(parameters, 1.5).unwrap();
        let scene = Scene {
            domain: Domain::all((0.0, 1.0), (0.0, 1.2)).unwrap(),
            tolerance,
            ..Scene::default()
        };
        evaluator_tradeoff("a surface", &AnyBrdf::Paper(brdf), &scene)
    }

    #[test]
    fn every_evaluator_is_measured_or_has_a_reason() {
        let trade = trade(1e-3);
        assert_eq!(trade.evaluators.len() + trade.not_made.len(), 6);
        assert!(trade.not_made.iter().all(|e| !e.reason.is_empty()));
        let plan = trade.plan.unwrap();
        let chosen = trade.evaluators.iter().find(|e| e.name == plan).unwrap();
        assert!(chosen.max_relative_error <= 1e-3 && chosen.refusal.is_none());
        for e in &trade.evaluators {
            assert!(e.ns_per_evaluation > 0.0 && e.p99_relative_error <= e.max_relative_error);
            assert_eq!(e.refusal.is_none(), e.name == plan);
        }
        let front: Vec<_> = trade.evaluators.iter().filter(|e| e.pareto).collect();
        // The front includes the fastest and the most accurate evaluator.
        assert!(front.len() >= 2 && front.iter().any(|e| e.max_relative_error == 0.0));
        let text = trade.text();
        assert!(text.contains("<- plan") && text.contains(&format!("plan: {plan}")));
    }

    #[test]
    fn csv_and_json_contain_the_same_numbers() {
        let trade = trade(1e-3);
        let mut bytes = Vec::new();
        write_evaluator_tradeoff(&trade, &mut bytes).unwrap();
        let mut reader = csv::Reader::from_reader(bytes.as_slice());
        let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        let json = serde_json::to_value(&trade).unwrap();
        assert_eq!(rows.len(), json["evaluators"].as_array().unwrap().len());
        for (row, e) in rows.iter().zip(json["evaluators"].as_array().unwrap()) {
            assert_eq!(&row[0], e["name"].as_str().unwrap());
            let error: f64 = row[4].parse().unwrap();
            assert_eq!(error, e["max_relative_error"].as_f64().unwrap());
        }
    }

    #[test]
    fn an_unattainable_tolerance_is_reported() {
        let trade = trade(1e-30);
        assert_eq!(trade.plan, None);
        assert!(trade.text().contains("no plan: no evaluator is within"));
    }
}
