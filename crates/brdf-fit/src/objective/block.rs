//! The columns of the model, evaluated for a block of rows at a time.

#![expect(
    clippy::inline_always,
    reason = "a function that is not inlined is not compiled for the present processor"
)]

use std::ops::Range;
use std::sync::LazyLock;

use brdf_core::facet::{Beckmann, Ellipsoid, FacetDistribution, Ggx, Power};
use brdf_core::fresnel::Dielectric;
use brdf_core::shadowing::{Shadowing, Smith, VGroove};
use brdf_core::{Family, ModelParameters};
use pulp::{Simd, WithSimd};

use super::angles::AngleRows;
use super::rows::Objective;
use crate::model::Parameter;

/// The vectors of the processor, which are determined once.
pub(crate) static PROCESSOR: LazyLock<pulp::Arch> = LazyLock::new(pulp::Arch::new);

/// The number of rows that are evaluated together: their columns stay in the nearest cache.
pub(crate) const BLOCK: usize = 32;

/// The columns y, a, u of a block of rows, and the derivatives of u with respect to k1, n and p.
/// Rows beyond the last one are zero.
pub(crate) struct Block {
    pub(crate) y: [f64; BLOCK],
    pub(crate) a: [f64; BLOCK],
    pub(crate) u: [f64; BLOCK],
    pub(crate) by: [[f64; BLOCK]; 3],
}

impl Block {
    const EMPTY: Self = Self {
        y: [0.0; BLOCK],
        a: [0.0; BLOCK],
        u: [0.0; BLOCK],
        by: [[0.0; BLOCK]; 3],
    };

    /// Loads the columns y and a of these rows.
    #[inline]
    fn load(&mut self, measured: &[f64], diffuse: &[f64]) {
        let rows = measured.len();
        self.y[..rows].copy_from_slice(measured);
        self.a[..rows].copy_from_slice(diffuse);
        if rows < BLOCK {
            let [by_k1, by_n, by_p] = &mut self.by;
            for column in [&mut self.y, &mut self.a, &mut self.u, by_k1, by_n, by_p] {
                column[rows..].fill(0.0);
            }
        }
    }
}

/// Runs a kernel with the facet distribution and the shadowing of a family, in the widest vectors of the
/// processor. The loops have the same operations in the same order on all processors, so that the digits
/// do not depend on it.
macro_rules! with_terms {
    ($family:expr, $k1:expr, $p:expr, |$facet:ident, $shadowing:ident| $body:expr) => {
        match $family {
            Family::Paper => {
                let ($facet, $shadowing) = (Ellipsoid::new($k1), VGroove);
                PROCESSOR.dispatch($body)
            }
            Family::Smith => {
                let ($facet, $shadowing) = (Ellipsoid::new($k1), Smith::new($k1));
                PROCESSOR.dispatch($body)
            }
            Family::Power => {
                let ($facet, $shadowing) = (Power::new($k1, $p), VGroove);
                PROCESSOR.dispatch($body)
            }
            Family::Ggx => {
                let ($facet, $shadowing) = (Ggx::new($k1), Smith::new($k1));
                PROCESSOR.dispatch($body)
            }
            Family::Beckmann => {
                let ($facet, $shadowing) = (Beckmann::new($k1), VGroove);
                PROCESSOR.dispatch($body)
            }
        }
    };
}

impl Objective {
    /// u of some rows without their Fresnel factor, for the width k1 and the exponent p.
    pub(crate) fn shape_column(&self, k1: f64, p: f64, rows: Range<usize>, shape: &mut Vec<f64>) {
        shape.clear();
        shape.resize(rows.len(), 0.0);
        let shaped = self.shaped(rows);
        with_terms!(self.family, k1, p, |facet, shadowing| Shape {
            facet,
            shadowing,
            rows: shaped,
            to: shape,
        });
    }

    /// The column u at the given k1, n and p.
    pub(crate) fn lobe_column(&self, at: &ModelParameters) -> Vec<f64> {
        let mut column = Vec::new();
        self.shape_column(at.k1, at.p, 0..self.len(), &mut column);
        let fresnel = self.fresnel_column(at.n);
        column
            .iter_mut()
            .zip(fresnel.iter())
            .for_each(|(u, fresnel)| *u *= fresnel);
        column
    }

