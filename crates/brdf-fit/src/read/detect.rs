//! Detection of a file's format: by the content, then by the extension.

use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;

use super::merl;
use super::options::ReadOptions;
use super::reader::{READERS, Reader};
use super::text::HEAD;
use crate::scan::Format;

impl Format {
    /// Detects the format of a text that begins with `head`, or of a binary file that `head` is the
    /// whole of; `None` where neither the content nor the extension of `path` is that of a known
    /// format. The content takes precedence.
    pub fn detect(head: &[u8], path: &Path) -> Option<Self> {
        by_content(head).or_else(|| by_extension(path))
    }

    /// The usual extensions of files in the format, without the dot.
    pub fn extensions(self) -> &'static [&'static str] {
        Reader::of(self).extensions
    }
}

/// The reader of a format whose mark a file carries.
pub(super) fn by_mark(head: &[u8]) -> Option<&'static Reader> {
    const MARKED: &[Reader] = &READERS;
    let mut marked = MARKED.iter().filter(|reader| reader.has_mark());
    marked.find(|reader| (reader.recognises)(head))
}

/// Whether a file is read as a MERL table, channel by channel: by the format in the options, by its
/// content or by its extension.
///
/// Only regular files are: a pipe cannot be read a second time after the detection.
pub(super) fn is_merl_file(path: &Path, options: &ReadOptions) -> bool {
    let is_file = path.metadata().is_ok_and(|metadata| metadata.is_file());
    is_file
        && match options.format {
            Some(format) => format == Format::Merl,
            None => is_detected_as_merl(path).unwrap_or(false),
        }
}

fn is_detected_as_merl(path: &Path) -> io::Result<bool> {
    let file = File::open(path)?;
    let size = file.metadata()?.len();
    let mut head = Vec::new();
    file.take(HEAD as u64).read_to_end(&mut head)?;
    Ok(merl::is_table(&head, size) || Format::detect(&head, path) == Some(Format::Merl))
}

fn by_content(head: &[u8]) -> Option<Format> {
    let found = READERS.iter().find(|reader| (reader.recognises)(head));
    found.map(|reader| reader.format)
}

fn by_extension(path: &Path) -> Option<Format> {
    let extension = path.extension()?.to_str()?.to_lowercase();
    let formats = Format::NAMED.into_iter().map(|(format, _)| format);
    let mut formats = formats.filter(|&format| format != Format::Csv);
    // CSV is the default: an extension such as .csv does not show that the format is known.
    formats.find(|format| format.extensions().contains(&extension.as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn detected(head: &str, name: &str) -> Option<Format> {
        Format::detect(head.as_bytes(), Path::new(name))
    }

    #[test]
    fn the_content_takes_precedence_over_the_extension() {
        let csv = "# sample: x\npsi_deg,theta_deg,brdf_per_sr\n1,2,3\n";
        assert_eq!(detected(csv, "a.bsdf"), Some(Format::Csv));
        let astm = "LAB_NAME x\nVARS theta_i,phi_i,theta_s,phi_s,BRDF\n";
        assert_eq!(detected(astm, "a.csv"), Some(Format::Astm));
        let commented = format!("# theta_i, theta_s, BRDF\n{astm}");
        assert_eq!(detected(&commented, "a.txt"), Some(Format::Astm));
        let zemax = "\u{feff}# x\r\nSource\tMeasured\r\nSymmetry  PlaneSymmetrical\r\nSpectralContent Monochrome\r\n";
        assert_eq!(detected(zemax, "a.txt"), Some(Format::Zemax));
        let black_lab = "BRF Values\nsrc_z\tsrc_a\tview_z\tview_a\t630.79nm\n";
        assert_eq!(detected(black_lab, "a"), Some(Format::BlackLab));
        let table = "# quantity: brdf\ntheta, 10, 30\n-5, 0.1, \n";
        assert_eq!(detected(table, "a.csv"), Some(Format::Goniometer));
    }

    #[test]
    fn a_file_has_the_mark_of_one_format_at_most() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/formats");
        for entry in std::fs::read_dir(folder).into_iter().flatten() {
            let path = entry.unwrap().path();
            let bytes = std::fs::read(&path).unwrap();
            let marked = READERS.iter().filter(|reader| reader.has_mark());
            let marked = marked.filter(|reader| (reader.recognises)(&bytes));
            assert!(marked.count() <= 1, "{}", path.display());
        }
    }

    #[test]
    fn the_extension_decides_where_the_content_does_not() {
        assert_eq!(detected("", "a.BSDF"), Some(Format::Zemax));
        assert_eq!(detected("x", "a.astm"), Some(Format::Astm));
        assert_eq!(detected("x", "a.csv"), None);
        assert_eq!(detected("x", "astm"), None);
    }

    #[test]
    fn every_format_has_a_name_that_parses() {
        for (format, name) in Format::NAMED {
            assert_eq!(name.parse::<Format>().unwrap(), format);
            assert_eq!(format.name(), name);
        }
        let error = "x".parse::<Format>().unwrap_err();
        assert!(
            error
                .to_string()
                .contains("expected one of csv, merl, astm, "),
            "{error}"
        );
    }
}
