//! MERL tables, as [`read::merl`](crate::read::merl) describes them.

use std::f64::consts::PI;
use std::fmt;
use std::io::{self, Write};

use brdf_core::{AnyBrdf, Geometry};
use rayon::prelude::*;

use super::domain::LIMIT_DEG;
use super::material::Fitted;
use super::target::ExportError;
use crate::read::merl::{Bins, Channel};

/// The number of a bin that holds no value.
const NO_VALUE: f64 = -1.0;

/// Direction pairs of each kind at which the error of a table is measured.
const LOOKUPS: u32 = 1 << 17;

/// The relative error of f_r where a program takes that of the bin that its directions lie in, up to
/// 85 deg of incidence and view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LookupError {
    /// The median in red, green and blue, over direction pairs that are even in psi, theta and phi.
    pub median: [f64; 3],
    /// The largest in red, green and blue, at those and at as many that are even over the table: few
    /// of the former meet a narrow lobe.
    pub largest: [f64; 3],
}

/// Writes the fits of red, green and blue as a table of 90 x 90 x 180 bins: f_r in the middle of
/// each bin, -1 where one of its directions is not above the surface.
///
/// Errors: a tolerance is given, and the bins do not keep to it.
pub(super) fn write(
    fits: [&Fitted; 3],
    tolerance: Option<f64>,
    writer: &mut dyn Write,
) -> Result<LookupError, ExportError> {
    let found = LookupError::of(fits.map(|fit| &fit.brdf));
    match tolerance {
        Some(tolerance) if !found.keeps_to(tolerance) => {
            return Err(ExportError::Bins { tolerance, found });
        }
        _ => write_table(fits, writer)?,
    }
    Ok(found)
}

fn write_table(fits: [&Fitted; 3], writer: &mut dyn Write) -> io::Result<()> {
    let bins = Bins::STANDARD;
    for count in [bins.theta_h, bins.theta_d, bins.phi_d] {
        let count = i32::try_from(count).map_err(io::Error::other)?;
        writer.write_all(&count.to_le_bytes())?;
    }
    for (channel, fit) in Channel::ALL.into_iter().zip(fits) {
        let slabs: Vec<Vec<u8>> = (0..bins.theta_h)
            .into_par_iter()
            .map(|i| slab(bins, i, channel, &fit.brdf))
            .collect();
        for slab in slabs {
            writer.write_all(&slab)?;
        }
    }
    Ok(())
}

/// The bytes of the bins of one `theta_h`.
fn slab(bins: Bins, i: usize, channel: Channel, brdf: &AnyBrdf) -> Vec<u8> {
    let cells = (0..bins.theta_d).flat_map(|j| (0..bins.phi_d).map(move |k| [i, j, k]));
    let number = |bin| value(brdf, bins.centre(bin)?).map(|f| f / channel.scale());
    cells
        .flat_map(|bin| number(bin).unwrap_or(NO_VALUE).to_le_bytes())
        .collect()
}

/// f_r; `None` outside the domain.
fn value(brdf: &AnyBrdf, [psi, theta, phi]: [f64; 3]) -> Option<f64> {
    let geometry = Geometry::new(psi, theta, phi).ok()?;
    Some(brdf.value(&geometry))
}

impl LookupError {
    fn of(brdfs: [&AnyBrdf; 3]) -> Self {
        let channels = brdfs.map(|brdf| {
            let even = lookup_errors(brdf, |number| Some(direction_pair(number)));
            let of_table = lookup_errors(brdf, table_pair);
            let largest = even.iter().chain(&of_table).copied().fold(0.0, f64::max);
            (median(even), largest)
        });
        Self {
            median: channels.map(|(median, _)| median),
            largest: channels.map(|(_, largest)| largest),
        }
    }

    fn keeps_to(&self, tolerance: f64) -> bool {
        self.largest.iter().all(|&error| error <= tolerance)
    }
}

