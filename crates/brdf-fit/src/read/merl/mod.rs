//! MERL tables: isotropic BRDFs of three channels over a grid of half and difference angles.
//!
//! The binary layout is that of Matusik, Pfister, Brand and McMillan, "A Data-Driven Reflectance Model"
//! (ACM Trans. Graph. 22(3), 2003), as the reference code of their database reads it: three 32-bit
//! integers, the numbers of bins of `theta_h`, `theta_d` and `phi_d` (90, 90 and 180), and then the
//! channels red, green and blue, each a 64-bit floating-point number for each bin, with `phi_d` varying
//! fastest. All numbers are little-endian. With x the position within a bin, from 0 to 1, bin (i, j, k)
//! of (I, J, K) is at
//!
//! ```text
//! theta_h = 90 deg ((i + x) / I)^2        tilt of the half vector: alpha
//! theta_d = 90 deg (j + x) / J            angle between source and half vector: gamma
//! phi_d   = 180 deg (k + x) / K           azimuth of the source about the half vector
//! ```
//!
//! (Rusinkiewicz, EGWR 1998; the other half of `phi_d` is the same by reciprocity). The value of a bin
//! is read as that at its centre, x = 1/2. f_r in 1/sr, without a cosine factor, is
//!
//! ```text
//! f_r = value * scale,   scale = 1/1500 (red), 1.15/1500 (green), 1.66/1500 (blue)
//! ```
//!
//! A negative value marks a bin that was not measured, or that lies below the horizon.
//!
//! The format states no wavelengths. The channels are assigned the dominant wavelengths of the sRGB
//! primaries: 0.611, 0.549 and 0.464 um. Exports recognise the channels by them.

mod bins;
mod channels;
mod header;
mod table;

use std::io::{Cursor, Read, Seek};

use super::error::ReadError;
use super::options::ReadOptions;
use super::reader::{Content, Reader};
use crate::scan::{Format, Measurements};
pub use bins::Bins;
pub(super) use bins::from_half_and_difference;
pub use channels::Channel;
pub(super) use header::{begins_table, is_table};
pub use table::Table;

pub(super) const READER: Reader = Reader {
    format: Format::Merl,
    extensions: &["binary"],
    recognises: |bytes| is_table(bytes, bytes.len() as u64),
    content: Content::Bytes(|path, bytes, options| {
        let name = path.display().to_string();
        read(Table::new(Cursor::new(bytes), &name)?, options)
    }),
};

/// The channels of a table one after the other, in ascending order of wavelength, each with as many
/// readings as the options keep.
///
/// # Errors
///
/// The options set an angular convention.
pub(super) fn channels(
    mut table: Table<impl Read + Seek>,
    options: &ReadOptions,
) -> Result<impl Iterator<Item = Result<Measurements, ReadError>>, ReadError> {
    table.check_options(options)?;
    let sample = options.sample;
    Ok(Channel::ALL.into_iter().rev().map(move |channel| {
        let all = table.channel(channel)?;
        Ok(match sample {
            Some(count) => all.sampled(count),
            None => all,
        })
    }))
}

/// The readings of all channels in one scan.
///
/// # Errors
///
/// The options set an angular convention, or a channel cannot be read.
pub(super) fn read(
    table: Table<impl Read + Seek>,
    options: &ReadOptions,
) -> Result<Measurements, ReadError> {
    let mut together = Measurements::default();
    for channel in channels(table, options)? {
        let channel = channel?;
        let mut readings = std::mem::take(&mut together.readings);
        let mut conversions = std::mem::take(&mut together.conversions);
        readings.extend_from_slice(&channel.readings);
        conversions.extend_from_slice(&channel.conversions);
        together = Measurements {
            conversions,
            readings,
            ..channel
        };
    }
    Ok(together)
}
