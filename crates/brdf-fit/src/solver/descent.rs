//! Descents to a minimum of E along k1, n and p, where k2 and kD are the best ones at each step.

use std::ops::Range;

use brdf_core::ModelParameters;
use nalgebra::{SMatrix, SVector};

use crate::model::{FEW_READINGS, Parameter, ReducedModel};
use crate::objective::{BLOCK, Block, Objective, ProfileSums, TakeBlock, dot, solve_for};

/// The nonlinear parameters: k1, n and p.
const NONLINEAR: [Parameter; 3] = [Parameter::K1, Parameter::N, Parameter::P];

/// The largest number of steps.
const MOST_STEPS: usize = 400;

/// The number of Gauss-Newton steps before those with differences of slopes.
const GAUSS_NEWTON_STEPS: usize = 8;

/// A descent ends where a further step would gain less than this fraction of E ...
const GAIN: f64 = 1e-13;

/// ... or this fraction of the readings' squares, which is rounding.
const ROUNDING: f64 = 1e-17;

/// Where a step has gained its prediction within this fraction, so will the next one.
const AS_PREDICTED: f64 = 0.3;

/// The longest step of ln k1 or ln p: two steps of the grid, so that a descent does not leave its valley.
const LONGEST: f64 = 0.5;

/// The difference of ln k1, n or ln p for second derivatives.
const DIFFERENCE: f64 = 1e-5;

/// The rows of a scan: y of unit length, and the factors of the rows where the scan has its own weights.
#[derive(Clone, Copy)]
pub(crate) struct Rows<'a> {
    pub(crate) y: &'a [f64],
    pub(crate) factors: Option<&'a [f64]>,
}

/// The scalar products of the columns u, a, du/dk1, du/dn, du/dp and y.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Products {
    /// Of u, a and the derivatives with each other; the lower triangle.
    pub(crate) columns: [[f64; 5]; 5],
    /// With y.
    pub(crate) measured: [f64; 5],
}

impl Products {
    /// The products at some parameters, with the derivatives that are asked for.
    pub(crate) fn at(
        objective: &Objective,
        at: &ModelParameters,
        derivatives: [bool; 3],
        rows: Rows<'_>,
    ) -> Self {
        let mut adding = Adding {
            products: Self::default(),
            rows,
            used: [true, true, derivatives[0], derivatives[1], derivatives[2]],
        };
        objective.give_blocks(at, derivatives, 0..objective.len(), &mut adding);
        adding.products
    }

    pub(crate) fn sums(&self) -> ProfileSums {
        ProfileSums {
            uu: self.columns[0][0],
            ua: self.columns[1][0],
            aa: self.columns[1][1],
            uy: self.measured[0],
            ay: self.measured[1],
        }
    }

    pub(crate) fn of(&self, i: usize, j: usize) -> f64 {
        self.columns[i.max(j)][i.min(j)]
    }
}

/// Adds the products of each block.
struct Adding<'a> {
    products: Products,
    rows: Rows<'a>,
    used: [bool; 5],
}

impl TakeBlock for Adding<'_> {
    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a function that is not inlined is not compiled for the present processor"
    )]
    fn take(&mut self, range: Range<usize>, block: &Block) {
        let Self {
            products,
            rows,
            used,
        } = self;
        // Rows beyond the last one are zero, as they are in the block.
        let mut y = [0.0; BLOCK];
        y[..range.len()].copy_from_slice(&rows.y[range.clone()]);
        let mut columns: [&[f64; BLOCK]; 5] =
            [&block.u, &block.a, &block.by[0], &block.by[1], &block.by[2]];
        let mut own;
        if let Some(factors) = rows.factors {
            own = [[0.0; BLOCK]; 5];
            for i in (0..5).filter(|i| used[*i]) {
                let scaled = columns[i].iter().zip(&factors[range.clone()]);
                for (own, (x, factor)) in own[i].iter_mut().zip(scaled) {
                    *own = x * factor;
                }
            }
            columns = own.each_ref();
        }
        for i in (0..5).filter(|i| used[*i]) {
            products.measured[i] += dot(columns[i], &y);
            for j in (0..=i).filter(|j| used[*j]) {
                products.columns[i][j] += dot(columns[i], columns[j]);
            }
        }
    }
}

/// Descents of a model.
pub(crate) struct Descent<'a> {
    pub(crate) objective: &'a Objective,
    pub(crate) model: ReducedModel,
}

