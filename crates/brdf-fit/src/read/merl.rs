//! MERL tables: isotropic BRDFs of three channels over a grid of half and difference angles.
//!
//! The binary layout of Matusik, Pfister, Brand and McMillan, "A Data-Driven Reflectance Model"
//! (ACM Trans. Graph. 22(3), 2003), as the reference code of its database reads it: three 32-bit
//! integers, the numbers of bins of `theta_h`, `theta_d` and `phi_d` (90, 90 and 180), then the
//! channels red, green and blue one after the other, each a 64-bit floating point number for each
//! bin, `phi_d` running fastest. All little-endian. With x the position in a bin, from 0 to 1, bin
//! (i, j, k) of (I, J, K) is at
//!
//! ```text
//! theta_h = 90 deg ((i + x) / I)^2        tilt of the half vector: alpha
//! theta_d = 90 deg (j + x) / J            angle between source and half vector: gamma
//! phi_d   = 180 deg (k + x) / K           azimuth of the source about the half vector
//! ```
//!
//! (Rusinkiewicz, EGWR 1998; the other half of `phi_d` is the same by reciprocity). A bin's value is
//! taken for its middle, x = 1/2. f_r in 1/sr, not multiplied by a cosine, is the number times
//! 1/1500, 1.15/1500 and 1.66/1500 in red, green and blue. A negative number is a bin that was not
//! measured, or that lies below the horizon.
//!
//! The format states no wavelengths. The channels are given the dominant wavelengths of the sRGB
//! primaries, by which exports know them again.

use std::f64::consts::{FRAC_PI_2, PI};
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::Path;

use nalgebra::Vector3;
use rayon::prelude::*;

use super::detect::HEAD;
use super::{ReadError, ReadOptions, text};
use crate::format::counted;
use crate::scan::{Convention, Format};
use crate::scan::{Measurement, Measurements};

/// Bytes of the three numbers of bins.
const HEADER: usize = 12;

/// Bytes of a value.
const VALUE: usize = 8;

/// More bins in a channel, of which the database has 1.5 million, are no table: a file without
/// content can be of any size, and their readings would take more than 1 GB.
const MOST_BINS: usize = 1 << 24;

/// Slabs of one `theta_h` that are converted together.
const SLABS: usize = 8;

/// The width of the classes of incidence angles, in radians: the table has no incidences.
const INCIDENCE_CLASS: f64 = 5.0 * PI / 180.0;

/// A channel of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channel {
    /// The first.
    Red,
    /// The second.
    Green,
    /// The third.
    Blue,
}

impl Channel {
    /// All channels, in the order of the file.
    pub const ALL: [Self; 3] = [Self::Red, Self::Green, Self::Blue];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Red => "red",
            Self::Green => "green",
            Self::Blue => "blue",
        }
    }

    /// The wavelength that stands for it, in micrometres: the dominant one of the primary of sRGB
    /// (IEC 61966-2-1) against its white.
    pub const fn wavelength_um(self) -> f64 {
        match self {
            Self::Red => 0.611,
            Self::Green => 0.549,
            Self::Blue => 0.464,
        }
    }

    /// f_r in 1/sr of the number 1.
    pub fn scale(self) -> f64 {
        match self {
            Self::Red => 1.0 / 1500.0,
            Self::Green => 1.15 / 1500.0,
            Self::Blue => 1.66 / 1500.0,
        }
    }
}

/// The numbers of bins of `theta_h`, `theta_d` and `phi_d`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bins {
    /// Bins of `theta_h`.
    pub theta_h: usize,
    /// Bins of `theta_d`.
    pub theta_d: usize,
    /// Bins of `phi_d`.
    pub phi_d: usize,
}

impl Bins {
    /// Those of the database.
    pub const STANDARD: Self = Self {
        theta_h: 90,
        theta_d: 90,
        phi_d: 180,
    };

    fn of_numbers(numbers: [i32; 3]) -> Option<Self> {
        let [theta_h, theta_d, phi_d] = numbers.map(|n| usize::try_from(n).unwrap_or(0));
        let bins = Self {
            theta_h,
            theta_d,
            phi_d,
        };
        bins.size()
            .is_some_and(|size| size > HEADER as u64)
            .then_some(bins)
    }

