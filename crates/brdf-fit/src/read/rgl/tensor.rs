//! The container: a list of named tensors.
//!
//! ```text
//! 12 bytes  "tensor_file" and a zero byte
//!  2 bytes  version: 1, 0
//!  4 bytes  number of tensors
//! for each tensor:
//!  2 bytes  length of the name, then the name
//!  2 bytes  number of dimensions
//!  1 byte   type of the numbers
//!  8 bytes  where the numbers begin in the file
//!  8 bytes  for each dimension: its size
//! ```

use std::fmt::Write as _;

use crate::read::text::quotable;

pub(super) const MAGIC: &[u8] = b"tensor_file\0";

/// The type of the numbers of a tensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    UInt8,
    Float32,
    Float64,
    Other(u8),
}

impl Kind {
    /// The type with a number in the file.
    fn of(number: u8) -> Self {
        match number {
            1 => Self::UInt8,
            10 => Self::Float32,
            11 => Self::Float64,
            other => Self::Other(other),
        }
    }

    /// The size of a number in bytes.
    fn size(self) -> Option<usize> {
        match self {
            Self::UInt8 => Some(1),
            Self::Float32 => Some(4),
            Self::Float64 => Some(8),
            Self::Other(_) => None,
        }
    }
}

/// A tensor, whose numbers stay in the bytes of the file.
#[derive(Debug, Clone)]
pub(super) struct Tensor<'a> {
    name: String,
    kind: Kind,
    pub(super) shape: Vec<usize>,
    bytes: &'a [u8],
}

impl Tensor<'_> {
    /// The number at a position, the last dimension varying fastest; NaN beyond the end.
    pub(super) fn at(&self, position: usize) -> f64 {
        let size = self.kind.size().unwrap_or(1);
        let start = position.saturating_mul(size);
        let bytes = self.bytes.get(start..start.saturating_add(size));
        let bytes = bytes.unwrap_or_default();
        let float32 = || Some(f64::from(f32::from_le_bytes(bytes.try_into().ok()?)));
        let float64 = || Some(f64::from_le_bytes(bytes.try_into().ok()?));
        let found = match self.kind {
            Kind::UInt8 => bytes.first().map(|byte| f64::from(*byte)),
            Kind::Float32 => float32(),
            Kind::Float64 => float64(),
            Kind::Other(_) => None,
        };
        found.unwrap_or(f64::NAN)
    }

    /// The number of numbers.
    pub(super) fn len(&self) -> usize {
        self.bytes.len() / self.kind.size().unwrap_or(1)
    }

    pub(super) fn numbers(&self) -> Vec<f64> {
        (0..self.len()).map(|position| self.at(position)).collect()
    }

    /// The sizes as a text, such as `1 x 8 x 32`.
    fn sizes(&self) -> String {
        let mut text = String::new();
        for (i, size) in self.shape.iter().enumerate() {
            let times = if i == 0 { "" } else { " x " };
            let _ = write!(text, "{times}{size}");
        }
        text
    }
}

/// The tensors of a file.
pub(super) struct TensorFile<'a> {
    tensors: Vec<Tensor<'a>>,
}

impl<'a> TensorFile<'a> {
    /// # Errors
    ///
    /// What is wrong with the file, as the end of a sentence that begins with its name.
    pub(super) fn new(bytes: &'a [u8]) -> Result<Self, String> {
        let truncated =
            || "is a truncated RGL tensor file: expected the list of its tensors".to_owned();
        let mut rest = bytes.strip_prefix(MAGIC).ok_or_else(|| {
            "does not begin with \"tensor_file\": expected an RGL tensor file".to_owned()
        })?;
        let version = take(&mut rest, 2).ok_or_else(truncated)?;
        if version != [1, 0] {
            let [major, minor] = [version.first(), version.get(1)].map(|part| part.unwrap_or(&0));
            return Err(format!(
                "is a tensor file of version {major}.{minor}: expected 1.0"
            ));
        }
        let count = integer(&mut rest, 4).ok_or_else(truncated)?;
        let mut tensors = Vec::new();
        for _ in 0..count {
            tensors.push(tensor(&mut rest, bytes).ok_or_else(truncated)??);
        }
        Ok(Self { tensors })
    }

