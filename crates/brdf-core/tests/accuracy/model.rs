//! The model in double-double arithmetic, from its equations.

use brdf_core::Parameters;

use crate::double_double::DoubleDouble;

/// A pair of directions, in radians, and a model.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Point {
    pub(crate) psi: f64,
    pub(crate) theta: f64,
    pub(crate) phi: f64,
    pub(crate) parameters: Parameters,
    pub(crate) n: f64,
}

/// f_r in 1/sr, eq. (4).
pub(crate) fn brdf(point: &Point) -> DoubleDouble {
    let number = DoubleDouble::from;
    let (one, two) = (number(1.0), number(2.0));
    let (psi, theta) = (number(point.psi), number(point.theta.abs()));
    let (cos_psi, cos_theta) = (psi.cos(), theta.cos());
    // h = source + view, with sin psi - sin theta as a product.
    let h_z = cos_psi + cos_theta;
    let half = number(0.5);
    let in_plane = two * cos_of_half_sum(psi, theta) * ((psi - theta) * half).sin();
    let cos2_half_phi = cos2_half_azimuth(point);
    let h_t2 = in_plane.squared() + number(4.0) * psi.sin() * theta.sin() * cos2_half_phi;
    let length2 = h_t2 + h_z.squared();
    let cos2_gamma = length2 * number(0.25);
    let cos_alpha = h_z / length2.sqrt();
    let sin2_alpha = h_t2 / length2;

    let k1_squared = number(point.parameters.k1).squared();
    let facet = k1_squared * cos_alpha / (sin2_alpha + k1_squared * cos_alpha.squared());
    let open = one / (cos_psi * cos_theta);
    let shadowed = open.min(h_z / (cos2_gamma * cos_psi.max(cos_theta)));
    let specular = facet * fresnel(point.n, cos2_gamma) * shadowed;
    let (k2, kd) = (point.parameters.k2, point.parameters.kd);
    (number(k2) * specular + number(kd)) * DoubleDouble::frac_1_pi()
}

/// cos((psi + theta)/2), with all digits for two angles next to pi/2.
fn cos_of_half_sum(psi: DoubleDouble, theta: DoubleDouble) -> DoubleDouble {
    let half = DoubleDouble::from(0.5);
    if psi.nearest() + theta.nearest() > std::f64::consts::FRAC_PI_2 {
        ((psi.complement() + theta.complement()) * half).sin()
    } else {
        ((psi + theta) * half).cos()
    }
}

/// cos^2(phi/2) of the azimuth that belongs to |theta|, which is phi + pi for a negative theta.
fn cos2_half_azimuth(point: &Point) -> DoubleDouble {
    let (rest, odd) = DoubleDouble::from(0.5 * point.phi).modulo_right_angle();
    if odd == (point.theta < 0.0) {
        rest.cos().squared()
    } else {
        rest.sin().squared()
    }
}

/// R0(gamma) by the Fresnel equations with g = sqrt(n^2 - 1 + c^2), where (g - c)/(g + c) over
/// (n - 1)/(n + 1) is ((n + 1)/(g + c))^2, and g - c is (n^2 - 1)/(g + c).
fn fresnel(n: f64, cos2_gamma: DoubleDouble) -> DoubleDouble {
    let (one, n) = (DoubleDouble::from(1.0), DoubleDouble::from(n));
    let n2_minus_1 = (n - one) * (n + one);
    let c = cos2_gamma.sqrt();
    let sum = (n2_minus_1 + cos2_gamma).sqrt() + c;
    let b = (c * sum - one) / (c * n2_minus_1 / sum + one);
    let ratio = ((n + one) / sum).squared().squared();
    DoubleDouble::from(0.5) * ratio * (one + b.squared())
}
