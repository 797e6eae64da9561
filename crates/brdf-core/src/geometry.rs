//! A pair of directions, reduced to the quantities that the terms of the model depend on.

#![expect(
    clippy::inline_always,
    reason = "a call costs a tenth of an evaluation"
)]

use std::f64::consts::FRAC_PI_2;

use crate::direction::{Direction, difference, divided, dot, length, sum};
use crate::direction_pair::{DirectionPair, HalfVector};
use crate::numeric::{HalfAngle, cos_quarter, half_of_azimuth};

/// The largest deviation of a direction vector's length from 1.
///
/// It admits vectors that were rounded to `f32`; these are normalised.
const LENGTH_TOLERANCE: f64 = 1e-6;

/// A pair of directions: light is incident at the zenith angle psi and observed at the zenith angle
/// theta and the azimuth phi relative to the source (0 is back towards the source, pi is forward).
/// The surface normal is the z axis (Fig. 1 of the paper).
///
/// A geometry contains the quantities that the terms of the model depend on, in forms that keep
/// their relative accuracy up to grazing angles and next to the specular direction. With
/// h = source + view, its component `h_z` = cos psi + cos theta along the normal and its tangential
/// component `h_t`:
///
/// ```text
/// tan^2 alpha = h_t^2 / h_z^2
///             = tan^2((psi - theta)/2) + 4 sin psi sin theta cos^2(phi/2) / h_z^2
/// cos^2 gamma = |source + view|^2 / 4
///             = (h_z^2 / cos^2((psi - theta)/2) + 4 sin psi sin theta cos^2(phi/2)) / 4
/// sin^2 gamma = |source - view|^2 / 4
/// ```
///
/// where alpha is the tilt of the facet that mirrors the source into the view and gamma the
/// incidence angle on that facet. The first form follows from
/// sin psi - sin theta = (cos psi + cos theta) tan((psi - theta)/2). The only difference of nearly
/// equal numbers that remains is psi - theta, which is exact if they are nearly equal.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Stored"))]
pub struct Geometry {
    pub(crate) cos_psi: f64,
    pub(crate) cos_theta: f64,
    pub(crate) cos_gamma: f64,
    pub(crate) cos2_gamma: f64,
    pub(crate) sin2_gamma: f64,
    pub(crate) tan2_alpha: f64,
    pub(crate) sec_alpha: f64,
}

/// A pair of directions outside the model's domain.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GeometryError {
    /// The incidence angle is not in [0, pi/2).
    #[error("incidence angle psi = {0} rad: expected a value in [0, pi/2)")]
    Incidence(f64),
    /// The view angle is not in (-pi/2, pi/2).
    #[error("view angle theta = {0} rad: expected a value between -pi/2 and pi/2")]
    View(f64),
    /// The azimuth is not a finite number.
    #[error("azimuth phi = {0} rad: expected a finite number")]
    Azimuth(f64),
    /// The cosine of a zenith angle is not in (0, 1].
    #[error("cosine of a zenith angle = {0}: expected a value in (0, 1]")]
    ZenithCosine(f64),
    /// The cosine of the azimuth is not in [-1, 1].
    #[error("cosine of the azimuth = {0}: expected a value in [-1, 1]")]
    AzimuthCosine(f64),
    /// The functions of the angles in a file do not belong to one pair of directions.
    #[error("the cosines and tangents do not belong to one pair of directions")]
    Inconsistent,
    /// A direction vector is not of length 1.
    #[error("direction of length {0}: expected a unit vector")]
    Length(f64),
    /// A direction points into the surface or along it.
    #[error("direction with z = {0}: expected z > 0, the side of the surface normal")]
    BelowSurface(f64),
}

/// A [`Geometry`] in a file, before it is checked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct Stored {
    cos_psi: f64,
    cos_theta: f64,
    cos_gamma: f64,
    cos2_gamma: f64,
    sin2_gamma: f64,
    tan2_alpha: f64,
    sec_alpha: f64,
}