    /// Evaluates the column u at the given k1, n and p, with its derivative with respect to k1 where it is
    /// asked for, and passes them on.
    pub(crate) fn with_lobe<W: WithLobe>(
        &self,
        at: &ModelParameters,
        by_k1: bool,
        columns: &mut LobeColumns,
        then: W,
    ) -> W::Output {
        columns.u.resize(self.len(), 0.0);
        columns.by_k1.resize(self.len(), 0.0);
        let fresnel = self.fresnel_column(at.n);
        let (rows, fresnel) = (self.shaped(0..self.len()), &*fresnel);
        with_terms!(self.family, at.k1, at.p, |facet, shadowing| WholeLobe {
            facet,
            shadowing,
            rows,
            fresnel,
            by_k1,
            columns,
            then,
        })
    }

    /// Evaluates u and the requested derivatives with respect to k1, n and p, block by block, and
    /// passes each block to `take`.
    pub(crate) fn for_blocks(
        &self,
        at: &ModelParameters,
        derivatives: [bool; 3],
        rows: Range<usize>,
        take: impl FnMut(Range<usize>, &Block),
    ) {
        self.give_blocks(at, derivatives, rows, &mut Call(take));
    }

    /// [`for_blocks`](Self::for_blocks) to what is compiled with them, for the present processor.
    pub(crate) fn give_blocks<T: TakeBlock>(
        &self,
        at: &ModelParameters,
        derivatives: [bool; 3],
        rows: Range<usize>,
        to: &mut T,
    ) {
        with_terms!(self.family, at.k1, at.p, |facet, shadowing| Blocks {
            objective: self,
            facet,
            shadowing,
            n: at.n,
            derivatives,
            rows,
            to,
        });
    }

    #[inline(always)]
    fn for_blocks_of<F: FacetDistribution, S: Shadowing>(
        &self,
        facet: F,
        shadowing: S,
        n: f64,
        [by_k1, by_n, by_p]: [bool; 3],
        rows: Range<usize>,
        to: &mut impl TakeBlock,
    ) {
        let dielectric = Dielectric::new(n);
        let mut start = rows.start;
        let mut block = Block::EMPTY;
        let (mut shape, mut fresnel) = ([0.0; BLOCK], [0.0; BLOCK]);
        while start < rows.end {
            let range = start..(start + BLOCK).min(rows.end);
            let shaped = self.shaped(range.clone());
            block.load(&self.measured[range.clone()], &self.diffuse[range.clone()]);
            self.fill_fresnel(&dielectric, range.clone(), &mut fresnel);
            fill_shape(facet, shadowing, shaped, &mut shape);
            multiply(&shape[..range.len()], &fresnel, &mut block.u);
            let [u_by_k1, u_by_n, u_by_p] = &mut block.by;
            if by_k1 {
                fill_by_k1(facet, shadowing, shaped, &fresnel, u_by_k1);
            }
            if by_n {
                let rows = shaped.angles.cos_gamma.iter().zip(shaped.angles.sin2_gamma);
                for ((slope, shape), (cos, sin2)) in u_by_n.iter_mut().zip(&shape).zip(rows) {
                    *slope = shape * dielectric.relative_derivative_n(*cos, *sin2);
                }
            }
            if by_p {
                for ((slope, fresnel), (t, sec, shadowed)) in
                    u_by_p.iter_mut().zip(&fresnel).zip(shaped.tilts())
                {
                    *slope = shadowed * facet.derivative_p(*t, *sec) * fresnel;
                }
            }
            start = range.end;
            to.take(range, &block);
        }
    }

    /// R0(gamma) of some rows; the precomputed column is used if n is its refractive index.
    #[inline(always)]
    fn fill_fresnel(&self, dielectric: &Dielectric, rows: Range<usize>, to: &mut [f64; BLOCK]) {
        if dielectric.n() == self.n {
            to[..rows.len()].copy_from_slice(&self.directions.fresnel[rows]);
        } else {
            for (value, cos_gamma) in to.iter_mut().zip(self.angles(rows).cos_gamma) {
                *value = dielectric.relative(*cos_gamma);
            }
        }
    }

    fn shaped(&self, rows: Range<usize>) -> Shaped<'_> {
        Shaped {
            shadowed: &self.shadowed[rows.clone()],
            angles: self.angles(rows),
        }
    }
}

/// What u depends on beside the Fresnel factor, for some rows.
#[derive(Clone, Copy)]
struct Shaped<'a> {
    angles: AngleRows<'a>,
    /// a, multiplied by G/(cos psi cos theta) where the shadowing does not depend on k1.
    shadowed: &'a [f64],
}

