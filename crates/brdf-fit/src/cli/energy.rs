//! `--energy-conserving 80` as `--energy-conserving=80`.
//!
//! The value of this option is optional. clap would take any word behind the option as its value,
//! even a file, or none at all without an equals sign; here a word is the value if it is a number.

use std::env;
use std::ffi::{OsStr, OsString};
use std::path::Path;

const OPTION: &str = "--energy-conserving";

/// The command line, in which `--energy-conserving` and a number behind it are one word.
pub(super) fn command_line() -> Vec<OsString> {
    joined(env::args_os(), |word| Path::new(word).exists())
}

/// Joins `--energy-conserving` and a following number that is not a file.
fn joined(
    words: impl IntoIterator<Item = OsString>,
    is_file: impl Fn(&OsStr) -> bool,
) -> Vec<OsString> {
    let mut words = words.into_iter().peekable();
    let mut joined = Vec::new();
    while let Some(mut word) = words.next() {
        if word == "--" {
            // Only files follow.
            joined.push(word);
            joined.extend(words);
            break;
        }
        if word == OPTION
            && let Some(value) = words.next_if(|next| is_number(next) && !is_file(next))
        {
            word.push("=");
            word.push(value);
        }
        joined.push(word);
    }
    joined
}

fn is_number(word: &OsStr) -> bool {
    word.to_str()
        .is_some_and(|word| word.parse::<f64>().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_that_is_no_file_is_the_value() {
        for (words, expected) in [
            (
                "fit --energy-conserving 80 a.csv",
                "fit --energy-conserving=80 a.csv",
            ),
            (
                "fit a.csv --energy-conserving 8e1",
                "fit a.csv --energy-conserving=8e1",
            ),
            ("fit --energy-conserving -1", "fit --energy-conserving=-1"),
            (
                "fit --energy-conserving=80 70",
                "fit --energy-conserving=80 70",
            ),
            (
                "fit --energy-conserving a.csv",
                "fit --energy-conserving a.csv",
            ),
            ("fit --energy-conserving -", "fit --energy-conserving -"),
            (
                "fit a.csv --energy-conserving",
                "fit a.csv --energy-conserving",
            ),
            ("fit --energy-conserving 75", "fit --energy-conserving 75"),
            (
                "fit -- --energy-conserving 80",
                "fit -- --energy-conserving 80",
            ),
        ] {
            let words = words.split(' ').map(OsString::from);
            let found = joined(words, |word| word == "75");
            assert_eq!(found.join(OsStr::new(" ")), expected);
        }
    }
}
