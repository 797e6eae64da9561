//! The columns of the model, evaluated for a block of rows at a time.

use std::ops::Range;

use brdf_core::facet::{Beckmann, Ellipsoid, FacetDistribution, Ggx, Power};
use brdf_core::fresnel::Dielectric;
use brdf_core::shadowing::{Shadowing, Smith, VGroove};
use brdf_core::{Family, ModelParameters};

use super::rows::{Angles, Objective};
use crate::model::Parameter;

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

impl Objective {
    /// u of some rows without their Fresnel factor, for the width k1 and the exponent p.
    pub(crate) fn shape_column(&self, k1: f64, p: f64, rows: Range<usize>, shape: &mut Vec<f64>) {
        fn fill<'a, F: FacetDistribution, S: Shadowing>(
            rows: impl Iterator<Item = (&'a Angles, &'a f64)>,
            facet: F,
            shadowing: S,
            shape: &mut Vec<f64>,
        ) {
            shape.clear();
            shape.extend(rows.map(|row| shape_of(facet, shadowing, row)));
        }
        let shadowed = &self.shadowed[rows.clone()];
        let rows = self.angles()[rows].iter().zip(shadowed);
        match self.family {
            Family::Paper => fill(rows, Ellipsoid::new(k1), VGroove, shape),
            Family::Smith => fill(rows, Ellipsoid::new(k1), Smith::new(k1), shape),
            Family::Power => fill(rows, Power::new(k1, p), VGroove, shape),
            Family::Ggx => fill(rows, Ggx::new(k1), Smith::new(k1), shape),
            Family::Beckmann => fill(rows, Beckmann::new(k1), VGroove, shape),
        }
    }

    /// The column u at the given k1, n and p.
    pub(crate) fn lobe_column(&self, at: &ModelParameters) -> Vec<f64> {
        let mut column = Vec::with_capacity(self.len());
        self.for_blocks(at, [false; 3], 0..self.len(), |rows, block| {
            column.extend_from_slice(&block.u[..rows.len()]);
        });
        column
    }

    /// Evaluates u and the requested derivatives with respect to k1, n and p, block by block, and
    /// passes each block to `take`. The terms of the family are chosen here, outside the loop.
    pub(crate) fn for_blocks(
        &self,
        at: &ModelParameters,
        derivatives: [bool; 3],
        rows: Range<usize>,
        take: impl FnMut(Range<usize>, &Block),
    ) {
        let (k1, p) = (at.k1, at.p);
        match self.family {
            Family::Paper => {
                self.for_blocks_of(Ellipsoid::new(k1), VGroove, at.n, derivatives, rows, take);
            }
            Family::Smith => {
                let (facet, shadowing) = (Ellipsoid::new(k1), Smith::new(k1));
                self.for_blocks_of(facet, shadowing, at.n, derivatives, rows, take);
            }
            Family::Power => {
                self.for_blocks_of(Power::new(k1, p), VGroove, at.n, derivatives, rows, take);
            }
            Family::Ggx => {
                let (facet, shadowing) = (Ggx::new(k1), Smith::new(k1));
                self.for_blocks_of(facet, shadowing, at.n, derivatives, rows, take);
            }
            Family::Beckmann => {
                self.for_blocks_of(Beckmann::new(k1), VGroove, at.n, derivatives, rows, take);
            }
        }
    }

    fn for_blocks_of<F: FacetDistribution, S: Shadowing>(
        &self,
        facet: F,
        shadowing: S,
        n: f64,
        [by_k1, by_n, by_p]: [bool; 3],
        rows: Range<usize>,
        mut take: impl FnMut(Range<usize>, &Block),
    ) {
        let dielectric = Dielectric::new(n);
        let angles = self.angles();
        let mut start = rows.start;
        let mut block = Block::EMPTY;
        let mut fresnel = [0.0; BLOCK];
        while start < rows.end {
            let range = start..(start + BLOCK).min(rows.end);
            block.load(&self.measured[range.clone()], &self.diffuse[range.clone()]);
            self.fill_fresnel(&dielectric, range.clone(), &mut fresnel);
            let rows = || {
                let angles = angles[range.clone()].iter();
                fresnel
                    .iter()
                    .zip(angles.zip(&self.shadowed[range.clone()]))
            };
            for (u, (fresnel, row)) in block.u.iter_mut().zip(rows()) {
                *u = shape_of(facet, shadowing, row) * fresnel;
            }
            let [u_by_k1, u_by_n, u_by_p] = &mut block.by;
            if by_k1 {
                for (slope, (fresnel, row)) in u_by_k1.iter_mut().zip(rows()) {
                    *slope = shape_by_k1(facet, shadowing, row) * fresnel;
                }
            }
            if by_n {
                for (slope, (_, row)) in u_by_n.iter_mut().zip(rows()) {
                    let by_n = dielectric.relative_derivative_n(row.0.cos_gamma, row.0.sin2_gamma);
                    *slope = shape_of(facet, shadowing, row) * by_n;
                }
            }
            if by_p {
                for (slope, (fresnel, (angles, shadowed))) in u_by_p.iter_mut().zip(rows()) {
                    let by_p = facet.derivative_p(angles.tan2_alpha, angles.sec_alpha);
                    *slope = shadowed * by_p * fresnel;
                }
            }
            start = range.end;
            take(range, &block);
        }
    }

    /// R0(gamma) of some rows; the precomputed column is used if n is its refractive index.
    fn fill_fresnel(&self, dielectric: &Dielectric, rows: Range<usize>, to: &mut [f64; BLOCK]) {
        if dielectric.n() == self.n {
            to[..rows.len()].copy_from_slice(&self.directions.fresnel[rows]);
        } else {
            for (value, angles) in to.iter_mut().zip(&self.angles()[rows]) {
                *value = dielectric.relative(angles.cos_gamma);
            }
        }
    }
}

