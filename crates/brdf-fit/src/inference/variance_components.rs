//! The covariance of the readings' errors, estimated from the residuals of a fit.
//!
//! With the residuals e and the model's values mu, both relative to the rms of the model's values,
//! the errors have the covariance
//!
//! ```text
//! V = diag(t1 + t2 |mu| + t3 mu^2) + t4 sum_b mu_b mu_b^T + t5 sum_g mu_g mu_g^T,   t >= 0
//! ```
//!
//! `mu_b` is mu restricted to a patch b of neighbouring view directions, `mu_g` to an incidence g: a
//! constant error, one like counting statistics, one in proportion to the reading, one common to
//! neighbours, and one of the gain of each incidence. Where a scan states standard deviations, one
//! factor on their squares takes the place of t1, t2 and t3.
//!
//! The components maximise the restricted likelihood (Patterson and Thompson, Biometrika 58, 545,
//! 1971), which accounts for the parameters that were fitted. Each iteration multiplies a component
//! by a power of the ratio of its quadratic form and its trace (the minorise-maximise iteration of
//! Zhou, Hu, Qiao, Cho and Zhou, Journal of Computational and Graphical Statistics 28, 350, 2019).
//! The structure of V makes a step linear in the number of readings.

use std::ops::Range;

/// The largest number of iterations: standard errors are then within 2 % of those after 1000 for nine
/// scans in ten.
const STEPS: usize = 60;

/// The iteration ends where the mean variance moves by less than this fraction in a step.
const SETTLED: f64 = 2e-4;

/// The first iterations move by the square root of the ratio, the later ones by nearly all of it.
const CAREFUL_STEPS: usize = 8;

/// The number of independent components of a reading's variance.
pub(super) const WHITE: usize = 3;

/// The readings of non-zero weight as the estimate needs them. P is the number of fitted parameters.
#[derive(Debug, Clone)]
pub(super) struct Terms<const P: usize> {
    /// The readings, sorted by patches.
    pub(super) rows: Vec<Term<P>>,
    pub(super) patches: Vec<Patch>,
    /// The number of incidences.
    pub(super) incidences: usize,
}

/// One reading.
#[derive(Debug, Clone, Copy)]
pub(super) struct Term<const P: usize> {
    /// mu: the model's value of f_r cos theta over the rms of all.
    pub(super) size: f64,
    /// e: the residual over the rms of the model's values.
    pub(super) residual: f64,
    /// The derivatives of the model by each parameter, in any unit.
    pub(super) slopes: [f64; P],
    /// The variance for a component of 1, of each independent component.
    pub(super) white: [f64; WHITE],
}

/// Neighbouring readings of one incidence.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Patch {
    pub(super) rows: Range<usize>,
    pub(super) incidence: usize,
}

/// The components of the variance, relative to the mean square of the model's values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Components {
    /// Those of independent errors, one for each of [`Term::white`].
    pub(super) white: [f64; WHITE],
    /// t4, common to the readings of a patch.
    pub(super) patch: f64,
    /// t5, common to the readings of an incidence.
    pub(super) gain: f64,
}

impl Components {
    /// The change of each component's mean variance, added up, over the mean variance. The last of the
    /// mean shapes is that of patches and incidences.
    fn change(&self, before: &Self, shapes: &[f64; WHITE + 1]) -> f64 {
        let all = |components: &Self| {
            let [a, b, c] = components.white;
            [a, b, c, components.patch, components.gain]
        };
        let shapes = shapes.iter().chain(&shapes[WHITE..]);
        let (mut changed, mut total) = (0.0, 0.0);
        for ((now, before), shape) in all(self).iter().zip(all(before)).zip(shapes) {
            changed += (now - before).abs() * shape;
            total += now * shape;
        }
        changed / total
    }
}

/// The mean variance of the readings for each independent component of 1, and for one in proportion to
/// their squares.
fn mean_shapes<const P: usize>(terms: &Terms<P>) -> [f64; WHITE + 1] {
    let mut sums = [0.0; WHITE + 1];
    for row in &terms.rows {
        for (sum, shape) in sums.iter_mut().zip(&row.white) {
            *sum += shape;
        }
        sums[WHITE] += row.size * row.size;
    }
    sums.map(|sum| sum / terms.rows.len() as f64)
}

