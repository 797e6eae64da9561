//! MERL tables; [`read::merl`](crate::read::merl) describes the format.

use std::io::{self, Write};

use brdf_core::AnyBrdf;
use rayon::prelude::*;

use super::domain::value;
use super::error::ExportError;
use super::material::Fitted;
use super::nearest_bin::LookupError;
use crate::read::merl::{Bins, Channel};

/// The entry of a bin without a value.
const NO_VALUE: f64 = -1.0;

/// Writes the fits of red, green and blue as a table of 90 x 90 x 180 bins: f_r at the centre of
/// each bin, -1 where one of its directions is not above the surface. Returns the error of the
/// table.
///
/// # Errors
///
/// The error of the table exceeds the tolerance, and nothing is written; writing fails.
pub(super) fn write(
    fits: [&Fitted; 3],
    tolerance: Option<f64>,
    writer: &mut dyn Write,
) -> Result<LookupError, ExportError> {
    let found = LookupError::measured(fits.map(|fit| &fit.brdf));
    match tolerance {
        Some(tolerance) if !found.is_within(tolerance) => {
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

/// The bytes of the bins of one channel with the same `theta_h`.
fn slab(bins: Bins, i: usize, channel: Channel, brdf: &AnyBrdf) -> Vec<u8> {
    let cells = (0..bins.theta_d).flat_map(|j| (0..bins.phi_d).map(move |k| [i, j, k]));
    let number = |bin| value(brdf, bins.centre(bin)?).map(|f| f / channel.scale());
    cells
        .flat_map(|bin| number(bin).unwrap_or(NO_VALUE).to_le_bytes())
        .collect()
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use brdf_core::{Family, ModelParameters};

    use super::*;
    use crate::export::test_fits::fitted;
    use crate::read::merl::Table;

    fn coloured() -> [Fitted; 3] {
        [
            (Family::Paper, [0.6, 0.05, 0.09, 1.5, 1.0]),
            (Family::Ggx, [0.6, 0.12, 0.15, 1.6, 1.0]),
            (Family::Power, [0.5, 0.35, 0.3, 1.4, 2.0]),
        ]
        .map(|(family, [k2, kd, k1, n, p])| fitted(family, ModelParameters { k2, kd, k1, n, p }))
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
            // Every bin above the surface has a value, and no other bin.
            let above = (0..Bins::STANDARD.count())
                .filter(|bin| above(*bin))
                .count();
            assert_eq!(scan.readings().len(), above);
            assert_eq!(scan.conversions.len(), 1, "{:?}", scan.conversions);
            for r in scan.readings() {
                let exact = value(&fit.brdf, [r.psi, r.theta, r.phi]).unwrap();
                // Writing divides by the factor of the channel, reading multiplies with it.
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
    fn a_tolerance_that_the_bins_exceed_is_an_error_and_nothing_is_written() {
        let fits = coloured();
        let found = LookupError::measured(fits.each_ref().map(|fit| &fit.brdf));
        let worst = found.largest.into_iter().fold(0.0, f64::max);
        let mut bytes = Vec::new();
        let error = write(fits.each_ref(), Some(0.99 * worst), &mut bytes).unwrap_err();
        let message = error.to_string();
        assert!(
            message.starts_with("the maximum error of a MERL table exceeds the tolerance "),
            "{message}"
        );
        assert!(message.contains(&format!("({found})")), "{message}");
        assert!(
            message.ends_with(": expected no tolerance, or another format"),
            "{message}"
        );
        assert!(bytes.is_empty());
        assert_eq!(
            write(fits.each_ref(), Some(worst), &mut bytes).unwrap(),
            found
        );
    }
}
