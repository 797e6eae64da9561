//! One evaluation of the restricted likelihood's equations: for given components of the errors'
//! covariance V, the quadratic form and the trace of each component with
//! P = V^-1 - V^-1 J (J^T V^-1 J)^-1 J^T V^-1.
//!
//! V is a diagonal D and a term of rank 1 for each patch and each incidence. By Woodbury's formula,
//! V^-1 x = D^-1 x - D^-1 mu h^T x with one h for each patch, from sums over the readings of patches: a step
//! is two passes over the readings, each of them vector code.

#![expect(
    clippy::inline_always,
    reason = "a function that is not inlined is not compiled for the present processor"
)]

use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::variance_components::{Components, Patch, Terms, WHITE};
use crate::objective::{PROCESSOR, dot_of};

/// The number of readings that are evaluated together: loops over this many are vector code.
const BLOCK: usize = 32;

/// A quantity of the readings of a block.
type Column = [f64; BLOCK];

/// The readings of a block. Those beyond the last one are zero, and have no effect.
#[derive(Debug, Clone)]
struct Block<const P: usize> {
    size: Column,
    residual: Column,
    slopes: [Column; P],
    white: [Column; WHITE],
    /// 1 beyond the last reading, so that the variance is not zero there.
    missing: Column,
    /// The inverse of D.
    precision: Column,
    /// The readings of each patch that has some in this block.
    pieces: Vec<Piece>,
}

#[derive(Debug, Clone)]
struct Piece {
    patch: usize,
    rows: Range<usize>,
}

/// The quadratic form of each component with P e, and the trace of the component with P.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Scores {
    pub(super) white: [(f64, f64); WHITE],
    pub(super) patch: (f64, f64),
    pub(super) gain: (f64, f64),
}

/// What the readings of a group have in common.
#[derive(Debug, Clone, Copy)]
pub(super) struct Common<const P: usize> {
    /// mu^T P e.
    pub(super) residual: f64,
    /// mu^T Q with Q = V^-1 J L^-T, L L^T = J^T V^-1 J.
    pub(super) projected: [f64; P],
    /// mu^T V1^-1 mu, V1 being V without the gains.
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

    /// Adds the quadratic form and the trace of this group, whose incidence has the given k.
    fn score(&self, gain: f64, to: &mut (f64, f64)) {
        to.0 += self.residual * self.residual;
        to.1 += self.information
            - gain * self.information * self.information
            - dot(&self.projected, &self.projected);
    }
}

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

    fn add(&mut self, other: &Self, factor: f64) {
        self.information += factor * other.information;
        self.residual += factor * other.residual;
        for (own, other) in self.slopes.iter_mut().zip(&other.slopes) {
            *own += factor * other;
        }
    }
}

/// J^T V^-1 J, of which the lower triangle is used, and J^T V^-1 e.
struct Equations<const P: usize> {
    matrix: [[f64; P]; P],
    right: [f64; P],
}

impl<const P: usize> Equations<P> {
    /// Takes away what a term of rank 1 in V takes from its inverse.
    fn remove(&mut self, sums: &Sums<P>, factor: f64) {
        for c in 0..P {
            let scaled = factor * sums.slopes[c];
            self.right[c] -= scaled * sums.residual;
            for d in 0..=c {
                self.matrix[c][d] -= scaled * sums.slopes[d];
            }
        }
    }
}

/// What V^-1 takes from the readings of a patch.
#[derive(Debug, Clone, Copy)]
struct Taken<const P: usize> {
    /// V^-1 x = D^-1 x - D^-1 mu h^T x: h of the slopes and of the residual.
    slopes: [f64; P],
    residual: f64,
    /// What the diagonal of V^-1 loses, per square of D^-1 mu.
    loss: f64,
}

/// The readings of a fit, and the memory of an evaluation.
pub(super) struct Restricted<const P: usize> {
    blocks: Vec<Block<P>>,
    /// The incidence of each patch.
    incidence_of: Vec<usize>,
    /// Added to each variance.
    least: f64,
    patches: Vec<Sums<P>>,
    incidences: Vec<Sums<P>>,
    /// k_g of each incidence.
    gains: Vec<f64>,
    taken: Vec<Taken<P>>,
    common: Vec<Common<P>>,
    common_of_incidences: Vec<Common<P>>,
}

/// The parts of [`Block`] that the rows from `start` on fill.
fn block_of<const P: usize>(terms: &Terms<P>, start: usize) -> Block<P> {
    let rows = &terms.rows[start..(start + BLOCK).min(terms.rows.len())];
    let column = |of: &dyn Fn(usize) -> f64| -> Column {
        std::array::from_fn(|i| if i < rows.len() { of(i) } else { 0.0 })
    };
    Block {
        size: column(&|i| rows[i].size),
        residual: column(&|i| rows[i].residual),
        slopes: std::array::from_fn(|c| column(&|i| rows[i].slopes[c])),
        white: std::array::from_fn(|k| column(&|i| rows[i].white[k])),
        missing: std::array::from_fn(|i| f64::from(u8::from(i >= rows.len()))),
        precision: [0.0; BLOCK],
        pieces: Vec::new(),
    }
}