/// u of a row, given by its angles and its shadowing, without its Fresnel factor.
///
/// The rows are those of iterators: indices would be checked, and the loops would not be vector code.
#[inline]
fn shape_of<F: FacetDistribution, S: Shadowing>(
    facet: F,
    shadowing: S,
    (angles, shadowed): (&Angles, &f64),
) -> f64 {
    let shape = shadowed * facet.relative(angles.tan2_alpha, angles.sec_alpha);
    if S::DEPENDS_ON_WIDTH {
        let (psi, theta) = (angles.cos_psi, angles.cos_theta);
        shape * shadowing.over_cosines(psi, theta, angles.tan2_alpha)
    } else {
        shape
    }
}

/// The derivative of [`shape_of`] with respect to k1.
#[inline]
fn shape_by_k1<F: FacetDistribution, S: Shadowing>(
    facet: F,
    shadowing: S,
    (angles, shadowed): (&Angles, &f64),
) -> f64 {
    let (t, sec) = (angles.tan2_alpha, angles.sec_alpha);
    let slope = facet.derivative_k1(t, sec);
    if S::DEPENDS_ON_WIDTH {
        let (psi, theta) = (angles.cos_psi, angles.cos_theta);
        let by_facet = slope * shadowing.over_cosines(psi, theta, t);
        let by_shadowing =
            facet.relative(t, sec) * shadowing.over_cosines_derivative_k1(psi, theta, t);
        shadowed * (by_facet + by_shadowing)
    } else {
        shadowed * slope
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
#[inline]
pub(crate) fn dot(x: &[f64; BLOCK], y: &[f64; BLOCK]) -> f64 {
    let mut sums = [0.0; 4];
    for (x, y) in x.as_chunks::<4>().0.iter().zip(y.as_chunks::<4>().0) {
        for lane in 0..4 {
            sums[lane] += x[lane] * y[lane];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

/// The scalar product of columns of any length, in eight independent running sums.
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
