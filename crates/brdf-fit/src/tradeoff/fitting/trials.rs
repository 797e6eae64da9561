//! The ways to fit a scan that are compared.

use std::borrow::Cow;
use std::fmt;

use brdf_core::ModelParameters;

use super::error::TrialError;
use super::profile_alone::{Depth, fit_by_profile};
use super::reduced::{
    every_reading, every_second_incidence, without_largest, without_largest_name,
};
use crate::fit::FitOptions;
use crate::fit::{Fit, Stage, fit};
use crate::format::counted;
use crate::scan::Measurements;
use crate::solver::{Method, Termination};
use crate::solver::{Method::LevenbergMarquardt as Lm, Method::NelderMead as Nm};

/// Of each incidence every `step`-th reading, and the name of that.
const STEPS: [(usize, &str); 3] = [
    (2, "every 2nd reading"),
    (4, "every 4th reading"),
    (8, "every 8th reading"),
];

/// Numbers of readings of the samples of a table.
const SAMPLES: [usize; 6] = [262_144, 65_536, 16_384, 4096, 1024, 256];

/// Largest numbers of iterations of each stage.
const ITERATIONS: [u64; 5] = [1, 2, 4, 8, 16];

/// The methods of stage 1 and of stage 2, their name, and whether they are also tried with the global
/// check.
const METHODS: [(Option<Method>, Option<Method>, &str, bool); 8] = [
    (Some(Lm), Some(Lm), "LM", true),
    (None, Some(Lm), "LM, stage 2 only", true),
    (Some(Lm), None, "LM, stage 1 only", false),
    (Some(Nm), Some(Nm), "NM", true),
    (None, Some(Nm), "NM, stage 2 only", false),
    (Some(Nm), None, "NM, stage 1 only", false),
    (Some(Nm), Some(Lm), "NM, then LM", false),
    (Some(Lm), Some(Nm), "LM, then NM", false),
];

/// One way to fit a scan.
pub(super) struct Trial<'a> {
    pub(super) name: String,
    pub(super) options: FitOptions,
    /// The readings that it fits, or why the scan has no such readings.
    scan: Readings<'a>,
    by: By,
}

/// All or some of the readings of a scan.
type Readings<'a> = Result<Cow<'a, Measurements>, TrialError>;

/// The procedure of a trial.
#[derive(Debug, Clone, Copy)]
enum By {
    /// The stages of the options.
    Stages,
    /// The profile alone, at this n where that is not free.
    Profile { n: f64, depth: Depth },
}

/// The result of a trial.
pub(super) struct Found {
    pub(super) parameters: ModelParameters,
    pub(super) stages: Stages,
    pub(super) readings: usize,
    pub(super) incidences: usize,
    pub(super) converged: bool,
    pub(super) ended_by: String,
}

/// The stages of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stages {
    Both,
    AllOnly,
    Stage1Only,
}

impl Stages {
    fn of<T>(stage1: Option<T>, stage2: Option<T>) -> Self {
        match (stage1, stage2) {
            (Some(_), Some(_)) => Self::Both,
            (None, _) => Self::AllOnly,
            (Some(_), None) => Self::Stage1Only,
        }
    }
}

impl fmt::Display for Stages {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Both => "both",
            Self::AllOnly => "all incidences only",
            Self::Stage1Only => "stage 1 only",
        })
    }
}

/// The options of the reference: Levenberg-Marquardt in both stages until it converges, and the global
/// check.
pub(super) fn reference_options(options: &FitOptions) -> FitOptions {
    let default = FitOptions::default();
    FitOptions {
        stage1: default.stage1,
        stage2: default.stage2,
        max_iterations: default.max_iterations,
        global_check: true,
        ..options.clone()
    }
}

