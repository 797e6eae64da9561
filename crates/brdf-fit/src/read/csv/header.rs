//! The lines before the rows: comments, lines of free text, and the header that names the columns.

use super::roles::{Roles, Rows};
use crate::read::comments::{Comments, comment_of};
use crate::read::error::{ReadError, Remedy};
use crate::read::fields::Separator;
use crate::read::names::Role;
use crate::read::options::ReadOptions;
use crate::read::text::{Text, quotable};

/// How many lines are searched for the header.
const SEARCHED_LINES: usize = 200;

/// The names of the columns as the project writes them.
const OWN_NAMES: [&str; 7] = [
    "wavelength_um",
    "psi_deg",
    "theta_deg",
    "phi_deg",
    "brdf_per_sr",
    "sigma_per_sr",
    "n",
];

/// Whether a line names the columns of a table. Some programs write the header behind a `#`.
pub(super) fn is_header(line: &[u8], renamed: &[(String, String)]) -> bool {
    let comment = comment_of(line);
    let (line, needs_psi) = match comment.and_then(after_format) {
        Some(names) => (names, false),
        None => (comment.unwrap_or(line), true),
    };
    // Lines of numbers are not looked at closely.
    let is_letter = |byte: &&u8| !byte.is_ascii() || byte.is_ascii_alphabetic();
    if line.iter().filter(is_letter).take(6).count() < 6 {
        return false;
    }
    let needs = Needs {
        psi: needs_psi,
        reading: true,
    };
    header_of(line, renamed).is_some_and(|(_, columns)| is_complete(&columns, needs))
}

/// The names of the columns in a comment `format: theta phi DSF`.
fn after_format(comment: &[u8]) -> Option<&[u8]> {
    comment.trim_ascii_start().strip_prefix(b"format:")
}

/// The columns of a line and their separator, with the separator that gives the most columns with a
/// role; `None` where no column has one.
fn header_of(line: &[u8], renamed: &[(String, String)]) -> Option<(Separator, Vec<Column>)> {
    let split = |separator: Separator| {
        let mut fields = Vec::new();
        separator.split(line, &mut fields).ok()?;
        let columns: Vec<Column> = fields
            .iter()
            .map(|name| Column::new(name, renamed))
            .collect();
        let known = columns
            .iter()
            .filter(|column| column.role.is_some())
            .count();
        (known > 0).then_some((known, separator, columns))
    };
    let found = Separator::ALL.into_iter().filter_map(split);
    // Of separators that give as many, the first one is taken.
    let best = found.rev().max_by_key(|(known, ..)| *known);
    best.map(|(_, separator, columns)| (separator, columns))
}

/// What a header must name beside the view angle.
#[derive(Clone, Copy)]
struct Needs {
    /// The incidence angle, which may also stand in a comment.
    psi: bool,
    reading: bool,
}

/// Whether the columns have angles and a reading, as far as these are needed.
fn is_complete(columns: &[Column], needs: Needs) -> bool {
    let has = |wanted: fn(&Role) -> bool| {
        let mut roles = columns.iter().filter_map(|column| column.role.as_ref());
        roles.any(wanted)
    };
    let zeniths = |role: &&Column| {
        matches!(
            role.role,
            Some(Role::Psi(_) | Role::Theta(_) | Role::ThetaS(_))
        )
    };
    let zeniths = columns.iter().filter(zeniths).count();
    let reading = has(|role| {
        matches!(
            role,
            Role::Value(_) | Role::Channel(_) | Role::Polarised(..)
        )
    }) || has(|role| *role == Role::Signal) && has(|role| *role == Role::Reference);
    (reading || !needs.reading) && zeniths >= if needs.psi { 2 } else { 1 }
}

/// A column by its header.
#[derive(Debug, Clone)]
pub(super) struct Column {
    /// The name as messages quote it.
    pub(super) name: String,
    pub(super) role: Option<Role>,
    renamed: bool,
}

impl Column {
    fn new(field: &[u8], renamed: &[(String, String)]) -> Self {
        let name = String::from_utf8_lossy(field);
        let name = name.trim_matches(|c: char| c.is_whitespace() || c == '"');
        let other = renamed
            .iter()
            .find(|(from, _)| from.trim().eq_ignore_ascii_case(name));
        let role = Role::named(other.map_or(name, |(_, to)| to));
        Self {
            name: quotable(name.as_bytes()),
            role,
            renamed: other.is_some(),
        }
    }
}

