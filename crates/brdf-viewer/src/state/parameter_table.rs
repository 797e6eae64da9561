//! The parameters as a table for the clipboard.

use std::fmt::Write as _;

use brdf_fit::Estimate;
use brdf_fit::format::digits;

use super::sample::Scan;
use super::{Effect, State};

impl State {
    pub(super) fn copy_parameters(&mut self) {
        let Some(sample) = self.active_sample() else {
            return;
        };
        let text = parameter_table(sample.scan());
        "parameters copied".clone_into(&mut self.status);
        self.effects.push(Effect::Copy(text));
    }
}

/// The parameters of a scan with standard errors and 95 % intervals where available, in columns
/// separated by tabs.
fn parameter_table(scan: &Scan) -> String {
    let mut text = "parameter\tvalue\tstandard error\t95 % from\t95 % to\n".to_owned();
    let uncertainty = scan
        .current_fit()
        .and_then(|report| report.uncertainty.as_ref());
    for parameter in scan.parameters.model_parameters() {
        let estimate = uncertainty.and_then(|u| u.estimate(parameter));
        let interval = estimate.map(Estimate::interval_95);
        let cell = |value: Option<f64>| value.map_or_else(String::new, digits);
        let error = estimate.and_then(Estimate::standard_error);
        let _ = writeln!(
            text,
            "{parameter}\t{}\t{}\t{}\t{}",
            parameter.of(&scan.parameters.values),
            cell(error),
            cell(interval.and_then(|i| i.from)),
            cell(interval.and_then(|i| i.to)),
        );
    }
    text
}
