//! A pair of directions in the form that the terms of the model depend on, in any kind of number.

#![expect(
    clippy::inline_always,
    reason = "a call costs a tenth of an evaluation and prevents vector code"
)]

use crate::numeric::{Real, sin_cos_quarter, sin_eighth, sin2_cos2_of_half};

/// The half vector between source and view, of any length, on which the distribution of facet
/// normals depends.
///
/// alpha is its angle with the surface normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfVector<R> {
    /// The square of the component across the surface normal, length^2 sin^2 alpha.
    pub across2: R,
    /// The component along the surface normal, length cos alpha.
    pub along: R,
    /// The square of the length.
    pub length2: R,
    /// The length.
    pub length: R,
}

impl HalfVector<f64> {
    /// The vector with a component of 1 along the normal, from tan^2 alpha and sec alpha.
    #[inline(always)]
    pub fn from_tilt(tan2_alpha: f64, sec_alpha: f64) -> Self {
        Self {
            across2: tan2_alpha,
            along: 1.0,
            length2: 1.0 + tan2_alpha,
            length: sec_alpha,
        }
    }
}

impl<R: Real> HalfVector<R> {
    /// tan^2 alpha.
    #[inline(always)]
    pub fn tan2_alpha(&self) -> R {
        self.across2 / (self.along * self.along)
    }
}

/// The directions of source and view.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DirectionPair<R> {
    /// cos psi of the source.
    pub(crate) cos_psi: R,
    /// cos theta of the view.
    pub(crate) cos_theta: R,
    /// (source + view)/2, whose length is cos gamma.
    pub(crate) half: HalfVector<R>,
}

/// A zenith angle in [0, pi/2] with its sine and cosine.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Zenith<R> {
    pub(crate) angle: R,
    pub(crate) sin: R,
    pub(crate) cos: R,
}

impl<R: Real> Zenith<R> {
    /// The sine and cosine of an angle that is known to be in [0, pi/2].
    #[inline(always)]
    pub(crate) fn new(angle: R) -> Self {
        let (sin, cos) = sin_cos_quarter(angle);
        Self { angle, sin, cos }
    }

    /// The sine and cosine of any number. The cosine is NaN for numbers outside [0, pi/2].
    #[inline(always)]
    pub(crate) fn checked(angle: R) -> Self {
        let zenith = Self::new(angle);
        let inside = (angle >= R::of(0.0)) & (angle < R::of(1.6));
        Self {
            cos: R::select(inside, zenith.cos, R::of(f64::NAN)),
            ..zenith
        }
    }
}

impl<R: Real> DirectionPair<R> {
    /// The value, or NaN if one of the directions is not above the surface.
    #[inline(always)]
    pub(crate) fn if_above_surface(&self, value: R) -> R {
        let above = (self.cos_psi > R::of(0.0)) & (self.cos_theta > R::of(0.0));
        R::select(above, value, R::of(f64::NAN))
    }

    /// From the half vector (source + view)/2: the square of its component across the normal and the
    /// square of its length.
    #[inline(always)]
    pub(crate) fn from_half(cos_psi: R, cos_theta: R, across2: R, length2: R) -> Self {
        Self {
            cos_psi,
            cos_theta,
            half: HalfVector {
                across2,
                along: R::of(0.5) * (cos_psi + cos_theta),
                length2,
                length: length2.sqrt(),
            },
        }
    }

    /// From zenith angles and the azimuth as cos^2(phi/2). With h = source + view and
    /// h_z = cos psi + cos theta,
    ///
    /// ```text
    /// h_t^2 = h_z^2 tan^2((psi - theta)/2) + 4 sin psi sin theta cos^2(phi/2)
    /// |h|^2 = h_z^2 / cos^2((psi - theta)/2) + 4 sin psi sin theta cos^2(phi/2)
    /// ```
    #[inline(always)]
    pub(crate) fn from_zeniths(source: Zenith<R>, view: Zenith<R>, cos2_half_phi: R) -> Self {
        let difference = HalfDifference::of(source, view);
        Self::from_difference(source, view, difference, cos2_half_phi)
    }

