//! The grid of a table: bins of half and difference angles, and the directions at their centres.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::Vector3;

/// Sine and cosine of an angle.
type SinCos = (f64, f64);

/// The numbers of bins of `theta_h`, `theta_d` and `phi_d`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bins {
    /// Bins of `theta_h`.
    pub theta_h: usize,
    /// Bins of `theta_d`.
    pub theta_d: usize,
    /// Bins of `phi_d`.
    pub phi_d: usize,
}

impl Bins {
    /// The bins of the tables in the MERL database, 90 x 90 x 180.
    pub const STANDARD: Self = Self {
        theta_h: 90,
        theta_d: 90,
        phi_d: 180,
    };

    /// The number of bins of one `theta_h`.
    pub(super) fn per_slab(self) -> usize {
        self.theta_d * self.phi_d
    }

    /// The number of bins of a channel.
    pub fn count(self) -> usize {
        self.theta_h * self.per_slab()
    }

    /// The indices of the bin that contains a pair of directions, given by psi, theta and phi in
    /// radians.
    ///
    /// With the unit vectors s of the source and v of the view, `theta_h` is the zenith angle of
    /// s + v, tan `theta_d` = |s - v| / |s + v|, and `phi_d` is the azimuth of s about the half
    /// vector, counted from the direction in which the half vector is tilted.
    pub fn bin_of(self, [psi, theta, phi]: [f64; 3]) -> [usize; 3] {
        let source = Vector3::new(psi.sin(), 0.0, psi.cos());
        let view = Vector3::new(
            theta.sin() * phi.cos(),
            theta.sin() * phi.sin(),
            theta.cos(),
        );
        let (sum, difference) = (source + view, source - view);
        let across = sum.x.hypot(sum.y);
        let theta_h = across.atan2(sum.z);
        let theta_d = difference.norm().atan2(sum.norm());
        // A half vector along the normal is tilted in no direction: any may be chosen.
        let tilt = if across > 0.0 {
            [sum.x / across, sum.y / across]
        } else {
            [1.0, 0.0]
        };
        let (sin_h, cos_h) = theta_h.sin_cos();
        let along = (source.x * tilt[0] + source.y * tilt[1]) * cos_h - source.z * sin_h;
        let around = source.y * tilt[0] - source.x * tilt[1];
        let phi_d = around.atan2(along).rem_euclid(PI);
        [
            index_at((theta_h / FRAC_PI_2).sqrt(), self.theta_h),
            index_at(theta_d / FRAC_PI_2, self.theta_d),
            index_at(phi_d / PI, self.phi_d),
        ]
    }

    /// psi, theta and phi in radians at the centre of a bin; `None` where one of the two directions is
    /// not above the surface.
    pub fn centre(self, [i, j, k]: [usize; 3]) -> Option<[f64; 3]> {
        Self::angles_at([
            centre_of(i, self.theta_h),
            centre_of(j, self.theta_d),
            centre_of(k, self.phi_d),
        ])
    }

    /// psi, theta and phi in radians at a position in the table, from 0 to 1 along each of its axes;
    /// `None` where one of the two directions is not above the surface.
    pub(crate) fn angles_at([root_h, part_d, part_phi]: [f64; 3]) -> Option<[f64; 3]> {
        angles(
            half_angle(root_h),
            difference_angle(part_d),
            azimuth(part_phi),
        )
    }

    /// [`centre`](Self::centre) of the bins j, k of the slab i of one `theta_h`. The sines and cosines
    /// along each axis are computed once.
    pub(super) fn centres_of_slab(self, i: usize) -> impl Fn(usize, usize) -> Option<[f64; 3]> {
        let half = half_angle(centre_of(i, self.theta_h));
        let azimuths = (0..self.phi_d).map(|k| azimuth(centre_of(k, self.phi_d)));
        let azimuths: Vec<SinCos> = azimuths.collect();
        let differences = (0..self.theta_d).map(|j| difference_angle(centre_of(j, self.theta_d)));
        let differences: Vec<SinCos> = differences.collect();
        move |j, k| angles(half, differences[j], azimuths[k])
    }
}