impl<const P: usize> Restricted<P> {
    pub(super) fn new(terms: &Terms<P>, least: f64) -> Self {
        let starts = (0..terms.rows.len()).step_by(BLOCK);
        let mut blocks: Vec<Block<P>> = starts.map(|start| block_of(terms, start)).collect();
        for (patch, Patch { rows, .. }) in terms.patches.iter().enumerate() {
            let mut start = rows.start;
            while start < rows.end {
                let block = start / BLOCK;
                let end = rows.end.min((block + 1) * BLOCK);
                blocks[block].pieces.push(Piece {
                    patch,
                    rows: start - block * BLOCK..end - block * BLOCK,
                });
                start = end;
            }
        }
        let none = Taken {
            slopes: [0.0; P],
            residual: 0.0,
            loss: 0.0,
        };
        let patches = terms.patches.len();
        Self {
            blocks,
            incidence_of: terms.patches.iter().map(|patch| patch.incidence).collect(),
            least,
            patches: vec![Sums::ZERO; patches],
            incidences: vec![Sums::ZERO; terms.incidences],
            gains: vec![0.0; terms.incidences],
            taken: vec![none; patches],
            common: vec![Common::ZERO; patches],
            common_of_incidences: vec![Common::ZERO; terms.incidences],
        }
    }

    /// The scores at some components.
    pub(super) fn scores(&mut self, components: &Components) -> Scores {
        PROCESSOR.dispatch(Evaluation {
            of: self,
            components,
        })
    }

    /// What the readings of each patch have in common, after [`scores`](Self::scores).
    pub(super) fn common(&self) -> &[Common<P>] {
        &self.common
    }

    /// The sums over the patches with D alone, and the equations of the parameters.
    #[inline(always)]
    fn sum(&mut self, white: &[f64; WHITE]) -> Equations<P> {
        let mut equations = Equations {
            matrix: [[0.0; P]; P],
            right: [0.0; P],
        };
        self.patches.fill(Sums::ZERO);
        for block in &mut self.blocks {
            block.set_precision(white, self.least);
            let of_size = product(&block.size, &block.precision);
            let information = product(&block.size, &of_size);
            let residual = product(&block.residual, &of_size);
            let slopes: [Column; P] = std::array::from_fn(|c| product(&block.slopes[c], &of_size));
            for Piece { patch, rows } in &block.pieces {
                let sum = |column: &Column| column[rows.clone()].iter().sum::<f64>();
                let sums = &mut self.patches[*patch];
                sums.information += sum(&information);
                sums.residual += sum(&residual);
                for (own, slopes) in sums.slopes.iter_mut().zip(&slopes) {
                    *own += sum(slopes);
                }
            }
            for c in 0..P {
                let scaled = product(&block.slopes[c], &block.precision);
                equations.right[c] += dot_of(&scaled, &block.residual);
                for d in 0..=c {
                    equations.matrix[c][d] += dot_of(&scaled, &block.slopes[d]);
                }
            }
        }
        equations
    }

    #[inline(always)]
    fn evaluate(&mut self, components: &Components) -> Scores {
        let mut equations = self.sum(&components.white);
        self.incidences.fill(Sums::ZERO);
        for (&incidence, sums) in self.incidence_of.iter().zip(&self.patches) {
            let (k, left) = shrink(components.patch, sums.information);
            equations.remove(sums, k);
            self.incidences[incidence].add(sums, left);
        }
        for (gain, sums) in self.gains.iter_mut().zip(&self.incidences) {
            *gain = shrink(components.gain, sums.information).0;
            equations.remove(sums, *gain);
        }
        let factor = inverse_cholesky(&equations.matrix);
        let projected = forward(&factor, &equations.right);
        // (J^T V^-1 J)^-1 J^T V^-1 e.
        let shift: [f64; P] =
            std::array::from_fn(|c| (c..P).map(|i| factor[i][c] * projected[i]).sum());
        let mut scores = Scores::default();
        self.add_groups(components.patch, &factor, &shift, &mut scores);
        for block in &self.blocks {
            block.add_scores(&self.taken, &factor, &shift, &mut scores.white);
        }
        scores
    }

    /// What V^-1 takes from each patch, what its readings and those of each incidence have in common, and
    /// the scores of these.
    #[inline(always)]
    fn add_groups(
        &mut self,
        component: f64,
        factor: &[[f64; P]; P],
        shift: &[f64; P],
        scores: &mut Scores,
    ) {
        self.common_of_incidences.fill(Common::ZERO);
        let of_patches = self.taken.iter_mut().zip(&mut self.common);
        let patches = self.incidence_of.iter().zip(&self.patches);
        for ((&incidence, sums), (taken, common)) in patches.zip(of_patches) {
            let (k, left) = shrink(component, sums.information);
            let (gain, whole) = (self.gains[incidence], &self.incidences[incidence]);
            let (of_whole, shared) = (left * gain, gain * sums.information);
            *taken = Taken {
                slopes: std::array::from_fn(|c| k * sums.slopes[c] + of_whole * whole.slopes[c]),
                residual: k * sums.residual + of_whole * whole.residual,
                loss: k + of_whole * left,
            };
            // mu^T V^-1 J and mu^T V^-1 e of the patch.
            let slopes: [f64; P] =
                std::array::from_fn(|c| left * (sums.slopes[c] - shared * whole.slopes[c]));
            let residual = left * (sums.residual - shared * whole.residual);
            *common = Common {
                residual: residual - dot(&slopes, shift),
                projected: forward(factor, &slopes),
                information: left * sums.information,
            };
            common.score(gain, &mut scores.patch);
            self.common_of_incidences[incidence].add(common);
        }
        for (common, &gain) in self.common_of_incidences.iter().zip(&self.gains) {
            common.score(gain, &mut scores.gain);
        }
    }
}