    /// [`from_zeniths`](Self::from_zeniths) with given functions of (psi - theta)/2.
    #[inline(always)]
    pub(crate) fn from_difference(
        source: Zenith<R>,
        view: Zenith<R>,
        difference: HalfDifference<R>,
        cos2_half_phi: R,
    ) -> Self {
        let h_z = source.cos + view.cos;
        let quarter_h_z2 = R::of(0.25) * (h_z * h_z);
        let out_of_plane = (source.sin * view.sin) * cos2_half_phi;
        Self::from_half(
            source.cos,
            view.cos,
            quarter_h_z2.mul_add(difference.tan2, out_of_plane),
            quarter_h_z2.mul_add(difference.sec2, out_of_plane),
        )
    }

    /// From psi, signed theta and phi in [-2 pi, 2 pi], in radians.
    #[inline(always)]
    pub(crate) fn from_angles(psi: R, theta: R, phi: R) -> Self {
        let (sin2, cos2) = sin2_cos2_of_half(phi);
        // (theta < 0, phi) equals (|theta|, phi + pi), which exchanges the two squares.
        let cos2_half_phi = R::select(theta < R::of(0.0), sin2, cos2);
        let (source, view) = (Zenith::checked(psi), Zenith::checked(theta.abs()));
        Self::from_zeniths(source, view, cos2_half_phi)
    }

    /// From the cosines of psi, theta and phi. With d = cos theta - cos psi,
    ///
    /// ```text
    /// sin psi - sin theta = d h_z / (sin psi + sin theta)
    /// h_t^2 = (sin psi - sin theta)^2 + 2 sin psi sin theta (1 + cos phi)
    /// ```
    ///
    /// which contains no difference of rounded numbers and needs one root for both sines.
    #[inline(always)]
    pub(crate) fn from_cosines(cos_psi: R, cos_theta: R, cos_phi: R) -> Self {
        let one = R::of(1.0);
        // A cosine may be above 1 by its rounding error, which is as large as below 1.
        let sin2_psi = ((one - cos_psi) * (one + cos_psi)).abs();
        let sin2_theta = ((one - cos_theta) * (one + cos_theta)).abs();
        let sines = (sin2_psi * sin2_theta).sqrt();
        // (sin psi + sin theta)^2, which must not be 0.
        let sum2 = (sin2_psi + sin2_theta) + (sines + sines) + R::of(1e-30);
        let along = R::of(0.5) * (cos_psi + cos_theta);
        let product = (cos_theta - cos_psi) * along;
        let half_sines = R::of(0.5) * sines;
        let out_of_plane = half_sines * (one + cos_phi).abs();
        let across2 = product * product / sum2 + out_of_plane;
        Self::from_half(cos_psi, cos_theta, across2, along.mul_add(along, across2))
    }

    /// From unit vectors towards the source and towards the viewer, z along the normal.
    ///
    /// The lengths differ by a rounding error, which is not negligible next to the mirror direction
    /// of a narrow lobe. It is corrected to first order.
    #[inline(always)]
    pub(crate) fn from_directions(source: [R; 3], view: [R; 3]) -> Self {
        let [sum_x, sum_y, sum_z] = [0, 1, 2].map(|i| source[i] + view[i]);
        let [x, y, z] = [0, 1, 2].map(|i| source[i] - view[i]);
        // |source|^2 - |view|^2, half of which is the length that the view lacks.
        let longer = x.mul_add(sum_x, y.mul_add(sum_y, z * sum_z));
        let scale = R::of(0.5) * longer;
        let half = |sum: R, component: R| R::of(0.5) * scale.mul_add(component, sum);
        let (half_x, half_y) = (half(sum_x, view[0]), half(sum_y, view[1]));
        let across2 = half_x.mul_add(half_x, half_y * half_y);
        let cos_theta = scale.mul_add(view[2], view[2]);
        let along = R::of(0.5) * (source[2] + cos_theta);
        Self::from_half(source[2], cos_theta, across2, along.mul_add(along, across2))
    }
}

/// tan^2 and 1/cos^2 of (psi - theta)/2.
#[derive(Clone, Copy)]
pub(crate) struct HalfDifference<R> {
    pub(crate) tan2: R,
    pub(crate) sec2: R,
}

impl<R: Real> HalfDifference<R> {
    #[inline(always)]
    pub(crate) fn of(source: Zenith<R>, view: Zenith<R>) -> Self {
        let sin = sin_eighth(R::of(0.5) * (source.angle - view.angle));
        let sin2 = sin * sin;
        // The sine is at most 1/sqrt(2).
        let sec2 = R::of(1.0) / (R::of(1.0) - sin2);
        Self {
            tan2: sin2 * sec2,
            sec2,
        }
    }
}