/// psi, theta and phi in radians from `theta_h`, `theta_d` and `phi_d` in radians; `None` where one of the
/// two directions is not above the surface.
pub(in crate::read) fn from_half_and_difference(
    theta_h: f64,
    theta_d: f64,
    phi_d: f64,
) -> Option<[f64; 3]> {
    angles(theta_h.sin_cos(), theta_d.sin_cos(), phi_d.sin_cos())
}

/// psi, theta and phi in radians from the sines and cosines of `theta_h`, `theta_d` and `phi_d`; `None`
/// where one of the two directions is not above the surface.
///
/// With the half vector h = (sin `theta_h`, 0, cos `theta_h`), the source is the direction of the
/// spherical coordinates (`theta_d`, `phi_d`) rotated from the normal to h, and the view is its mirror
/// image about h: v = 2 (s . h) h - s, where s . h = cos `theta_d`.
fn angles(
    (sin_h, cos_h): SinCos,
    (sin_d, cos_d): SinCos,
    (sin_phi, cos_phi): SinCos,
) -> Option<[f64; 3]> {
    let along = sin_d * cos_phi;
    let source = [
        along * cos_h + cos_d * sin_h,
        sin_d * sin_phi,
        cos_d * cos_h - along * sin_h,
    ];
    let view = [
        2.0 * cos_d * sin_h - source[0],
        -source[1],
        2.0 * cos_d * cos_h - source[2],
    ];
    (source[2] > 0.0 && view[2] > 0.0).then(|| {
        let zenith = |[x, y, z]: [f64; 3]| (x * x + y * y).sqrt().atan2(z);
        let cross = source[0] * view[1] - source[1] * view[0];
        let dot = source[0] * view[0] + source[1] * view[1];
        [zenith(source), zenith(view), cross.atan2(dot)]
    })
}

/// The position of the centre of a bin, from 0 to 1 along its axis.
fn centre_of(index: usize, bins: usize) -> f64 {
    (index as f64 + 0.5) / bins as f64
}

/// The index of the bin that contains a position from 0 to 1.
fn index_at(position: f64, bins: usize) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a position is not negative, and there are few bins"
    )]
    let bin = (position * bins as f64) as usize;
    bin.min(bins - 1)
}

/// Sine and cosine of `theta_h` at a position along its axis, which is its square root.
fn half_angle(root: f64) -> SinCos {
    (FRAC_PI_2 * root * root).sin_cos()
}

/// Sine and cosine of `theta_d` at a position along its axis.
fn difference_angle(position: f64) -> SinCos {
    (FRAC_PI_2 * position).sin_cos()
}

/// Sine and cosine of `phi_d` at a position along its axis.
fn azimuth(position: f64) -> SinCos {
    (PI * position).sin_cos()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const SMALL: Bins = Bins {
        theta_h: 6,
        theta_d: 5,
        phi_d: 8,
    };

    #[test]
    fn the_angles_of_a_bin_are_those_of_its_half_vector() {
        for (i, j, k) in [(0, 0, 0), (2, 1, 3), (3, 2, 7)] {
            let [psi, theta, phi] = SMALL.centre([i, j, k]).unwrap();
            let geometry = brdf_core::Geometry::new(psi, theta, phi).unwrap();
            let part = |index: usize, bins: usize| (index as f64 + 0.5) / bins as f64;
            let theta_h = FRAC_PI_2 * part(i, SMALL.theta_h).powi(2);
            assert!((geometry.tan2_alpha().sqrt().atan() - theta_h).abs() < 1e-12);
            let theta_d = FRAC_PI_2 * part(j, SMALL.theta_d);
            assert!((geometry.cos_gamma() - theta_d.cos()).abs() < 1e-12);
        }
    }

    proptest! {
        #[test]
        fn the_centre_of_a_bin_lies_in_it(i in 0_usize..90, j in 0_usize..90, k in 0_usize..180) {
            if let Some(angles) = Bins::STANDARD.centre([i, j, k]) {
                prop_assert_eq!(Bins::STANDARD.bin_of(angles), [i, j, k]);
            }
        }
    }
}
