//! A table in a file, whose channels are read one at a time.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::bins::Bins;
use super::channels::{Channel, NotFinite, Omitted, Slab};
use super::header::{HEADER, VALUE, bins_of};
use crate::format::counted;
use crate::read::error::ReadError;
use crate::read::options::ReadOptions;
use crate::scan::{Convention, Format, Measurement, Measurements};

/// How many slabs of one `theta_h` are converted in parallel.
const SLABS: usize = 8;

/// The width of the classes of incidence angles in radians (5 deg): the angles in a table are not
/// grouped by incidence.
const INCIDENCE_CLASS: f64 = 5.0 * std::f64::consts::PI / 180.0;

/// A table whose header and size have been checked. Its channels are read one at a time, since each
/// of them has 1.1 million readings.
#[derive(Debug)]
pub struct Table<R> {
    path: PathBuf,
    reader: R,
    bins: Bins,
}

impl Table<File> {
    /// Opens the table in a file.
    ///
    /// # Errors
    ///
    /// The file cannot be read, or does not begin with the numbers of bins of a table of its size.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        let path = path.as_ref();
        let file = File::open(path).map_err(|error| ReadError::io(path, error))?;
        Self::with_path(file, path)
    }
}

impl<R: Read + Seek> Table<R> {
    /// The table in the bytes of a reader. `name` stands for the path of the file in errors and
    /// reports.
    ///
    /// # Errors
    ///
    /// As [`open`](Self::open).
    pub fn new(reader: R, name: &str) -> Result<Self, ReadError> {
        Self::with_path(reader, Path::new(name))
    }

    fn with_path(mut reader: R, path: &Path) -> Result<Self, ReadError> {
        let io = |error| ReadError::io(path, error);
        let size = reader.seek(SeekFrom::End(0)).map_err(io)?;
        reader.rewind().map_err(io)?;
        if size < HEADER as u64 {
            let message = format!(
                "has {}: expected a MERL table, which begins with three numbers of bins in 12 bytes",
                counted(usize::try_from(size).unwrap_or(usize::MAX), "byte")
            );
            return Err(ReadError::file(path, message));
        }
        let mut header = [0; HEADER];
        reader.read_exact(&mut header).map_err(io)?;
        let bins = bins_of(&header, size);
        Ok(Self {
            bins: bins.map_err(|error| ReadError::file(path, error.to_string()))?,
            path: path.to_owned(),
            reader,
        })
    }

    /// # Errors
    ///
    /// The options set an angular convention, which the half and difference angles of a table do not
    /// have, or declare columns or comments.
    pub(in crate::read) fn check_options(&self, options: &ReadOptions) -> Result<(), ReadError> {
        super::READER.check_options(&self.path, options)?;
        let why = "a MERL table has angles about the half vector";
        options
            .fixed_convention(&self.path, Convention::default(), why)
            .map(drop)
    }

    /// The readings of a channel: f_r at the centres of the bins that were measured and whose two
    /// directions are above the surface, in the order of the file.
    ///
    /// # Errors
    ///
    /// The file cannot be read, a value is not a finite number, or no bin was measured.
    pub fn channel(&mut self, channel: Channel) -> Result<Measurements, ReadError> {
        let bins = self.bins;
        let mut readings = Vec::new();
        let mut omitted = Omitted::default();
        for first in (0..bins.theta_h).step_by(SLABS) {
            let together = first..(first + SLABS).min(bins.theta_h);
            let values = self.values(channel, together.clone())?;
            let converted: Vec<Slab> = values
                .par_chunks_exact(VALUE * bins.per_slab())
                .zip(together)
                .map(|(values, i)| Slab::new(bins, channel, i, values))
                .collect::<Result<_, _>>()
                .map_err(|error| self.value_error(&error))?;
            for slab in converted {
                readings.extend(slab.readings);
                omitted.add(slab.omitted);
            }
        }
        let conversion = format!(
            "MERL table, {} assigned to {} um: f_r at the centre of each bin of theta_h, theta_d, phi_d",
            channel.name(),
            channel.wavelength_um()
        );
        Ok(Measurements {
            incidence_class: Some(INCIDENCE_CLASS),
            ..self.measurements(channel, conversion, omitted, readings)?
        })
    }

