//! A table of text cells, and its layouts as plain text, HTML and Markdown.

use std::fmt::Write as _;

use crate::format::printable;

/// A table of text cells.
///
/// ```
/// use brdf_fit::report::{Column, Row, Table};
///
/// let table = Table {
///     caption: "Incidences".to_owned(),
///     columns: vec![Column::left("psi deg", 9), Column::right("E %", 8)],
///     rows: vec![Row::new(["30", "1.25"])],
///     notes: vec!["E of each incidence".to_owned()],
/// };
/// assert_eq!(table.markdown(), "| psi deg | E % |\n|---|---:|\n| 30 | 1.25 |\n");
/// assert_eq!(
///     table.text(),
///     "  psi deg       E %\n  30           1.25\n  E of each incidence\n"
/// );
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    /// Caption above the table; only HTML shows it.
    pub caption: String,
    /// The columns.
    pub columns: Vec<Column>,
    /// The rows.
    pub rows: Vec<Row>,
    /// Sentences below the table; Markdown does not show them.
    pub notes: Vec<String>,
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// Its heading.
    pub heading: String,
    /// Its alignment.
    pub alignment: Alignment,
    /// Its minimum width in the text layout, in characters.
    pub width: usize,
}

/// Alignment of the cells of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Alignment {
    /// Flush left, for names and sentences.
    Left,
    /// Flush right, for numbers.
    Right,
}

/// A row of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Row {
    /// Its cells, from the first column on.
    pub cells: Vec<String>,
    /// A remark in place of the remaining cells.
    pub remark: Option<String>,
}

impl Column {
    /// A column with its cells flush left.
    pub fn left(heading: impl Into<String>, width: usize) -> Self {
        Self {
            heading: heading.into(),
            alignment: Alignment::Left,
            width,
        }
    }

    /// A column with its cells flush right.
    pub fn right(heading: impl Into<String>, width: usize) -> Self {
        Self {
            heading: heading.into(),
            alignment: Alignment::Right,
            width,
        }
    }
}

impl Row {
    /// A row of cells.
    pub fn new(cells: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self {
            cells: cells.into_iter().map(Into::into).collect(),
            remark: None,
        }
    }

    /// A row of cells and a remark in place of the remaining ones.
    pub fn with_remark(
        cells: impl IntoIterator<Item = impl Into<String>>,
        remark: impl Into<String>,
    ) -> Self {
        Self {
            remark: Some(remark.into()),
            ..Self::new(cells)
        }
    }

    /// The cells and the remark, followed by empty cells up to a number of columns.
    fn padded(&self, columns: usize) -> impl Iterator<Item = &str> {
        let cells = self.cells.iter().chain(&self.remark).map(String::as_str);
        cells.chain(std::iter::repeat("")).take(columns)
    }
}

impl Table {
    /// The headings, rows and notes as indented lines with aligned columns.
    pub fn text(&self) -> String {
        let headings = Row::new(self.columns.iter().map(|column| column.heading.as_str()));
        let mut text = self.line(&headings);
        for row in &self.rows {
            text += &self.line(row);
        }
        for note in &self.notes {
            let _ = writeln!(text, "  {note}");
        }
        text
    }

    fn line(&self, row: &Row) -> String {
        let mut line = "  ".to_owned();
        let mut after_number = false;
        for (column, cell) in self.columns.iter().zip(&row.cells) {
            let width = column.width;
            let _ = match column.alignment {
                Alignment::Left => write!(line, "{}{cell:<width$}", gap(after_number)),
                // A cell as wide as its column keeps its distance.
                Alignment::Right => write!(line, " {cell:>width$}", width = width - 1),
            };
            after_number = column.alignment == Alignment::Right;
        }
        if let Some(remark) = &row.remark {
            let _ = write!(line, "{}{remark}", gap(after_number));
        }
        line.truncate(line.trim_end().len());
        line.push('\n');
        line
    }