#[cfg(feature = "serde")]
impl TryFrom<Stored> for Geometry {
    type Error = GeometryError;

    fn try_from(stored: Stored) -> Result<Self, GeometryError> {
        for cosine in [stored.cos_psi, stored.cos_theta] {
            if !(cosine > 0.0 && cosine <= 1.0) {
                return Err(GeometryError::ZenithCosine(cosine));
            }
        }
        let agree = |a: f64, b: f64| (a - b).abs() <= 1e-12 * a.abs().max(b.abs());
        let half_vector_z = 0.5 * (stored.cos_psi + stored.cos_theta);
        if !(stored.tan2_alpha >= 0.0
            && agree(stored.cos2_gamma + stored.sin2_gamma, 1.0)
            && agree(stored.cos_gamma * stored.cos_gamma, stored.cos2_gamma)
            && agree(stored.sec_alpha * stored.sec_alpha, 1.0 + stored.tan2_alpha)
            && agree(stored.cos_gamma, half_vector_z * stored.sec_alpha))
        {
            return Err(GeometryError::Inconsistent);
        }
        Ok(Self {
            cos_psi: stored.cos_psi,
            cos_theta: stored.cos_theta,
            cos_gamma: stored.cos_gamma,
            cos2_gamma: stored.cos2_gamma,
            sin2_gamma: stored.sin2_gamma,
            tan2_alpha: stored.tan2_alpha,
            sec_alpha: stored.sec_alpha,
        })
    }
}

impl Geometry {
    /// The geometry of the angles psi, theta and phi, in radians.
    ///
    /// Domain: psi in [0, pi/2), theta in (-pi/2, pi/2), any finite phi. The `f64` nearest to
    /// pi/2 is below pi/2 and belongs to the domain. A negative theta is the direction (|theta|,
    /// phi + pi), so that `new(psi, theta, 0.0)` accepts the signed in-plane angle of the paper.
    ///
    /// # Errors
    ///
    /// [`GeometryError`] for an angle outside its domain.
    ///
    /// # Examples
    ///
    /// ```
    /// use brdf_core::Geometry;
    ///
    /// let geometry = Geometry::new(0.5, 0.5, std::f64::consts::PI)?; // the specular direction
    /// assert!(geometry.tan2_alpha() < 1e-30);
    /// # Ok::<(), brdf_core::GeometryError>(())
    /// ```
    #[inline(always)]
    pub fn new(psi: f64, theta: f64, phi: f64) -> Result<Self, GeometryError> {
        if !(0.0..=FRAC_PI_2).contains(&psi) {
            return Err(GeometryError::Incidence(psi));
        }
        if theta.is_nan() || theta.abs() > FRAC_PI_2 {
            return Err(GeometryError::View(theta));
        }
        if !phi.is_finite() {
            return Err(GeometryError::Azimuth(phi));
        }
        Ok(Self::from_angles(psi, theta, phi))
    }

    /// The geometry in the plane of incidence, with the paper's signed view angle, in radians:
    /// theta = -psi is the specular direction and theta = psi looks back into the source.
    ///
    /// # Errors
    ///
    /// [`GeometryError`] for an angle outside the domain of [`new`](Self::new).
    #[inline(always)]
    pub fn in_plane(psi: f64, signed_theta: f64) -> Result<Self, GeometryError> {
        Self::new(psi, signed_theta, 0.0)
    }

