//! Scatter coordinates about the specular ray.

/// Converts scatter coordinates about the specular ray to the view zenith angle theta and azimuth phi
/// of the model. All angles are in radians; theta is in [0, pi], and pi/2 or more is below the surface.
///
/// The radial angle r and the azimuth a are spherical coordinates about the specular ray at the zenith
/// angle psi on the forward side, a = 0 pointing towards the normal. With x towards the source, y
/// across the plane of incidence and z along the normal, the view direction is
///
/// ```text
/// x = sin r cos a cos psi - cos r sin psi
/// y = sin r sin a
/// z = sin r cos a sin psi + cos r cos psi
/// ```
///
/// theta = atan2(sqrt(x^2 + y^2), z) and phi = atan2(y, x).
pub(crate) fn from_specular(psi: f64, azimuth: f64, radial: f64) -> (f64, f64) {
    let (sin_psi, cos_psi) = psi.sin_cos();
    let (sin_radial, cos_radial) = radial.sin_cos();
    let (out_of_plane, towards_normal) = (sin_radial * azimuth.sin(), sin_radial * azimuth.cos());
    let x = towards_normal * cos_psi - cos_radial * sin_psi;
    let z = towards_normal * sin_psi + cos_radial * cos_psi;
    (x.hypot(out_of_plane).atan2(z), out_of_plane.atan2(x))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, TAU};

    use proptest::prelude::*;

    use super::*;

    proptest! {
        // The reference is the spherical triangle of normal, specular ray and view.
        #[test]
        fn directions_agree_with_spherical_trigonometry(
            psi in 0.01..1.5_f64,
            azimuth in 0.0..TAU,
            radial in 0.01..3.1_f64,
        ) {
            let (theta, phi) = from_specular(psi, azimuth, radial);
            let cos_theta = psi.cos() * radial.cos() + psi.sin() * radial.sin() * azimuth.cos();
            prop_assert!((theta.cos() - cos_theta).abs() < 1e-14);
            // The angle at the normal between the specular ray and the view.
            let adjacent = radial.cos() - psi.cos() * cos_theta;
            let turn = adjacent / psi.sin();
            let sine = radial.sin() * azimuth.sin();
            // phi is counted from the source, which is opposite to the specular ray.
            prop_assert!((theta.sin() * phi.cos() + turn).abs() < 1e-12 / psi.sin());
            prop_assert!((theta.sin() * phi.sin() - sine).abs() < 1e-14);
        }

        #[test]
        fn the_radial_angle_is_that_from_the_specular_ray(
            psi in 0.0..FRAC_PI_2,
            azimuth in 0.0..TAU,
            radial in 0.0..3.1_f64,
        ) {
            let (theta, phi) = from_specular(psi, azimuth, radial);
            let cosine = -psi.sin() * theta.sin() * phi.cos() + psi.cos() * theta.cos();
            prop_assert!((cosine - radial.cos()).abs() < 1e-14);
        }
    }
}