/// The errors at direction pairs. A bin without a value is read as 0.
fn lookup_errors(brdf: &AnyBrdf, pair: impl Fn(u32) -> Option<[f64; 3]> + Sync) -> Vec<f64> {
    let bins = Bins::STANDARD;
    let error = |number: u32| {
        let at = pair(number)?;
        let exact = value(brdf, at)?;
        let middle = bins.centre(bins.bin_of(at));
        let read = middle.and_then(|middle| value(brdf, middle)).unwrap_or(0.0);
        (exact > 0.0).then(|| (read / exact - 1.0).abs())
    };
    (0..LOOKUPS).into_par_iter().filter_map(error).collect()
}

/// The middle one; 0 where a surface reflects nothing, of which nothing is read wrong.
fn median(mut errors: Vec<f64>) -> f64 {
    errors.sort_unstable_by(f64::total_cmp);
    errors.get(errors.len() / 2).copied().unwrap_or(0.0)
}

/// psi, theta and phi in radians, even up to the limit.
fn direction_pair(number: u32) -> [f64; 3] {
    let limit = LIMIT_DEG.to_radians();
    let [psi, theta, phi] = even(number);
    [psi * limit, theta * limit, phi * PI]
}

/// Psi, theta and phi in radians, even over the table; `None` beyond the limit.
fn table_pair(number: u32) -> Option<[f64; 3]> {
    let at = Bins::angles_at(even(number))?;
    (at[0].max(at[1]) <= LIMIT_DEG.to_radians()).then_some(at)
}

/// Points of the unit cube: the additive recurrence of the powers of the root of x^4 = x + 1
/// (M. Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018).
fn even(number: u32) -> [f64; 3] {
    const ROOT: f64 = 1.220_744_084_605_759_5;
    [1, 2, 3].map(|power| (0.5 + f64::from(number) / ROOT.powi(power)).fract())
}