    /// Bytes of the whole file; `None` beyond what numbers can say.
    fn size(self) -> Option<u64> {
        let slab = self.theta_d.checked_mul(self.phi_d)?;
        let values = self.theta_h.checked_mul(slab)?.checked_mul(3 * VALUE)?;
        u64::try_from(values.checked_add(HEADER)?).ok()
    }

    fn per_slab(self) -> usize {
        self.theta_d * self.phi_d
    }

    /// Bins of a channel.
    pub fn count(self) -> usize {
        self.theta_h * self.per_slab()
    }

    /// The bin that a direction pair lies in, by psi, theta and phi in radians.
    ///
    /// tan `theta_d` = |source - view| / |source + view|, and `phi_d` is the azimuth of the source
    /// about the half vector h, from the direction in which h is tilted.
    pub fn bin_of(self, [psi, theta, phi]: [f64; 3]) -> [usize; 3] {
        let source = Vector3::new(psi.sin(), 0.0, psi.cos());
        let view = Vector3::new(
            theta.sin() * phi.cos(),
            theta.sin() * phi.sin(),
            theta.cos(),
        );
        let (sum, difference) = (source + view, source - view);
        let across = sum.x.hypot(sum.y);
        let theta_h = across.atan2(sum.z);
        let theta_d = difference.norm().atan2(sum.norm());
        // Where h is the normal, any direction is that of its tilt.
        let tilt = if across > 0.0 {
            [sum.x / across, sum.y / across]
        } else {
            [1.0, 0.0]
        };
        let (sin_h, cos_h) = theta_h.sin_cos();
        let along = (source.x * tilt[0] + source.y * tilt[1]) * cos_h - source.z * sin_h;
        let around = source.y * tilt[0] - source.x * tilt[1];
        let phi_d = around.atan2(along).rem_euclid(PI);
        [
            place((theta_h / FRAC_PI_2).sqrt(), self.theta_h),
            place(theta_d / FRAC_PI_2, self.theta_d),
            place(phi_d / PI, self.phi_d),
        ]
    }

    /// The direction pair in the middle of a bin as psi, theta and phi in radians; `None` where one
    /// of them is not above the surface.
    pub fn centre(self, [i, j, k]: [usize; 3]) -> Option<[f64; 3]> {
        Self::angles_at([
            middle_of(i, self.theta_h),
            middle_of(j, self.theta_d),
            middle_of(k, self.phi_d),
        ])
    }

    /// The same at a place of the table, from 0 to 1 along each of its axes.
    pub(crate) fn angles_at([root_h, part_d, part_phi]: [f64; 3]) -> Option<[f64; 3]> {
        Self::pair(half(root_h), difference(part_d), azimuth(part_phi))
    }

    /// The same by sine and cosine of `theta_h`, `theta_d` and `phi_d`.
    ///
    /// With h = (sin `theta_h`, 0, cos `theta_h`), the source is the direction (`theta_d`, `phi_d`)
    /// turned from the normal to h, and the view its mirror image about h.
    fn pair(
        (sin_h, cos_h): (f64, f64),
        (sin_d, cos_d): (f64, f64),
        (sin_phi, cos_phi): (f64, f64),
    ) -> Option<[f64; 3]> {
        let along = sin_d * cos_phi;
        let source = [
            along * cos_h + cos_d * sin_h,
            sin_d * sin_phi,
            cos_d * cos_h - along * sin_h,
        ];
        let view = [
            2.0 * cos_d * sin_h - source[0],
            -source[1],
            2.0 * cos_d * cos_h - source[2],
        ];
        (source[2] > 0.0 && view[2] > 0.0).then(|| {
            let zenith = |[x, y, z]: [f64; 3]| (x * x + y * y).sqrt().atan2(z);
            let cross = source[0] * view[1] - source[1] * view[0];
            let dot = source[0] * view[0] + source[1] * view[1];
            [zenith(source), zenith(view), cross.atan2(dot)]
        })
    }
}

