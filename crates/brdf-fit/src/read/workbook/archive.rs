//! The zip archive of a workbook, within limits.

use std::io::{Cursor, Read, copy, sink};

use zip::ZipArchive;
use zip::result::ZipError;

/// The most bytes that the files of an archive may have when they are unpacked. A full sheet of a million
/// rows and seven columns has about 300 MB.
const MAX_UNPACKED: u64 = 1 << 30;

pub(super) type Archive<'a> = ZipArchive<Cursor<&'a [u8]>>;

/// What is said of a file that cannot be opened without a password.
pub(super) const PASSWORD: &str =
    "is protected by a password: save it without one, or save the sheet as CSV";

/// Opens an archive and unpacks each of its files once, which finds damage and limits the size, whatever
/// the archive states of it.
///
/// # Errors
///
/// The archive is damaged, protected by a password, or too large.
pub(super) fn open(bytes: &[u8]) -> Result<Archive<'_>, String> {
    open_within(bytes, MAX_UNPACKED)
}

pub(super) fn open_within(bytes: &[u8], most: u64) -> Result<Archive<'_>, String> {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|error| damaged(&error))?;
    let mut left = most;
    for i in 0..archive.len() {
        let file = archive.by_index(i).map_err(|error| damaged(&error))?;
        let unpacked = copy(&mut file.take(left + 1), &mut sink());
        let unpacked = unpacked.map_err(|error| format!("is damaged: {error}"))?;
        left = left.checked_sub(unpacked).ok_or_else(|| {
            format!(
                "is larger than {} MiB when it is unpacked: expected a workbook of readings",
                most >> 20
            )
        })?;
    }
    Ok(archive)
}

fn damaged(error: &ZipError) -> String {
    match error {
        ZipError::UnsupportedArchive(ZipError::PASSWORD_REQUIRED) => PASSWORD.to_owned(),
        _ => format!("is damaged: {error}"),
    }
}
