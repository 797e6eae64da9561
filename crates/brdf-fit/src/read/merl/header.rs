//! The header of a table: three numbers of bins, which must agree with the size of the file.

use super::bins::Bins;

/// Bytes of the header.
pub(super) const HEADER: usize = 12;

/// Bytes of a value.
pub(super) const VALUE: usize = 8;

/// The most bins of a channel; the MERL database has 1.5 million. The limit keeps a sparse file of any
/// size from being read: the readings of more bins would take more than 1 GB of memory.
const MOST_BINS: usize = 1 << 24;

/// Why a header is not that of a table.
#[derive(Debug, thiserror::Error)]
pub(super) enum HeaderError {
    #[error("is a MERL table in big-endian order: expected little-endian numbers")]
    BigEndian,
    #[error(
        "{} bins: expected three positive numbers, such as 90 x 90 x 180 of the MERL database",
        product(.0)
    )]
    NotPositive([i32; 3]),
    #[error("{} bins: expected at most {MOST_BINS} in a channel", product(.0))]
    TooMany([i32; 3]),
    #[error(
        "is {}: {} bins of three channels are {expected} bytes, the file has {size}",
        if size < expected { "truncated" } else { "too long" },
        product(numbers)
    )]
    Size {
        numbers: [i32; 3],
        expected: u64,
        size: u64,
    },
}

fn product([theta_h, theta_d, phi_d]: &[i32; 3]) -> String {
    format!("{theta_h} x {theta_d} x {phi_d}")
}

/// The numbers of bins in a header of a file of `size` bytes.
pub(super) fn bins_of(header: &[u8; HEADER], size: u64) -> Result<Bins, HeaderError> {
    let numbers = numbers(header, i32::from_le_bytes);
    if has_size(header, i32::from_be_bytes, size) {
        return Err(HeaderError::BigEndian);
    }
    let Some((bins, expected)) = checked(numbers) else {
        return Err(HeaderError::NotPositive(numbers));
    };
    if bins.count() > MOST_BINS {
        return Err(HeaderError::TooMany(numbers));
    }
    if expected != size {
        return Err(HeaderError::Size {
            numbers,
            expected,
            size,
        });
    }
    Ok(bins)
}

/// Whether the beginning of a file and its size are those of a table, in either byte order.
pub(in crate::read) fn is_table(start: &[u8], size: u64) -> bool {
    let Some(header) = start.first_chunk() else {
        return false;
    };
    has_size(header, i32::from_le_bytes, size) || has_size(header, i32::from_be_bytes, size)
}

/// Whether the beginning of a stream, of which the size is not known, may be that of a table.
pub(in crate::read) fn begins_table(start: &[u8]) -> bool {
    const LARGEST: u64 = 1 << 40;
    let is_header = |order| {
        let header = start.first_chunk().map(|header| numbers(header, order));
        header
            .and_then(checked)
            .is_some_and(|(_, size)| size < LARGEST)
    };
    is_header(i32::from_le_bytes) || is_header(i32::from_be_bytes)
}

fn has_size(header: &[u8; HEADER], order: fn([u8; 4]) -> i32, size: u64) -> bool {
    checked(numbers(header, order)).is_some_and(|(_, expected)| expected == size)
}

fn numbers(header: &[u8; HEADER], order: fn([u8; 4]) -> i32) -> [i32; 3] {
    let (words, _) = header.as_chunks::<4>();
    std::array::from_fn(|i| order(words[i]))
}

/// The numbers of bins and the size of the whole file in bytes; `None` where one of the numbers is not
/// positive, or the size is too large for an integer.
fn checked(numbers: [i32; 3]) -> Option<(Bins, u64)> {
    let [theta_h, theta_d, phi_d] = numbers.map(|n| usize::try_from(n).unwrap_or(0));
    let slab = theta_d.checked_mul(phi_d)?;
    let values = theta_h.checked_mul(slab)?.checked_mul(3 * VALUE)?;
    let size = u64::try_from(values.checked_add(HEADER)?).ok()?;
    let bins = Bins {
        theta_h,
        theta_d,
        phi_d,
    };
    (values > 0).then_some((bins, size))
}
