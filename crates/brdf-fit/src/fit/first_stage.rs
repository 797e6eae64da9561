//! The readings that the first stage of a fit is of.

use super::options::FitOptions;
use crate::format::{counted, in_degrees};
use crate::objective::Objective;
use crate::scan::{Incidence, Measurements, up_to};

/// The readings of the first stage.
#[derive(Debug, Clone)]
pub(super) struct FirstStage {
    /// The incidences that the initial values are taken from, where the rows of the objective are not
    /// readings.
    pub(super) incidences: Vec<Incidence>,
    /// The number of its incidences; `None` where they are all.
    pub(super) part: Option<usize>,
    /// E over the readings of the stage, where they are a part and the stage is alone. Before another
    /// stage, it is made for the time of the stage.
    pub(super) objective: Option<Objective>,
    /// Why stage 1 is left out although the options ask for it.
    pub(super) left_out: Option<String>,
}

impl FirstStage {
    /// The readings up to the limit of stage 1, where they suffice for it.
    pub(super) fn choose(
        all: &Objective,
        measurements: &Measurements,
        options: &FitOptions,
    ) -> Self {
        let chosen = up_to(all.segments(), |segment| segment.psi, options.stage1_limit);
        let count = chosen.len();
        let readings: usize = chosen.iter().map(|segment| segment.readings).sum();
        let (own, left_out) = if options.stage1.is_none() || readings == all.count() {
            (None, None)
        } else if readings <= options.reduced_model().free().len() {
            let limit_deg = in_degrees(options.stage1_limit);
            let readings = counted(readings, "reading");
            (None, Some(format!("{readings} up to {limit_deg} deg")))
        } else {
            match all.subset(|i| i < count) {
                Ok(objective) => (Some(objective), None),
                Err(error) => (None, Some(error.to_string())),
            }
        };
        let mut incidences = if all.readings().is_empty() {
            measurements.incidences()
        } else {
            Vec::new()
        };
        if own.is_some() {
            incidences.truncate(count);
        }
        Self {
            incidences,
            part: own.is_some().then_some(count),
            objective: own.filter(|_| options.stage2.is_none()),
            left_out,
        }
    }
}