    /// The tensor with a name.
    pub(super) fn find(&self, name: &str) -> Option<&Tensor<'a>> {
        self.tensors.iter().find(|tensor| tensor.name == name)
    }

    /// The tensor with a name.
    ///
    /// # Errors
    ///
    /// There is none.
    pub(super) fn expect(&self, name: &str) -> Result<&Tensor<'a>, String> {
        self.find(name).ok_or_else(|| {
            let names = self.tensors.iter().map(|tensor| quotable(tensor.name.as_bytes()));
            let names: Vec<String> = names.take(20).collect();
            format!(
                "is an RGL tensor file that cannot be read because it has no tensor {name}: expected a \
                 BRDF of the RGL database, found {}",
                names.join(", ")
            )
        })
    }

    /// The tensor with a name, which must have the given sizes, where they are known.
    ///
    /// # Errors
    ///
    /// There is none, or it has other sizes or numbers.
    pub(super) fn get(&self, name: &str, sizes: &[Option<usize>]) -> Result<&Tensor<'a>, String> {
        let tensor = self.expect(name)?;
        if let Kind::Other(number) = tensor.kind {
            return Err(format!(
                "has numbers of the type {number} in the tensor {name}: expected 32-bit or 64-bit \
                 floating-point numbers"
            ));
        }
        let is_size = |(size, expected): (&usize, &Option<usize>)| {
            *size > 0 && expected.is_none_or(|expected| expected == *size)
        };
        let agree =
            tensor.shape.len() == sizes.len() && tensor.shape.iter().zip(sizes).all(is_size);
        if agree {
            return Ok(tensor);
        }
        let size = |size: &Option<usize>| size.map_or("any".to_owned(), |size| size.to_string());
        let expected: Vec<String> = sizes.iter().map(size).collect();
        Err(format!(
            "has a tensor {name} of {} numbers: expected {}",
            tensor.sizes(),
            expected.join(" x ")
        ))
    }

    /// The text in a tensor.
    pub(super) fn text(&self, name: &str) -> Option<String> {
        let tensor = self
            .find(name)
            .filter(|tensor| tensor.kind == Kind::UInt8)?;
        let text = String::from_utf8_lossy(tensor.bytes);
        Some(text.trim_matches(['\0', ' ', '\n', '\r']).to_owned())
    }
}

fn take<'a>(rest: &mut &'a [u8], count: usize) -> Option<&'a [u8]> {
    let (taken, behind) = rest.split_at_checked(count)?;
    *rest = behind;
    Some(taken)
}

/// The little-endian integer in the next bytes.
fn integer(rest: &mut &[u8], size: usize) -> Option<u64> {
    let bytes = take(rest, size)?;
    let digits = bytes.iter().rev();
    Some(digits.fold(0, |number, byte| number << 8 | u64::from(*byte)))
}

/// The next tensor of the list; `None` where the list ends before it.
fn tensor<'a>(rest: &mut &[u8], file: &'a [u8]) -> Option<Result<Tensor<'a>, String>> {
    let length = usize::try_from(integer(rest, 2)?).ok()?;
    let name = String::from_utf8_lossy(take(rest, length)?).into_owned();
    let dimensions = integer(rest, 2)?;
    let kind = Kind::of(take(rest, 1)?.first().copied()?);
    let offset = integer(rest, 8)?;
    let mut shape = Vec::new();
    for _ in 0..dimensions {
        // A size beyond the address space is too large for any file.
        shape.push(usize::try_from(integer(rest, 8)?).unwrap_or(usize::MAX));
    }
    let Some(size) = kind.size() else {
        let bytes = &[];
        return Some(Ok(Tensor {
            name,
            kind,
            shape,
            bytes,
        }));
    };
    let count = shape
        .iter()
        .try_fold(size, |product, size| product.checked_mul(*size));
    let bytes = count
        .zip(usize::try_from(offset).ok())
        .and_then(|(count, start)| {
            let end = start.checked_add(count)?;
            file.get(start..end)
        });
    let tensor = |bytes| Tensor {
        name: name.clone(),
        kind,
        shape: shape.clone(),
        bytes,
    };
    Some(match bytes {
        Some(bytes) => Ok(tensor(bytes)),
        None => Err(format!(
            "is truncated: the tensor {} of {} numbers extends beyond its {} bytes",
            quotable(name.as_bytes()),
            tensor(&[]).sizes(),
            file.len()
        )),
    })
}
