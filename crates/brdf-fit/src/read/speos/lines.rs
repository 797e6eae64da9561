//! The lines of a file, one after the other.

use crate::read::error::ReadError;
use crate::read::number::Field;
use crate::read::text::{Text, quotable, words};

type Numbered<'a> = Result<(u64, &'a [u8]), ReadError>;

/// The lines of a file, with the number of the last one that was taken.
pub(super) struct Lines<'a> {
    pub(super) text: Text<'a>,
    rest: Box<dyn Iterator<Item = Numbered<'a>> + 'a>,
    pub(super) number: u64,
}

impl<'a> Lines<'a> {
    pub(super) fn new(text: Text<'a>) -> Self {
        Self {
            text,
            rest: Box::new(text.checked_lines()),
            number: 0,
        }
    }

    /// Takes the next line, which may be empty.
    ///
    /// # Errors
    ///
    /// There is none, or it is too long.
    pub(super) fn any(&mut self, expected: &str) -> Result<&'a [u8], ReadError> {
        match self.rest.next().transpose()? {
            Some((number, line)) => {
                self.number = number;
                Ok(line)
            }
            None => Err(self
                .text
                .error(format!("ends too early: expected {expected}"))),
        }
    }

    /// Takes the words of the next line that has any.
    ///
    /// # Errors
    ///
    /// There is none.
    pub(super) fn words(&mut self, expected: &str) -> Result<Vec<&'a [u8]>, ReadError> {
        loop {
            let found: Vec<&[u8]> = words(self.any(expected)?).collect();
            if !found.is_empty() {
                return Ok(found);
            }
        }
    }

    /// Takes a line of `count` words.
    ///
    /// # Errors
    ///
    /// The next line has another number of words.
    pub(super) fn counted_words(
        &mut self,
        count: usize,
        what: &str,
    ) -> Result<Vec<&'a [u8]>, ReadError> {
        let found = self.words(what)?;
        if found.len() == count {
            return Ok(found);
        }
        let message = format!("{} fields: expected {count}, {what}", found.len());
        Err(self.error(message))
    }

    /// Takes a line of `count` numbers for which `accepts` is true.
    ///
    /// # Errors
    ///
    /// The next line is another.
    pub(super) fn numbers(
        &mut self,
        count: usize,
        what: &str,
        accepts: fn(f64) -> bool,
    ) -> Result<Vec<f64>, ReadError> {
        let found = self.counted_words(count, what)?;
        let number = |word: &&[u8]| self.number_in(word, what, accepts);
        found.iter().map(number).collect()
    }

    /// Takes a line with two counts, each 1 or more.
    ///
    /// # Errors
    ///
    /// The next line is another.
    pub(super) fn two_counts(&mut self, what: &str) -> Result<(usize, usize), ReadError> {
        let found = self.counted_words(2, what)?;
        let mut counts = found.iter().map(|word| self.count_in(word, what));
        let mut next = || counts.next().unwrap_or(Ok(0));
        Ok((next()?, next()?))
    }

    /// Takes a line with a count, 1 or more.
    ///
    /// # Errors
    ///
    /// The next line is another.
    pub(super) fn count(&mut self, what: &str) -> Result<usize, ReadError> {
        let found = self.counted_words(1, what)?;
        found
            .first()
            .map_or(Ok(0), |word| self.count_in(word, what))
    }

    /// Takes a line with `count` flags, 0 or 1.
    ///
    /// # Errors
    ///
    /// The next line is another.
    pub(super) fn flags(&mut self, count: usize, what: &str) -> Result<Vec<bool>, ReadError> {
        let found = self.counted_words(count, what)?;
        let flag = |word: &&[u8]| match *word {
            b"0" => Ok(false),
            b"1" => Ok(true),
            _ => Err(self.error(format!("\"{}\": expected 0 or 1, {what}", quotable(word)))),
        };
        found.iter().map(flag).collect()
    }

    pub(super) fn number_in(
        &self,
        word: &[u8],
        what: &str,
        accepts: fn(f64) -> bool,
    ) -> Result<f64, ReadError> {
        let expected = format!("expected {what}");
        let field = Field::plain(word);
        self.text
            .number(self.number, what, &field, &expected, accepts)
    }

    fn count_in(&self, word: &[u8], what: &str) -> Result<usize, ReadError> {
        let parsed = str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        let count = parsed.filter(|&count: &usize| count > 0);
        count.ok_or_else(|| {
            let message = format!("\"{}\": expected 1 or more, {what}", quotable(word));
            self.error(message)
        })
    }

    /// An error at the last line that was taken.
    pub(super) fn error(&self, message: impl Into<String>) -> ReadError {
        self.text.line_error(self.number, message)
    }
}
