//! The objective over some of its rows, or with other weights.

use brdf_core::ModelParameters;

use super::error::ObjectiveError;
use super::rows::{Objective, Segment};
use super::weights::RELATIVE_FLOOR;

impl Objective {
    /// The objective over the incidences whose index `keep` accepts.
    ///
    /// # Errors
    ///
    /// E is not defined for these incidences.
    pub(crate) fn subset(&self, keep: impl Fn(usize) -> bool) -> Result<Self, ObjectiveError> {
        let segments = self.segments.iter().enumerate();
        let kept = segments.filter(|(i, _)| keep(*i));
        self.picked(kept.map(|(_, segment)| segment), 1)
    }

    /// The objective over about `limit` rows at most, evenly spaced within each incidence.
    ///
    /// # Errors
    ///
    /// E is not defined for these rows.
    pub(crate) fn thinned(&self, limit: usize) -> Result<Self, ObjectiveError> {
        let step = self.len().div_ceil(limit);
        // Condensed rows come in threes, the triangle of each cell. A step of a multiple of three
        // would take the same row of each triangle, which represents no readings.
        let of_threes = self.readings.is_empty() && step.is_multiple_of(3);
        self.picked(self.segments.iter(), step + usize::from(of_threes))
    }

    /// The objective over every `step`-th row of the given incidences.
    fn picked<'a>(
        &self,
        segments: impl Iterator<Item = &'a Segment>,
        step: usize,
    ) -> Result<Self, ObjectiveError> {
        let mut objective = Self::with_capacity(self.family, self.n, self.len() / step);
        if self.noise.is_none() {
            objective.noise = None;
        }
        for segment in segments {
            let start = objective.len();
            for i in segment.rows.clone().step_by(step) {
                objective.measured.push(self.measured[i]);
                objective.diffuse.push(self.diffuse[i]);
                objective.shadowed.push(self.shadowed[i]);
                objective.fresnel.push(self.fresnel[i]);
                objective.angles.push(self.angles[i]);
                objective.readings.extend(self.readings.get(i));
                if let (Some(to), Some(from)) = (&mut objective.noise, &self.noise) {
                    to.push(from[i]);
                }
            }
            objective.close_segment(segment.psi, start);
            if let (1, Some(whole)) = (step, objective.segments.last_mut()) {
                (whole.readings, whole.zero_weight) = (segment.readings, segment.zero_weight);
            }
        }
        objective.normalised()
    }

    /// The objective with the weight of each row multiplied by a factor >= 0.
    ///
    /// # Errors
    ///
    /// E is not defined with these weights.
    pub(crate) fn reweighted(&self, factor: impl Fn(usize) -> f64) -> Result<Self, ObjectiveError> {
        let mut objective = self.clone();
        for i in 0..self.len() {
            let root = factor(i).sqrt();
            objective.measured[i] *= root;
            objective.diffuse[i] *= root;
            objective.shadowed[i] *= root;
            if let Some(noise) = &mut objective.noise {
                noise[i] *= root;
            }
        }
        objective.normalised()
    }

    /// The objective with the weights of relative errors, 1/(m^2 + (0.02 rms)^2): m is f_r cos theta of
    /// the model at the given parameters, or of the readings.
    ///
    /// # Errors
    ///
    /// E is not defined with these weights.
    pub(crate) fn relative(&self, at: Option<&ModelParameters>) -> Result<Self, ObjectiveError> {
        let weights = self.row_weights();
        let rows = at.map(|at| self.residuals(at));
        let used = || {
            weights
                .iter()
                .enumerate()
                .filter(|(_, weight)| **weight > 0.0)
        };
        let reading = |i: usize| self.fixed_columns().0[i] / weights[i];
        let squares: f64 = used().map(|(i, _)| reading(i).powi(2)).sum();
        let floor = RELATIVE_FLOOR * (squares / used().count().max(1) as f64).sqrt();
        self.reweighted(|i| {
            if weights[i] == 0.0 {
                return 0.0;
            }
            let value = rows
                .as_ref()
                .map_or_else(|| reading(i), |rows| (rows[i].0 + rows[i].1) / weights[i]);
            (value * value + floor * floor).recip()
        })
    }
}