impl<'a> Shaped<'a> {
    /// tan^2 alpha, sec alpha and the shadowed diffuse column.
    #[inline]
    fn tilts(self) -> impl Iterator<Item = (&'a f64, &'a f64, &'a f64)> {
        let tilts = self.angles.tan2_alpha.iter().zip(self.angles.sec_alpha);
        let rows = tilts.zip(self.shadowed);
        rows.map(|((t, sec), shadowed)| (t, sec, shadowed))
    }

    /// cos psi, cos theta and tan^2 alpha.
    #[inline]
    fn cosines(self) -> impl Iterator<Item = (&'a f64, &'a f64, &'a f64)> {
        let cosines = self.angles.cos_psi.iter().zip(self.angles.cos_theta);
        let rows = cosines.zip(self.angles.tan2_alpha);
        rows.map(|((psi, theta), t)| (psi, theta, t))
    }
}

/// [`Objective::shape_column`].
struct Shape<'a, F, S> {
    facet: F,
    shadowing: S,
    rows: Shaped<'a>,
    to: &'a mut [f64],
}

impl<F: FacetDistribution, S: Shadowing> WithSimd for Shape<'_, F, S> {
    type Output = ();

    #[inline(always)]
    fn with_simd<V: Simd>(self, _: V) {
        fill_shape(self.facet, self.shadowing, self.rows, self.to);
    }
}

/// What is done with the column of a lobe, in the same vector code as its evaluation.
pub(crate) trait WithLobe {
    type Output;

    /// Takes u and its derivative with respect to k1, whose values are of no use where it was not asked for.
    fn with_lobe(self, u: &mut [f64], by_k1: &mut [f64]) -> Self::Output;
}

/// The memory of the column of a lobe and of its derivative with respect to k1.
#[derive(Debug, Default)]
pub(crate) struct LobeColumns {
    u: Vec<f64>,
    by_k1: Vec<f64>,
}

/// [`Objective::with_lobe`].
struct WholeLobe<'a, F, S, W> {
    facet: F,
    shadowing: S,
    rows: Shaped<'a>,
    fresnel: &'a [f64],
    by_k1: bool,
    columns: &'a mut LobeColumns,
    then: W,
}

impl<F: FacetDistribution, S: Shadowing, W: WithLobe> WithSimd for WholeLobe<'_, F, S, W> {
    type Output = W::Output;

    #[inline(always)]
    fn with_simd<V: Simd>(self, _: V) -> W::Output {
        let (facet, shadowing) = (self.facet, self.shadowing);
        let LobeColumns { u, by_k1 } = self.columns;
        fill_shape(facet, shadowing, self.rows, u);
        for (u, fresnel) in u.iter_mut().zip(self.fresnel) {
            *u *= fresnel;
        }
        if self.by_k1 {
            fill_by_k1(facet, shadowing, self.rows, self.fresnel, by_k1);
        }
        self.then.with_lobe(u, by_k1)
    }
}

/// Takes the columns of some rows, block by block.
pub(crate) trait TakeBlock {
    fn take(&mut self, rows: Range<usize>, block: &Block);
}

/// Calls a function for each block.
struct Call<F>(F);

impl<F: FnMut(Range<usize>, &Block)> TakeBlock for Call<F> {
    #[inline(always)]
    fn take(&mut self, rows: Range<usize>, block: &Block) {
        self.0(rows, block);
    }
}

/// [`Objective::give_blocks`].
struct Blocks<'a, F, S, T> {
    objective: &'a Objective,
    facet: F,
    shadowing: S,
    n: f64,
    derivatives: [bool; 3],
    rows: Range<usize>,
    to: &'a mut T,
}

impl<F, S, T> WithSimd for Blocks<'_, F, S, T>
where
    F: FacetDistribution,
    S: Shadowing,
    T: TakeBlock,
{
    type Output = ();

    #[inline(always)]
    fn with_simd<V: Simd>(self, _: V) {
        let (facet, shadowing) = (self.facet, self.shadowing);
        self.objective.for_blocks_of(
            facet,
            shadowing,
            self.n,
            self.derivatives,
            self.rows,
            self.to,
        );
    }
}

