//! An array of NumPy whose elements are readings.

use std::fmt;
use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use npyz::{DType, Endianness, NpyHeader, Order, TypeChar};

use super::error::CubeError;

/// The type of the elements of an array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Element {
    /// 32 bits.
    Float32,
    /// 64 bits.
    Float64,
}

impl fmt::Display for Element {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Float32 => "float32",
            Self::Float64 => "float64",
        })
    }
}

/// Readings of some scans, one scan after the other.
#[derive(Debug, Clone)]
pub(super) enum Piece {
    Float32(Vec<f32>),
    Float64(Vec<f64>),
}

/// A file of NumPy, `.npy`, with the readings of many scans: an array of 32 or 64 bit numbers, of which one
/// dimension runs over the readings of a scan and the others over the scans.
#[derive(Debug)]
pub struct Cube {
    path: PathBuf,
    file: BufReader<File>,
    /// Where the elements begin, in bytes.
    start: u64,
    element: Element,
    big_endian: bool,
    fortran_order: bool,
    shape: Vec<u64>,
    axis: usize,
    /// In the order in memory, the number of scans before, and after, the dimension of the readings.
    outer: u64,
    inner: u64,
}

impl Cube {
    /// Opens an array of scans of this number of readings. `axis` is the dimension that runs over the readings, from
    /// 0; where it is not given, the only one of that size.
    ///
    /// # Errors
    ///
    /// The file cannot be read or is no array of 32 or 64 bit numbers, it is shorter than its header
    /// says, or no dimension, or several, have this number of elements.
    pub fn open(
        path: impl AsRef<Path>,
        readings: usize,
        axis: Option<usize>,
    ) -> Result<Self, CubeError> {
        let path = path.as_ref();
        let io = |error| CubeError::io(path, &error);
        let mut file = BufReader::new(File::open(path).map_err(io)?);
        let header = NpyHeader::from_reader(&mut file).map_err(|error| {
            CubeError::array(path, format!("is no array of NumPy (.npy): {error}"))
        })?;
        let (element, big_endian) = element(path, &header.dtype())?;
        let shape = header.shape().to_vec();
        let axis = find_axis(path, &shape, readings, axis)?;
        let fortran_order = header.order() == Order::Fortran;
        let (before, after) = (product(&shape[..axis]), product(&shape[axis + 1..]));
        let (outer, inner) = if fortran_order {
            (after, before)
        } else {
            (before, after)
        };
        let cube = Self {
            path: path.to_owned(),
            start: file.stream_position().map_err(io)?,
            file,
            element,
            big_endian,
            fortran_order,
            shape,
            axis,
            outer,
            inner,
        };
        cube.check_length()?;
        Ok(cube)
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The type of the elements.
    pub fn element(&self) -> Element {
        self.element
    }

    /// The dimension that runs over the readings, from 0.
    pub fn axis(&self) -> usize {
        self.axis
    }

    /// The shape of the array without the dimension of the readings.
    pub fn scan_shape(&self) -> Vec<u64> {
        let mut shape = self.shape.clone();
        shape.remove(self.axis);
        shape
    }

    /// The number of scans.
    pub fn scans(&self) -> u64 {
        self.outer * self.inner
    }

    /// The number of readings of a scan.
    pub fn readings(&self) -> u64 {
        self.shape[self.axis]
    }

    /// Whether the first dimension is the one whose elements are adjacent.
    pub(super) fn fortran_order(&self) -> bool {
        self.fortran_order
    }

    fn width(&self) -> u64 {
        match self.element {
            Element::Float32 => 4,
            Element::Float64 => 8,
        }
    }

    fn check_length(&self) -> Result<(), CubeError> {
        let io = |error| CubeError::io(&self.path, &error);
        let found = self.file.get_ref().metadata().map_err(io)?.len();
        let elements = self
            .shape
            .iter()
            .try_fold(1_u64, |all, n| all.checked_mul(*n));
        let expected =
            elements.and_then(|all| all.checked_mul(self.width())?.checked_add(self.start));
        match expected {
            Some(expected) if expected <= found => Ok(()),
            _ => {
                let message = format!(
                    "is cut off: it has {found} bytes, and its header states the shape {} of {}",
                    shape_text(&self.shape),
                    self.element
                );
                Err(CubeError::array(&self.path, message))
            }
        }
    }

    /// Reads `count` scans from `first` on, in the order in which they lie in the file.
    pub(super) fn read(&mut self, first: u64, count: u64) -> Result<Piece, CubeError> {
        let bytes = self.bytes(first, count);
        let bytes = bytes.map_err(|error| CubeError::io(&self.path, &error))?;
        Ok(match (self.element, self.big_endian) {
            (Element::Float32, true) => Piece::Float32(numbers(&bytes, f32::from_be_bytes)),
            (Element::Float32, false) => Piece::Float32(numbers(&bytes, f32::from_le_bytes)),
            (Element::Float64, true) => Piece::Float64(numbers(&bytes, f64::from_be_bytes)),
            (Element::Float64, false) => Piece::Float64(numbers(&bytes, f64::from_le_bytes)),
        })
    }

    /// The bytes of the elements of some scans, one scan after the other.
    fn bytes(&mut self, first: u64, count: u64) -> std::io::Result<Vec<u8>> {
        let (width, readings) = (self.width(), self.readings());
        let mut all = vec![0; length(count * readings * width)];
        if self.inner == 1 {
            self.file
                .seek(SeekFrom::Start(self.start + first * readings * width))?;
            self.file.read_exact(&mut all)?;
            return Ok(all);
        }
        // The scans lie side by side: each reading of all of them is read at once, and distributed.
        let (size, step) = (length(width), length(readings * width));
        let mut side_by_side = Vec::new();
        let mut scan = first;
        while scan < first + count {
            let (outer, inner) = (scan / self.inner, scan % self.inner);
            let scans = (self.inner - inner).min(first + count - scan);
            let row = length(scans * width);
            side_by_side.resize(length(readings) * row, 0);
            // Whole rows are adjacent in the file.
            let at_once = if scans == self.inner { readings } else { 1 };
            for (i, rows) in side_by_side
                .chunks_exact_mut(length(at_once) * row)
                .enumerate()
            {
                let reading = outer * readings + at_once * i as u64;
                let place = self.start + (reading * self.inner + inner) * width;
                self.file.seek(SeekFrom::Start(place))?;
                self.file.read_exact(rows)?;
            }
            let to = &mut all[length((scan - first) * readings * width)..];
            for (reading, row) in side_by_side.chunks_exact(row).enumerate() {
                let targets = to[reading * size..].chunks_mut(step);
                for (target, value) in targets.zip(row.chunks_exact(size)) {
                    target[..size].copy_from_slice(value);
                }
            }
            scan += scans;
        }
        Ok(all)
    }
}

/// A number of bytes of a piece, which fits into memory.
fn length(bytes: u64) -> usize {
    usize::try_from(bytes).unwrap_or(usize::MAX)
}

fn product(shape: &[u64]) -> u64 {
    shape.iter().product()
}

fn numbers<const N: usize, T>(bytes: &[u8], of: impl Fn([u8; N]) -> T) -> Vec<T> {
    bytes.as_chunks().0.iter().map(|bytes| of(*bytes)).collect()
}

/// A shape as NumPy prints it.
pub(super) fn shape_text(shape: &[u64]) -> String {
    if let [only] = shape {
        return format!("({only},)");
    }
    let sizes: Vec<String> = shape.iter().map(u64::to_string).collect();
    format!("({})", sizes.join(", "))
}

/// The type of the elements, and whether their most significant byte is the first.
fn element(path: &Path, dtype: &DType) -> Result<(Element, bool), CubeError> {
    let found = match dtype {
        DType::Plain(plain) if plain.type_char() == TypeChar::Float => match plain.size_field() {
            4 => Some((Element::Float32, plain)),
            8 => Some((Element::Float64, plain)),
            _ => None,
        },
        _ => None,
    };
    let Some((element, plain)) = found else {
        let message = format!(
            "has elements of type {}: expected '<f4' or '<f8', as of array.astype(\"float32\")",
            dtype.descr()
        );
        return Err(CubeError::array(path, message));
    };
    Ok((element, plain.endianness() == Endianness::Big))
}

/// The dimension that runs over the readings.
fn find_axis(
    path: &Path,
    shape: &[u64],
    readings: usize,
    axis: Option<usize>,
) -> Result<usize, CubeError> {
    let wanted = readings as u64;
    let fits: Vec<usize> = (0..shape.len())
        .filter(|axis| shape[*axis] == wanted)
        .collect();
    let text = shape_text(shape);
    match (axis, &fits[..]) {
        (Some(axis), _) if fits.contains(&axis) => Ok(axis),
        (Some(axis), _) => {
            let message = match shape.get(axis) {
                Some(size) => format!(
                    "dimension {axis} of the shape {text} has {size} elements: expected {readings}, the \
                     number of angles"
                ),
                None => format!(
                    "has the shape {text} and no dimension {axis}: expected one from 0 to {}",
                    shape.len().saturating_sub(1)
                ),
            };
            Err(CubeError::array(path, message))
        }
        (None, [only]) => Ok(*only),
        (None, []) => {
            let message = format!(
                "has the shape {text}: expected a dimension of {readings} elements, the number of angles"
            );
            Err(CubeError::array(path, message))
        }
        (None, [first, second, ..]) => Err(CubeError::Ambiguous {
            path: path.to_owned(),
            shape: text,
            first: *first,
            second: *second,
            readings,
        }),
    }
}

#[cfg(test)]
mod tests {
    use npyz::WriterBuilder as _;

