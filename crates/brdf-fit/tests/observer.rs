//! Observation and cancellation of fits.

use std::ops::ControlFlow;
use std::sync::Mutex;

use brdf_core::Parameters;
use brdf_fit::synthetic::scan;
use brdf_fit::{
    Depth, Fit, FitError, FitOptions, Loss, Measurements, Method, ModelChoice, Observer, Phase,
    RefractiveIndex, Report, Stage, Step, Task, fit, fit_observed,
};

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
    let (observed, error) = Report::observed(&scan, &options, given, Depth::Assessed, &observer);
    assert_eq!(error, None);
    let (plain, _) = Report::new(&scan, &options, Depth::Assessed);
    let fits = [&observed, &plain].map(|report| without_times(report.fit.clone().unwrap()));
    assert_eq!(fits[0], fits[1]);
    assert_eq!(observed.uncertainty, plain.uncertainty);
    assert_eq!(observed.assessment, plain.assessment);
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
fn the_assessment_counts_incidences_and_models() {
    let observer = Recorder::default();
    let given = ModelChoice::Given;
    let (report, _) = Report::observed(&bright(), &options(), given, Depth::Assessed, &observer);
    let steps = observer.of(Phase::Assessment);
    let parts: Vec<_> = steps.iter().filter_map(|step| step.part).collect();
    let numbers = |task: Task, count: usize| {
        let of_task = parts.iter().filter(|part| part.task == task);
        let mut numbers: Vec<usize> = of_task
            .map(|part| {
                assert_eq!(part.count, count);
                part.number
            })
            .collect();
        numbers.sort_unstable();
        assert!(numbers.into_iter().eq(1..=count), "{task}: {parts:?}");
    };
    numbers(Task::CrossValidation, bright().incidences().len());
    let assessment = report.assessment.unwrap();
    let models = assessment.models.len() + assessment.left_out.len();
    numbers(Task::Model, models);
    let texts: Vec<String> = parts.iter().map(ToString::to_string).collect();
    assert!(
        texts.contains(&"cross-validation 3 of 8".to_owned()),
        "{texts:?}"
    );
    assert!(texts.contains(&format!("model 2 of {models}")), "{texts:?}");
}

/// The report with the fit comes once, from the same computation: no stage runs twice.
#[test]
fn the_fit_is_reported_before_the_rest_of_its_analysis() {
    let (observer, parts) = (Recorder::default(), Mutex::new(Vec::new()));
    let (whole, error) = Report::observed_in_parts(
        &bright(),
        &options(),
        ModelChoice::Given,
        Depth::Assessed,
        &observer,
        &|report| {
            assert!(observer.of(Phase::Assessment).is_empty());
            parts.lock().unwrap().push(report.clone());
        },
    );
    assert_eq!(error, None);
    let parts = parts.into_inner().unwrap();
    let [part] = parts.as_slice() else {
        panic!("{} reports", parts.len());
    };
    assert!(part.assessment.is_none() && whole.assessment.is_some());
    assert_eq!(part.fit, whole.fit);
    assert_eq!(part.uncertainty, whole.uncertainty);
    assert_eq!(part.warnings, whole.warnings);
    let starts = observer.of(Phase::Stage1);
    let starts = starts
        .iter()
        .filter(|step| step.iteration == 0 && step.parameters.is_some());
    assert_eq!(starts.count(), 1);
    let (plain, _) = Report::new(&bright(), &options(), Depth::Assessed);
    let fits = [&whole, &plain].map(|report| without_times(report.fit.clone().unwrap()));
    assert_eq!(fits[0], fits[1]);
    assert_eq!(whole.uncertainty, plain.uncertainty);
    assert_eq!(whole.assessment, plain.assessment);
}

#[test]
fn phases_have_words() {
    assert_eq!(
        PHASES.map(|phase| phase.to_string())[..3],
        ["stage 1", "stage 2", "global check"]
    );
}
