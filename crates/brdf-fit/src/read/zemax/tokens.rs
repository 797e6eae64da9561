//! The words of a file, one after the other.

use crate::read::comments::{comment_of, key_and_value};
use crate::read::error::ReadError;
use crate::read::number::Field;
use crate::read::text::{Text, quotable, words};
use crate::scan::Metadata;

/// The words of a file with the numbers of their lines. Comments are read as metadata.
pub(in crate::read) struct Tokens<'a> {
    pub(in crate::read) text: Text<'a>,
    words: std::iter::Peekable<std::vec::IntoIter<(u64, &'a [u8])>>,
    pub(in crate::read) metadata: Metadata,
    /// The line of the last word that was taken.
    line: u64,
}

impl<'a> Tokens<'a> {
    /// # Errors
    ///
    /// A line is too long.
    pub(in crate::read) fn new(text: Text<'a>) -> Result<Self, ReadError> {
        let mut found = Vec::new();
        let mut metadata = Metadata::default();
        for line in text.checked_lines() {
            let (number, line) = line?;
            match comment_of(line) {
                Some(comment) => {
                    let comment = String::from_utf8_lossy(comment);
                    metadata.0.extend(key_and_value(&comment));
                }
                None => found.extend(words(line).map(|word| (number, word))),
            }
        }
        Ok(Self {
            text,
            words: found.into_iter().peekable(),
            metadata,
            line: 0,
        })
    }

    /// The next word, which is not taken.
    pub(in crate::read) fn peek(&mut self) -> Option<&'a [u8]> {
        self.words.peek().map(|(_, word)| *word)
    }

    /// Takes the next word.
    ///
    /// # Errors
    ///
    /// There is none.
    pub(in crate::read) fn next(&mut self, expected: &str) -> Result<&'a [u8], ReadError> {
        match self.words.next() {
            Some((line, word)) => {
                self.line = line;
                Ok(word)
            }
            None => Err(self
                .text
                .error(format!("ends too early: expected {expected}"))),
        }
    }

    /// Takes the next word, which must be `expected`, in upper or lower case.
    ///
    /// # Errors
    ///
    /// It is another.
    pub(in crate::read) fn keyword(&mut self, expected: &'static str) -> Result<(), ReadError> {
        self.choose(&[expected]).map(drop)
    }

    /// Takes the next word, which must be one of `words`, in upper or lower case. Returns its index.
    ///
    /// # Errors
    ///
    /// It is another.
    pub(in crate::read) fn choose(&mut self, words: &[&str]) -> Result<usize, ReadError> {
        let expected = words.join(" or ");
        let word = self.next(&expected)?;
        let found = words
            .iter()
            .position(|known| word.eq_ignore_ascii_case(known.as_bytes()));
        found.ok_or_else(|| self.unexpected(word, &expected))
    }

    /// Takes the next word, which must be a finite number for which `accepts` is true.
    ///
    /// # Errors
    ///
    /// It is not.
    pub(in crate::read) fn number(
        &mut self,
        name: &str,
        expected: &str,
        accepts: fn(f64) -> bool,
    ) -> Result<f64, ReadError> {
        let word = self.next(name)?;
        self.text
            .number(self.line, name, &Field::plain(word), expected, accepts)
    }

    /// Takes the next word, which must be a reading, or say that none was taken.
    ///
    /// # Errors
    ///
    /// As [`Text::reading`].
    pub(super) fn reading(&mut self, name: &str) -> Result<Option<f64>, ReadError> {
        let word = self.next(name)?;
        self.text
            .reading(self.line, name, &Field::plain(word), None)
    }

    /// Takes a count and as many angles in degrees. Memory is allocated for the angles in the file,
    /// not for the count.
    ///
    /// # Errors
    ///
    /// The count is not a positive integer, or an angle is not a number for which `accepts` is true.
    pub(in crate::read) fn angles(
        &mut self,
        name: &'static str,
        accepts: fn(f64) -> bool,
    ) -> Result<Vec<f64>, ReadError> {
        let word = self.next(name)?;
        let count = std::str::from_utf8(word)
            .ok()
            .and_then(|word| word.parse::<u64>().ok());
        let Some(count) = count.filter(|&count| count > 0) else {
            let message = "is not a number of angles: expected 1 or more";
            return Err(self.text.value_error(self.line, name, word, message));
        };
        let mut angles = Vec::new();
        for _ in 0..count {
            angles.push(self.number(name, "expected degrees", accepts)?);
        }
        Ok(angles)
    }

    /// # Errors
    ///
    /// There is another word.
    pub(in crate::read) fn end(&mut self, expected: &str) -> Result<(), ReadError> {
        match self.words.next() {
            None => Ok(()),
            Some((line, word)) => {
                self.line = line;
                Err(self.unexpected(word, expected))
            }
        }
    }

    /// An error at the line of the last word.
    pub(in crate::read) fn error(&self, message: impl Into<String>) -> ReadError {
        self.text.line_error(self.line, message)
    }

    /// The error that the last word is not the expected one.
    pub(in crate::read) fn unexpected(&self, word: &[u8], expected: &str) -> ReadError {
        self.error(format!("\"{}\": expected {expected}", quotable(word)))
    }
}
