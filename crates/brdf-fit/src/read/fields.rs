//! A line of a table, split into its fields.
//!
//! Not by a CSV reader over the whole file: to it a stray quote opens a field that goes on over
//! the following lines, and readings are swallowed without a word. A reading stands on one line,
//! so a quote that its line does not close is an error of that line.

/// Splits a line into `fields`, which is emptied first; quotes around a field are taken off.
///
/// Errors: what is wrong with the quotes.
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

/// Spaces before a field; a tab may be the separator.
fn without_spaces(text: &[u8]) -> &[u8] {
    let spaces = text.iter().take_while(|&&byte| byte == b' ').count();
    &text[spaces..]
}

fn up_to_separator(text: &[u8], separator: u8) -> (&[u8], &[u8]) {
    let end = text.iter().position(|&byte| byte == separator);
    text.split_at(end.unwrap_or(text.len()))
}

/// The text before the quote that closes it, and what follows; two quotes stand for one.
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
    fn fields_stand_between_separators() {
        assert_eq!(fields("1,2,,4", b',').unwrap(), ["1", "2", "", "4"]);
        assert_eq!(fields("1;2,5;", b';').unwrap(), ["1", "2,5", ""]);
        assert_eq!(fields("1\t\t3", b'\t').unwrap(), ["1", "", "3"]);
    }

    #[test]
    fn quotes_keep_separators_in_a_field() {
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
    fn a_quote_that_its_line_does_not_close_is_an_error() {
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