/// The channels of a table one after the other, in ascending order of wavelength, of each as many
/// readings as are wanted.
///
/// Errors: options that choose sides.
pub(super) fn channels(
    mut table: Table<impl Read + Seek>,
    options: &ReadOptions,
) -> Result<impl Iterator<Item = Result<Measurements, ReadError>>, ReadError> {
    table.check(options)?;
    let sample = options.sample;
    Ok(Channel::ALL.into_iter().rev().map(move |channel| {
        let all = table.channel(channel)?;
        Ok(match sample {
            Some(count) => all.sampled(count),
            None => all,
        })
    }))
}

/// The readings of all channels together.
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

/// The middle of a bin, from 0 to 1 along its axis.
fn middle_of(index: usize, bins: usize) -> f64 {
    (index as f64 + 0.5) / bins as f64
}

/// Sine and cosine of `theta_h` at a place along its axis.
fn half(root: f64) -> (f64, f64) {
    (FRAC_PI_2 * root * root).sin_cos()
}

/// Sine and cosine of `theta_d` at a place along its axis.
fn difference(part: f64) -> (f64, f64) {
    (FRAC_PI_2 * part).sin_cos()
}

/// Sine and cosine of `phi_d` at a place along its axis.
fn azimuth(part: f64) -> (f64, f64) {
    (PI * part).sin_cos()
}

/// The bin of a position from 0 to 1.
fn place(position: f64, bins: usize) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a position is not negative, and there are few bins"
    )]
    let bin = (position * bins as f64) as usize;
    bin.min(bins - 1)
}

/// Whether a file is read as a table, a channel at a time: because the options say so, or its
/// content, or its name. What is no file but a pipe is not: what is looked at of it is gone.
pub(super) fn is_table(path: &Path, options: &ReadOptions) -> bool {
    let is_file = path.metadata().is_ok_and(|metadata| metadata.is_file());
    is_file
        && match options.format {
            Some(format) => format == Format::Merl,
            None => begins_as_table(path).unwrap_or(false),
        }
}

fn begins_as_table(path: &Path) -> io::Result<bool> {
    let file = File::open(path)?;
    let size = file.metadata()?.len();
    let mut head = Vec::new();
    file.take(HEAD).read_to_end(&mut head)?;
    Ok(recognises(&head, size) || Format::detect(&head, path) == Some(Format::Merl))
}

/// Whether the beginning of a file and its size are those of a table, in either order of bytes.
pub(super) fn recognises(start: &[u8], size: u64) -> bool {
    let Some(header) = start.first_chunk() else {
        return false;
    };
    let fits = |numbers| Bins::of_numbers(numbers).and_then(Bins::size) == Some(size);
    fits(numbers(header, i32::from_le_bytes)) || fits(numbers(header, i32::from_be_bytes))
}

fn numbers(header: &[u8; HEADER], of: fn([u8; 4]) -> i32) -> [i32; 3] {
    let (words, _) = header.as_chunks::<4>();
    std::array::from_fn(|i| of(words[i]))
}

/// A table whose header and size have been checked. Its channels are read one at a time: all three
/// are 1.1 million readings each.
#[derive(Debug)]
pub struct Table<R> {
    name: String,
    reader: R,
    bins: Bins,
}

impl Table<File> {
    /// Opens a file.
    ///
    /// Errors: what does not begin with the numbers of bins of a file of this size.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        let path = path.as_ref();
        let file = File::open(path).map_err(|error| ReadError::Io {
            path: path.to_owned(),
            error,
        })?;
        Self::new(file, &path.display().to_string())
    }
}

impl<R: Read + Seek> Table<R> {
    /// The table in what a reader gives; `name` stands for the file in errors and reports.
    ///
    /// Errors: what does not begin with the numbers of bins of as many bytes.
    pub fn new(mut reader: R, name: &str) -> Result<Self, ReadError> {
        let mut header = [0; HEADER];
        let size = reader
            .seek(SeekFrom::End(0))
            .and_then(|size| {
                reader.rewind()?;
                Ok(size)
            })
            .map_err(|error| io_error(name, error))?;
        if size < HEADER as u64 {
            let message = format!(
                "has {}: expected a MERL table, which begins with three numbers of bins in 12 bytes",
                counted(usize::try_from(size).unwrap_or(usize::MAX), "byte")
            );
            return Err(file_error(name, message));
        }
        reader
            .read_exact(&mut header)
            .map_err(|error| io_error(name, error))?;
        let bins = checked_bins(&header, size).map_err(|message| file_error(name, message))?;
        let name = name.to_owned();
        Ok(Self { name, reader, bins })
    }