    /// The geometry of two unit vectors that point away from the surface, towards the source and
    /// towards the viewer; z is along the surface normal.
    ///
    /// Vectors whose length differs from 1 by up to 1e-6 are normalised.
    ///
    /// # Errors
    ///
    /// [`GeometryError::Length`] for a vector that is not of unit length and
    /// [`GeometryError::BelowSurface`] for one with z <= 0.
    ///
    /// # Examples
    ///
    /// ```
    /// use brdf_core::Geometry;
    ///
    /// let geometry = Geometry::from_directions([0.6, 0.0, 0.8], [0.0, 0.6, 0.8])?;
    /// assert!((geometry.cos_psi() - 0.8).abs() < 1e-15);
    /// # Ok::<(), brdf_core::GeometryError>(())
    /// ```
    pub fn from_directions(
        source: impl Direction,
        view: impl Direction,
    ) -> Result<Self, GeometryError> {
        let source = checked_direction(source.components())?;
        let view = checked_direction(view.components())?;
        let half = sum(source, view);
        let difference = difference(source, view);
        let across2 = half[0] * half[0] + half[1] * half[1];
        let sin2_gamma = 0.25 * dot(difference, difference);
        let length2 = 0.25 * dot(half, half);
        let pair = DirectionPair::from_half(source[2], view[2], 0.25 * across2, length2);
        Ok(Self::from_pair(&pair, pair.half.tan2_alpha(), sin2_gamma))
    }

    /// The geometry of the cosines of psi and theta, in (0, 1], and of phi, in [-1, 1].
    ///
    /// A cosine determines a small angle poorly: angles or directions are more accurate if they are
    /// available.
    ///
    /// # Errors
    ///
    /// [`GeometryError::ZenithCosine`] or [`GeometryError::AzimuthCosine`] for a cosine outside its
    /// domain.
    pub fn from_cosines(cos_psi: f64, cos_theta: f64, cos_phi: f64) -> Result<Self, GeometryError> {
        for cosine in [cos_psi, cos_theta] {
            if !(cosine > 0.0 && cosine <= 1.0) {
                return Err(GeometryError::ZenithCosine(cosine));
            }
        }
        if !(-1.0..=1.0).contains(&cos_phi) {
            return Err(GeometryError::AzimuthCosine(cos_phi));
        }
        let pair = DirectionPair::from_cosines(cos_psi, cos_theta, cos_phi);
        // |source - view|^2 has parts along the normal, tangential in plane, and out of plane.
        let along = cos_psi - cos_theta;
        let sin2 = |cosine: f64| (1.0 - cosine) * (1.0 + cosine);
        let sines = (sin2(cos_psi) * sin2(cos_theta)).sqrt();
        let sum2 = sin2(cos_psi) + sin2(cos_theta) + 2.0 * sines;
        let in_plane = if along == 0.0 {
            0.0
        } else {
            (along * (cos_psi + cos_theta)).powi(2) / sum2
        };
        let across2 = in_plane + 2.0 * sines * (1.0 - cos_phi);
        let sin2_gamma = 0.25 * (along * along + across2);
        Ok(Self::from_pair(&pair, pair.half.tan2_alpha(), sin2_gamma))
    }

    /// The geometry of angles in the domain. With s = (psi + theta)/2, d = (psi - theta)/2 and
    /// a = phi/2, in which theta is not negative,
    ///
    /// ```text
    /// cos^2 gamma = cos^2 d cos^2 a + cos^2 s sin^2 a
    /// sin^2 gamma = sin^2 d cos^2 a + sin^2 s sin^2 a
    /// tan^2 alpha = (sin^2 s cos^2 d cos^2 a + sin^2 d cos^2 s sin^2 a) / (cos^2 s cos^2 d)
    /// ```
    ///
    /// The rounding errors are carried in cos^2 gamma and in the numerator and the denominator of
    /// tan^2 alpha, because a small n multiplies that of cos^2 gamma in R0.
    #[inline(always)]
    fn from_angles(psi: f64, theta: f64, phi: f64) -> Self {
        // (theta < 0, phi) equals (|theta|, phi + pi).
        let azimuth = HalfAngle::of_azimuth(half_of_azimuth(phi), theta < 0.0);
        let theta = theta.abs();
        let difference = HalfAngle::of_difference(psi, theta);
        let sum = HalfAngle::of_sum(psi, theta);
        let near = difference.cos2 * azimuth.cos2;
        let far = sum.cos2 * azimuth.sin2;
        let across2 = sum.sin2 * near + difference.sin2 * far;
        let cos2_gamma = (near + far).nearest();
        let sin2_gamma = difference.sin2.value() * azimuth.cos2.value()
            + sum.sin2.value() * azimuth.sin2.value();
        let below = sum.cos2 * difference.cos2;
        let tan2_alpha = across2.nearest() / below.nearest();
        Self {
            cos_psi: cos_quarter(psi),
            cos_theta: cos_quarter(theta),
            cos_gamma: cos2_gamma.sqrt(),
            cos2_gamma,
            sin2_gamma,
            tan2_alpha,
            sec_alpha: (1.0 + tan2_alpha).sqrt(),
        }
    }