/// Which components are estimated; the others are zero.
#[derive(Debug, Clone, Copy)]
pub(super) struct Estimated {
    pub(super) white: [bool; WHITE],
    pub(super) patch: bool,
    pub(super) gain: bool,
    /// The lower bound of the first independent component.
    pub(super) least_first: f64,
}

/// A constant error and one in proportion to the reading, both independent.
pub(super) const INDEPENDENT: Estimated = Estimated {
    white: [true, false, true],
    patch: false,
    gain: false,
    least_first: 0.0,
};

/// The sums over one patch, or over one incidence.
#[derive(Debug, Clone, Copy)]
struct Sums<const P: usize> {
    /// mu^T V0^-1 mu, V0 being what was added to V before.
    information: f64,
    /// mu^T V0^-1 J.
    slopes: [f64; P],
    /// mu^T V0^-1 e.
    residual: f64,
}

impl<const P: usize> Sums<P> {
    const ZERO: Self = Self {
        information: 0.0,
        slopes: [0.0; P],
        residual: 0.0,
    };
}

/// V^-1 for given components, applied to the residuals and the slopes.
struct Inverse<const P: usize> {
    /// The inverse of the diagonal of V.
    precision: Vec<f64>,
    /// What V^-1 subtracts in each patch.
    patches: Vec<PatchInverse<P>>,
    /// k_g of each incidence.
    gains: Vec<f64>,
    /// The inverse of the Cholesky factor L of J^T V^-1 J.
    factor: [[f64; P]; P],
    /// Q^T e with Q = V^-1 J L^-T.
    projected: [f64; P],
}

#[derive(Clone, Copy)]
struct PatchInverse<const P: usize> {
    /// V^-1 x = precision x - precision mu h^T x: h of the slopes and of the residual.
    slopes: [f64; P],
    residual: f64,
    /// What the diagonal of V^-1 loses, per square of precision mu.
    loss: f64,
    /// q_b: mu_b^T V1^-1 mu_b, V1 being V without the gains.
    information: f64,
}

impl<const P: usize> Inverse<P> {
    fn new(terms: &Terms<P>, components: &Components, least: f64) -> Self {
        let precision: Vec<f64> = terms
            .rows
            .iter()
            .map(|row| 1.0 / (dot(&components.white, &row.white) + least))
            .collect();
        let sums: Vec<Sums<P>> = terms
            .patches
            .iter()
            .map(|patch| patch_sums(terms, &precision, patch))
            .collect();
        let shrink = |sums: &Sums<P>| {
            let k = components.patch / (1.0 + components.patch * sums.information);
            (k, 1.0 - k * sums.information)
        };
        let mut incidences = vec![Sums::<P>::ZERO; terms.incidences];
        for (patch, sums) in terms.patches.iter().zip(&sums) {
            let (_, left) = shrink(sums);
            let incidence = &mut incidences[patch.incidence];
            incidence.information += left * sums.information;
            incidence.residual += left * sums.residual;
            for c in 0..P {
                incidence.slopes[c] += left * sums.slopes[c];
            }
        }
        let gains: Vec<f64> = incidences
            .iter()
            .map(|sums| components.gain / (1.0 + components.gain * sums.information))
            .collect();
        let patches: Vec<PatchInverse<P>> = terms
            .patches
            .iter()
            .zip(&sums)
            .map(|(patch, sums)| {
                let (k, left) = shrink(sums);
                let (gain, whole) = (gains[patch.incidence], &incidences[patch.incidence]);
                PatchInverse {
                    slopes: std::array::from_fn(|c| {
                        k * sums.slopes[c] + left * gain * whole.slopes[c]
                    }),
                    residual: k * sums.residual + left * gain * whole.residual,
                    loss: k + gain * left * left,
                    information: left * sums.information,
                }
            })
            .collect();
        let (factor, projected) = factorised(terms, &precision, &patches);
        Self {
            precision,
            patches,
            gains,
            factor,
            projected,
        }
    }
}

impl<const P: usize> PatchInverse<P> {
    /// V^-1 J of one reading.
    fn slopes(&self, row: &Term<P>, precision: f64) -> [f64; P] {
        let u = precision * row.size;
        std::array::from_fn(|c| precision * row.slopes[c] - u * self.slopes[c])
    }

