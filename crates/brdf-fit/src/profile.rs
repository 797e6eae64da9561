//! The exact minimum over k2 and kD for a given k1, and the search over k1 that checks each fit
//! against the global optimum.
//!
//! For a fixed k1 the model is linear in k2 and kD, so E has one minimum over k2 >= 0, kD >= 0,
//! which is known in closed form. What remains is a function of k1 alone, the profile.

use argmin::core::{CostFunction, Error, Executor, State};
use argmin::solver::brent::BrentOpt;
use brdf_core::Parameters;
use serde::{Deserialize, Serialize};

use crate::criterion::{Criterion, ProfileSums};
use crate::solver::K1_RANGE;

/// Steps of the search, equal in ln k1: 0.25 each. As a function of ln k1 the model has its nearest
/// singularity at a distance of pi/2 in the complex plane, so that its profile cannot have
/// features much narrower.
const STEPS: u32 = 83;

/// A minimum is refined until ln k1 is known to this: E, flat there, is then known to 1e-10 of itself.
const REFINED: f64 = 1e-5;

/// The profile at one k1: the best weights there, and E with them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ProfilePoint {
    /// k2, kD and k1.
    pub parameters: Parameters,
    /// E as a fraction (in JSON `e_fraction`).
    #[serde(rename = "e_fraction")]
    pub error: f64,
}

/// E minimised over k2 >= 0 and kD >= 0 at the given k1.
pub fn best_weights(criterion: &Criterion, k1: f64) -> ProfilePoint {
    let (k2, kd, error) = solve(&criterion.profile_sums(k1));
    ProfilePoint {
        parameters: Parameters { k2, kd, k1 },
        error,
    }
}

/// k2, kD and E of the best weights.
///
/// Either both are positive and the normal equations hold for both, or one is zero and the other
/// is the best by itself.
pub(crate) fn solve(sums: &ProfileSums) -> (f64, f64, f64) {
    let &ProfileSums { uu, ua, uy, aa, ay } = sums;
    let determinant = uu * aa - ua * ua;
    // Collinear to rounding: the two parts cannot be told apart, and one of them does as well.
    if determinant > 1e-14 * uu * aa {
        let k2 = (uy * aa - ay * ua) / determinant;
        let kd = (ay * uu - uy * ua) / determinant;
        if k2 >= 0.0 && kd >= 0.0 {
            return (k2, kd, 1.0 - k2 * uy - kd * ay);
        }
    }
    let specular = if uu > 0.0 { (uy / uu).max(0.0) } else { 0.0 };
    let diffuse = (ay / aa).max(0.0);
    if specular * uy > diffuse * ay {
        (specular, 0.0, 1.0 - specular * uy)
    } else {
        (0.0, diffuse, 1.0 - diffuse * ay)
    }
}

/// The profile over the whole range of k1, with its minima.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Points in equal steps of ln k1.
    pub points: Vec<ProfilePoint>,
}

impl Profile {
    /// Evaluates the profile over [`K1_RANGE`].
    pub fn search(criterion: &Criterion) -> Self {
        let span = (K1_RANGE.1 / K1_RANGE.0).ln();
        let k1 = |step| match step {
            0 => K1_RANGE.0,
            STEPS => K1_RANGE.1,
            _ => K1_RANGE.0 * (span * f64::from(step) / f64::from(STEPS)).exp(),
        };
        let points = (0..=STEPS)
            .map(|step| best_weights(criterion, k1(step)))
            .collect();
        Self { points }
    }

    /// The lowest of the points.
    pub fn lowest_point(&self) -> ProfilePoint {
        let points = self.points.iter().copied();
        points
            .min_by(|a, b| a.error.total_cmp(&b.error))
            .unwrap_or(self.points[0])
    }

    /// The lowest minimum, each local one refined.
    pub fn global_minimum(&self, criterion: &Criterion) -> ProfilePoint {
        let last = self.points.len() - 1;
        let error = |i: usize| self.points[i].error;
        (0..=last)
            .filter(|&i| {
                (i == 0 || error(i) <= error(i - 1)) && (i == last || error(i) < error(i + 1))
            })
            .map(|i| {
                let left = self.points[i.saturating_sub(1)];
                let right = self.points[(i + 1).min(last)];
                refine(criterion, left, self.points[i], right)
            })
            .min_by(|a, b| a.error.total_cmp(&b.error))
            .unwrap_or(self.points[0])
    }
}