    #[inline(always)]
    fn from_pair(pair: &DirectionPair<f64>, tan2_alpha: f64, sin2_gamma: f64) -> Self {
        let half = pair.half;
        Self {
            cos_psi: pair.cos_psi,
            cos_theta: pair.cos_theta,
            cos_gamma: half.length,
            cos2_gamma: half.length2,
            sin2_gamma,
            tan2_alpha,
            sec_alpha: (1.0 + tan2_alpha).sqrt(),
        }
    }

    /// The half vector with a component of 1 along the normal.
    #[inline(always)]
    pub(crate) fn half(&self) -> HalfVector<f64> {
        HalfVector::from_tilt(self.tan2_alpha, self.sec_alpha)
    }

    /// cos psi, the cosine of the incidence angle.
    pub fn cos_psi(&self) -> f64 {
        self.cos_psi
    }

    /// cos theta, the cosine of the view angle.
    pub fn cos_theta(&self) -> f64 {
        self.cos_theta
    }

    /// cos gamma, the cosine of the incidence angle on the facet.
    pub fn cos_gamma(&self) -> f64 {
        self.cos_gamma
    }

    /// cos^2 gamma.
    pub fn cos2_gamma(&self) -> f64 {
        self.cos2_gamma
    }

    /// sin^2 gamma, accurate also where gamma is small.
    pub fn sin2_gamma(&self) -> f64 {
        self.sin2_gamma
    }

    /// tan^2 alpha of the facet's tilt alpha, accurate also where alpha is small.
    pub fn tan2_alpha(&self) -> f64 {
        self.tan2_alpha
    }

    /// 1 / cos alpha of the facet's tilt alpha.
    pub fn sec_alpha(&self) -> f64 {
        self.sec_alpha
    }
}

