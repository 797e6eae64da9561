//! Files of other programs, which are called by their names instead of being misread.

use super::text::lines;

/// How a file begins, what it is, and what to do.
const BINARY: [(&[u8], &str); 12] = [
    (b"PK\x03\x04", "a zip archive"),
    (b"tensor_file", "an RGL tensor file of a measured BSDF"),
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

/// Texts of other programs: how a line begins, and what the file is.
const TEXT: [(&str, &str); 10] = [
    ("<WindowElement", "an LBNL WINDOW XML file (Klems basis)"),
    ("<?xml", "an XML file"),
    ("<!DOCTYPE", "a web page"),
    ("<html", "a web page"),
    ("OPTIS - ", "an Ansys Speos surface file"),
    ("DataType:\tBRDF(RT", "an export of an RT-300S (.jdv)"),
    ("AOI ", "a LightTools table of a BSDF"),
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

/// What a text of another program is. Of several marks the most telling one is taken: an XML file of a
/// window is one of the window.
fn text(head: &[u8]) -> Option<&'static str> {
    let starts = |mark: &str| {
        let mut lines = lines(head)
            .take(64)
            .map(|(_, line)| line.trim_ascii_start());
        let starts = |line: &[u8]| line.starts_with(mark.as_bytes());
        match mark {
            // These may stand anywhere above the data, the others in the first line alone.
            "AOI " | "<WindowElement" => lines.any(starts),
            _ => lines.find(|line| !line.is_empty()).is_some_and(starts),
        }
    };
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
            (b"tensor_file\0\x01", "RGL"),
            (b"%PDF-1.7", "PDF"),
            (b"<?xml version=\"1.0\"?>\n<WindowElement>", "WINDOW XML"),
            (b"OPTIS - brdf surface file v8.0\n", "Speos"),
            (
                b"# note\nSymmetry Asymmetric\nAOI 10\nPOI 0\n",
                "LightTools",
            ),
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