    /// An HTML table below its caption, and a paragraph for each note.
    pub fn html(&self) -> String {
        let mut text = format!(
            "<h3>{}</h3>\n<div class=\"scroll\"><table>\n",
            escaped(&self.caption)
        );
        let headings = self.columns.iter().map(|column| column.heading.as_str());
        text += &self.html_row("th", headings);
        for row in &self.rows {
            text += &self.html_row("td", row.padded(self.columns.len()));
        }
        text += "</table></div>\n";
        for note in &self.notes {
            let _ = writeln!(text, "<p>{}</p>", escaped(note));
        }
        text
    }

    fn html_row<'a>(&self, element: &str, cells: impl Iterator<Item = &'a str>) -> String {
        let mut text = "<tr>".to_owned();
        for (column, cell) in self.columns.iter().zip(cells) {
            let class = match column.alignment {
                Alignment::Left => " class=\"left\"",
                Alignment::Right => "",
            };
            let _ = write!(text, "<{element}{class}>{}</{element}>", escaped(cell));
        }
        text + "</tr>\n"
    }

    /// A Markdown table, without caption and notes.
    pub fn markdown(&self) -> String {
        let mut text = markdown_row(self.columns.iter().map(|column| column.heading.as_str()));
        text.push('|');
        for column in &self.columns {
            text += match column.alignment {
                Alignment::Left => "---|",
                Alignment::Right => "---:|",
            };
        }
        text.push('\n');
        for row in &self.rows {
            text += &markdown_row(row.padded(self.columns.len()));
        }
        text
    }
}

/// The blanks before a cell flush left: numbers end where their column ends.
fn gap(after_number: bool) -> &'static str {
    if after_number { "  " } else { "" }
}

fn markdown_row<'a>(cells: impl Iterator<Item = &'a str>) -> String {
    let cells: Vec<String> = cells.map(|cell| cell.replace('|', "\\|")).collect();
    format!("| {} |\n", cells.join(" | "))
}

/// A text with the characters replaced that are markup in HTML or control the direction of writing.
pub(super) fn escaped(text: &str) -> String {
    printable(text)
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        Table {
            caption: "A & B".to_owned(),
            columns: vec![
                Column::left("", 6),
                Column::right("value", 8),
                Column::left("remark", 0),
            ],
            rows: vec![
                Row::new(["k1", "0.25", "a<b"]),
                Row::new(["k2", "-"]),
                Row::with_remark(["n"], "not determined"),
                Row::with_remark(["p", "1"], "at | bound"),
            ],
            notes: vec!["a note".to_owned()],
        }
    }

    #[test]
    fn text_is_aligned_and_lines_have_no_trailing_blanks() {
        let lines = [
            "           value  remark",
            "  k1        0.25  a<b",
            "  k2           -",
            "  n     not determined",
            "  p            1  at | bound",
            "  a note",
        ];
        assert_eq!(table().text(), lines.join("\n") + "\n");
    }

    #[test]
    fn html_escapes_cells_and_fills_short_rows() {
        let html = table().html();
        assert!(html.starts_with("<h3>A &amp; B</h3>\n<div class=\"scroll\"><table>\n<tr>"));
        assert!(
            html.contains("<td class=\"left\">k1</td><td>0.25</td><td class=\"left\">a&lt;b</td>")
        );
        assert!(html.contains("<td>not determined</td><td class=\"left\"></td></tr>"));
        assert!(html.ends_with("</table></div>\n<p>a note</p>\n"));
        assert_eq!(html.matches("<td").count(), 12);
    }

    #[test]
    fn markdown_marks_numbers_and_escapes_bars() {
        let expected = "|  | value | remark |\n|---|---:|---|\n| k1 | 0.25 | a<b |\n| k2 | - |  |\n\
                        | n | not determined |  |\n| p | 1 | at \\| bound |\n";
        assert_eq!(table().markdown(), expected);
    }
}
