//! The objective over some of its rows, or with other weights.

use std::sync::Arc;

use brdf_core::ModelParameters;

use super::error::ObjectiveError;
use super::rows::{Directions, Objective, Segment};
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
        let kept: Vec<&Segment> = kept.map(|(_, segment)| segment).collect();
        match kept.last() {
            Some(last) if *last == &self.segments[kept.len() - 1] => self.first(kept.len()),
            _ => self.picked(kept.into_iter(), 1),
        }
    }

    /// The objective over the first incidences, of which there is at least one. It shares the directions
    /// of the rows.
    fn first(&self, incidences: usize) -> Result<Self, ObjectiveError> {
        let segments = self.segments[..incidences].to_vec();
        let rows = segments.last().map_or(0, |last| last.rows.end);
        let objective = Self {
            measured: self.measured[..rows].to_vec(),
            diffuse: self.diffuse[..rows].to_vec(),
            shadowed: self.shadowed[..rows].to_vec(),
            directions: Arc::clone(&self.directions),
            noise: self.noise.as_ref().map(|noise| noise[..rows].to_vec()),
            segments,
            ..*self
        };
        objective.normalised()
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
        let of_threes = self.readings().is_empty() && step.is_multiple_of(3);
        self.picked(self.segments.iter(), step + usize::from(of_threes))
    }

    /// The objective over every `step`-th row of the given incidences.
    fn picked<'a>(
        &self,
        segments: impl Iterator<Item = &'a Segment>,
        step: usize,
    ) -> Result<Self, ObjectiveError> {
        let rows = self.len() / step;
        let mut objective = Self::with_capacity(self.family, self.n, rows);
        let mut directions = Directions::with_capacity(rows);
        if self.noise.is_none() {
            objective.noise = None;
        }
        for segment in segments {
            let start = objective.len();
            for i in segment.rows.clone().step_by(step) {
                objective.measured.push(self.measured[i]);
                objective.diffuse.push(self.diffuse[i]);
                objective.shadowed.push(self.shadowed[i]);
                directions.fresnel.push(self.directions.fresnel[i]);
                directions.angles.push(self.directions.angles.get(i));
                directions.readings.extend(self.readings().get(i));
                if let (Some(to), Some(from)) = (&mut objective.noise, &self.noise) {
                    to.push(from[i]);
                }
            }
            objective.close_segment(segment.psi, start);
            if let (1, Some(whole)) = (step, objective.segments.last_mut()) {
                (whole.readings, whole.zero_weight) = (segment.readings, segment.zero_weight);
            }
        }
        objective.directions = Arc::new(directions);
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

#[cfg(test)]
mod tests {
    use brdf_core::{Family, Parameters};

    use super::*;
    use crate::model::Parameter;
    use crate::objective::weights::Weights;
    use crate::scan::synthetic::scan;

    fn objective() -> Objective {
        let scan = scan(Parameters::new(0.3, 0.1, 0.2).unwrap(), 1.5);
        Objective::new(&scan, Family::Paper, 1.5, &Weights::default()).unwrap()
    }

    #[test]
    fn the_first_incidences_and_other_weights_share_the_directions_of_all() {
        let all = objective();
        let shares = |other: &Objective| Arc::strong_count(&other.directions) > 1;
        assert!(shares(&all.subset(|i| i < 3).unwrap()));
        assert!(shares(&all.reweighted(|i| 1.0 + i as f64).unwrap()));
        assert!(!shares(&all.subset(|i| i != 1).unwrap()));
        assert!(!shares(&all.thinned(20).unwrap()));
    }

    #[test]
    fn shared_directions_are_those_of_the_rows() {
        let all = objective();
        let shared = all.subset(|i| i < 3).unwrap();
        let copied = all.picked(all.segments[..3].iter(), 1).unwrap();
        let at = ModelParameters {
            k2: 0.2,
            kd: 0.15,
            k1: 0.3,
            n: 1.7,
            p: 1.2,
        };
        assert_eq!(shared.error(&at), copied.error(&at));
        assert_eq!(
            shared.normal_equations(&at, &Parameter::ALL),
            copied.normal_equations(&at, &Parameter::ALL)
        );
        assert_eq!(shared.readings(), copied.readings());
        assert_eq!(shared.segments(), copied.segments());
        assert_eq!(shared.row_weights(), copied.row_weights());
        assert_eq!(shared.fresnel_column(1.5), copied.fresnel_column(1.5));
        assert_eq!(shared.fresnel_column(2.0), copied.fresnel_column(2.0));
    }
}