/// In percent, and by colour where the colours differ.
impl fmt::Display for LookupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let of = |i: usize| {
            let percent = |error: f64| format!("{:.2} %", 100.0 * error);
            let (median, largest) = (percent(self.median[i]), percent(self.largest[i]));
            format!("within {median} (median), {largest} (worst)")
        };
        write!(f, "nearest bin up to {LIMIT_DEG} deg: f_r ")?;
        let [red, green, blue] = [of(0), of(1), of(2)];
        if red == green && green == blue {
            return f.write_str(&red);
        }
        write!(f, "{red} in red, {green} in green, {blue} in blue")
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use brdf_core::{Family, ModelParameters};

    use super::*;
    use crate::read::merl::Table;

    fn fitted(family: Family, [k2, kd, k1, n, p]: [f64; 5]) -> Fitted {
        Fitted {
            file: "scan.csv".to_owned(),
            wavelength_um: None,
            brdf: AnyBrdf::new(family, &ModelParameters { k2, kd, k1, n, p }).unwrap(),
            e_percent: 1.0,
            psi_max_deg: 70.0,
        }
    }

    fn coloured() -> [Fitted; 3] {
        [
            fitted(Family::Paper, [0.6, 0.05, 0.09, 1.5, 1.0]),
            fitted(Family::Ggx, [0.6, 0.12, 0.15, 1.6, 1.0]),
            fitted(Family::Power, [0.5, 0.35, 0.3, 1.4, 2.0]),
        ]
    }

    fn written(fits: &[Fitted; 3]) -> (Vec<u8>, LookupError) {
        let mut bytes = Vec::new();
        let found = write(fits.each_ref(), None, &mut bytes).unwrap();
        (bytes, found)
    }

    #[test]
    fn what_is_written_is_read_again() {
        let fits = coloured();
        let (bytes, _) = written(&fits);
        assert_eq!(bytes.len(), 12 + 3 * 8 * 90 * 90 * 180);
        let mut table = Table::new(Cursor::new(bytes), "x").unwrap();
        for (channel, fit) in Channel::ALL.into_iter().zip(&fits) {
            let scan = table.channel(channel).unwrap();
            // Every bin above the surface, and no other has a value.
            let above = (0..Bins::STANDARD.count())
                .filter(|bin| above(*bin))
                .count();
            assert_eq!(scan.readings().len(), above);
            assert_eq!(scan.conversions.len(), 1, "{:?}", scan.conversions);
            for r in scan.readings() {
                let exact = value(&fit.brdf, [r.psi, r.theta, r.phi]).unwrap();
                // The channel's factor is divided by and multiplied with.
                let rounding = 2.0 * f64::EPSILON * exact;
                assert!((r.brdf - exact).abs() <= rounding, "{} {exact}", r.brdf);
            }
        }
    }

    fn above(bin: usize) -> bool {
        let (i, j, k) = (bin / 16200, bin / 180 % 90, bin % 180);
        Bins::STANDARD.centre([i, j, k]).is_some()
    }

    #[test]
    fn bins_below_the_horizon_are_minus_one() {
        let (bytes, _) = written(&coloured());
        let numbers = bytes[12..].as_chunks::<8>().0;
        for (bin, number) in numbers.iter().enumerate() {
            let number = f64::from_le_bytes(*number);
            if above(bin % Bins::STANDARD.count()) {
                assert!(number > 0.0, "{bin}: {number}");
            } else {
                assert_eq!(number, -1.0, "{bin}");
            }
        }
    }

    #[test]
    fn the_error_of_the_nearest_bin_is_small_for_the_dull_and_large_for_the_glossy() {
        let of = |k2, k1| {
            let fit = fitted(Family::Paper, [k2, 0.1, k1, 1.5, 1.0]);
            LookupError::of([&fit.brdf; 3])
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
    fn every_direction_up_to_the_limit_has_a_bin_above_the_surface() {
        for number in 0..LOOKUPS {
            let pairs = [Some(direction_pair(number)), table_pair(number)];
            for at in pairs.into_iter().flatten() {
                assert!(at[0].max(at[1]) <= LIMIT_DEG.to_radians());
                let bin = Bins::STANDARD.bin_of(at);
                assert!(Bins::STANDARD.centre(bin).is_some(), "{at:?}");
            }
        }
    }

    #[test]
    fn the_points_are_even() {
        // As many in each of 8 x 8 x 8 blocks, within a few.
        let mut counts = vec![0_u32; 512];
        for number in 0..LOOKUPS {
            let block = |part: f64| (0_u32..8).rfind(|&i| f64::from(i) <= 8.0 * part);
            let [a, b, c] = even(number).map(|part| block(part).unwrap());
            counts[(64 * a + 8 * b + c) as usize] += 1;
        }
        let mean = LOOKUPS / 512;
        assert!(
            counts.iter().all(|&n| n.abs_diff(mean) < mean / 10),
            "{counts:?}"
        );
    }

    #[test]
    fn a_tolerance_that_the_bins_do_not_keep_to_is_an_error_and_nothing_is_written() {
        let fits = coloured();
        let found = LookupError::of(fits.each_ref().map(|fit| &fit.brdf));
        let worst = found.largest.into_iter().fold(0.0, f64::max);
        let mut bytes = Vec::new();
        let error = write(fits.each_ref(), Some(0.99 * worst), &mut bytes).unwrap_err();
        let said = error.to_string();
        assert!(
            said.contains("the bins of a MERL table, nearest bin up to 85 deg"),
            "{said}"
        );
        assert!(
            said.ends_with("expected no --tolerance, or another format"),
            "{said}"
        );
        assert!(bytes.is_empty());
        assert_eq!(
            write(fits.each_ref(), Some(worst), &mut bytes).unwrap(),
            found
        );
    }

    #[test]
    fn the_words_name_the_colours_where_they_differ() {
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