    use super::*;

    /// Writes an array of the shape whose elements are their indices in C order, in either order in memory.
    fn array(folder: &Path, shape: [u64; 3], order: Order, big_endian: bool) -> PathBuf {
        let path = folder.join("array.npy");
        let dtype: npyz::TypeStr = if big_endian { ">f4" } else { "<f8" }.parse().unwrap();
        let mut bytes = Vec::new();
        npyz::WriteOptions::new_header_only()
            .dtype(DType::new_scalar(dtype))
            .shape(&shape)
            .order(order)
            .writer(&mut bytes)
            .write_header_only()
            .unwrap();
        let [a, b, c] = shape;
        let mut push = |i: u64, j: u64, k: u64| {
            let index = (i * b + j) * c + k;
            if big_endian {
                bytes.extend((index as f32).to_be_bytes());
            } else {
                bytes.extend((index as f64).to_le_bytes());
            }
        };
        match order {
            Order::C => (0..a * b * c).for_each(|at| push(at / (b * c), at / c % b, at % c)),
            Order::Fortran => (0..a * b * c).for_each(|at| push(at % a, at / a % b, at / (a * b))),
        }
        std::fs::write(&path, bytes).unwrap();
        path
    }

    fn values(piece: Piece) -> Vec<f64> {
        match piece {
            Piece::Float32(values) => values.into_iter().map(f64::from).collect(),
            Piece::Float64(values) => values,
        }
    }