/// The minimum between the neighbours of a lowest point, by Brent's method in ln k1.
fn refine(
    criterion: &Criterion,
    left: ProfilePoint,
    lowest: ProfilePoint,
    right: ProfilePoint,
) -> ProfilePoint {
    let log_k1 = |point: ProfilePoint| point.parameters.k1.ln();
    let solver = BrentOpt::new(log_k1(left), log_k1(right)).set_tolerance(REFINED, REFINED);
    let found = Executor::new(InLogK1(criterion), solver)
        .configure(|state| state.max_iters(100))
        .ctrlc(false)
        .run()
        .ok()
        .and_then(|result| result.state.get_best_param().copied());
    // At the ends of the range the lowest point may be the end itself.
    found
        .map(|log_k1| best_weights(criterion, log_k1.exp().clamp(K1_RANGE.0, K1_RANGE.1)))
        .filter(|point| point.error < lowest.error)
        .unwrap_or(lowest)
}

/// The profile as a function of ln k1.
struct InLogK1<'a>(&'a Criterion);

impl CostFunction for InLogK1<'_> {
    type Param = f64;
    type Output = f64;

    fn cost(&self, log_k1: &f64) -> Result<f64, Error> {
        Ok(best_weights(self.0, log_k1.exp()).error)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::synthetic::scan;
    use crate::weights::Weights;

    fn criterion(k2: f64, kd: f64, k1: f64) -> Criterion {
        let mut readings = scan(Parameters::new(k2, kd, k1).unwrap(), 1.5)
            .readings()
            .to_vec();
        for (i, reading) in readings.iter_mut().enumerate() {
            reading.brdf *= 1.0 + 0.1 * (i as f64).sin();
        }
        Criterion::new(&readings, 1.5, &Weights::default()).unwrap()
    }

    #[test]
    fn the_global_minimum_is_that_of_a_dense_scan() {
        let criterion = criterion(0.3, 0.1, 0.2);
        let found = Profile::search(&criterion).global_minimum(&criterion);
        let dense = (0..20_000)
            .map(|i| best_weights(&criterion, 1e-3 * 1.0005_f64.powi(i)).error)
            .fold(f64::INFINITY, f64::min);
        assert!(found.error <= dense && found.error > dense * (1.0 - 1e-6));
    }

    #[test]
    fn a_profile_without_a_minimum_ends_at_the_end_of_its_range() {
        // A peak between the readings: the narrower, the better.
        let mut readings = scan(Parameters::new(0.3, 0.1, 0.2).unwrap(), 1.5)
            .readings()
            .to_vec();
        for reading in &mut readings {
            reading.brdf = if reading.theta == -reading.psi {
                1e3
            } else {
                0.1
            };
        }
        let criterion = Criterion::new(&readings, 1.5, &Weights::default()).unwrap();
        let found = Profile::search(&criterion).global_minimum(&criterion);
        assert_eq!(found.parameters.k1, K1_RANGE.0);
    }

    proptest! {
        #[test]
        fn the_best_weights_are_the_best(
            k2 in 0.0..1.0, kd in 0.0..1.0, log_k1 in -3.0..0.5_f64, at in -5.0..2.0_f64,
            by_k2 in -0.5..0.5_f64, by_kd in -0.5..0.5_f64,
        ) {
            let criterion = criterion(k2 + 1e-3, kd, log_k1.exp());
            let best = best_weights(&criterion, at.exp());
            let Parameters { k2, kd, k1 } = best.parameters;
            prop_assert!(k2 >= 0.0 && kd >= 0.0);
            prop_assert!((criterion.error(&best.parameters) - best.error).abs() < 1e-13);
            let other = Parameters { k2: (k2 + by_k2).max(0.0), kd: (kd + by_kd).max(0.0), k1 };
            prop_assert!(criterion.error(&other) >= best.error - 1e-13);
        }
    }
}