/// The comments and the header of a table.
pub(super) struct Preamble {
    pub(super) comments: Comments,
    pub(super) header: Header,
    /// The number of lines after the header, and so the largest possible number of readings.
    pub(super) lines_after: usize,
    /// The lines of free text before the header.
    pub(super) skipped: usize,
}

impl Preamble {
    /// Looks at each line of the text once: comments may also follow the header.
    ///
    /// # Errors
    ///
    /// A line is too long, a comment is not valid, or there is no header.
    pub(super) fn read(
        text: &Text<'_>,
        rows: Rows,
        options: &ReadOptions,
    ) -> Result<Self, ReadError> {
        let mut comments = Comments::declared(text, &options.declarations)?;
        let mut search = Search::default();
        let mut lines_after = 0;
        for (number, line) in text.lines() {
            text.check_length(number, line)?;
            let comment = comment_of(line);
            if search.header.is_none() {
                let names = comment.and_then(after_format);
                let candidate = Candidate {
                    number,
                    line: names.or(comment).unwrap_or(line),
                    is_comment: comment.is_some(),
                    // A sentence in a comment may contain other names.
                    needs: Needs {
                        psi: comment.is_some() && names.is_none(),
                        reading: rows == Rows::Readings,
                    },
                };
                search.take(&candidate, &options.columns);
                if search.header.is_some() {
                    continue;
                }
            }
            match comment {
                Some(comment) => comments.add(text, number, comment)?,
                None => lines_after += usize::from(search.header.is_some()),
            }
        }
        let Search {
            header,
            skipped,
            best,
        } = search;
        let Some(header) = header else {
            return Err(no_header(text, best.as_ref(), rows));
        };
        header.check_names(text, &options.columns)?;
        Ok(Self {
            comments,
            header,
            lines_after,
            skipped,
        })
    }
}

/// A line that may be the header.
struct Candidate<'a> {
    number: u64,
    /// The text without a leading `#` and `format:`.
    line: &'a [u8],
    is_comment: bool,
    needs: Needs,
}

/// The search for the header.
#[derive(Default)]
struct Search {
    header: Option<Header>,
    /// The lines of text before the header.
    skipped: usize,
    /// The line with the most columns that have a role.
    best: Option<Header>,
}

impl Search {
    fn take(&mut self, candidate: &Candidate<'_>, renamed: &[(String, String)]) {
        let &Candidate {
            number,
            line,
            is_comment,
            needs,
        } = candidate;
        if line.trim_ascii().is_empty()
            || line.starts_with(b"sep=")
            || self.skipped > SEARCHED_LINES
        {
            return;
        }
        let found = header_of(line, renamed).map(|(separator, columns)| Header {
            number,
            separator,
            columns,
        });
        match found {
            // A sentence may contain the names of columns, but a header has nothing else.
            Some(header) if is_complete(&header.columns, needs) => {
                self.header = Some(header);
                return;
            }
            Some(header) if !is_comment => {
                let more = |best: &Header| header.known() > best.known();
                if self.best.as_ref().is_none_or(more) {
                    self.best = Some(header);
                }
            }
            _ => {}
        }
        self.skipped += usize::from(!is_comment);
    }
}

/// The error of a text without a header: what was understood of the line that is nearest to one.
fn no_header(text: &Text<'_>, best: Option<&Header>, rows: Rows) -> ReadError {
    let names = if rows == Rows::Angles {
        "psi_deg and theta_deg"
    } else {
        "psi_deg, theta_deg and brdf_per_sr"
    };
    let expected = format!("expected a line that names the columns, such as {names}");
    let Some(header) = best else {
        let mut lines = text.lines().map(|(_, line)| line);
        let first = lines.find(|line| comment_of(line).is_none() && !line.trim_ascii().is_empty());
        let found = first.map_or_else(String::new, |line| {
            format!(", found \"{}\"", quotable(line))
        });
        return text.error(format!("has no header: {expected}{found}"));
    };
    let mut missing = header.missing();
    missing.truncate(if rows == Rows::Angles {
        1
    } else {
        missing.len()
    });
    let missing = missing.join(" and ");
    header.unclear(text, &format!("no column for {missing}:"))
}

/// The line that names the columns.
#[derive(Debug, Clone)]
pub(super) struct Header {
    /// The number of the line, counted from 1.
    pub(super) number: u64,
    pub(super) separator: Separator,
    pub(super) columns: Vec<Column>,
}

impl Header {
    fn known(&self) -> usize {
        self.columns
            .iter()
            .filter(|column| column.role.is_some())
            .count()
    }