    /// V^-1 e of one reading.
    fn residual(&self, row: &Term<P>, precision: f64) -> f64 {
        precision * row.residual - precision * row.size * self.residual
    }
}

/// The inverse of the Cholesky factor L of J^T V^-1 J, and L^-1 J^T V^-1 e.
fn factorised<const P: usize>(
    terms: &Terms<P>,
    precision: &[f64],
    patches: &[PatchInverse<P>],
) -> ([[f64; P]; P], [f64; P]) {
    let (mut matrix, mut right) = ([[0.0; P]; P], [0.0; P]);
    for (patch, inverse) in terms.patches.iter().zip(patches) {
        let rows = patch.rows.clone();
        for (row, &precision) in terms.rows[rows.clone()].iter().zip(&precision[rows]) {
            let solved = inverse.slopes(row, precision);
            for c in 0..P {
                right[c] += solved[c] * row.residual;
                for d in 0..=c {
                    matrix[c][d] += row.slopes[c] * solved[d];
                }
            }
        }
    }
    let factor = inverse_cholesky(&matrix);
    (factor, forward(&factor, &right))
}

/// The sums over a patch with the diagonal of V alone.
fn patch_sums<const P: usize>(terms: &Terms<P>, precision: &[f64], patch: &Patch) -> Sums<P> {
    let mut sums = Sums::ZERO;
    let rows = patch.rows.clone();
    for (row, &precision) in terms.rows[rows.clone()].iter().zip(&precision[rows]) {
        let u = row.size * precision;
        sums.information += row.size * u;
        sums.residual += u * row.residual;
        for c in 0..P {
            sums.slopes[c] += u * row.slopes[c];
        }
    }
    sums
}

/// The inverse of the Cholesky factor of a positive definite matrix, of which the lower triangle is
/// given. A pivot that rounding makes negative has no effect.
fn inverse_cholesky<const P: usize>(matrix: &[[f64; P]; P]) -> [[f64; P]; P] {
    let (mut factor, mut inverse) = ([[0.0; P]; P], [[0.0; P]; P]);
    for i in 0..P {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
            let rest = matrix[i][j] - known;
            factor[i][j] = if i == j {
                rest.max(0.0).sqrt()
            } else {
                rest * inverse[j][j]
            };
        }
        if factor[i][i] > 0.0 {
            inverse[i][i] = 1.0 / factor[i][i];
        }
        for j in 0..i {
            let sum: f64 = (j..i).map(|k| factor[i][k] * inverse[k][j]).sum();
            inverse[i][j] = -inverse[i][i] * sum;
        }
    }
    inverse
}

/// L^-1 x, with L^-1 lower triangular.
fn forward<const P: usize>(factor: &[[f64; P]; P], x: &[f64; P]) -> [f64; P] {
    std::array::from_fn(|i| {
        let mut sum = 0.0;
        for j in 0..=i {
            sum += factor[i][j] * x[j];
        }
        sum
    })
}

fn dot<const P: usize>(a: &[f64; P], b: &[f64; P]) -> f64 {
    let mut sum = 0.0;
    for i in 0..P {
        sum += a[i] * b[i];
    }
    sum
}

/// The quadratic form of each component with P e, and the trace of the component with P:
/// P = V^-1 - V^-1 J (J^T V^-1 J)^-1 J^T V^-1.
struct Scores {
    white: [(f64, f64); WHITE],
    patch: (f64, f64),
    gain: (f64, f64),
}

/// What the readings of a group have in common.
#[derive(Debug, Clone, Copy)]
pub(super) struct Common<const P: usize> {
    /// mu^T P e.
    pub(super) residual: f64,
    /// mu^T Q with Q = V^-1 J L^-T, L L^T = J^T V^-1 J.
    pub(super) projected: [f64; P],
    /// mu^T V^-1 mu.
    pub(super) information: f64,
}

impl<const P: usize> Common<P> {
    pub(super) const ZERO: Self = Self {
        residual: 0.0,
        projected: [0.0; P],
        information: 0.0,
    };

