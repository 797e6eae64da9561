//! The lines before the rows: comments, and the header that names the columns.

use crate::read::comments::{Comments, comment_of};
use crate::read::error::ReadError;
use crate::read::fields;
use crate::read::text::{Text, quotable};

pub(super) const WAVELENGTH: &str = "wavelength_um";
pub(super) const PSI: &str = "psi_deg";
pub(super) const THETA: &str = "theta_deg";
pub(super) const PHI: &str = "phi_deg";
pub(super) const BRDF: &str = "brdf_per_sr";
pub(super) const SIGMA: &str = "sigma_per_sr";
pub(super) const INDEX: &str = "n";
const KNOWN: [&str; 7] = [WAVELENGTH, PSI, THETA, PHI, BRDF, SIGMA, INDEX];
const REQUIRED: [&str; 3] = [PSI, THETA, BRDF];

/// Whether a line names the columns. Some programs write the header behind a `#`.
pub(in crate::read) fn is_header(line: &[u8]) -> bool {
    names_the_columns(comment_of(line).unwrap_or(line))
}

fn names_the_columns(text: &[u8]) -> bool {
    let text = String::from_utf8_lossy(text).to_lowercase();
    REQUIRED.iter().all(|name| text.contains(name))
}

/// The comments and the header of a table.
pub(super) struct Preamble<'a> {
    pub(super) comments: Comments,
    pub(super) header: Header<'a>,
    /// The number of lines after the header, and so the largest possible number of readings.
    pub(super) lines_after: usize,
}

impl<'a> Preamble<'a> {
    /// Looks at each line of the text once: comments may also follow the header.
    ///
    /// # Errors
    ///
    /// A line is too long, a comment is not valid, or there is no header.
    pub(super) fn read(text: &Text<'a>) -> Result<Self, ReadError> {
        let mut comments = Comments::default();
        let mut header = None;
        let mut lines_after = 0;
        for (number, line) in text.lines() {
            text.check_length(number, line)?;
            match comment_of(line) {
                Some(comment) if header.is_none() && names_the_columns(comment) => {
                    header = Some(Header::new(number, comment));
                }
                Some(comment) => comments.add(text, number, comment)?,
                None if header.is_some() => lines_after += 1,
                None if line.trim_ascii().is_empty() || line.starts_with(b"sep=") => {}
                None => header = Some(Header::new(number, line)),
            }
        }
        let header = header.ok_or_else(|| {
            text.error("has no header: expected a line with psi_deg, theta_deg and brdf_per_sr")
        })?;
        Ok(Self {
            comments,
            header,
            lines_after,
        })
    }
}

/// The line that names the columns.
pub(super) struct Header<'a> {
    /// The number of the line, counted from 1.
    pub(super) number: u64,
    /// The text without a leading `#`.
    line: &'a [u8],
    pub(super) separator: u8,
}

impl<'a> Header<'a> {
    fn new(number: u64, line: &'a [u8]) -> Self {
        Self {
            number,
            line,
            separator: separator_of(line),
        }
    }

    /// The columns that the header names.
    ///
    /// # Errors
    ///
    /// A required column is missing, a known column is given twice, or a quote is not closed.
    pub(super) fn columns(&self, text: &Text<'_>) -> Result<Columns, ReadError> {
        let mut fields = Vec::new();
        fields::split(self.line, self.separator, &mut fields)
            .map_err(str::to_owned)
            .and_then(|()| Columns::find(&fields))
            .map_err(|message| text.line_error(self.number, message))
    }
}

/// The separator that gives the most known columns; a comma where several give as many.
fn separator_of(header: &[u8]) -> u8 {
    let known = |separator: u8| {
        let fields = header.split(move |&byte| byte == separator);
        fields
            .filter(|field| KNOWN.contains(&column_name(field).as_str()))
            .count()
    };
    let separators = *b"\t;,";
    separators
        .into_iter()
        .max_by_key(|&separator| known(separator))
        .unwrap_or(b',')
}

/// The name of a column in lower case, without quotes.
fn column_name(field: &[u8]) -> String {
    let name = String::from_utf8_lossy(field);
    name.trim_matches(|c: char| c.is_ascii_whitespace() || c == '"')
        .to_lowercase()
}

/// The position of each quantity in a row.
pub(super) struct Columns {
    pub(super) count: usize,
    pub(super) psi: usize,
    pub(super) theta: usize,
    pub(super) brdf: usize,
    pub(super) wavelength: Option<usize>,
    pub(super) phi: Option<usize>,
    pub(super) sigma: Option<usize>,
    pub(super) n: Option<usize>,
    /// The names of the columns that are not read.
    pub(super) ignored: Vec<String>,
}

impl Columns {
    fn find(header: &[&[u8]]) -> Result<Self, String> {
        let names: Vec<String> = header.iter().map(|field| column_name(field)).collect();
        let twice = |name: &&&str| names.iter().filter(|other| other == *name).count() > 1;
        if let Some(name) = KNOWN.iter().find(twice) {
            return Err(format!("column {name} is given twice"));
        }
        let position = |name: &str| names.iter().position(|n| n == name);
        let missing: Vec<&str> = REQUIRED
            .into_iter()
            .filter(|name| position(name).is_none())
            .collect();
        let (Some(psi), Some(theta), Some(brdf)) = (position(PSI), position(THETA), position(BRDF))
        else {
            return Err(format!(
                "missing column {}: expected a header with psi_deg, theta_deg and brdf_per_sr, found \"{}\"",
                missing.join(" and "),
                quotable(names.join(", ").as_bytes()),
            ));
        };
        Ok(Self {
            count: names.len(),
            psi,
            theta,
            brdf,
            wavelength: position(WAVELENGTH),
            phi: position(PHI),
            sigma: position(SIGMA),
            n: position(INDEX),
            ignored: names
                .iter()
                .filter(|name| !name.is_empty() && !KNOWN.contains(&name.as_str()))
                .cloned()
                .collect(),
        })
    }
}
