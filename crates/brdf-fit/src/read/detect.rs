//! Which format a file is in: by its content first, by its extension second.

use std::path::Path;

use super::text::{lines, without_mark};
use super::{csv, goniometer, merl};
use crate::scan::Format;

/// How much of a file is looked at, in bytes: a header with its comments is not longer.
pub(super) const HEAD: u64 = 65_536;

impl Format {
    /// The format of a text that begins with these bytes, or of a table that is all of them; `None`
    /// where neither they nor the extension of its name tell.
    pub fn detect(head: &[u8], path: &Path) -> Option<Self> {
        if merl::recognises(head, head.len() as u64) {
            return Some(Self::Merl);
        }
        let end = head.len().min(usize::try_from(HEAD).unwrap_or(usize::MAX));
        by_content(without_mark(&head[..end])).or_else(|| by_extension(path))
    }

    /// The extensions that files of the format have, without the dot.
    pub fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::Csv => &["csv", "tsv"],
            Self::Merl => &["binary"],
            Self::Astm => &["astm"],
            Self::Zemax => &["bsdf"],
            // Their files have the extensions of any text.
            Self::BlackLab | Self::Goniometer => &[],
        }
    }
}

fn by_content(head: &[u8]) -> Option<Format> {
    let mut zemax_lines = 0;
    for (_, line) in lines(head) {
        if csv::is_header(line) {
            return Some(Format::Csv);
        }
        match first_word(line) {
            b"VARS" => return Some(Format::Astm),
            b"src_z" => return Some(Format::BlackLab),
            b"Symmetry" | b"SpectralContent" | b"ScatterType" | b"SampleRotation" => {
                zemax_lines += 1;
            }
            _ => {}
        }
        if zemax_lines == 2 {
            return Some(Format::Zemax);
        }
    }
    goniometer::is_table(head).then_some(Format::Goniometer)
}

fn by_extension(path: &Path) -> Option<Format> {
    let extension = path.extension()?.to_str()?.to_lowercase();
    let formats = Format::NAMED.into_iter().map(|(format, _)| format);
    let mut formats = formats.filter(|&format| format != Format::Csv);
    // What is only called a table is read as one by default, and may be of no known format.
    formats.find(|format| format.extensions().contains(&extension.as_str()))
}

fn first_word(line: &[u8]) -> &[u8] {
    let mut words = line.trim_ascii_start().split(u8::is_ascii_whitespace);
    words.next().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn detected(head: &str, name: &str) -> Option<Format> {
        Format::detect(head.as_bytes(), Path::new(name))
    }

    #[test]
    fn content_goes_before_the_extension() {
        let csv = "# sample: x\npsi_deg,theta_deg,brdf_per_sr\n1,2,3\n";
        assert_eq!(detected(csv, "a.bsdf"), Some(Format::Csv));
        let astm = "LAB_NAME x\nVARS theta_i,phi_i,theta_s,phi_s,BRDF\n";
        assert_eq!(detected(astm, "a.csv"), Some(Format::Astm));
        let zemax = "\u{feff}# x\r\nSource\tMeasured\r\nSymmetry  PlaneSymmetrical\r\nSpectralContent Monochrome\r\n";
        assert_eq!(detected(zemax, "a.txt"), Some(Format::Zemax));
        let black_lab = "BRF Values\nsrc_z\tsrc_a\tview_z\tview_a\t630.79nm\n";
        assert_eq!(detected(black_lab, "a"), Some(Format::BlackLab));
        let table = "# quantity: brdf\ntheta, 10, 30\n-5, 0.1, \n";
        assert_eq!(detected(table, "a.csv"), Some(Format::Goniometer));
    }

    #[test]
    fn the_extension_tells_where_the_content_does_not() {
        assert_eq!(detected("", "a.BSDF"), Some(Format::Zemax));
        assert_eq!(detected("x", "a.astm"), Some(Format::Astm));
        assert_eq!(detected("x", "a.csv"), None);
        assert_eq!(detected("x", "astm"), None);
    }

    #[test]
    fn every_format_is_called_by_its_name() {
        for (format, name) in Format::NAMED {
            assert_eq!(name.parse(), Ok(format));
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
