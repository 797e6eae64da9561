//! The errors of ln f_r that a plan reckons with, and their covariance between two settings.

use super::setting::Site;

/// The length of the misfit over the views and over the incidences, in radians: 15 and 30 deg.
const VIEW_LENGTH: f64 = 0.261_799_387_799_149_4;
const INCIDENCE_LENGTH: f64 = 0.523_598_775_598_298_8;

/// The length of the misfit over the tilt of the facets in widths of the lobe, and over the incidence angle on
/// them in radians.
const TILT_LENGTH: f64 = 0.5;
const FACET_LENGTH: f64 = 0.523_598_775_598_298_8;

/// Incidences that differ by less are one, in radians: 0.25 deg.
const SAME_INCIDENCE: f64 = 0.004_363;

/// The sizes of the errors of ln f_r: of the reading, of its incidence, and of the model.
///
/// With u = asinh(tan(alpha)/k1), the tilt of the facet in widths of the lobe, the difference d of the surface from
/// the model is taken for a random function of the directions with
///
/// ```text
/// cov d = angular^2 exp(-(dx^2 + dy^2)/(2 (15 deg)^2) - dpsi^2/(2 (30 deg)^2))
///       + lobe^2 exp(-du^2/(2 0.5^2) - dgamma^2/(2 (30 deg)^2)),
/// ```
///
/// x and y being the view from the mirror direction; a reading has the further errors `proportional`, of its own,
/// and `incidence`, common to all readings of its incidence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorModel {
    /// The error of each reading in proportion to it.
    pub proportional: f64,
    /// The error in proportion that the readings of an incidence have in common.
    pub incidence: f64,
    /// The misfit of the model that depends on the angles.
    pub angular: f64,
    /// The misfit of the model that depends on the place within the lobe.
    pub lobe: f64,
    /// The part of the differences between models that is a possible misfit.
    pub models: f64,
}

/// 3 % of each reading, 5 % of each incidence, and a misfit of 10 % twice: within a factor of two those of the
/// measured samples, whose scale the residuals correct.
impl Default for ErrorModel {
    fn default() -> Self {
        Self {
            proportional: 0.03,
            incidence: 0.05,
            angular: 0.1,
            lobe: 0.1,
            models: 0.5,
        }
    }
}

impl ErrorModel {
    /// The variance of the error of a reading.
    pub(super) fn variance(&self) -> f64 {
        self.proportional.powi(2) + self.incidence.powi(2) + self.misfit_variance()
    }

    /// The variance of the misfit.
    pub(super) fn misfit_variance(&self) -> f64 {
        self.angular.powi(2) + self.lobe.powi(2)
    }

    /// The covariance of the misfit at two settings, for lobes of width k1.
    pub(super) fn misfit(&self, a: &Place, b: &Place) -> f64 {
        let square = |difference: f64, length: f64| (difference / length).powi(2);
        let angular = square(a.site.along - b.site.along, VIEW_LENGTH)
            + square(a.site.across - b.site.across, VIEW_LENGTH)
            + square(a.site.setting.psi - b.site.setting.psi, INCIDENCE_LENGTH);
        let lobe = square(a.tilt - b.tilt, TILT_LENGTH)
            + square(a.site.gamma - b.site.gamma, FACET_LENGTH);
        self.angular.powi(2) * (-0.5 * angular).exp() + self.lobe.powi(2) * (-0.5 * lobe).exp()
    }

    /// The covariance of the errors of two different readings, without the misfit.
    pub(super) fn common(&self, a: &Place, b: &Place) -> f64 {
        if is_same_incidence(a.site.setting.psi, b.site.setting.psi) {
            self.incidence.powi(2)
        } else {
            0.0
        }
    }
}

/// Whether two incidence angles are one.
pub(super) fn is_same_incidence(a: f64, b: f64) -> bool {
    (a - b).abs() < SAME_INCIDENCE
}

/// A setting and the tilt of its facet in widths of the lobe.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) site: Site,
    pub(super) tilt: f64,
}

impl Place {
    pub(super) fn new(site: Site, k1: f64) -> Self {
        let tilt = site.tilt(k1);
        Self { site, tilt }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::planning::setting::Setting;

    fn places() -> Vec<Place> {
        let mut places = Vec::new();
        for psi in [0.0, 10.0, 40.0, 75.0_f64] {
            for theta in [-80.0, -40.0, -5.0, 20.0, 60.0_f64] {
                for phi in [0.0, 45.0, 90.0_f64] {
                    let setting = Setting {
                        psi: psi.to_radians(),
                        theta: theta.to_radians(),
                        phi: phi.to_radians(),
                    };
                    places.push(Place::new(Site::new(setting).unwrap(), 0.2));
                }
            }
        }
        places
    }

    #[test]
    fn the_covariance_is_symmetric_and_has_no_negative_eigenvalue() {
        let (model, places) = (ErrorModel::default(), places());
        let count = places.len();
        let matrix = DMatrix::from_fn(count, count, |i, j| {
            let (a, b) = (&places[i], &places[j]);
            assert_eq!(model.misfit(a, b), model.misfit(b, a));
            model.misfit(a, b) + model.common(a, b)
        });
        let smallest = matrix.symmetric_eigenvalues().min();
        assert!(smallest > -1e-12, "{smallest}");
        let place = &places[7];
        let found = model.misfit(place, place);
        assert!((found - model.misfit_variance()).abs() < 1e-15);
    }
}