    #[test]
    fn every_axis_of_every_order_gives_the_scans_in_the_order_of_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let shape = [3_u64, 4, 5];
        for (order, big_endian) in [
            (Order::C, false),
            (Order::C, true),
            (Order::Fortran, false),
            (Order::Fortran, true),
        ] {
            let path = array(folder.path(), shape, order, big_endian);
            for axis in 0..3 {
                let readings = usize::try_from(shape[axis]).unwrap();
                let mut cube = Cube::open(&path, readings, None).unwrap();
                assert_eq!((cube.axis(), cube.scans()), (axis, 60 / shape[axis]));
                let mut rest: Vec<usize> = (0..3).filter(|other| *other != axis).collect();
                if order == Order::Fortran {
                    rest.reverse();
                }
                let mut expected = Vec::new();
                for slow in 0..shape[rest[0]] {
                    for fast in 0..shape[rest[1]] {
                        for reading in 0..shape[axis] {
                            let mut at = [0; 3];
                            (at[rest[0]], at[rest[1]], at[axis]) = (slow, fast, reading);
                            expected.push(((at[0] * 4 + at[1]) * 5 + at[2]) as f64);
                        }
                    }
                }
                let scans = cube.scans();
                let cut = scans / 2 + 1;
                let mut found = values(cube.read(0, cut).unwrap());
                found.extend(values(cube.read(cut, scans - cut).unwrap()));
                assert_eq!(found, expected, "{order:?}, axis {axis}");
            }
        }
    }

    #[test]
    fn what_is_no_array_of_scans_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = array(folder.path(), [3, 4, 3], Order::C, false);
        let open = |readings, axis| Cube::open(&path, readings, axis).unwrap_err().to_string();
        assert!(open(3, None).ends_with(
            "dimensions 0 and 2 of (3, 4, 3) both have the number of angles, 3: expected to be told which one \
             runs over the readings"
        ));
        assert!(Cube::open(&path, 3, Some(2)).is_ok());
        assert!(open(7, None).contains("has the shape (3, 4, 3): expected a dimension of 7"));
        assert!(open(3, Some(1)).contains("dimension 1 of the shape (3, 4, 3) has 4 elements"));
        assert!(open(3, Some(5)).contains("no dimension 5: expected one from 0 to 2"));
        let bytes = std::fs::read(&path).unwrap();
        std::fs::write(&path, &bytes[..bytes.len() - 1]).unwrap();
        assert!(open(4, None).contains("is cut off"));
        std::fs::write(&path, "psi_deg,theta_deg\n").unwrap();
        assert!(open(4, None).contains("is no array of NumPy"));
    }
}
