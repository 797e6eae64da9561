//! Tests that all distributions share.

use std::f64::consts::TAU;

use proptest::prelude::*;

use super::*;
use crate::numeric::integrate;

const LAWS: [&str; 4] = ["ellipsoid", "power", "ggx", "beckmann"];

/// The value, its derivatives with respect to k1 and p, and the peak density.
fn evaluate(law: &str, k1: f64, p: f64, alpha: f64) -> [f64; 4] {
    fn all(facet: impl FacetDistribution, alpha: f64) -> [f64; 4] {
        let (t, sec) = (alpha.tan().powi(2), 1.0 / alpha.cos());
        [
            facet.relative(t, sec),
            facet.derivative_k1(t, sec),
            facet.derivative_p(t, sec),
            facet.peak_density(),
        ]
    }
    match law {
        "ellipsoid" => all(Ellipsoid::new(k1), alpha),
        "power" => all(Power::new(k1, p), alpha),
        "ggx" => all(Ggx::new(k1), alpha),
        _ => all(Beckmann::new(k1), alpha),
    }
}

/// tan^2 alpha drawn from u.
fn drawn(law: &str, k1: f64, p: f64, u: f64) -> f64 {
    match law {
        "ellipsoid" => Ellipsoid::new(k1).sample_tan2_alpha(u),
        "power" => Power::new(k1, p).sample_tan2_alpha(u),
        "ggx" => Ggx::new(k1).sample_tan2_alpha(u),
        _ => Beckmann::new(k1).sample_tan2_alpha(u),
    }
}

/// The fraction of the facet normals that are drawn with tan^2 alpha between two values, by quadrature
/// in v with tan alpha = w sinh v.
fn fraction_between(law: &str, k1: f64, p: f64, tan2_alpha: [f64; 2]) -> f64 {
    fn of(facet: impl FacetDistribution, [from, to]: [f64; 2]) -> f64 {
        let width = facet.k1().min(1.0);
        let ring = |v: f64| {
            let (sinh, cosh) = (v.sinh(), v.cosh());
            let t = (width * sinh).powi(2);
            let sec = (1.0 + t).sqrt();
            let area = width * width * sinh * cosh / (sec * (1.0 + t));
            TAU * facet.sampling_density(t, sec) * area
        };
        let [from, to] = [from, to].map(|t| (t.sqrt() / width).asinh());
        let breaks = std::array::from_fn::<f64, 9, _>(|i| from + (to - from) * i as f64 / 8.0);
        integrate(&ring, breaks, 1e-11)
    }
    match law {
        "ellipsoid" => of(Ellipsoid::new(k1), tan2_alpha),
        "power" => of(Power::new(k1, p), tan2_alpha),
        "ggx" => of(Ggx::new(k1), tan2_alpha),
        _ => of(Beckmann::new(k1), tan2_alpha),
    }
}

#[test]
fn drawn_tilts_are_continuous_at_their_limits() {
    for u in [1e-6, 0.3, 0.999_999] {
        for (k1, p, beside) in [(0.3, 1.0, 1e-9), (1.0, 1.0, 1e-9), (1.0, 3.0, 1e-9)] {
            let at = |k1, p| drawn("power", k1, p, u);
            let limit = at(k1, p);
            for near in [at(k1 * (1.0 + beside), p), at(k1, p * (1.0 - beside))] {
                assert!((near / limit - 1.0).abs() < 1e-7, "{k1} {p} {u}");
            }
        }
        let ellipsoid = drawn("ellipsoid", 1.0, 1.0, u);
        assert!((ellipsoid / (u / (1.0 - u)) - 1.0).abs() < 1e-15);
    }
}

#[test]
fn the_peak_is_one_for_any_width() {
    for k1 in [1e-8, 0.1, 1.0, 1e8] {
        for law in LAWS {
            assert_eq!(evaluate(law, k1, 2.0, 0.0)[0], 1.0, "{law} {k1}");
        }
    }
}

#[test]
fn the_peak_density_normalises() {
    // Midpoint rule over the tilt of the normalisation integral.
    for k1 in [0.2, 0.94, 0.95, 0.96, 1.0, 1.04, 1.05, 1.06, 1.338, 20.0] {
        for p in [0.5, 2.3] {
            for law in LAWS {
                let steps = 20_000;
                let sum: f64 = (0..steps)
                    .map(|i| {
                        let alpha =
                            std::f64::consts::FRAC_PI_2 * (f64::from(i) + 0.5) / f64::from(steps);
                        evaluate_relative(law, k1, p, alpha) * alpha.cos() * alpha.sin()
                    })
                    .sum();
                let integral = TAU * sum * std::f64::consts::FRAC_PI_2 / f64::from(steps);
                let peak = evaluate(law, k1, p, 0.0)[3];
                assert!(
                    (peak * integral - 1.0).abs() < 2e-5,
                    "{law} {k1} {p}: {}",
                    peak * integral
                );
            }
        }
    }
}

