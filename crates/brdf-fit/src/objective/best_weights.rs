//! The best weights k2 and kD at given other parameters, in closed form.

use super::evaluation::ProfileSums;

/// The best k2, kD and their E for normalised readings, where some weights are fixed: the free part
/// describes the readings less the fixed part.
pub(crate) fn solve_for(fixed: [Option<f64>; 2], sums: &ProfileSums) -> (f64, f64, f64) {
    let &ProfileSums { uu, ua, uy, aa, ay } = sums;
    match fixed {
        [None, None] => solve(sums),
        [Some(k2), None] => {
            let left = ay - k2 * ua;
            let kd = alone(left, aa);
            (k2, kd, 1.0 - 2.0 * k2 * uy + k2 * k2 * uu - kd * left)
        }
        [None, Some(kd)] => {
            let left = uy - kd * ua;
            let k2 = alone(left, uu);
            (k2, kd, 1.0 - 2.0 * kd * ay + kd * kd * aa - k2 * left)
        }
        [Some(k2), Some(kd)] => {
            let squares = k2 * k2 * uu + 2.0 * k2 * kd * ua + kd * kd * aa;
            (k2, kd, 1.0 - 2.0 * (k2 * uy + kd * ay) + squares)
        }
    }
}

/// How much the readings ask for a lobe where there is none: the scalar product of what the best diffuse part
/// leaves of them and the unit column of the lobe, less its diffuse part where kD adapts. A lobe lowers E
/// where this is positive, and a faint one by its square.
pub(crate) fn demand_for_lobe(fixed_kd: Option<f64>, sums: &ProfileSums) -> f64 {
    let &ProfileSums { uu, ua, uy, aa, ay } = sums;
    let kd = fixed_kd.unwrap_or_else(|| alone(ay, aa));
    let adapts = fixed_kd.is_none() && kd > 0.0;
    let rest = if adapts { uu - ua * ua / aa } else { uu };
    if rest > 1e-14 * uu {
        (uy - kd * ua) / rest.sqrt()
    } else {
        f64::NEG_INFINITY
    }
}

/// The best weight of one part alone.
fn alone(measured: f64, squared: f64) -> f64 {
    if squared > 0.0 {
        (measured / squared).max(0.0)
    } else {
        0.0
    }
}

/// The best k2, kD and their E.
///
/// Either both weights are positive and satisfy the normal equations, or one is zero and the other
/// is the best weight of its part alone.
pub(crate) fn solve(sums: &ProfileSums) -> (f64, f64, f64) {
    let &ProfileSums { uu, ua, uy, aa, ay } = sums;
    let determinant = uu * aa - ua * ua;
    // If the parts are collinear within rounding, one of them alone reaches the minimum.
    if determinant > 1e-14 * uu * aa {
        let k2 = (uy * aa - ay * ua) / determinant;
        let kd = (ay * uu - uy * ua) / determinant;
        if k2 >= 0.0 && kd >= 0.0 {
            return (k2, kd, 1.0 - k2 * uy - kd * ay);
        }
    }
    let (specular, diffuse) = (alone(uy, uu), alone(ay, aa));
    if specular * uy > diffuse * ay {
        (specular, 0.0, 1.0 - specular * uy)
    } else {
        (0.0, diffuse, 1.0 - diffuse * ay)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The products of three columns of a few rows: u and a are positive, y has any sign and unit length.
    fn sums(u: &[f64], a: &[f64], y: &[f64]) -> ProfileSums {
        let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
        let length = dot(y, y).sqrt();
        ProfileSums {
            uu: dot(u, u),
            ua: dot(u, a),
            uy: dot(u, y) / length,
            aa: dot(a, a),
            ay: dot(a, y) / length,
        }
    }

    proptest! {
        #[test]
        fn a_lobe_is_part_of_the_best_fit_where_there_is_a_demand_for_it(
            u in prop::array::uniform5(0.01..1.0_f64),
            a in prop::array::uniform5(0.01..1.0_f64),
            y in prop::array::uniform5(-1.0..1.0_f64),
            kd in 0.0..2.0_f64,
        ) {
            let sums = sums(&u, &a, &y);
            for fixed_kd in [None, Some(0.0), Some(kd)] {
                let demand = demand_for_lobe(fixed_kd, &sums);
                let (k2, ..) = solve_for([None, fixed_kd], &sums);
                prop_assert!((k2 > 0.0) == (demand > 0.0) || demand.abs() < 1e-12);
            }
        }

        #[test]
        fn a_lobe_explains_the_square_of_its_demand(
            u in prop::array::uniform5(0.01..1.0_f64),
            a in prop::array::uniform5(0.01..1.0_f64),
            k2 in 0.0..1.0_f64,
            kd in 0.1..1.0_f64,
        ) {
            let y: [f64; 5] = std::array::from_fn(|i| k2 * u[i] + kd * a[i]);
            let sums = sums(&u, &a, &y);
            let (_, _, error) = solve_for([None, None], &sums);
            let (_, _, plain) = solve_for([Some(0.0), None], &sums);
            prop_assert!((plain - error - demand_for_lobe(None, &sums).powi(2)).abs() < 1e-9);
        }
    }
}