    /// Checks that no option chooses sides.
    pub(super) fn check(&self, options: &ReadOptions) -> Result<(), ReadError> {
        let why = "a MERL table has angles about the half vector";
        options
            .fixed(Path::new(&self.name), Convention::default(), why)
            .map(|_| ())
    }

    /// The readings of a channel: the bins that were measured, with both directions above the
    /// surface, in the order of the file.
    ///
    /// Errors: a value that is no finite number; a channel without a measured bin.
    pub fn channel(&mut self, channel: Channel) -> Result<Measurements, ReadError> {
        let bins = self.bins;
        let mut readings = Vec::new();
        let (mut not_measured, mut below) = (0, 0);
        for first in (0..bins.theta_h).step_by(SLABS) {
            let together = first..(first + SLABS).min(bins.theta_h);
            let values = self.values(channel, together.clone())?;
            let converted: Vec<Slab> = values
                .par_chunks_exact(VALUE * bins.per_slab())
                .zip(together)
                .map(|(values, i)| Slab::of(bins, channel, i, values))
                .collect::<Result<_, _>>()
                .map_err(|message| file_error(&self.name, message))?;
            for slab in converted {
                readings.extend(slab.readings);
                not_measured += slab.not_measured;
                below += slab.below;
            }
        }
        if readings.is_empty() {
            return Err(file_error(&self.name, nothing_measured(channel)));
        }
        let mut conversions = vec![conversion(channel)];
        conversions.extend(left_out(not_measured, below));
        Ok(Measurements {
            source: self.name.clone(),
            format: Format::Merl,
            conversions,
            incidence_class: Some(INCIDENCE_CLASS),
            readings,
            ..Measurements::default()
        })
    }

    /// A channel as a goniometer would have scanned it in the plane of incidence, psi from 0 to 80 by
    /// 10 deg and theta from -85 to 85 by 2.5 deg: each reading is the value of the bin that its
    /// directions lie in. For pictures, which show incidences.
    ///
    /// Errors: as of [`channel`](Self::channel).
    pub fn in_plane_scan(&mut self, channel: Channel) -> Result<Measurements, ReadError> {
        let values = self.values(channel, 0..self.bins.theta_h)?;
        let (values, _) = values.as_chunks::<VALUE>();
        let mut readings = Vec::new();
        let mut not_measured = 0;
        for psi_deg in (0..=80).step_by(10) {
            for theta in (-34..=34).map(|step| 2.5 * f64::from(step)) {
                let (psi, theta) = (f64::from(psi_deg).to_radians(), theta.to_radians());
                let [i, j, k] = self.bins.bin_of([psi, theta, 0.0]);
                let bin = (i * self.bins.theta_d + j) * self.bins.phi_d + k;
                let value = f64::from_le_bytes(values[bin]);
                if !value.is_finite() {
                    let message = not_finite(channel, [i, j, k], value);
                    return Err(file_error(&self.name, message));
                }
                if value < 0.0 {
                    not_measured += 1;
                    continue;
                }
                readings.push(Measurement {
                    wavelength_um: Some(channel.wavelength_um()),
                    psi,
                    theta,
                    phi: 0.0,
                    brdf: value * channel.scale(),
                    sigma: None,
                });
            }
        }
        if readings.is_empty() {
            return Err(file_error(&self.name, nothing_measured(channel)));
        }
        let conversions = [scan_conversion(channel)]
            .into_iter()
            .chain(left_out(not_measured, 0));
        Ok(Measurements {
            source: self.name.clone(),
            format: Format::Merl,
            conversions: conversions.collect(),
            readings,
            ..Measurements::default()
        })
    }

    /// The bytes of a channel, of these slabs of one `theta_h` each. There are as many in the file.
    fn values(&mut self, channel: Channel, slabs: Range<usize>) -> Result<Vec<u8>, ReadError> {
        let slab = VALUE * self.bins.per_slab();
        let length = slab * slabs.len();
        let before = channel as usize * VALUE * self.bins.count() + slab * slabs.start;
        let start = (HEADER + before) as u64;
        let mut values = Vec::with_capacity(length);
        let read = self.reader.seek(SeekFrom::Start(start)).and_then(|_| {
            let mut rest = self.reader.by_ref().take(length as u64);
            rest.read_to_end(&mut values)
        });
        match read {
            Ok(read) if read == length => Ok(values),
            Ok(_) => Err(file_error(&self.name, "became shorter while it was read")),
            Err(error) => Err(io_error(&self.name, error)),
        }
    }
}

