//! The error of f_r read from the nearest bin of a MERL table.

use std::f64::consts::PI;
use std::fmt;

use brdf_core::AnyBrdf;
use rayon::prelude::*;

use super::domain::{MAX_ZENITH_DEG, value};
use crate::read::merl::Bins;

/// The number of direction pairs of each kind at which the error of a table is measured.
const SAMPLES: u32 = 1 << 17;

/// The relative error of f_r where a program reads it from the bin in which a direction pair lies,
/// without interpolation, up to 85 deg of incidence and view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LookupError {
    /// The median in red, green and blue, over direction pairs distributed evenly in psi, theta and
    /// phi.
    pub median: [f64; 3],
    /// The maximum in red, green and blue, over these pairs and as many that are distributed evenly
    /// over the axes of the table, because few of the former fall into a narrow lobe.
    pub largest: [f64; 3],
}

impl LookupError {
    /// Measures the error of the tables of three BRDFs: red, green and blue.
    pub(super) fn measured(brdfs: [&AnyBrdf; 3]) -> Self {
        let channels = brdfs.map(|brdf| {
            let by_angles = lookup_errors(brdf, |number| Some(pair_by_angles(number)));
            let by_bins = lookup_errors(brdf, pair_by_bins);
            let largest = by_angles
                .iter()
                .chain(&by_bins)
                .copied()
                .fold(0.0, f64::max);
            (median(by_angles), largest)
        });
        Self {
            median: channels.map(|(median, _)| median),
            largest: channels.map(|(_, largest)| largest),
        }
    }

    /// Whether the maximum error of no colour exceeds a relative tolerance.
    pub(super) fn is_within(&self, tolerance: f64) -> bool {
        self.largest.iter().all(|&error| error <= tolerance)
    }
}

/// The relative errors at the numbered direction pairs. A bin without a value is read as 0; pairs
/// at which f_r is 0 are left out.
fn lookup_errors(brdf: &AnyBrdf, pair: impl Fn(u32) -> Option<[f64; 3]> + Sync) -> Vec<f64> {
    let bins = Bins::STANDARD;
    let error = |number: u32| {
        let at = pair(number)?;
        let exact = value(brdf, at)?;
        let middle = bins.centre(bins.bin_of(at));
        let read = middle.and_then(|middle| value(brdf, middle)).unwrap_or(0.0);
        (exact > 0.0).then(|| (read / exact - 1.0).abs())
    };
    (0..SAMPLES).into_par_iter().filter_map(error).collect()
}

/// The median; 0 where there are no errors, because the surface reflects nothing.
fn median(mut errors: Vec<f64>) -> f64 {
    errors.sort_unstable_by(f64::total_cmp);
    errors.get(errors.len() / 2).copied().unwrap_or(0.0)
}

/// A pair as psi, theta and phi in radians, distributed evenly in these angles.
fn pair_by_angles(number: u32) -> [f64; 3] {
    let limit = MAX_ZENITH_DEG.to_radians();
    let [psi, theta, phi] = quasirandom(number);
    [psi * limit, theta * limit, phi * PI]
}

/// A pair as psi, theta and phi in radians, distributed evenly over the axes of the table; `None`
/// beyond [`MAX_ZENITH_DEG`].
fn pair_by_bins(number: u32) -> Option<[f64; 3]> {
    let at = Bins::angles_at(quasirandom(number))?;
    (at[0].max(at[1]) <= MAX_ZENITH_DEG.to_radians()).then_some(at)
}

/// Quasirandom points of the unit cube: the additive recurrence by powers of the root of x^4 = x +
/// 1 (M. Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018).
fn quasirandom(number: u32) -> [f64; 3] {
    const ROOT: f64 = 1.220_744_084_605_759_5;
    [1, 2, 3].map(|power| (0.5 + f64::from(number) / ROOT.powi(power)).fract())
}

/// The errors in percent, for each colour where the colours differ.
impl fmt::Display for LookupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let of = |i: usize| {
            let percent = |error: f64| format!("{:.2} %", 100.0 * error);
            let (median, largest) = (percent(self.median[i]), percent(self.largest[i]));
            format!("within {median} (median), {largest} (worst)")
        };
        write!(f, "nearest bin up to {MAX_ZENITH_DEG} deg: f_r ")?;
        let [red, green, blue] = [of(0), of(1), of(2)];
        if red == green && green == blue {
            return f.write_str(&red);
        }
        write!(f, "{red} in red, {green} in green, {blue} in blue")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::test_fits::of_paper;

    #[test]
    fn the_error_of_the_nearest_bin_is_small_for_dull_and_large_for_glossy_surfaces() {
        let of = |k2, k1| {
            let fit = of_paper([k2, 0.1, k1, 1.5]);
            LookupError::measured([&fit.brdf; 3])
        };
        let lambertian = of(0.0, 0.3);
        assert_eq!(
            (lambertian.median, lambertian.largest),
            ([0.0; 3], [0.0; 3])
        );
        let (dull, glossy) = (of(0.3, 0.5), of(0.3, 0.01));
        assert!(dull.median[0] > 1e-4 && dull.largest[0] < 0.25, "{dull}");
        assert!(glossy.largest[0] > 1.5 * dull.largest[0], "{glossy}");
    }

    #[test]
    fn every_direction_pair_up_to_the_limit_has_a_bin_above_the_surface() {
        for number in 0..SAMPLES {
            let pairs = [Some(pair_by_angles(number)), pair_by_bins(number)];
            for at in pairs.into_iter().flatten() {
                assert!(at[0].max(at[1]) <= MAX_ZENITH_DEG.to_radians());
                let bin = Bins::STANDARD.bin_of(at);
                assert!(Bins::STANDARD.centre(bin).is_some(), "{at:?}");
            }
        }
    }

    #[test]
    fn the_points_are_distributed_evenly() {
        // Each of 8 x 8 x 8 blocks has the same number of points within 10 %.
        let mut counts = vec![0_u32; 512];
        for number in 0..SAMPLES {
            let block = |part: f64| (0_u32..8).rfind(|&i| f64::from(i) <= 8.0 * part);
            let [a, b, c] = quasirandom(number).map(|part| block(part).unwrap());
            counts[(64 * a + 8 * b + c) as usize] += 1;
        }
        let mean = SAMPLES / 512;
        assert!(
            counts.iter().all(|&n| n.abs_diff(mean) < mean / 10),
            "{counts:?}"
        );
    }

    #[test]
    fn the_colours_are_named_where_their_errors_differ() {
        let grey = LookupError {
            median: [0.012; 3],
            largest: [0.37; 3],
        };
        assert_eq!(
            grey.to_string(),
            "nearest bin up to 85 deg: f_r within 1.20 % (median), 37.00 % (worst)"
        );
        let coloured = LookupError {
            largest: [0.37, 0.2, 0.1],
            ..grey
        };
        assert_eq!(
            coloured.to_string(),
            "nearest bin up to 85 deg: f_r within 1.20 % (median), 37.00 % (worst) in red, within 1.20 % \
             (median), 20.00 % (worst) in green, within 1.20 % (median), 10.00 % (worst) in blue"
        );
    }
}
