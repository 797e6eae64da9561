//! The lobe's column at many widths, for a fixed refractive index.

use brdf_core::Family;
use brdf_core::facet::{Beckmann, Ellipsoid, FacetDistribution, Ggx, Power};
use brdf_core::shadowing::{Shadowing, Smith, VGroove};

use super::rows::Objective;

/// What the lobe's column u needs of each row, each function of the angles in a column of its own, so that
/// the loops are vector code.
#[derive(Debug, Clone)]
pub(crate) struct LobeRows {
    family: Family,
    tan2_alpha: Vec<f64>,
    sec_alpha: Vec<f64>,
    cos_psi: Vec<f64>,
    cos_theta: Vec<f64>,
    /// What does not depend on k1: the weight, the Fresnel factor and, for some families, the shadowing.
    scale: Vec<f64>,
}

impl Objective {
    /// The rows for columns at the refractive index of the objective.
    pub(crate) fn lobe_rows(&self) -> LobeRows {
        let column = |of: fn(&super::rows::Angles) -> f64| self.angles().iter().map(of).collect();
        let scale = self.shadowed.iter().zip(&self.directions.fresnel);
        LobeRows {
            family: self.family,
            tan2_alpha: column(|angles| angles.tan2_alpha),
            sec_alpha: column(|angles| angles.sec_alpha),
            cos_psi: column(|angles| angles.cos_psi),
            cos_theta: column(|angles| angles.cos_theta),
            scale: scale
                .map(|(shadowed, fresnel)| shadowed * fresnel)
                .collect(),
        }
    }
}

impl LobeRows {
    /// u of each row.
    pub(crate) fn column(&self, k1: f64, p: f64, to: &mut [f64]) {
        match self.family {
            Family::Paper => self.fill(Ellipsoid::new(k1), VGroove, to),
            Family::Smith => self.fill(Ellipsoid::new(k1), Smith::new(k1), to),
            Family::Power => self.fill(Power::new(k1, p), VGroove, to),
            Family::Ggx => self.fill(Ggx::new(k1), Smith::new(k1), to),
            Family::Beckmann => self.fill(Beckmann::new(k1), VGroove, to),
        }
    }

    fn fill<F: FacetDistribution, S: Shadowing>(&self, facet: F, shadowing: S, to: &mut [f64]) {
        let rows = self.tan2_alpha.iter().zip(&self.sec_alpha).zip(&self.scale);
        for (u, ((tan2, sec), scale)) in to.iter_mut().zip(rows) {
            *u = scale * facet.relative(*tan2, *sec);
        }
        if S::DEPENDS_ON_WIDTH {
            let rows = self
                .cos_psi
                .iter()
                .zip(&self.cos_theta)
                .zip(&self.tan2_alpha);
            for (u, ((psi, theta), tan2)) in to.iter_mut().zip(rows) {
                *u *= shadowing.over_cosines(*psi, *theta, *tan2);
            }
        }
    }
}
