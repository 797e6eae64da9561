//! The one interface of all readers: the bytes of a file and the options in; a scan with the notes of
//! what was understood out.

use std::path::Path;

use super::error::{ReadError, Remedy};
use super::options::{ReadOptions, SHEET};
use super::text::Text;
use super::{
    astm, black_lab, csv, fred, goniometer, klems, lighttools, merl, open_material, rgl, rt300s,
    speos, ssdd, tracepro, workbook, zemax,
};
use crate::scan::{Format, Measurements};

/// All readers, in the order in which the content of a file is compared with their formats: those
/// whose files carry a mark of the format, then tables, which are known by the form of their lines.
pub(super) const READERS: [Reader; 16] = [
    merl::READER,
    workbook::READER,
    rgl::READER,
    astm::READER,
    black_lab::READER,
    speos::READER,
    lighttools::READER,
    rt300s::READER,
    klems::READER,
    zemax::READER,
    fred::READER,
    open_material::READER,
    tracepro::READER,
    ssdd::READER,
    csv::READER,
    goniometer::READER,
];

/// A scan, or why the file is none.
pub(super) type Read = Result<Measurements, ReadError>;

/// How files in one format are recognised and read.
pub(super) struct Reader {
    pub(super) format: Format,
    /// The usual extensions of the files, without the dot and in lower case.
    pub(super) extensions: &'static [&'static str],
    /// Whether a file with these bytes is in the format; they may be the beginning of the file.
    pub(super) recognises: fn(&[u8]) -> bool,
    /// What the file is given as.
    pub(super) content: Content,
}

/// The function that reads a file, by what it takes.
pub(super) enum Content {
    /// A table as text, of which the options may declare the columns and the comments.
    Table(fn(Text<'_>, &ReadOptions) -> Read),
    /// A text that states its quantities and units itself.
    Text(fn(Text<'_>, &ReadOptions) -> Read),
    /// The bytes of a binary file with tables, of which the options may declare the columns and the
    /// comments.
    Tables(fn(&Path, &[u8], &ReadOptions) -> Read),
    /// The bytes of a file that states its quantities and units itself: binary data, or text whose lines may
    /// be of any length.
    Bytes(fn(&Path, &[u8], &ReadOptions) -> Read),
}

impl Reader {
    /// The reader of a format.
    pub(super) fn of(format: Format) -> &'static Self {
        const ALL: &[Reader] = &READERS;
        let found = ALL.iter().find(|reader| reader.format == format);
        // A test has every format in the list.
        found.unwrap_or(&ALL[ALL.len() - 1])
    }

    /// Whether the files carry a mark of the format.
    pub(super) fn has_mark(&self) -> bool {
        !matches!(self.content, Content::Table(_))
    }

    /// Whether the files are other than text in lines.
    pub(super) fn is_binary(&self) -> bool {
        matches!(self.content, Content::Bytes(_) | Content::Tables(_))
    }

    /// The scan in the bytes of a whole file.
    ///
    /// # Errors
    ///
    /// The file is not a scan in the format, or the options declare what the format states itself.
    pub(super) fn read(&self, path: &Path, bytes: &[u8], options: &ReadOptions) -> Read {
        self.check_options(path, options)?;
        match self.content {
            Content::Table(read) => read(Text::new(path, bytes)?, options),
            Content::Text(read) => {
                read(Text::new(path, bytes)?, options).map_err(|error| match error.remedy() {
                    // Files of these formats have no comment that could be declared.
                    Some(Remedy::Missing) => error.with_remedy(None),
                    _ => error,
                })
            }
            Content::Bytes(read) | Content::Tables(read) => read(path, bytes, options),
        }
    }

    /// # Errors
    ///
    /// The options declare what files of the format do not have: columns, comments or sheets.
    pub(super) fn check_options(
        &self,
        path: &Path,
        options: &ReadOptions,
    ) -> Result<(), ReadError> {
        let sheet = options.declarations.iter().find(|(key, _)| key == SHEET);
        let declared = options.columns.first().or(options.declarations.first());
        let name = self.format.name();
        let (declared, why) = match self.content {
            Content::Tables(_) => (None, String::new()),
            Content::Table(_) => (sheet, format!("files of the format {name} have no sheets")),
            Content::Text(_) | Content::Bytes(_) => {
                let why =
                    format!("the format {name} states its columns, quantities and units itself");
                (declared, why)
            }
        };
        let Some((key, value)) = declared else {
            return Ok(());
        };
        let message = format!("\"{key}={value}\" cannot be declared: {why}");
        Err(ReadError::file(path, message))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_has_its_reader() {
        for (format, _) in Format::NAMED {
            assert_eq!(Reader::of(format).format, format);
        }
        assert_eq!(READERS.len(), Format::NAMED.len());
    }

    #[test]
    fn formats_that_state_everything_take_no_declarations() {
        let options = ReadOptions {
            declarations: vec![("unit".to_owned(), "percent".to_owned())],
            ..ReadOptions::default()
        };
        let states_all =
            |reader: &&Reader| !matches!(reader.content, Content::Table(_) | Content::Tables(_));
        for reader in READERS.iter().filter(states_all) {
            let error = reader.read(Path::new("a"), b"x", &options).unwrap_err();
            let message = error.to_string();
            assert!(
                message.contains("\"unit=percent\" cannot be declared"),
                "{message}"
            );
            assert!(message.contains(reader.format.name()), "{message}");
        }
    }

    #[test]
    fn only_workbooks_have_sheets() {
        let options = ReadOptions {
            declarations: vec![("sheet".to_owned(), "A".to_owned())],
            ..ReadOptions::default()
        };
        let table = b"psi_deg,theta_deg,brdf_per_sr\n10,20,0.1\n";
        for format in [Format::Csv, Format::Goniometer] {
            let error = Reader::of(format).read(Path::new("a"), table, &options);
            let message = error.unwrap_err().to_string();
            assert!(
                message.contains("\"sheet=A\" cannot be declared: files of the format"),
                "{message}"
            );
        }
        assert!(
            Reader::of(Format::Workbook)
                .check_options(Path::new("a"), &options)
                .is_ok()
        );
    }
}