/// The readings of the bins of one `theta_h`, and what was left out.
#[derive(Default)]
struct Slab {
    readings: Vec<Measurement>,
    not_measured: usize,
    below: usize,
}

impl Slab {
    /// The slab of index i from the bytes of its values.
    fn of(bins: Bins, channel: Channel, i: usize, values: &[u8]) -> Result<Self, String> {
        let mut slab = Self::default();
        let half = half(middle_of(i, bins.theta_h));
        let azimuths = (0..bins.phi_d).map(|k| azimuth(middle_of(k, bins.phi_d)));
        let azimuths: Vec<(f64, f64)> = azimuths.collect();
        let differences = (0..bins.theta_d).map(|j| difference(middle_of(j, bins.theta_d)));
        let differences: Vec<(f64, f64)> = differences.collect();
        for (bin, value) in values.as_chunks::<VALUE>().0.iter().enumerate() {
            let (j, k) = (bin / bins.phi_d, bin % bins.phi_d);
            let value = f64::from_le_bytes(*value);
            if !value.is_finite() {
                return Err(not_finite(channel, [i, j, k], value));
            }
            match Bins::pair(half, differences[j], azimuths[k]) {
                Some(_) if value < 0.0 => slab.not_measured += 1,
                None if value >= 0.0 => slab.below += 1,
                None => {}
                Some([psi, theta, phi]) => slab.readings.push(Measurement {
                    wavelength_um: Some(channel.wavelength_um()),
                    psi,
                    theta,
                    phi,
                    brdf: value * channel.scale(),
                    sigma: None,
                }),
            }
        }
        Ok(slab)
    }
}

fn not_finite(channel: Channel, [i, j, k]: [usize; 3], value: f64) -> String {
    format!(
        "{}, bin ({i}, {j}, {k}): {value} is not a finite number: expected f_r, or a negative number \
         for a bin that was not measured",
        channel.name()
    )
}

fn nothing_measured(channel: Channel) -> String {
    format!("has no measured bin in {}", channel.name())
}

fn conversion(channel: Channel) -> String {
    format!(
        "MERL table, {} taken for {} um: f_r in the middle of each bin of theta_h, theta_d, phi_d",
        channel.name(),
        channel.wavelength_um()
    )
}

fn scan_conversion(channel: Channel) -> String {
    format!(
        "MERL table, {} taken for {} um: the bins that a scan in the plane of incidence meets",
        channel.name(),
        channel.wavelength_um()
    )
}

/// What was left out, in words; nothing where nothing was.
fn left_out(not_measured: usize, below: usize) -> Option<String> {
    let bins = |count: usize, what: &str| (count > 0).then(|| format!("{count} {what}"));
    let parts = [
        bins(not_measured, "bins that were not measured (negative)"),
        bins(below, "measured bins below the horizon"),
    ];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    (!parts.is_empty()).then(|| format!("left out: {}", parts.join(", ")))
}

/// The numbers of bins, or what is wrong with them.
fn checked_bins(header: &[u8; HEADER], size: u64) -> Result<Bins, String> {
    let little = numbers(header, i32::from_le_bytes);
    let as_big = Bins::of_numbers(numbers(header, i32::from_be_bytes));
    if as_big.and_then(Bins::size) == Some(size) {
        return Err(
            "is a MERL table in big-endian order: expected little-endian numbers".to_owned(),
        );
    }
    let [theta_h, theta_d, phi_d] = little;
    let Some((bins, expected)) = Bins::of_numbers(little).and_then(|b| Some((b, b.size()?))) else {
        return Err(format!(
            "{theta_h} x {theta_d} x {phi_d} bins: expected three positive numbers, of a MERL table \
             90 x 90 x 180"
        ));
    };
    if bins.count() > MOST_BINS {
        return Err(format!(
            "{theta_h} x {theta_d} x {phi_d} bins: expected no more than {MOST_BINS} in a channel"
        ));
    }
    if expected == size {
        return Ok(bins);
    }
    let word = if size < expected {
        "truncated"
    } else {
        "too long"
    };
    Err(format!(
        "is {word}: {theta_h} x {theta_d} x {phi_d} bins of three channels are {expected} bytes, \
         the file has {size}"
    ))
}

