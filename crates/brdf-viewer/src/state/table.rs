//! The parameters as a table for other programs.

use std::fmt::Write as _;

use brdf_fit::format::digits;
use brdf_fit::inference::Estimate;

use super::sample::Sample;
use super::{Effect, State};

impl State {
    pub(super) fn copy_parameters(&mut self) {
        let Some(sample) = self.active_sample() else {
            return;
        };
        let text = parameter_table(sample);
        "parameters copied".clone_into(&mut self.status);
        self.effects.push(Effect::Copy(text));
    }
}

/// The parameters of the scan that is shown, as a table for other programs: columns separated by
/// tabs.
fn parameter_table(sample: &Sample) -> String {
    let scan = sample.scan();
    let knobs = scan.knobs;
    let mut text = "parameter\tvalue\tstandard error\t95 % from\t95 % to\n".to_owned();
    let uncertainty = scan
        .fit_shown()
        .and_then(|report| report.uncertainty.as_ref());
    for parameter in knobs.parameters() {
        let estimate = uncertainty.and_then(|u| u.estimate(parameter));
        let interval = estimate.map(Estimate::interval_95);
        let end = |end: Option<f64>| end.map_or_else(String::new, digits);
        let error = estimate.and_then(Estimate::standard_error);
        let _ = writeln!(
            text,
            "{parameter}\t{}\t{}\t{}\t{}",
            parameter.of(&knobs.at),
            end(error),
            end(interval.and_then(|i| i.from)),
            end(interval.and_then(|i| i.to)),
        );
    }
    text
}