/// A step of a descent: the parameters with the best weights, E there, and the products.
pub(super) struct Local {
    pub(super) at: ModelParameters,
    pub(super) error: f64,
    pub(super) products: Products,
    /// Whether k2 and kD adapt: free, and not at zero.
    adapt: [bool; 2],
}

impl Descent<'_> {
    pub(super) fn local(
        &self,
        at: ModelParameters,
        derivatives: [bool; 3],
        rows: Rows<'_>,
    ) -> Local {
        let products = Products::at(self.objective, &at, derivatives, rows);
        let fixed = self.model.fixed_weights();
        let (k2, kd, error) = solve_for(fixed, &products.sums());
        Local {
            at: ModelParameters { k2, kd, ..at },
            error,
            products,
            adapt: [
                fixed[0].is_none() && k2 > 0.0,
                fixed[1].is_none() && kd > 0.0,
            ],
        }
    }

    /// The minimum below a start and E there, within the ranges of the parameters.
    ///
    /// Damped Gauss-Newton steps on ln k1, n and ln p. Where they do not gain what they predict, because
    /// the residuals are large or the valley is flat, steps with differences of slopes are tried as well.
    pub(crate) fn from(&self, start: ModelParameters, rows: Rows<'_>) -> (ModelParameters, f64) {
        self.with_other_valleys(self.descend(start, rows), rows)
    }

    /// The lowest of the minima below some starts and E there. Where few readings are nearly interpolated, each
    /// start may lead to another valley, and else the lowest.
    pub(crate) fn lowest(
        &self,
        starts: impl Iterator<Item = ModelParameters>,
        rows: Rows<'_>,
    ) -> Option<(ModelParameters, f64)> {
        if self.has_few_readings() {
            let minima = starts.map(|start| self.from(start, rows));
            return minima.min_by(|a, b| a.1.total_cmp(&b.1));
        }
        let minima = starts.map(|start| self.descend(start, rows));
        let lowest = minima.min_by(|a, b| a.error.total_cmp(&b.error))?;
        Some(self.with_other_valleys(lowest, rows))
    }

    pub(super) fn has_few_readings(&self) -> bool {
        self.objective.count() < FEW_READINGS
    }

    pub(super) fn descend(&self, start: ModelParameters, rows: Rows<'_>) -> Local {
        let free = NONLINEAR.map(|parameter| self.model.frees(parameter));
        let mut here = self.with_lobe_near(self.local(start, free, rows), free, rows);
        let mut damping = 1e-4;
        let mut is_predicted = false;
        let mut newton = self.has_few_readings();
        for i in 0..MOST_STEPS {
            newton |= i >= GAUSS_NEWTON_STEPS;
            let least = GAIN * here.error.max(0.0) + ROUNDING;
            let first = Step::at(&here, free, damping, None);
            let second = newton.then(|| self.bends(&here, free, rows));
            let second = second.and_then(|bends| Step::at(&here, free, damping, Some(bends)));
            let promising = |step: &Step| step.gain > least;
            let steps = [first.filter(promising), second.filter(promising)];
            if steps.iter().all(Option::is_none) {
                if newton || is_predicted {
                    break;
                }
                newton = true;
                continue;
            }
            let tried = steps.into_iter().flatten().map(|step| {
                let there = self.local(step.to, free, rows);
                (step.gain, there)
            });
            let lowest = tried.min_by(|a, b| a.1.error.total_cmp(&b.1.error));
            let Some((predicted, there)) = lowest.filter(|(_, there)| there.error < here.error)
            else {
                damping *= 8.0;
                if damping > 1e9 {
                    break;
                }
                continue;
            };
            is_predicted = ((here.error - there.error) / predicted - 1.0).abs() < AS_PREDICTED;
            here = there;
            damping = (damping * 0.2).max(1e-12);
        }
        here
    }

    /// The second derivatives of E/2 along ln k1, n and ln p, from differences of the slopes.
    fn bends(&self, here: &Local, free: [bool; 3], rows: Rows<'_>) -> SMatrix<f64, 3, 3> {
        let (slopes, _) = equations(here, free);
        let mut bends = SMatrix::<f64, 3, 3>::zeros();
        for (i, parameter) in NONLINEAR.into_iter().enumerate().filter(|(i, _)| free[*i]) {
            let (_, highest) = parameter.range();
            let inwards = parameter.of(&here.at) < highest * (1.0 - 2.0 * DIFFERENCE);
            let mut step = SVector::<f64, 3>::zeros();
            step[i] = if inwards { DIFFERENCE } else { -DIFFERENCE };
            let there = self.local(shifted(&here.at, free, &step), free, rows);
            let (other, _) = equations(&there, free);
            bends.set_column(i, &((other - slopes) / step[i]));
        }
        0.5 * (bends + bends.transpose())
    }
}