fn evaluate_relative(law: &str, k1: f64, p: f64, alpha: f64) -> f64 {
    evaluate(law, k1, p, alpha)[0]
}

#[test]
fn the_exponents_one_and_two_are_known_laws() {
    for alpha in [0.0_f64, 0.1, 0.8, 1.5] {
        let ellipsoid = evaluate_relative("ellipsoid", 0.3, 1.0, alpha);
        let power = evaluate_relative("power", 0.3, 1.0, alpha);
        assert!((power / ellipsoid - 1.0).abs() < 1e-13);
        let ggx = evaluate_relative("ggx", 0.3, 2.0, alpha) * alpha.cos();
        let power = evaluate_relative("power", 0.3, 2.0, alpha);
        assert!((power / ggx - 1.0).abs() < 1e-13);
    }
}

proptest! {
    #[test]
    fn derivatives_are_those_of_the_value(
        log_k1 in -3.0..3.0_f64, p in 0.3..8.0_f64, alpha in 0.0..1.5,
    ) {
        let k1 = log_k1.exp();
        for law in LAWS {
            let (h, q) = (1e-5 * k1, 1e-5 * p);
            let at = |k1, p| evaluate_relative(law, k1, p, alpha);
            let [value, by_k1, by_p, _] = evaluate(law, k1, p, alpha);
            let difference = (at(k1 + h, p) - at(k1 - h, p)) / (2.0 * h);
            let scale = (value / k1).max(1.0 / k1).max(by_k1.abs());
            prop_assert!((by_k1 - difference).abs() < 1e-6 * scale, "{law}");
            let difference = (at(k1, p + q) - at(k1, p - q)) / (2.0 * q);
            prop_assert!((by_p - difference).abs() < 1e-6 * (1.0 + by_p.abs()), "{law}");
        }
    }

    #[test]
    fn tilts_are_drawn_with_their_density(
        log_k1 in -9.2..6.9_f64, p in prop_oneof![Just(1.0), 0.1..16.0_f64], u in 1e-6..0.999,
    ) {
        let k1 = log_k1.exp();
        for law in LAWS {
            let below = fraction_between(law, k1, p, [0.0, drawn(law, k1, p, u)]);
            prop_assert!((below / u - 1.0).abs() < 1e-8, "{law}: {below}");
        }
    }

    #[test]
    fn steep_tilts_are_drawn_with_their_density(
        log_k1 in -9.2..6.9_f64, p in prop_oneof![Just(1.0), 0.1..16.0_f64], log_rest in -20.0..-1.0_f64,
    ) {
        let (k1, rest) = (log_k1.exp(), log_rest.exp());
        for law in LAWS {
            let between = [0.25, 0.75].map(|part| drawn(law, k1, p, 1.0 - part * rest));
            let fraction = fraction_between(law, k1, p, [between[1], between[0]]);
            prop_assert!((fraction / (0.5 * rest) - 1.0).abs() < 1e-6, "{law}: {fraction} {rest}");
        }
    }

    #[test]
    fn drawn_tilts_are_finite_and_ascend(
        log_k1 in -18.4..18.4_f64, p in 0.1..16.0_f64, u in 0.0..1.0_f64, step in 1e-6..1e-3,
    ) {
        let k1 = log_k1.exp();
        for law in LAWS {
            let at = |u: f64| drawn(law, k1, p, u.min(1.0 - f64::EPSILON / 2.0));
            prop_assert!(at(0.0) == 0.0 && at(1.0).is_finite(), "{law}: {}", at(1.0));
            prop_assert!(at(u) >= 0.0 && at(u) <= at(u + step), "{law}: {}", at(u));
        }
    }

    #[test]
    fn values_are_finite_and_not_negative(
        log_k1 in -18.0..18.0_f64, p in 0.1..16.0_f64, alpha in 0.0..1.57,
    ) {
        for law in LAWS {
            let [value, by_k1, by_p, peak] = evaluate(law, log_k1.exp(), p, alpha);
            prop_assert!(value >= 0.0 && value.is_finite(), "{law}: {value}");
            prop_assert!(by_k1 >= 0.0 && by_k1.is_finite(), "{law}: {by_k1}");
            prop_assert!(by_p.is_finite(), "{law}: {by_p}");
            prop_assert!(peak > 0.0 && peak.is_finite(), "{law}: {peak}");
        }
    }
}
