//! MERL tables, as [`read::merl`](crate::read::merl) describes them.

use std::io::{self, Write};

use brdf_core::{AnyBrdf, Geometry};
use rayon::prelude::*;

use super::coating::Fitted;
use crate::read::merl::{Bins, Channel};

/// The number of a bin that holds no value.
const NO_VALUE: f64 = -1.0;

/// Writes the fits of red, green and blue as a table of 90 x 90 x 180 bins: f_r in the middle of
/// each bin, -1 where one of its directions is not above the surface.
pub(super) fn write(fits: [&Fitted; 3], writer: &mut dyn Write) -> io::Result<()> {
    let bins = Bins::USUAL;
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
    let value = |bin: [usize; 3]| {
        let [psi, theta, phi] = bins.middle(bin)?;
        let geometry = Geometry::new(psi, theta, phi).ok()?;
        Some(brdf.value(&geometry) / channel.scale())
    };
    cells
        .flat_map(|bin| value(bin).unwrap_or(NO_VALUE).to_le_bytes())
        .collect()
}