    /// What is missing of a table of readings, in words.
    fn missing(&self) -> Vec<&'static str> {
        let has = |wanted: fn(&Role) -> bool| {
            self.columns
                .iter()
                .filter_map(|c| c.role.as_ref())
                .any(wanted)
        };
        let wanted = [
            (
                "the incidence angle (psi_deg)",
                has(|role| matches!(role, Role::Psi(_) | Role::ThetaS(_))),
            ),
            (
                "the view angle (theta_deg)",
                has(|role| matches!(role, Role::Theta(_) | Role::ThetaS(_))),
            ),
            (
                "the reading (brdf_per_sr)",
                has(|role| {
                    matches!(
                        role,
                        Role::Value(_) | Role::Channel(_) | Role::Polarised(..) | Role::Signal
                    )
                }),
            ),
        ];
        wanted
            .into_iter()
            .filter(|(_, has)| !has)
            .map(|(name, _)| name)
            .collect()
    }

    /// The error that the columns do not say what is needed: the problem, and what was understood of
    /// each column.
    pub(super) fn unclear(&self, text: &Text<'_>, problem: &str) -> ReadError {
        let message = format!("{problem} {}", self.understood());
        let error = text.line_error(self.number, message);
        error.with_remedy(Some(Remedy::Columns))
    }

    /// What was understood of each column, and how to say what it is.
    fn understood(&self) -> String {
        let column = |column: &Column| match column.role {
            Some(role) => format!("\"{}\" is {}", column.name, role.in_words()),
            None => format!("\"{}\" is not known", column.name),
        };
        let columns: Vec<String> = self.columns.iter().take(12).map(column).collect();
        let example = self.columns.iter().find(|column| column.role.is_none());
        let example = example.map_or("R", |column| column.name.as_str());
        let role = match self.missing().first() {
            Some(missing) if missing.contains("psi_deg") => "psi_deg",
            Some(missing) if missing.contains("theta_deg") => "theta_deg",
            _ => "reflectance_factor_percent",
        };
        format!(
            "{}; say what a column is by its name, or in the options of the reading, as in \
             \"{example}={role}\"",
            columns.join(", ")
        )
    }

    /// # Errors
    ///
    /// The options name a column that the header does not have.
    fn check_names(&self, text: &Text<'_>, renamed: &[(String, String)]) -> Result<(), ReadError> {
        for (name, role) in renamed {
            if Role::named(role).is_none() {
                let message = format!(
                    "the role \"{role}\" of the column \"{name}\" is not known: expected one such as \
                     psi_deg, theta_rad, brdf_per_sr, reflectance_factor_percent, wavelength_nm or ignore"
                );
                return Err(text.line_error(self.number, message));
            }
            if !self
                .columns
                .iter()
                .any(|column| column.name.eq_ignore_ascii_case(name.trim()))
            {
                let names: Vec<_> = self
                    .columns
                    .iter()
                    .map(|column| column.name.as_str())
                    .collect();
                let message = format!("no column \"{name}\": the columns are {}", names.join(", "));
                return Err(text.line_error(self.number, message));
            }
        }
        Ok(())
    }

    /// The sentence that reports the columns whose names are not the project's own; `None` where there is
    /// none.
    pub(super) fn sentence(&self) -> Option<String> {
        let foreign = self.columns.iter().filter(|column| {
            let own = OWN_NAMES
                .iter()
                .any(|own| column.name.eq_ignore_ascii_case(own));
            column
                .role
                .is_some_and(|role| !matches!(role, Role::Channel(_) | Role::Label))
                && (!own || column.renamed)
        });
        let words: Vec<String> = foreign
            .filter_map(|column| {
                Some(format!(
                    "{} is the {}",
                    column.name,
                    column.role?.in_words()
                ))
            })
            .map(|sentence| {
                sentence
                    .replace("is the the ", "is the ")
                    .replace("is the f_r", "is f_r")
            })
            .collect();
        (!words.is_empty()).then(|| words.join(", "))
    }

    /// The names of the columns that are not used.
    pub(super) fn names_without_use(&self) -> Vec<String> {
        let unused = |column: &&Column| matches!(column.role, None | Some(Role::Label));
        let unused = self.columns.iter().filter(unused);
        unused
            .map(|column| column.name.to_lowercase())
            .filter(|name| !name.is_empty())
            .collect()
    }

    /// # Errors
    ///
    /// Two columns have one role, or a role is missing.
    pub(super) fn roles(&self, text: &Text<'_>, rows: Rows) -> Result<Roles, ReadError> {
        Roles::of(&self.columns, rows).map_err(|message| text.line_error(self.number, message))
    }
}
