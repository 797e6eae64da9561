//! The model as a textbook prints it, term by term: correct on paper, and what the stable forms of
//! `brdf-core` are measured against.

use std::f64::consts::PI;

use brdf_core::Parameters;

/// f_r and its derivatives by k2 and k1, by the printed formulas.
pub fn brdf(psi: f64, theta: f64, phi: f64, parameters: Parameters, n: f64) -> [f64; 3] {
    let Parameters { k2, kd, k1 } = parameters;
    let cos_2_gamma = psi.cos() * theta.cos() + psi.sin() * theta.sin() * phi.cos();
    let cos_gamma = (0.5 * cos_2_gamma.acos()).cos();
    let cos_alpha = (psi.cos() + theta.cos()) / (2.0 * cos_gamma);
    let denominator = 1.0 + (k1 * k1 - 1.0) * cos_alpha * cos_alpha;
    let facet = k1 * k1 * cos_alpha / denominator;
    let facet_slope = 2.0 * k1 * cos_alpha / denominator
        - k1 * k1 * cos_alpha * 2.0 * k1 * cos_alpha * cos_alpha / (denominator * denominator);
    let fresnel = reflectance(n, cos_gamma) / reflectance(n, 1.0);
    let shadowing = 1.0_f64
        .min(2.0 * cos_alpha * theta.cos() / cos_gamma)
        .min(2.0 * cos_alpha * psi.cos() / cos_gamma);
    let mirror = fresnel * shadowing / (psi.cos() * theta.cos()) / PI;
    [
        k2 * facet * mirror + kd / PI,
        facet * mirror,
        k2 * facet_slope * mirror,
    ]
}

fn reflectance(n: f64, cos_gamma: f64) -> f64 {
    let g = (n * n - 1.0 + cos_gamma * cos_gamma).sqrt();
    let ratio = (g - cos_gamma) / (g + cos_gamma);
    let b = (cos_gamma * (g + cos_gamma) - 1.0) / (cos_gamma * (g - cos_gamma) + 1.0);
    0.5 * ratio * ratio * (1.0 + b * b)
}