    pub(super) fn add(&mut self, other: &Self) {
        self.residual += other.residual;
        self.information += other.information;
        for (own, other) in self.projected.iter_mut().zip(&other.projected) {
            *own += other;
        }
    }
}

/// What the readings of each patch have in common, where the errors are independent.
pub(super) fn common_errors<const P: usize>(
    terms: &Terms<P>,
    independent: &Components,
) -> Vec<Common<P>> {
    let inverse = Inverse::new(terms, independent, 1e-12 * mean_square(terms));
    let mut ignored = [(0.0, 0.0); WHITE];
    (0..terms.patches.len())
        .map(|b| add_patch(terms, &inverse, b, &mut ignored))
        .collect()
}

/// Adds the scores of the independent components over one patch; returns what its readings have in
/// common.
fn add_patch<const P: usize>(
    terms: &Terms<P>,
    inverse: &Inverse<P>,
    b: usize,
    white: &mut [(f64, f64); WHITE],
) -> Common<P> {
    let PatchInverse {
        loss, information, ..
    } = inverse.patches[b];
    let mut common = Common {
        information,
        ..Common::ZERO
    };
    let (patch, rows) = (&inverse.patches[b], terms.patches[b].rows.clone());
    for (row, &precision) in terms.rows[rows.clone()]
        .iter()
        .zip(&inverse.precision[rows])
    {
        let q = forward(&inverse.factor, &patch.slopes(row, precision));
        let z = patch.residual(row, precision) - dot(&q, &inverse.projected);
        let u = precision * row.size;
        let diagonal = precision - loss * u * u - dot(&q, &q);
        for (score, shape) in white.iter_mut().zip(&row.white) {
            score.0 += shape * z * z;
            score.1 += shape * diagonal;
        }
        common.residual += row.size * z;
        for (sum, q) in common.projected.iter_mut().zip(&q) {
            *sum += row.size * q;
        }
    }
    common
}

fn scores<const P: usize>(terms: &Terms<P>, inverse: &Inverse<P>) -> Scores {
    let mut scores = Scores {
        white: [(0.0, 0.0); WHITE],
        patch: (0.0, 0.0),
        gain: (0.0, 0.0),
    };
    let add = |score: &mut (f64, f64), group: &Common<P>, gain: f64| {
        let information = group.information;
        score.0 += group.residual * group.residual;
        score.1 += information
            - gain * information * information
            - dot(&group.projected, &group.projected);
    };
    let mut incidences = vec![Common::ZERO; terms.incidences];
    for (b, patch) in terms.patches.iter().enumerate() {
        let common = add_patch(terms, inverse, b, &mut scores.white);
        add(&mut scores.patch, &common, inverse.gains[patch.incidence]);
        incidences[patch.incidence].add(&common);
    }
    for (common, &gain) in incidences.iter().zip(&inverse.gains) {
        add(&mut scores.gain, common, gain);
    }
    scores
}

/// The sum of squares of the residuals over the degrees of freedom.
fn mean_square<const P: usize>(terms: &Terms<P>) -> f64 {
    let squares: f64 = terms
        .rows
        .iter()
        .map(|row| row.residual * row.residual)
        .sum();
    squares / terms.rows.len().saturating_sub(P).max(1) as f64
}