    /// A channel as a goniometer scans the plane of incidence: psi from 0 to 80 deg by 10 deg, theta
    /// from -85 to 85 deg by 2.5 deg. Each reading is the value of the bin that contains its
    /// directions. Figures use it, since they show incidences.
    ///
    /// # Errors
    ///
    /// As [`channel`](Self::channel).
    pub fn in_plane_scan(&mut self, channel: Channel) -> Result<Measurements, ReadError> {
        let values = self.values(channel, 0..self.bins.theta_h)?;
        let (values, _) = values.as_chunks::<VALUE>();
        let mut readings = Vec::new();
        let mut omitted = Omitted::default();
        for psi_deg in (0..=80).step_by(10) {
            for theta in (-34..=34).map(|step| 2.5 * f64::from(step)) {
                let (psi, theta) = (f64::from(psi_deg).to_radians(), theta.to_radians());
                let [i, j, k] = self.bins.bin_of([psi, theta, 0.0]);
                let bin = (i * self.bins.theta_d + j) * self.bins.phi_d + k;
                let value = f64::from_le_bytes(values[bin]);
                let value = NotFinite::check(channel, [i, j, k], value)
                    .map_err(|error| self.value_error(&error))?;
                if value < 0.0 {
                    omitted.not_measured += 1;
                } else {
                    readings.push(channel.reading(value, [psi, theta, 0.0]));
                }
            }
        }
        let conversion = format!(
            "MERL table, {} assigned to {} um: the bins that contain the directions of a scan in the \
             plane of incidence",
            channel.name(),
            channel.wavelength_um()
        );
        self.measurements(channel, conversion, omitted, readings)
    }

    fn measurements(
        &self,
        channel: Channel,
        conversion: String,
        omitted: Omitted,
        readings: Vec<Measurement>,
    ) -> Result<Measurements, ReadError> {
        if readings.is_empty() {
            let message = format!("has no measured bin in {}", channel.name());
            return Err(ReadError::file(&self.path, message));
        }
        let conversions = [conversion].into_iter().chain(omitted.sentence());
        Ok(Measurements {
            source: self.path.display().to_string(),
            format: Format::Merl,
            conversions: conversions.collect(),
            readings,
            ..Measurements::default()
        })
    }

    fn value_error(&self, error: &NotFinite) -> ReadError {
        ReadError::file(&self.path, error.to_string())
    }

    /// The bytes of the values of a channel, of some slabs of one `theta_h` each.
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
            Ok(_) => {
                let message = "became shorter while it was being read";
                Err(ReadError::file(&self.path, message))
            }
            Err(error) => Err(ReadError::io(&self.path, error)),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use proptest::prelude::*;

    use super::super::header::is_table;
    use super::*;

    const SMALL: Bins = Bins {
        theta_h: 6,
        theta_d: 5,
        phi_d: 8,
    };

    /// A table whose values are the positions of the bins in their channel, plus 1000 for each channel
    /// before it.
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
    fn bins_are_readings_at_their_centres() {
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
    fn damaged_tables_are_refused_without_allocating_what_their_header_claims() {
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
        // The size exceeds the range of integers, and the memory.
        assert!(error(&header([i32::MAX; 3])).contains("expected three positive numbers"));
        assert!(
            error(&header([i32::MAX, 1 << 20, 1]))
                .contains("2147483647 x 1048576 x 1 bins: expected at most 16777216 in a channel")
        );
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
        assert!(is_table(&table, table.len() as u64));
        assert!(!is_table(&table, 1 + table.len() as u64));
        assert!(!is_table(b"psi_deg,theta_deg,brdf_per_sr", 29));
        assert!(!is_table(b"", 0));
    }

    #[test]
    fn an_in_plane_scan_has_the_values_of_the_bins_of_its_directions() {
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