/// A step from one point to another.
struct Step {
    to: ModelParameters,
    /// The decrease of E that the quadratic model of the step predicts.
    gain: f64,
}

impl Step {
    /// `bends` are second derivatives in place of those of Gauss-Newton. `None` where E is not convex.
    fn at(
        here: &Local,
        free: [bool; 3],
        damping: f64,
        bends: Option<SMatrix<f64, 3, 3>>,
    ) -> Option<Self> {
        let (slopes, gauss_newton) = equations(here, free);
        let moves: [bool; 3] = std::array::from_fn(|i| {
            free[i] && gauss_newton[(i, i)] > 0.0 && can_move(i, &here.at, slopes[i])
        });
        let damped = |matrix: SMatrix<f64, 3, 3>| {
            SMatrix::<f64, 3, 3>::from_fn(|i, j| match (moves[i] && moves[j], i == j) {
                (true, true) => matrix[(i, i)] + damping * gauss_newton[(i, i)],
                (true, false) => matrix[(i, j)],
                (false, same) => f64::from(u8::from(same)),
            })
        };
        let down = SVector::<f64, 3>::from_fn(|i, _| if moves[i] { -slopes[i] } else { 0.0 });
        let step = damped(bends.unwrap_or(gauss_newton))
            .cholesky()?
            .solve(&down);
        Some(Self {
            to: shifted(&here.at, free, &step),
            gain: step.dot(&down),
        })
    }
}

/// The slopes of E/2 along ln k1, n and ln p, and the Gauss-Newton approximation of its second
/// derivatives, with the best weights everywhere.
fn equations(here: &Local, free: [bool; 3]) -> (SVector<f64, 3>, SMatrix<f64, 3, 3>) {
    let Local {
        at,
        products,
        adapt,
        ..
    } = here;
    let scale = [at.k1, 1.0, at.p];
    let slope = |i: usize| {
        let column = i + 2;
        let model = at.k2 * products.of(column, 0) + at.kd * products.of(column, 1);
        at.k2 * scale[i] * (model - products.measured[column])
    };
    let slopes = SVector::from_fn(|i, _| if free[i] { slope(i) } else { 0.0 });
    // What the weights that adapt can make up for is taken from the columns.
    let (uu, ua, aa) = (products.of(0, 0), products.of(1, 0), products.of(1, 1));
    let both = uu * aa - ua * ua;
    let explained = |i: usize, j: usize| {
        let [ui, ai, uj, aj] = [(0, i), (1, i), (0, j), (1, j)].map(|(c, i)| products.of(c, i + 2));
        match adapt {
            [true, true] if both > 1e-14 * uu * aa => {
                (aa * ui * uj - ua * (ui * aj + ai * uj) + uu * ai * aj) / both
            }
            [true, _] => ui * uj / uu,
            [false, true] => ai * aj / aa,
            [false, false] => 0.0,
        }
    };
    let matrix = SMatrix::from_fn(|i, j| {
        if free[i] && free[j] {
            let rest = products.of(i + 2, j + 2) - explained(i, j);
            at.k2 * at.k2 * scale[i] * scale[j] * rest
        } else {
            0.0
        }
    });
    (slopes, matrix)
}

/// Whether a parameter can move against its slope within its range.
fn can_move(i: usize, at: &ModelParameters, slope: f64) -> bool {
    let (lowest, highest) = NONLINEAR[i].range();
    let value = NONLINEAR[i].of(at);
    slope != 0.0 && !(value <= lowest && slope > 0.0 || value >= highest && slope < 0.0)
}

fn shifted(at: &ModelParameters, free: [bool; 3], step: &SVector<f64, 3>) -> ModelParameters {
    let mut to = *at;
    for (i, parameter) in NONLINEAR.into_iter().enumerate().filter(|(i, _)| free[*i]) {
        let (lowest, highest) = parameter.range();
        let value = parameter.of(at);
        let moved = match parameter {
            Parameter::N => value + step[i],
            _ => value * step[i].clamp(-LONGEST, LONGEST).exp(),
        };
        parameter.set(&mut to, moved.clamp(lowest, highest));
    }
    to
}