/// All trials with a scan, the reference first. `whole` are the options of the reference, and n its
/// refractive index.
///
/// The global check takes the same time after any stages and would complete a fit that few
/// iterations leave unfinished: only some methods are tried with it.
pub(super) fn trials<'a>(scan: &'a Measurements, whole: &FitOptions, n: f64) -> Vec<Trial<'a>> {
    let mut trials = Vec::new();
    for (stage1, stage2, name, with_check) in METHODS {
        let stages = FitOptions {
            stage1,
            stage2,
            ..whole.clone()
        };
        if with_check {
            trials.push(Trial::of(scan, format!("{name} + check"), stages.clone()));
        }
        trials.push(Trial::of(scan, name.to_owned(), without_check(&stages)));
    }
    for (depth, name) in [
        (Depth::Grid, "profile"),
        (Depth::Refined, "profile, refined"),
    ] {
        trials.push(Trial::of_profile(
            scan,
            name,
            whole,
            By::Profile { n, depth },
        ));
    }
    for (name, fewer) in fewer_readings(scan) {
        trials.push(Trial {
            name,
            options: without_check(whole),
            scan: fewer,
            by: By::Stages,
        });
    }
    trials.extend(ITERATIONS.map(|most| {
        let options = FitOptions {
            max_iterations: most,
            ..without_check(whole)
        };
        let count = usize::try_from(most).unwrap_or(usize::MAX);
        Trial::of(scan, counted(count, "iteration"), options)
    }));
    trials
}

fn without_check(options: &FitOptions) -> FitOptions {
    FitOptions {
        global_check: false,
        ..options.clone()
    }
}

fn fewer_readings(scan: &Measurements) -> Vec<(String, Readings<'_>)> {
    let mut fewer: Vec<(String, Readings<'_>)> = if scan.is_table() {
        samples(scan).collect()
    } else {
        let every = |(step, name): &(usize, &str)| {
            (name.to_string(), Ok(Cow::Owned(every_reading(scan, *step))))
        };
        STEPS.iter().map(every).collect()
    };
    let second = every_second_incidence(scan).map(Cow::Owned);
    fewer.push(("every 2nd incidence".to_owned(), second));
    let smaller = without_largest(scan).map(Cow::Owned);
    fewer.push((without_largest_name(scan), smaller));
    fewer
}

/// Samples of a table, in descending order of their size.
fn samples(table: &Measurements) -> impl Iterator<Item = (String, Readings<'_>)> {
    let all = table.readings().len();
    let counts = SAMPLES.into_iter().filter(move |&count| count < all);
    counts.map(|count| {
        let sampled = Ok(Cow::Owned(table.sampled(count)));
        (format!("sample of {count}"), sampled)
    })
}

impl<'a> Trial<'a> {
    /// A fit of all readings by stages.
    fn of(scan: &'a Measurements, name: String, options: FitOptions) -> Self {
        Self {
            name,
            options,
            scan: Ok(Cow::Borrowed(scan)),
            by: By::Stages,
        }
    }

    /// A fit of all readings by the profile. It has no stages; its options are those of a single one.
    fn of_profile(scan: &'a Measurements, name: &str, whole: &FitOptions, by: By) -> Self {
        let options = FitOptions {
            stage1: None,
            ..without_check(whole)
        };
        Self {
            by,
            ..Self::of(scan, name.to_owned(), options)
        }
    }
}

