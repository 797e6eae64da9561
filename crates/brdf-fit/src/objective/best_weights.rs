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