/// The components that maximise the restricted likelihood.
pub(super) fn estimate<const P: usize>(terms: &Terms<P>, estimated: Estimated) -> Components {
    let mean = mean_square(terms);
    let starts = [0.3, 0.2, 0.3];
    let start = |used: bool, start: f64| if used { start * mean } else { 0.0 };
    let mut components = Components {
        white: std::array::from_fn(|k| start(estimated.white[k], starts[k])),
        patch: start(estimated.patch, 0.2),
        gain: start(estimated.gain, 0.2),
    };
    if estimated.least_first > 0.0 {
        // The shapes are stated variances: the start is that factor on them.
        let stated: f64 = terms.rows.iter().map(|row| row.white[0]).sum();
        let stated = stated / terms.rows.len() as f64;
        components.white[0] = (mean / stated).max(estimated.least_first);
    }
    // All residuals are zero: so are the components.
    if mean <= 0.0 {
        return components;
    }
    let shapes = mean_shapes(terms);
    for step in 0..STEPS {
        let inverse = Inverse::new(terms, &components, 1e-12 * mean);
        let scores = scores(terms, &inverse);
        let power = if step < CAREFUL_STEPS { 0.5 } else { 0.9 };
        let moved = |component: f64, (form, trace): (f64, f64), least: f64| {
            if component == 0.0 {
                return 0.0;
            }
            let ratio = (form / trace.max(1e-300)).clamp(1e-4, 1e4);
            (component * ratio.powf(power)).max(least)
        };
        let least = |k: usize| if k == 0 { estimated.least_first } else { 0.0 }.max(1e-9 * mean);
        let before = components;
        components = Components {
            white: std::array::from_fn(|k| moved(components.white[k], scores.white[k], least(k))),
            patch: moved(components.patch, scores.patch, 1e-9 * mean),
            gain: moved(components.gain, scores.gain, 1e-9 * mean),
        };
        if step >= CAREFUL_STEPS && components.change(&before, &shapes) < SETTLED {
            break;
        }
    }
    components
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 36 readings of three incidences with three patches each.
    fn terms() -> Terms<3> {
        let each =
            |of: &dyn Fn(f64) -> f64| -> Vec<f64> { (0..36).map(|i| of(f64::from(i))).collect() };
        let size = each(&|x| 0.2 + 1.5 * (0.37 * x).sin().abs());
        let residual = each(&|x| {
            let common =
                0.1 * (5.0 * (x / 4.0).floor()).sin() + 0.3 * (2.0 * (x / 12.0).floor()).cos();
            let size = 0.2 + 1.5 * (0.37 * x).sin().abs();
            size * (common + 0.08 * (17.0 * x).sin()) + 0.03 * (29.0 * x).cos()
        });
        let rows = (0..36).zip(size.iter().zip(&residual));
        let row = |(i, (&size, &residual)): (i32, (&f64, &f64))| {
            let x = f64::from(i);
            Term {
                size,
                residual,
                slopes: [1.0 + 0.5 * (0.3 * x).cos(), size * size, (0.21 * x).sin()],
                white: [1.0, size, size * size],
            }
        };
        Terms {
            rows: rows.map(row).collect(),
            patches: (0..9)
                .map(|b| Patch {
                    rows: 4 * b..4 * (b + 1),
                    incidence: b / 3,
                })
                .collect(),
            incidences: 3,
        }
    }

    /// Within the change that ends the iteration early.
    fn near(found: f64, expected: f64) {
        assert!((found / expected - 1.0).abs() < 0.01, "{found} {expected}");
    }

    fn close(found: f64, expected: f64) {
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    }

    /// The expected numbers are those of an independent implementation of the iteration, in C.
    #[test]
    fn the_components_are_those_of_an_independent_implementation() {
        let all = estimate(
            &terms(),
            Estimated {
                white: [true; WHITE],
                patch: true,
                gain: true,
                least_first: 0.0,
            },
        );
        near(all.white[0], 3.602_115_292_192e-4);
        near(all.white[1], 1.997_941_117_218e-3);
        near(all.white[2], 3.058_551_897_357e-3);
        near(all.patch, 2.064_638_630_214e-3);
        near(all.gain, 3.653_528_923_146e-2);
        let independent = estimate(&terms(), INDEPENDENT);
        near(independent.white[0], 4.623_922_381_709e-3);
        near(independent.white[2], 2.656_602_003_009e-2);
        assert_eq!(
            (independent.white[1], independent.patch, independent.gain),
            (0.0, 0.0, 0.0)
        );
    }

    /// P e and the traces by matrices of all readings, as in the definitions.
    #[test]
    fn the_structured_inverse_is_the_inverse() {
        let terms = terms();
        let components = Components {
            white: [0.01, 0.02, 0.03],
            patch: 0.05,
            gain: 0.04,
        };
        let incidence_of = |i: usize| i / 12;
        let v = nalgebra::DMatrix::from_fn(36, 36, |i, j| {
            let mut value = 0.0;
            if i == j {
                value += (0..WHITE)
                    .map(|k| components.white[k] * terms.rows[i].white[k])
                    .sum::<f64>();
            }
            if i / 4 == j / 4 {
                value += components.patch * terms.rows[i].size * terms.rows[j].size;
            }
            if incidence_of(i) == incidence_of(j) {
                value += components.gain * terms.rows[i].size * terms.rows[j].size;
            }
            value
        });
        let inverse = v.try_inverse().unwrap();
        let j = nalgebra::DMatrix::from_fn(36, 3, |i, c| terms.rows[i].slopes[c]);
        let middle = (j.transpose() * &inverse * &j).try_inverse().unwrap();
        let p = &inverse - &inverse * &j * middle * j.transpose() * &inverse;
        let z = &p * nalgebra::DVector::from_fn(36, |i, _| terms.rows[i].residual);
        let scores = scores(&terms, &Inverse::new(&terms, &components, 0.0));
        for k in 0..WHITE {
            let shape = |i: usize| terms.rows[i].white[k];
            close(
                scores.white[k].0,
                (0..36).map(|i| shape(i) * z[i] * z[i]).sum(),
            );
            close(
                scores.white[k].1,
                (0..36).map(|i| shape(i) * p[(i, i)]).sum(),
            );
        }
        let form = |same: &dyn Fn(usize, usize) -> bool| {
            let (mut squares, mut trace) = (0.0, 0.0);
            for a in 0..36 {
                for b in (0..36).filter(|&b| same(a, b)) {
                    let sizes = terms.rows[a].size * terms.rows[b].size;
                    squares += sizes * z[a] * z[b];
                    trace += sizes * p[(a, b)];
                }
            }
            (squares, trace)
        };
        let (squares, trace) = form(&|a, b| a / 4 == b / 4);
        close(scores.patch.0, squares);
        close(scores.patch.1, trace);
        let (squares, trace) = form(&|a, b| incidence_of(a) == incidence_of(b));
        close(scores.gain.0, squares);
        close(scores.gain.1, trace);
    }

    /// Of a balanced one-way layout the estimates are those of the analysis of variance: the mean square
    /// within groups, and that between groups less it, over the size of a group.
    #[test]
    fn a_balanced_layout_has_the_components_of_the_analysis_of_variance() {
        const GROUPS: usize = 6;
        const SIZE: usize = 10;
        let value = |i: usize| {
            let group = (7.0 * (i / SIZE) as f64).sin();
            0.3 * group + 0.1 * (13.0 * i as f64).cos()
        };
        let row = |i: usize| Term {
            size: 1.0,
            residual: value(i),
            slopes: [1.0],
            white: [1.0, 0.0, 0.0],
        };
        let patch = |g: usize| Patch {
            rows: SIZE * g..SIZE * (g + 1),
            incidence: g,
        };
        let terms = Terms {
            rows: (0..GROUPS * SIZE).map(row).collect(),
            patches: (0..GROUPS).map(patch).collect(),
            incidences: GROUPS,
        };
        let found = estimate(
            &terms,
            Estimated {
                white: [true, false, false],
                patch: false,
                gain: true,
                least_first: 0.0,
            },
        );
        let mean = |of: &dyn Fn(usize) -> f64, over: Range<usize>| {
            let count = over.len() as f64;
            over.map(of).sum::<f64>() / count
        };
        let group = |g: usize| mean(&value, SIZE * g..SIZE * (g + 1));
        let whole = mean(&value, 0..GROUPS * SIZE);
        let between: f64 = (0..GROUPS).map(|g| (group(g) - whole).powi(2)).sum();
        let between = SIZE as f64 * between / (GROUPS - 1) as f64;
        let within: f64 = (0..GROUPS * SIZE)
            .map(|i| (value(i) - group(i / SIZE)).powi(2))
            .sum();
        let within = within / (GROUPS * (SIZE - 1)) as f64;
        near(found.white[0], within);
        near(found.gain, (between - within) / SIZE as f64);
    }

    #[test]
    fn zero_residuals_have_zero_components() {
        let mut terms = terms();
        for row in &mut terms.rows {
            row.residual = 0.0;
        }
        let none = Estimated {
            white: [true; WHITE],
            patch: true,
            gain: true,
            least_first: 0.0,
        };
        let found = estimate(&terms, none);
        assert_eq!(
            (found.white, found.patch, found.gain),
            ([0.0; WHITE], 0.0, 0.0)
        );
    }
}