/// The normalised direction.
fn checked_direction(direction: [f64; 3]) -> Result<[f64; 3], GeometryError> {
    let length = length(direction);
    if length.is_nan() || (length - 1.0).abs() > LENGTH_TOLERANCE {
        return Err(GeometryError::Length(length));
    }
    if direction[2] <= 0.0 {
        return Err(GeometryError::BelowSurface(direction[2]));
    }
    Ok(divided(direction, length))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use proptest::prelude::*;

    use super::*;

    fn direction(zenith: f64, azimuth: f64) -> [f64; 3] {
        [
            zenith.sin() * azimuth.cos(),
            zenith.sin() * azimuth.sin(),
            zenith.cos(),
        ]
    }

    #[test]
    fn the_mirror_direction_has_no_tilt() {
        for psi_deg in [0.0_f64, 1.0, 45.0, 89.9] {
            let psi = psi_deg.to_radians();
            let geometry = Geometry::in_plane(psi, -psi).unwrap();
            assert_eq!(geometry.tan2_alpha(), 0.0);
            assert!((geometry.cos_gamma() - psi.cos()).abs() < 1e-15);
        }
    }

    #[test]
    fn retro_reflection_tilts_the_facet_by_psi() {
        let psi = 0.7_f64;
        let geometry = Geometry::in_plane(psi, psi).unwrap();
        assert!((geometry.tan2_alpha() - psi.tan().powi(2)).abs() < 1e-15);
        assert!((geometry.cos_gamma() - 1.0).abs() < 1e-15);
        assert_eq!(geometry.sin2_gamma(), 0.0);
    }

    #[test]
    fn angles_outside_the_domain_are_named() {
        let message = |psi, theta, phi| Geometry::new(psi, theta, phi).unwrap_err().to_string();
        assert!(message(-0.1, 0.0, 0.0).contains("psi = -0.1"));
        assert!(message(1.6, 0.0, 0.0).contains("psi = 1.6"));
        assert!(message(f64::NAN, 0.0, 0.0).contains("psi = NaN"));
        assert!(message(0.0, -1.6, 0.0).contains("theta = -1.6"));
        assert!(message(0.0, f64::NAN, 0.0).contains("theta = NaN"));
        assert!(message(0.0, 0.0, f64::INFINITY).contains("phi = inf"));
    }

    #[test]
    fn directions_outside_the_domain_are_named() {
        let up = [0.0, 0.0, 1.0];
        let message = |a, b| Geometry::from_directions(a, b).unwrap_err().to_string();
        assert!(message([0.0, 0.0, 2.0], up).contains("length 2"));
        assert!(message(up, [0.0, 0.0, -1.0]).contains("z = -1"));
        assert!(message(up, [1.0, 0.0, 0.0]).contains("z = 0"));
        assert!(message(up, [f64::NAN, 0.0, 1.0]).contains("length NaN"));
    }

    #[cfg(feature = "nalgebra")]
    #[test]
    fn arrays_and_vectors_give_the_same_geometry() {
        let (source, view) = (direction(0.4, 0.3), direction(1.1, 2.0));
        let by_arrays = Geometry::from_directions(source, view).unwrap();
        let [source, view] = [source, view].map(nalgebra::Vector3::from);
        assert_eq!(Geometry::from_directions(source, view), Ok(by_arrays));
    }

    proptest! {
        #[test]
        fn angles_and_directions_agree(
            psi in 0.0..1.55, theta in 0.0..1.55, phi in -7.0..7.0_f64,
        ) {
            let by_angles = Geometry::new(psi, theta, phi).unwrap();
            let by_directions =
                Geometry::from_directions(direction(psi, 0.0), direction(theta, phi)).unwrap();
            prop_assert!((by_angles.cos_gamma - by_directions.cos_gamma).abs() < 1e-14);
            prop_assert!((by_angles.sin2_gamma - by_directions.sin2_gamma).abs() < 1e-14);
            let tan2 = by_angles.tan2_alpha;
            prop_assert!((tan2 - by_directions.tan2_alpha).abs() < 1e-12 * (1.0 + tan2));
        }

        #[test]
        fn source_and_view_are_interchangeable(
            psi in 0.0..FRAC_PI_2, theta in 0.0..FRAC_PI_2, phi in -7.0..7.0_f64,
        ) {
            let there = Geometry::new(psi, theta, phi).unwrap();
            let back = Geometry::new(theta, psi, phi).unwrap();
            prop_assert_eq!(there.tan2_alpha, back.tan2_alpha);
            prop_assert_eq!(there.cos_gamma, back.cos_gamma);
            prop_assert_eq!(there.sin2_gamma, back.sin2_gamma);
        }

        #[test]
        fn a_negative_view_angle_is_the_forward_side(
            psi in 0.0..1.57, theta in 0.0..1.57_f64, phi in -3.0..3.0_f64,
        ) {
            let signed = Geometry::new(psi, -theta, phi).unwrap();
            let turned = Geometry::new(psi, theta, phi + PI).unwrap();
            prop_assert!((signed.cos_gamma - turned.cos_gamma).abs() < 1e-14);
            let tan2 = signed.tan2_alpha;
            prop_assert!((tan2 - turned.tan2_alpha).abs() < 1e-13 * (1.0 + tan2));
        }

        #[test]
        fn sine_and_cosine_of_the_facet_angle_are_consistent(
            psi in 0.0..FRAC_PI_2, theta in 0.0..FRAC_PI_2, phi in -7.0..7.0_f64,
        ) {
            let g = Geometry::new(psi, theta, phi).unwrap();
            prop_assert!((g.cos_gamma * g.cos_gamma + g.sin2_gamma - 1.0).abs() < 1e-14);
        }
    }
}
