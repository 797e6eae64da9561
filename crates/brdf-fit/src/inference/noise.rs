//! The errors of the readings as the residuals show them: their sizes, and tests of whether they are
//! independent and of constant size.

use serde::{Deserialize, Serialize};
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

use super::terms::{Grid, Readings, Source};
use super::variance_components::{Common, Components, INDEPENDENT, Terms, common_errors, estimate};

/// The significance level of each test.
pub const TEST_LEVEL: f64 = 0.01;

/// The source of the errors of the readings.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Noise {
    /// The residuals.
    Residuals,
    /// The standard deviations that the scan states, with a factor that the residuals require.
    Given {
        /// Reduced chi square: the sum of (residual / sigma)^2 over the degrees of freedom. Far
        /// above 1, the model deviates from the readings by more than their errors.
        reduced_chi_square: f64,
    },
}

/// The sizes of the components of the errors, estimated from the residuals of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ErrorSizes {
    /// A constant error of f_r cos theta, in percent of the rms of the model's values.
    pub constant_percent: f64,
    /// The error that grows with the square root of the reading, at a reading of the rms, in percent.
    pub counting_percent: f64,
    /// The error of each reading in proportion to it, in percent.
    pub proportional_percent: f64,
    /// The factor on stated standard deviations, at least 1; `None` where they are not used.
    pub stated_factor: Option<f64>,
    /// The error that the readings of a patch of 20 deg have in common, in percent of them.
    pub patch_percent: f64,
    /// The error that the readings of an incidence have in common, in percent of them; `None` with one
    /// incidence, where it is not visible.
    pub incidence_percent: Option<f64>,
}

impl ErrorSizes {
    pub(super) fn new(components: &Components, source: Source, full_incidences: usize) -> Self {
        let percent = |variance: f64| 100.0 * variance.sqrt();
        let [first, counting, proportional] = components.white;
        let constant = if source == Source::Residuals {
            first
        } else {
            0.0
        };
        Self {
            constant_percent: percent(constant),
            counting_percent: percent(counting),
            proportional_percent: percent(proportional),
            stated_factor: (source == Source::Stated).then(|| first.sqrt()),
            patch_percent: percent(components.patch),
            incidence_percent: (full_incidences > 1).then(|| percent(components.gain)),
        }
    }

    /// The error in proportion to the reading: of each, of patches and of incidences together, as a
    /// fraction.
    pub fn relative(&self) -> f64 {
        let of_incidence = self.incidence_percent.unwrap_or(0.0);
        0.01 * self
            .proportional_percent
            .hypot(self.patch_percent)
            .hypot(of_incidence)
    }
}

/// Tests of whether the residuals contradict independent errors of constant size in f_r cos theta, or
/// in proportion to it.
///
/// The first is Spearman's rank correlation of the model's values with the squared residuals. The
/// others compare what the readings of an incidence, or of a patch of 20 deg, have in common with what
/// independent errors t1 + t3 mu^2 would (score tests of the variance components t5 and t4, with
/// Satterthwaite's approximation of their distribution).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct NoiseTests {
    /// The p-value of "the errors do not grow with the reading".
    pub growth_p: f64,
    /// The p-value of "incidences do not differ as wholes"; `None` with fewer than two.
    pub incidence_p: Option<f64>,
    /// The p-value of "neighbouring readings do not err together"; `None` with one patch.
    pub patch_p: Option<f64>,
}

impl NoiseTests {
    /// `None` where no more readings than parameters are left.
    pub(super) fn of<const P: usize>(readings: &Readings<P>) -> Option<Self> {
        if readings.count() <= P + 2 {
            return None;
        }
        let (terms, _) = readings.sorted(Grid::Centred);
        let components = estimate(&terms, INDEPENDENT);
        let patches = common_errors(&terms, &components);
        let incidences = merged(&terms, &patches);
        Some(Self {
            growth_p: growth(&readings.sizes_and_squares()),
            incidence_p: (incidences.len() > 1).then(|| score_test(&incidences)),
            patch_p: (patches.len() > 1).then(|| score_test(&patches)),
        })
    }