fn io_error(name: &str, error: io::Error) -> ReadError {
    ReadError::Io {
        path: name.into(),
        error,
    }
}

fn file_error(name: &str, message: impl Into<String>) -> ReadError {
    text::file_error(Path::new(name), message)
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use proptest::prelude::*;

    use super::*;

    const SMALL: Bins = Bins {
        theta_h: 6,
        theta_d: 5,
        phi_d: 8,
    };

    /// A table whose value is the place of the bin in its channel, plus 1000 for each channel.
    fn bytes(bins: Bins) -> Vec<u8> {
        let mut bytes: Vec<u8> = [bins.theta_h, bins.theta_d, bins.phi_d]
            .into_iter()
            .flat_map(|count| i32::try_from(count).unwrap().to_le_bytes())
            .collect();
        for channel in 0..3 {
            let values = (0..bins.count()).map(|bin| (1000 * channel + bin) as f64);
            bytes.extend(values.flat_map(f64::to_le_bytes));
        }
        bytes
    }

    fn error(bytes: &[u8]) -> String {
        let read = |bytes| Table::new(Cursor::new(bytes), "x.binary")?.channel(Channel::Red);
        read(bytes).unwrap_err().to_string()
    }

    #[test]
    fn bins_are_readings_in_their_middle() {
        let mut table = Table::new(Cursor::new(bytes(SMALL)), "x").unwrap();
        let green = table.channel(Channel::Green).unwrap();
        let expected = |bin: usize| (1000 + bin) as f64 * (1.15 / 1500.0);
        let mut bins = (0..SMALL.count()).filter_map(|bin| {
            let (i, rest) = (bin / 40, bin % 40);
            Some((bin, SMALL.centre([i, rest / 8, rest % 8])?))
        });
        for reading in green.readings() {
            let (bin, angles) = bins.next().unwrap();
            assert_eq!([reading.psi, reading.theta, reading.phi], angles);
            assert_eq!(
                (reading.brdf, reading.wavelength_um),
                (expected(bin), Some(0.549))
            );
        }
        assert_eq!(bins.next(), None);
        assert!(green.conversions[1].contains("bins below the horizon"));
    }

    #[test]
    fn the_angles_of_a_bin_are_those_of_its_half_vector() {
        for (i, j, k) in [(0, 0, 0), (2, 1, 3), (3, 2, 7)] {
            let [psi, theta, phi] = SMALL.centre([i, j, k]).unwrap();
            let geometry = brdf_core::Geometry::new(psi, theta, phi).unwrap();
            let part = |index: usize, bins: usize| (index as f64 + 0.5) / bins as f64;
            let theta_h = FRAC_PI_2 * part(i, SMALL.theta_h).powi(2);
            assert!((geometry.tan2_alpha().sqrt().atan() - theta_h).abs() < 1e-12);
            let theta_d = FRAC_PI_2 * part(j, SMALL.theta_d);
            assert!((geometry.cos_gamma() - theta_d.cos()).abs() < 1e-12);
        }
    }

    #[test]
    fn negative_values_are_left_out_and_counted() {
        let mut bytes = bytes(SMALL);
        for bin in [0, 1, 9] {
            bytes[12 + 8 * bin..][..8].copy_from_slice(&(-0.5_f64).to_le_bytes());
        }
        let mut table = Table::new(Cursor::new(bytes), "x").unwrap();
        let red = table.channel(Channel::Red).unwrap();
        let green = table.channel(Channel::Green).unwrap();
        assert_eq!(red.readings().len() + 3, green.readings().len());
        assert!(
            red.conversions[1].contains("3 bins that were not measured"),
            "{:?}",
            red.conversions
        );
    }

    #[test]
    fn what_is_no_table_is_told_without_believing_its_header() {
        let header = |numbers: [i32; 3]| numbers.map(i32::to_le_bytes).concat();
        assert!(error(b"short").contains("has 5 bytes: expected a MERL table"));
        assert!(error(&header([90, 90, 180])).contains(
            "is truncated: 90 x 90 x 180 bins of three channels are 34992012 bytes, the file has 12"
        ));
        assert!(
            error(&header([-90, 90, 180])).contains("-90 x 90 x 180 bins: expected three positive")
        );
        assert!(
            error(&header([0, 90, 180])).contains("0 x 90 x 180 bins: expected three positive")
        );
        // More bytes than there are numbers for, and than there is memory for.
        assert!(error(&header([i32::MAX; 3])).contains("expected three positive numbers"));
        assert!(error(&header([i32::MAX, 1 << 20, 1])).contains(
            "2147483647 x 1048576 x 1 bins: expected no more than 16777216 in a channel"
        ));
        assert!(error(&header([1 << 12, 1 << 12, 1])).contains("is truncated"));
        let too_long = [bytes(SMALL), vec![0]].concat();
        assert!(
            error(&too_long)
                .contains("is too long: 6 x 5 x 8 bins of three channels are 5772 bytes")
        );
        let mut swapped = bytes(SMALL);
        swapped[..12]
            .as_chunks_mut::<4>()
            .0
            .iter_mut()
            .for_each(|word| word.reverse());
        assert!(error(&swapped).contains("big-endian"));
        let mut infinite = bytes(SMALL);
        infinite[12 + 8 * 47..][..8].copy_from_slice(&f64::NAN.to_le_bytes());
        assert_eq!(
            error(&infinite),
            "x.binary: red, bin (1, 0, 7): NaN is not a finite number: expected f_r, or a negative \
             number for a bin that was not measured"
        );
        let nothing = [header([6, 5, 8]), [(-1.0_f64).to_le_bytes(); 720].concat()].concat();
        assert!(error(&nothing).contains("has no measured bin in red"));
    }

    #[test]
    fn a_table_is_recognised_by_its_header_and_its_size() {
        let table = bytes(SMALL);
        assert!(recognises(&table, table.len() as u64));
        assert!(!recognises(&table, 1 + table.len() as u64));
        assert!(!recognises(b"psi_deg,theta_deg,brdf_per_sr", 29));
        assert!(!recognises(b"", 0));
    }

    #[test]
    fn a_scan_meets_the_bins_of_its_directions() {
        let mut table = Table::new(Cursor::new(bytes(Bins::STANDARD)), "x").unwrap();
        let scan = table.in_plane_scan(Channel::Red).unwrap();
        assert_eq!(
            (scan.readings().len(), scan.incidences().len()),
            (9 * 69, 9)
        );
        // At normal incidence the mirror direction is the first bin.
        let mirror = scan
            .readings()
            .iter()
            .find(|r| r.psi == 0.0 && r.theta == 0.0);
        assert_eq!(mirror.unwrap().brdf, 0.0);
    }

    proptest! {
        #[test]
        fn the_middle_of_a_bin_lies_in_it(i in 0_usize..90, j in 0_usize..90, k in 0_usize..180) {
            if let Some(angles) = Bins::STANDARD.centre([i, j, k]) {
                prop_assert_eq!(Bins::STANDARD.bin_of(angles), [i, j, k]);
            }
        }

        #[test]
        fn any_bytes_are_a_table_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..600)) {
            let _ = Table::new(Cursor::new(bytes), "x").map(|mut table| table.channel(Channel::Blue));
        }

        #[test]
        fn any_values_are_readings_or_an_error(
            numbers in prop::array::uniform3(1_i32..4),
            values in prop::collection::vec(any::<f64>(), 81),
        ) {
            let count: i32 = numbers.iter().product();
            let values = values.iter().take(3 * usize::try_from(count).unwrap());
            let bytes = [
                numbers.map(i32::to_le_bytes).concat(),
                values.flat_map(|value| value.to_le_bytes()).collect(),
            ].concat();
            let mut table = Table::new(Cursor::new(bytes), "x").unwrap();
            if let Ok(scan) = table.channel(Channel::Green) {
                prop_assert!(scan.readings().iter().all(|r| r.validated().is_ok()));
            }
        }
    }
}
