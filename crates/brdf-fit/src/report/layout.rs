//! Lines of text behind a label, wrapped to the width of a report.

use std::fmt::Write as _;

/// The width of the text, in characters.
const WIDTH: usize = 100;

/// The width of a label and the indent of what it labels.
const INDENT: usize = 12;

/// A sentence behind a label, wrapped to the width of the text.
pub(super) fn labelled(label: &str, sentence: &str) -> String {
    let label = format!("  {label:<width$}", width = INDENT - 2);
    let text = wrapped(&label, sentence, INDENT);
    if sentence.is_empty() {
        String::new()
    } else {
        text
    }
}

/// A line that begins with a label, wrapped at blanks to the width of the text; what follows is
/// indented.
pub(super) fn wrapped(label: &str, sentence: &str, indent: usize) -> String {
    let mut text = label.to_owned();
    let mut column = label.chars().count();
    for (i, word) in sentence.split(' ').enumerate() {
        let length = word.chars().count();
        if i > 0 && column + 1 + length > WIDTH {
            let _ = write!(text, "\n{:indent$}", "");
            column = indent;
        } else if i > 0 {
            text.push(' ');
            column += 1;
        }
        text += word;
        column += length;
    }
    text.push('\n');
    text
}
