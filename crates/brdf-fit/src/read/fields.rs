//! Splitting the line of a table into its fields.
//!
//! Lines are split one at a time instead of by a CSV reader of the whole file. There, a stray quote
//! would open a field that extends over the following lines, whose readings would be lost without a
//! warning. Each reading is on one line, so that a quote that is not closed on its line is an error.

/// The separator of the fields of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Separator {
    Byte(u8),
    /// Any number of spaces and tabs.
    Spaces,
}

impl Separator {
    /// All separators, those that are seldom part of a field first.
    pub(super) const ALL: [Self; 4] = [
        Self::Byte(b'\t'),
        Self::Byte(b';'),
        Self::Byte(b','),
        Self::Spaces,
    ];

    /// Splits a line into `fields`, whose previous content is dropped.
    ///
    /// # Errors
    ///
    /// As [`split`].
    pub(super) fn split<'a>(
        self,
        line: &'a [u8],
        fields: &mut Vec<&'a [u8]>,
    ) -> Result<(), &'static str> {
        match self {
            Self::Byte(byte) => split(line, byte, fields),
            Self::Spaces => {
                fields.clear();
                let words = line.split(u8::is_ascii_whitespace);
                fields.extend(words.filter(|word| !word.is_empty()));
                Ok(())
            }
        }
    }
}

/// Splits a line into `fields`, whose previous content is dropped. Quotes around a field are removed.
///
/// # Errors
///
/// A quote is not closed, or text follows a closing quote.
pub(super) fn split<'a>(
    line: &'a [u8],
    separator: u8,
    fields: &mut Vec<&'a [u8]>,
) -> Result<(), &'static str> {
    fields.clear();
    if !line.contains(&b'"') {
        fields.extend(line.split(|&byte| byte == separator));
        return Ok(());
    }
    let mut rest = line;
    loop {
        let (field, behind) = match without_spaces(rest).strip_prefix(b"\"") {
            Some(quoted) => up_to_closing_quote(quoted)?,
            None => up_to_separator(rest, separator),
        };
        fields.push(field);
        match without_spaces(behind).split_first() {
            None => return Ok(()),
            Some((&byte, next)) if byte == separator => rest = next,
            Some(_) => return Err("text follows a closing quote: expected a separator"),
        }
    }
}

/// The text without leading spaces. Tabs are kept: they may be the separator.
fn without_spaces(text: &[u8]) -> &[u8] {
    let spaces = text.iter().take_while(|&&byte| byte == b' ').count();
    &text[spaces..]
}

fn up_to_separator(text: &[u8], separator: u8) -> (&[u8], &[u8]) {
    let end = text.iter().position(|&byte| byte == separator);
    text.split_at(end.unwrap_or(text.len()))
}

/// The text before the closing quote and the text after it. Two quotes in a row are a quote within the
/// field, not its end.
fn up_to_closing_quote(text: &[u8]) -> Result<(&[u8], &[u8]), &'static str> {
    let mut i = 0;
    while i < text.len() {
        match (text[i], text.get(i + 1)) {
            (b'"', Some(b'"')) => i += 2,
            (b'"', _) => return Ok((&text[..i], &text[i + 1..])),
            _ => i += 1,
        }
    }
    Err("a quote is not closed on its line")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fields(line: &str, separator: u8) -> Result<Vec<String>, &'static str> {
        let mut fields = Vec::new();
        split(line.as_bytes(), separator, &mut fields)?;
        Ok(fields
            .iter()
            .map(|f| String::from_utf8_lossy(f).into_owned())
            .collect())
    }

    #[test]
    fn fields_are_the_texts_between_separators() {
        assert_eq!(fields("1,2,,4", b',').unwrap(), ["1", "2", "", "4"]);
        assert_eq!(fields("1;2,5;", b';').unwrap(), ["1", "2,5", ""]);
        assert_eq!(fields("1\t\t3", b'\t').unwrap(), ["1", "", "3"]);
    }

    #[test]
    fn separators_within_quotes_are_part_of_the_field() {
        assert_eq!(
            fields("\"0,5\", \"b\" ,c", b',').unwrap(),
            ["0,5", "b", "c"]
        );
        assert_eq!(
            fields("a,\"say \"\"x\"\"\",b", b',').unwrap(),
            ["a", "say \"\"x\"\"", "b"]
        );
        assert_eq!(
            fields("1,5\" pipe,\"\"", b',').unwrap(),
            ["1", "5\" pipe", ""]
        );
    }

    #[test]
    fn a_quote_that_is_not_closed_on_its_line_is_an_error() {
        assert!(
            fields("1,2,\"5 inch", b',')
                .unwrap_err()
                .contains("not closed")
        );
        assert!(
            fields("1,\"2\"3,4", b',')
                .unwrap_err()
                .contains("closing quote")
        );
    }
}
