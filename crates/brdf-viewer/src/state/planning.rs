//! The next readings of a scan: planned by the worker, shown in the plot, copied as a list.

use std::sync::Arc;

use brdf_fit::Measurements;
use brdf_fit::planning::MeasurementPlan;

use super::id::ScanId;
use super::sample::Scan;
use super::{Effect, State};
use crate::job::{FileJob, Job};

impl Scan {
    /// The plan of the next readings, unless other readings are used since it was made.
    pub fn current_plan(&self) -> Option<&MeasurementPlan> {
        let (readings, plan) = self.plan.as_ref()?;
        Arc::ptr_eq(readings, self.used()).then_some(plan)
    }
}

impl State {
    /// Plans the next readings of the current scan.
    pub(super) fn plan(&mut self) {
        let Some(sample) = self.active_sample() else {
            return;
        };
        let job = FileJob::Plan(sample.scan_id(), Arc::clone(sample.scan().used()));
        self.plans_being_made += 1;
        self.start(Job::File(job));
    }

    /// Takes over a plan, or the message that says why there is none.
    pub(super) fn take_plan(
        &mut self,
        id: ScanId,
        readings: Arc<Measurements>,
        plan: Result<Box<MeasurementPlan>, String>,
    ) {
        self.plans_being_made = self.plans_being_made.saturating_sub(1);
        match plan {
            Ok(plan) => {
                if let Some(scan) = self.scan_mut(id) {
                    scan.plan = Some((readings, plan));
                }
            }
            Err(error) => self.report_error(error),
        }
    }

    /// Copies the planned readings of the current scan.
    pub(super) fn copy_plan(&mut self) {
        let Some(text) = self.active_sample().and_then(|sample| {
            let plan = sample.scan().current_plan();
            plan.map(|plan| plan.csv(None))
        }) else {
            return;
        };
        "planned readings copied".clone_into(&mut self.status);
        self.effects.push(Effect::Copy(text));
    }
}