impl Trial<'_> {
    /// The methods: `levenberg-marquardt`, `nelder-mead`, both in their order, or `profile`.
    pub(super) fn method(&self) -> String {
        let (first, last) = (self.options.stage1, self.options.stage2);
        match (self.by, first, last) {
            (By::Profile { .. }, _, _) => "profile".to_owned(),
            (By::Stages, Some(first), Some(last)) if first != last => format!("{first}, {last}"),
            (By::Stages, first, last) => first
                .or(last)
                .map_or_else(String::new, |method| method.to_string()),
        }
    }

    /// The stages that are requested, and the numbers of readings and incidences.
    pub(super) fn requested(&self) -> (Stages, usize, usize) {
        let stages = Stages::of(self.options.stage1, self.options.stage2);
        let Ok(scan) = &self.scan else {
            return (stages, 0, 0);
        };
        let fitted = self.options.fitted_readings(scan);
        (stages, fitted.readings().len(), fitted.incidences().len())
    }

    /// Fits the readings of the trial.
    ///
    /// # Errors
    ///
    /// The scan has no such readings, or they cannot be fitted.
    pub(super) fn run(&self) -> Result<Found, TrialError> {
        let scan = self.scan.as_ref().map_err(TrialError::clone)?;
        match self.by {
            By::Stages => Ok(Found::of(&fit(scan, &self.options)?)),
            By::Profile { n, depth } => {
                let found = fit_by_profile(scan, &self.options, n, depth)?;
                let (stages, readings, incidences) = self.requested();
                Ok(Found {
                    parameters: found.parameters,
                    stages,
                    readings,
                    incidences,
                    converged: true,
                    ended_by: found.ended_by,
                })
            }
        }
    }
}

impl Found {
    fn of(fit: &Fit) -> Self {
        let last = fit.last_stage();
        let check = fit.global_check.as_ref();
        let replaced = check.is_some_and(|check| check.lower_minimum_taken);
        let ended_by = last.map_or_else(String::new, ended_by);
        Self {
            parameters: fit.at(),
            stages: Stages::of(fit.stage1, fit.stage2),
            readings: fit.readings,
            incidences: fit.incidences.len(),
            converged: replaced
                || last.is_some_and(|s| s.termination != Termination::IterationLimit),
            ended_by: if replaced {
                format!("{ended_by}; lower minimum of the check")
            } else {
                ended_by
            },
        }
    }
}

/// `LM: step too small`.
fn ended_by(stage: &Stage) -> String {
    format!("{}: {}", stage.method.short_name(), stage.termination)
}

#[cfg(test)]
mod tests {
    use brdf_core::Parameters;

    use super::*;

    #[test]
    fn the_names_of_the_trials_differ_and_the_reference_is_first() {
        let scan = crate::scan::synthetic::scan(Parameters::new(0.3, 0.1, 0.2).unwrap(), 1.5);
        let whole = reference_options(&FitOptions::default());
        let trials = trials(&scan, &whole, 1.5);
        assert_eq!(trials[0].options, whole);
        let mut names: Vec<&str> = trials.iter().map(|trial| trial.name.as_str()).collect();
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count);
    }

    #[test]
    fn the_reference_converges_whatever_the_options_are() {
        let options = FitOptions {
            stage1: None,
            stage2: Some(Nm),
            max_iterations: 3,
            global_check: false,
            ..FitOptions::default()
        };
        assert_eq!(reference_options(&options), FitOptions::default());
    }

    #[test]
    fn a_table_is_tried_by_samples() {
        let mut table = crate::scan::synthetic::scan(Parameters::new(0.3, 0.1, 0.2).unwrap(), 1.5);
        table.incidence_class = Some(0.1);
        table.readings.extend(table.readings.clone());
        let trials = trials(&table, &FitOptions::default(), 1.5);
        let found = trials
            .iter()
            .find(|trial| trial.name == "sample of 256")
            .unwrap();
        assert_eq!(found.requested().1, 256);
        assert!(
            trials
                .iter()
                .all(|trial| !trial.name.starts_with("every 2nd reading"))
        );
    }

    #[test]
    fn methods_are_named_in_their_order() {
        let scan = Measurements::default();
        let trials = trials(&scan, &FitOptions::default(), 1.5);
        let methods = |name: &str| {
            let mut all = trials.iter();
            all.find(|trial| trial.name == name).map(Trial::method)
        };
        assert_eq!(methods("NM, stage 1 only").as_deref(), Some("nelder-mead"));
        let mixed = methods("NM, then LM");
        assert_eq!(mixed.as_deref(), Some("nelder-mead, levenberg-marquardt"));
        assert_eq!(methods("profile").as_deref(), Some("profile"));
    }
}
