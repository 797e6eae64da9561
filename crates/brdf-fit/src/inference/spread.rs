//! The spread of fitted parameters by errors of known covariance, with the patches of one grid.

use statrs::distribution::{ContinuousCDF, StudentsT};

use super::terms::{Grid, Readings, Source};
use super::variance_components::{Components, Estimated, Terms, WHITE, estimate};

/// The probability below the upper end of an interval of 95 %.
pub(super) const UPPER_95: f64 = 0.975;

/// The quantile of Student's t.
pub(super) fn quantile(probability: f64, degrees_of_freedom: f64) -> f64 {
    // Beyond this the normal distribution is the same to four digits, and the quantile of t is not
    // computed accurately.
    let degrees = degrees_of_freedom.clamp(1.0, 1e5);
    StudentsT::new(0.0, 1.0, degrees).map_or(f64::NAN, |t| t.inverse_cdf(probability))
}

/// The spread of parameters with the patches of one grid.
pub(super) struct GridSpread<const P: usize> {
    pub(super) components: Components,
    pub(super) covariance: [[f64; P]; P],
    /// The degrees of freedom of each standard error.
    pub(super) degrees: [f64; P],
    /// Half of the interval of 95 %.
    pub(super) half_95: [f64; P],
}

impl<const P: usize> GridSpread<P> {
    pub(super) fn new(readings: &Readings<P>, grid: Grid, source: Source, share: f64) -> Self {
        let (terms, influence) = readings.sorted(grid);
        let estimated = match source {
            Source::Residuals => Estimated {
                white: [true; WHITE],
                patch: true,
                gain: readings.full_incidences > 1,
                least_first: 0.0,
            },
            Source::Stated => Estimated {
                white: [true, false, false],
                patch: true,
                gain: readings.full_incidences > 1,
                least_first: 1.0,
            },
        };
        let components = estimate(&terms, estimated);
        let parts = parts(&terms, &influence, &components, share);
        let count = readings.count() as f64 / share;
        let patches = terms.patches.len() as f64;
        let free = [
            count - patches - P as f64,
            patches - readings.incidences as f64,
            readings.full_incidences as f64 - 1.0,
        ]
        .map(|degrees| degrees.max(1.0));
        let squared_rms = readings.rms * readings.rms;
        let degrees: [f64; P] = std::array::from_fn(|i| {
            let variances = [0, 1, 2].map(|part| parts[part][i][i]);
            let sum: f64 = variances.iter().sum();
            let terms = variances.iter().zip(free).map(|(v, nu)| v * v / nu);
            (sum * sum / terms.sum::<f64>()).max(1.0)
        });
        let covariance: [[f64; P]; P] = std::array::from_fn(|i| {
            std::array::from_fn(|j| squared_rms * parts.iter().map(|part| part[i][j]).sum::<f64>())
        });
        Self {
            components,
            covariance,
            degrees,
            half_95: std::array::from_fn(|i| {
                quantile(UPPER_95, degrees[i]) * covariance[i][i].sqrt()
            }),
        }
    }

    /// The standard error of a parameter.
    pub(super) fn standard_error(&self, i: usize) -> f64 {
        self.covariance[i][i].sqrt()
    }
}

/// The covariance of the parameters by independent errors, by those of patches and by those of
/// incidences, in units of the squared rms of the model's values. `share` is the share of the readings
/// that stand for all: independent errors average over all of them.
fn parts<const P: usize>(
    terms: &Terms<P>,
    influence: &[[f64; P]],
    components: &Components,
    share: f64,
) -> [[[f64; P]; P]; 3] {
    let mut parts = [[[0.0; P]; P]; 3];
    let add = |part: &mut [[f64; P]; P], factor: f64, a: &[f64; P]| {
        for i in 0..P {
            for j in 0..P {
                part[i][j] += factor * a[i] * a[j];
            }
        }
    };
    let mut incidences = vec![[0.0; P]; terms.incidences];
    for patch in &terms.patches {
        let mut sum = [0.0; P];
        for i in patch.rows.clone() {
            let (row, a) = (&terms.rows[i], &influence[i]);
            let variance: f64 = (0..WHITE).map(|k| components.white[k] * row.white[k]).sum();
            add(&mut parts[0], variance * share, a);
            for c in 0..P {
                sum[c] += row.size * a[c];
            }
        }
        add(&mut parts[1], components.patch, &sum);
        for c in 0..P {
            incidences[patch.incidence][c] += sum[c];
        }
    }
    for sum in &incidences {
        add(&mut parts[2], components.gain, sum);
    }
    parts
}