impl<const P: usize> Block<P> {
    #[inline(always)]
    fn set_precision(&mut self, white: &[f64; WHITE], least: f64) {
        let [first, second, third] = &self.white;
        let mut precision = [0.0; BLOCK];
        for i in 0..BLOCK {
            let variance = white[0] * first[i] + white[1] * second[i] + white[2] * third[i];
            precision[i] = 1.0 / (variance + (least + self.missing[i]));
        }
        self.precision = precision;
    }

    /// Adds the scores of the independent components.
    #[inline(always)]
    fn add_scores(
        &self,
        taken: &[Taken<P>],
        factor: &[[f64; P]; P],
        shift: &[f64; P],
        scores: &mut [(f64, f64); WHITE],
    ) {
        let mut of_slopes = [[0.0; BLOCK]; P];
        let (mut of_residual, mut loss) = ([0.0; BLOCK], [0.0; BLOCK]);
        for Piece { patch, rows } in &self.pieces {
            let taken = &taken[*patch];
            for i in rows.clone() {
                for (column, slope) in of_slopes.iter_mut().zip(&taken.slopes) {
                    column[i] = *slope;
                }
                of_residual[i] = taken.residual;
                loss[i] = taken.loss;
            }
        }
        let (size, precision) = (&self.size, &self.precision);
        let mut z = [0.0; BLOCK];
        let mut lost = [0.0; BLOCK];
        for i in 0..BLOCK {
            z[i] = self.residual[i] - size[i] * of_residual[i];
            lost[i] = loss[i] * size[i] * size[i];
        }
        let mut rest = [[0.0; BLOCK]; P];
        for c in 0..P {
            for i in 0..BLOCK {
                rest[c][i] = self.slopes[c][i] - size[i] * of_slopes[c][i];
                z[i] -= rest[c][i] * shift[c];
            }
            let mut q = [0.0; BLOCK];
            for d in 0..=c {
                for i in 0..BLOCK {
                    q[i] += factor[c][d] * rest[d][i];
                }
            }
            for i in 0..BLOCK {
                lost[i] += q[i] * q[i];
            }
        }
        let (mut squares, mut traces) = ([0.0; BLOCK], [0.0; BLOCK]);
        for i in 0..BLOCK {
            let (w, weighted) = (precision[i], precision[i] * z[i]);
            squares[i] = weighted * weighted;
            traces[i] = w - (w * w) * lost[i];
        }
        for (score, shape) in scores.iter_mut().zip(&self.white) {
            score.0 += dot_of(shape, &squares);
            score.1 += dot_of(shape, &traces);
        }
    }
}

#[inline(always)]
fn product(x: &Column, y: &Column) -> Column {
    let mut product = [0.0; BLOCK];
    for i in 0..BLOCK {
        product[i] = x[i] * y[i];
    }
    product
}

/// [`Restricted::scores`].
struct Evaluation<'a, const P: usize> {
    of: &'a mut Restricted<P>,
    components: &'a Components,
}

impl<const P: usize> WithSimd for Evaluation<'_, P> {
    type Output = Scores;

    #[inline(always)]
    fn with_simd<V: Simd>(self, _: V) -> Scores {
        self.of.evaluate(self.components)
    }
}

/// k and 1 - k q of a component and mu^T V0^-1 mu = q, with (V0 + t mu mu^T)^-1 = V0^-1 - k V0^-1 mu mu^T V0^-1.
#[inline(always)]
fn shrink(component: f64, information: f64) -> (f64, f64) {
    let left = 1.0 / (1.0 + component * information);
    (component * left, left)
}

/// The inverse of the Cholesky factor of a positive definite matrix, of which the lower triangle is
/// given. A pivot that rounding makes negative has no effect.
#[inline(always)]
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
#[inline(always)]
fn forward<const P: usize>(factor: &[[f64; P]; P], x: &[f64; P]) -> [f64; P] {
    std::array::from_fn(|i| {
        let mut sum = 0.0;
        for j in 0..=i {
            sum += factor[i][j] * x[j];
        }
        sum
    })
}

#[inline(always)]
fn dot<const P: usize>(a: &[f64; P], b: &[f64; P]) -> f64 {
    let mut sum = 0.0;
    for i in 0..P {
        sum += a[i] * b[i];
    }
    sum
}