/// u of some rows without their Fresnel factor.
///
/// The rows are those of iterators: indices would be checked, and the loops would not be vector code.
#[inline(always)]
fn fill_shape<F: FacetDistribution, S: Shadowing>(
    facet: F,
    shadowing: S,
    rows: Shaped<'_>,
    to: &mut [f64],
) {
    for (shape, (t, sec, shadowed)) in to.iter_mut().zip(rows.tilts()) {
        *shape = shadowed * facet.relative(*t, *sec);
    }
    if S::DEPENDS_ON_WIDTH {
        for (shape, (psi, theta, t)) in to.iter_mut().zip(rows.cosines()) {
            *shape *= shadowing.over_cosines(*psi, *theta, *t);
        }
    }
}

/// The derivative of u with respect to k1.
#[inline(always)]
fn fill_by_k1<F: FacetDistribution, S: Shadowing>(
    facet: F,
    shadowing: S,
    rows: Shaped<'_>,
    fresnel: &[f64],
    to: &mut [f64],
) {
    if S::DEPENDS_ON_WIDTH {
        let rows = rows.tilts().zip(rows.cosines());
        for (slope, ((t, sec, shadowed), (psi, theta, _))) in to.iter_mut().zip(rows) {
            let by_facet = facet.derivative_k1(*t, *sec) * shadowing.over_cosines(*psi, *theta, *t);
            let by_shadowing =
                facet.relative(*t, *sec) * shadowing.over_cosines_derivative_k1(*psi, *theta, *t);
            *slope = shadowed * (by_facet + by_shadowing);
        }
    } else {
        for (slope, (t, sec, shadowed)) in to.iter_mut().zip(rows.tilts()) {
            *slope = shadowed * facet.derivative_k1(*t, *sec);
        }
    }
    to.iter_mut()
        .zip(fresnel)
        .for_each(|(slope, fresnel)| *slope *= fresnel);
}

#[inline(always)]
fn multiply(x: &[f64], y: &[f64; BLOCK], to: &mut [f64; BLOCK]) {
    for ((to, x), y) in to.iter_mut().zip(x).zip(y) {
        *to = x * y;
    }
}

/// Model - measured of a block.
pub(super) fn residual(block: &Block, at: &ModelParameters) -> [f64; BLOCK] {
    let mut residual = [0.0; BLOCK];
    for (j, r) in residual.iter_mut().enumerate() {
        *r = at.k2 * block.u[j] + at.kd * block.a[j] - block.y[j];
    }
    residual
}

/// The column of the Jacobian for a parameter, without its factor.
pub(super) fn column(block: &Block, parameter: Parameter) -> &[f64; BLOCK] {
    match parameter {
        Parameter::K2 => &block.u,
        Parameter::Kd => &block.a,
        Parameter::K1 => &block.by[0],
        Parameter::N => &block.by[1],
        Parameter::P => &block.by[2],
    }
}

/// The factor of the column of a parameter.
pub(super) fn column_factor(at: &ModelParameters, parameter: Parameter) -> f64 {
    match parameter {
        Parameter::K2 | Parameter::Kd => 1.0,
        Parameter::K1 | Parameter::N | Parameter::P => at.k2,
    }
}

/// The derivatives of u that the free parameters need, with respect to k1, n and p.
pub(super) fn derivatives_for(free: &[Parameter]) -> [bool; 3] {
    [Parameter::K1, Parameter::N, Parameter::P].map(|parameter| free.contains(&parameter))
}

/// A scalar product in four independent running sums: fast, and the same on every processor.
#[inline(always)]
pub(crate) fn dot(x: &[f64; BLOCK], y: &[f64; BLOCK]) -> f64 {
    let mut sums = [0.0; 4];
    for (x, y) in x.as_chunks::<4>().0.iter().zip(y.as_chunks::<4>().0) {
        for lane in 0..4 {
            sums[lane] += x[lane] * y[lane];
        }
    }
    // The halves of a vector first: in another order, the sums would not stay in one.
    (sums[0] + sums[2]) + (sums[1] + sums[3])
}

/// The scalar product of columns of any length, in eight independent running sums.
#[inline(always)]
pub(crate) fn dot_of(x: &[f64], y: &[f64]) -> f64 {
    const LANES: usize = 8;
    let mut sums = [0.0; LANES];
    let ((x, x_rest), (y, y_rest)) = (x.as_chunks::<LANES>(), y.as_chunks::<LANES>());
    for (x, y) in x.iter().zip(y) {
        for lane in 0..LANES {
            sums[lane] += x[lane] * y[lane];
        }
    }
    let rest: f64 = x_rest.iter().zip(y_rest).map(|(x, y)| x * y).sum();
    sums.iter().sum::<f64>() + rest
}