    /// Whether the errors grow with the reading.
    pub fn grows(&self) -> bool {
        self.growth_p < TEST_LEVEL
    }

    /// Whether whole incidences lie high or low together.
    pub fn incidences_differ(&self) -> bool {
        self.incidence_p.is_some_and(|p| p < TEST_LEVEL)
    }

    /// Whether neighbouring readings err together.
    pub fn neighbours_err_together(&self) -> bool {
        self.patch_p.is_some_and(|p| p < TEST_LEVEL)
    }
}

/// What the readings of each incidence have in common.
fn merged<const P: usize>(terms: &Terms<P>, patches: &[Common<P>]) -> Vec<Common<P>> {
    let mut incidences = vec![Common::ZERO; terms.incidences];
    for (patch, common) in terms.patches.iter().zip(patches) {
        incidences[patch.incidence].add(common);
    }
    incidences
}

/// The p-value of the sum of squares of what groups have in common.
fn score_test<const P: usize>(groups: &[Common<P>]) -> f64 {
    let statistic: f64 = groups.iter().map(|group| group.residual.powi(2)).sum();
    let (mut expected, mut squares, mut products) = (0.0, 0.0, [[0.0; P]; P]);
    for group in groups {
        let lost: f64 = group.projected.iter().map(|q| q * q).sum();
        expected += group.information - lost;
        squares += group.information * (group.information - 2.0 * lost);
        for (row, a) in products.iter_mut().zip(&group.projected) {
            for (product, b) in row.iter_mut().zip(&group.projected) {
                *product += a * b;
            }
        }
    }
    squares += products.as_flattened().iter().map(|x| x * x).sum::<f64>();
    let degrees = expected * expected / squares;
    let tail = ChiSquared::new(degrees).map(|chi| chi.sf(statistic * degrees / expected));
    tail.unwrap_or(1.0)
}

/// The p-value of Spearman's rank correlation.
fn growth(pairs: &[(f64, f64)]) -> f64 {
    let first = ranks(pairs.iter().map(|pair| pair.0));
    let second = ranks(pairs.iter().map(|pair| pair.1));
    let mean = 0.5 * (pairs.len() as f64 + 1.0);
    let (mut product, mut squares) = (0.0, [0.0; 2]);
    for (a, b) in first.iter().zip(&second) {
        let (a, b) = (a - mean, b - mean);
        product += a * b;
        squares[0] += a * a;
        squares[1] += b * b;
    }
    let correlation = product / (squares[0] * squares[1]).sqrt();
    if !correlation.is_finite() {
        return 1.0;
    }
    let deviations = correlation.abs() * (pairs.len() as f64 - 1.0).sqrt();
    2.0 * Normal::standard().cdf(-deviations)
}

/// The rank of each value from 1 on; equal values share the mean of their ranks.
fn ranks(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut order: Vec<(f64, usize)> = values.zip(0..).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut ranks = vec![0.0; order.len()];
    let mut start = 0;
    for group in order.chunk_by(|a, b| a.0 == b.0) {
        let mean = start as f64 + 0.5 * (group.len() as f64 + 1.0);
        for (_, i) in group {
            ranks[*i] = mean;
        }
        start += group.len();
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_values_share_the_mean_of_their_ranks() {
        assert_eq!(
            ranks([3.0, 1.0, 3.0, 2.0].into_iter()),
            [3.5, 1.0, 3.5, 2.0]
        );
    }

    #[test]
    fn perfectly_correlated_values_are_significant_and_shuffled_ones_are_not() {
        let grows: Vec<(f64, f64)> = (0..30).map(|i| (f64::from(i), f64::from(i * i))).collect();
        assert!(growth(&grows) < 1e-6);
        let shuffled: Vec<(f64, f64)> = (0..30)
            .map(|i| (f64::from(i), f64::from(i * 7 % 30)))
            .collect();
        assert!(growth(&shuffled) > 0.1);
        assert_eq!(growth(&[(1.0, 2.0); 5]), 1.0);
    }
}
