//! Files of other programs, which are called by their names instead of being misread.

use super::text::lines;

/// How a file begins, what it is, and what to do.
const BINARY: [(&[u8], &str); 11] = [
    (b"PK\x03\x04", "a zip archive"),
    (b"\x89HDF", "an HDF5 file"),
    (b"CDF\x01", "a NetCDF file"),
    (b"MATLAB 5.0", "a MATLAB file"),
    (b"\x93NUMPY", "a NumPy file"),
    (b"\x1f\x8b", "a gzip archive"),
    (b"%PDF", "a PDF file"),
    (b"\x89PNG", "a PNG picture"),
    (b"\xff\xd8\xff", "a JPEG picture"),
    (b"GIF8", "a GIF picture"),
    (b"\x7fELF", "a program"),
];

/// Texts of other programs: how the first line begins, and what the file is.
const TEXT: [(&str, &str); 8] = [
    ("<?xml", "an XML file"),
    ("<!DOCTYPE", "a web page"),
    ("<html", "a web page"),
    (
        "OPTIS - ",
        "an Ansys Speos file that is binary or no table of a BRDF",
    ),
    (
        "Name / Comment :",
        "a text of a Reflet goniophotometer (its .jdv can be read)",
    ),
    ("TracePro", "a TracePro property that is no table of a BSDF"),
    ("{", "a JSON document"),
    ("[{", "a JSON document"),
];

/// What a file is that begins with `head`, and why it cannot be read; `None` where it may be readable.
pub(super) fn foreign(head: &[u8]) -> Option<String> {
    let expected = "expected readings as a text table (save a sheet as CSV) or in a known format";
    let binary = BINARY.iter().find(|(start, _)| head.starts_with(start));
    let what = match binary {
        Some((_, what)) => Some(*what),
        None => text(head),
    };
    what.map(|what| format!("is {what}, which cannot be read: {expected}"))
}

/// What a text of another program is.
fn text(head: &[u8]) -> Option<&'static str> {
    let mut lines = lines(head).map(|(_, line)| line.trim_ascii_start());
    let first = lines.find(|line| !line.is_empty())?;
    let starts = |mark: &str| first.starts_with(mark.as_bytes());
    TEXT.iter()
        .find(|(mark, _)| starts(mark))
        .map(|(_, what)| *what)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_other_programs_are_called_by_their_names() {
        for (head, name) in [
            (&b"PK\x03\x04....[Content_Types].xml"[..], "zip archive"),
            (b"%PDF-1.7", "PDF"),
            (b"<?xml version=\"1.0\"?>\n<lamp>", "XML"),
            (b"OPTIS - Scattering surface file v8.0\n", "Speos"),
            (b"{\n \"header\": {}}", "JSON"),
        ] {
            let message = foreign(head).unwrap();
            assert!(message.contains(name), "{message}");
        }
        for head in [
            "psi_deg,theta_deg,brdf_per_sr\n1,2,3\n",
            "AOI,theta_r,brdf\n1,2,3\n",
            "Source Measured\nSymmetry PlaneSymmetrical\nSpectralContent Monochrome\n",
            "",
        ] {
            assert_eq!(foreign(head.as_bytes()), None, "{head}");
        }
    }
}
