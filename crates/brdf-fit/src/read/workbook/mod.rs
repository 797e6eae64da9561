//! Workbooks of spreadsheets: Excel (`.xlsx`, `.xlsm`, `.xls`) and OpenDocument (`.ods`).
//!
//! The cells of a sheet are the table of text that [`csv`](super::csv) or [`goniometer`](super::goniometer)
//! reads: names of columns, units, comments in the first column, what the options declare. The lines of
//! errors are the rows of the sheet, and errors name the sheet.
//!
//! ```text
//!      A                    B          C
//! 1    # sample: Red paint
//! 2    psi_deg              theta_deg  brdf_per_sr
//! 3    10                   -10        0.134
//! ```
//!
//! (The numbers are made up.) Of several sheets the one with readings is read; the notes name the others. A
//! hidden sheet is read where no other has readings. Where several have readings, the declaration
//! `sheet` chooses one by its name.
//!
//! What a cell holds is taken as the text of the table:
//!
//! - a number in full precision, not as it is shown. A formula is its result, as it was saved;
//! - a number that is shown in percent is a percentage: of a column of reflectance factors 7 % is 0.07, and
//!   of a column in percent 7;
//! - a date, a time and a truth value are text, which is no number: programs turn readings into dates;
//! - `#N/A` is a reading that was not taken. Another error such as `#DIV/0!` is an error, as is a formula that
//!   was never calculated;
//! - merged cells have the value of the first in all their rows, such as an incidence that is written once.
//!   In a row, merged cells hold the value in the first column only.
//!
//! Workbooks that are protected by a password, damaged, binary (`.xlsb`) or of Excel 95 and earlier are
//! errors. An archive may unpack to 1 GiB, and its sheets may hold ten million cells.
//!
//! Sources: Office Open XML (ECMA-376) as read by the crate `calamine`; [MS-XLS]; Open Document Format 1.2.
//! `calamine` 0.38 does not end on an `.ods` that is cut off, and fills the memory with an `.xls` whose
//! sectors form a loop or an `.ods` with many repeated cells, so that these two are read here.

#[cfg(feature = "workbook")]
mod archive;
#[cfg(feature = "workbook")]
mod biff;
#[cfg(feature = "workbook")]
mod choice;
#[cfg(feature = "workbook")]
mod number_format;
#[cfg(feature = "workbook")]
mod ods;
#[cfg(feature = "workbook")]
mod sheet;
#[cfg(feature = "workbook")]
mod xls;
#[cfg(feature = "workbook")]
mod xlsx;

#[cfg(feature = "workbook")]
use choice::read;

use super::reader::{Content, Reader};
use crate::scan::Format;

pub(super) const READER: Reader = Reader {
    format: Format::Workbook,
    extensions: &["xlsx", "xlsm", "xls", "ods"],
    recognises: |bytes| Kind::of(bytes).is_some(),
    content: Content::Tables(read),
};

/// The form of a workbook.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Excel since 2007: XML in a zip archive.
    Xlsx,
    /// Excel before 2007: records in a compound file. An encrypted workbook of any version is in one too.
    Xls,
    /// OpenDocument: XML in a zip archive.
    Ods,
}

impl Kind {
    /// The form of a workbook that begins with these bytes; `None` where they are not of a workbook.
    fn of(head: &[u8]) -> Option<Self> {
        if head.starts_with(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1") {
            return Some(Self::Xls);
        }
        // The names of the files in an archive stand before each of them and at its end.
        let has = |name: &[u8]| head.windows(name.len()).any(|window| window == name);
        match () {
            () if !head.starts_with(b"PK\x03\x04") => None,
            () if has(b"opendocument.spreadsheet") => Some(Self::Ods),
            () if has(b"xl/") => Some(Self::Xlsx),
            () => None,
        }
    }
}

/// Without the feature `workbook`, a workbook is called by its name.
#[cfg(not(feature = "workbook"))]
fn read(
    path: &std::path::Path,
    bytes: &[u8],
    _: &super::options::ReadOptions,
) -> super::reader::Read {
    let what = match Kind::of(bytes) {
        Some(Kind::Xlsx) => "is an Excel workbook (.xlsx)",
        Some(Kind::Xls) => "is an Excel workbook (.xls)",
        Some(Kind::Ods) => "is an ODS workbook",
        None => "is not a workbook",
    };
    let message = format!(
        "{what}, which cannot be read without the feature \"workbook\" of brdf-fit: expected readings as a \
         text table (save a sheet as CSV) or in another known format"
    );
    Err(super::error::ReadError::file(path, message))
}

#[cfg(all(test, feature = "workbook"))]
mod tests;

#[cfg(test)]
mod kinds {
    use super::*;

    #[test]
    fn workbooks_are_known_by_their_first_bytes() {
        for (head, kind) in [
            (&b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"[..], Some(Kind::Xls)),
            (
                b"PK\x03\x04....[Content_Types].xml...xl/workbook.xml",
                Some(Kind::Xlsx),
            ),
            (
                b"PK\x03\x04..mimetypeapplication/vnd.oasis.opendocument.spreadsheet",
                Some(Kind::Ods),
            ),
            (
                b"PK\x03\x04....[Content_Types].xml...word/document.xml",
                None,
            ),
            (b"\xd0\xcf", None),
            (b"xl/", None),
        ] {
            assert_eq!(Kind::of(head), kind);
        }
    }
}
