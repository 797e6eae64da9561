//! The functions of the directions that the terms of the model need, each in a column of its own, so that
//! loops over rows are vector code.

use std::ops::Range;

use brdf_core::Geometry;
use brdf_core::fresnel::Dielectric;

/// The functions of the directions of a row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Angles {
    pub(super) tan2_alpha: f64,
    pub(super) sec_alpha: f64,
    pub(super) cos_psi: f64,
    pub(super) cos_theta: f64,
    pub(super) cos_gamma: f64,
    pub(super) sin2_gamma: f64,
}

impl Angles {
    pub(super) fn new(geometry: &Geometry) -> Self {
        Self {
            tan2_alpha: geometry.tan2_alpha(),
            sec_alpha: geometry.sec_alpha(),
            cos_psi: geometry.cos_psi(),
            cos_theta: geometry.cos_theta(),
            cos_gamma: geometry.cos_gamma(),
            sin2_gamma: geometry.sin2_gamma(),
        }
    }
}

/// The same of many rows.
#[derive(Debug, Clone, Default)]
pub(super) struct AngleColumns {
    tan2_alpha: Vec<f64>,
    sec_alpha: Vec<f64>,
    cos_psi: Vec<f64>,
    cos_theta: Vec<f64>,
    cos_gamma: Vec<f64>,
    sin2_gamma: Vec<f64>,
}

/// The columns of some rows.
#[derive(Debug, Clone, Copy)]
pub(super) struct AngleRows<'a> {
    pub(super) tan2_alpha: &'a [f64],
    pub(super) sec_alpha: &'a [f64],
    pub(super) cos_psi: &'a [f64],
    pub(super) cos_theta: &'a [f64],
    pub(super) cos_gamma: &'a [f64],
    pub(super) sin2_gamma: &'a [f64],
}

impl AngleColumns {
    pub(super) fn with_capacity(rows: usize) -> Self {
        let column = || Vec::with_capacity(rows);
        Self {
            tan2_alpha: column(),
            sec_alpha: column(),
            cos_psi: column(),
            cos_theta: column(),
            cos_gamma: column(),
            sin2_gamma: column(),
        }
    }

    pub(super) fn push(&mut self, row: Angles) {
        self.tan2_alpha.push(row.tan2_alpha);
        self.sec_alpha.push(row.sec_alpha);
        self.cos_psi.push(row.cos_psi);
        self.cos_theta.push(row.cos_theta);
        self.cos_gamma.push(row.cos_gamma);
        self.sin2_gamma.push(row.sin2_gamma);
    }

    pub(super) fn get(&self, row: usize) -> Angles {
        Angles {
            tan2_alpha: self.tan2_alpha[row],
            sec_alpha: self.sec_alpha[row],
            cos_psi: self.cos_psi[row],
            cos_theta: self.cos_theta[row],
            cos_gamma: self.cos_gamma[row],
            sin2_gamma: self.sin2_gamma[row],
        }
    }

    pub(super) fn rows(&self, rows: Range<usize>) -> AngleRows<'_> {
        AngleRows {
            tan2_alpha: &self.tan2_alpha[rows.clone()],
            sec_alpha: &self.sec_alpha[rows.clone()],
            cos_psi: &self.cos_psi[rows.clone()],
            cos_theta: &self.cos_theta[rows.clone()],
            cos_gamma: &self.cos_gamma[rows.clone()],
            sin2_gamma: &self.sin2_gamma[rows],
        }
    }

    pub(super) fn len(&self) -> usize {
        self.cos_psi.len()
    }
}

impl AngleRows<'_> {
    /// R0(gamma) of each row at a refractive index.
    pub(super) fn fresnel(&self, n: f64) -> Vec<f64> {
        let fresnel = Dielectric::new(n);
        let relative = |cos_gamma: &f64| fresnel.relative(*cos_gamma);
        self.cos_gamma.iter().map(relative).collect()
    }
}
