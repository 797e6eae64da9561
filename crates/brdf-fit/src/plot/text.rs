//! Texts that fit into a limited space, which is counted in letters, and short numbers.

const DOTS: &str = "...";

/// A text of at most `longest` letters: the start of a longer one.
pub(super) fn shortened(text: &str, longest: usize) -> String {
    if text.chars().count() <= longest {
        return text.to_owned();
    }
    let start: String = text.chars().take(longest - DOTS.len()).collect();
    start.trim_end().to_owned() + DOTS
}

/// A text of at most `longest` letters: the start and the end of a longer one, where names differ
/// most.
pub(super) fn shortened_in_the_middle(text: &str, longest: usize) -> String {
    let letters: Vec<char> = text.chars().collect();
    if letters.len() <= longest {
        return text.to_owned();
    }
    let end = (longest - DOTS.len()) / 2;
    let start = letters[..longest - DOTS.len() - end].iter();
    let end = letters[letters.len() - end..].iter();
    start
        .copied()
        .chain(DOTS.chars())
        .chain(end.copied())
        .collect()
}

/// The lines of a text, broken between words, each of at most `longest` letters unless a single
/// word is longer.
pub(super) fn wrapped(text: &str, longest: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= longest => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// A number with four significant digits, without trailing zeros where it is not in exponential
/// notation.
pub(super) fn four_digits(value: f64) -> String {
    let scientific = format!("{value:.3e}");
    let rounded: f64 = scientific.parse().unwrap_or(value);
    if rounded == 0.0 || (1e-4..1e5).contains(&rounded.abs()) {
        rounded.to_string()
    } else {
        scientific
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits() {
        assert_eq!(four_digits(0.022_859_8), "0.02286");
        assert_eq!(four_digits(0.0), "0");
        assert_eq!(four_digits(1e-6), "1.000e-6");
        assert_eq!(four_digits(30.0), "30");
        assert_eq!(four_digits(f64::NAN), "NaN");
    }

    #[test]
    fn texts_are_cut_between_letters() {
        let name = "\u{3b1}".repeat(300);
        assert_eq!(shortened(&name, 105).chars().count(), 105);
        assert_eq!(shortened("short", 105), "short");
    }

    #[test]
    fn long_names_keep_their_start_and_their_end() {
        assert_eq!(shortened_in_the_middle("short", 9), "short");
        assert_eq!(
            shortened_in_the_middle("black_paint_cycled", 11),
            "blac...cled"
        );
    }

    #[test]
    fn notes_are_wrapped_between_words() {
        assert_eq!(wrapped("one two three", 7), ["one two", "three"]);
        assert_eq!(wrapped("incomprehensible", 7), ["incomprehensible"]);
        assert!(wrapped("", 7).is_empty());
    }
}
