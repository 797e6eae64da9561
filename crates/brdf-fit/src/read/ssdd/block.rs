//! The blocks of a file: keywords, lists of angles, and values.

use crate::read::comments::key_and_value;
use crate::read::error::ReadError;
use crate::read::number::{Field, is_angle, is_reading, was_not_taken};
use crate::read::text::{Text, quotable, words};
use crate::scan::Metadata;

/// The longest line in bytes that is quoted or split: more than any list of angles.
const MAX_LINE: usize = 1 << 20;

/// The colour of a value.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Color {
    Monochrome,
    Rgb,
    Xyz,
    /// Wavelengths in nm.
    Spectrum(Vec<f64>),
}

impl Color {
    /// The number of values of a colour.
    pub(super) fn channels(&self) -> usize {
        match self {
            Self::Monochrome => 1,
            Self::Rgb | Self::Xyz => 3,
            Self::Spectrum(wavelengths) => wavelengths.len(),
        }
    }
}

/// A block of data.
pub(super) struct Block {
    /// The number of its first line.
    pub(super) line: u64,
    /// What `DATA_TYPE` states.
    pub(super) kind: String,
    pub(super) color: Color,
    /// What `PARAM_TYPE` states; empty where it is missing.
    pub(super) parameters: String,
    /// The lists of angles in degrees. A list that is missing is a single 0.
    pub(super) lists: [Vec<f64>; 5],
    /// The values of all colours, one colour after the other; NaN where there is none.
    pub(super) values: Vec<f64>,
}

impl Block {
    /// What the block holds, in words.
    pub(super) fn in_words(&self) -> String {
        match self.kind.as_str() {
            "btdf" => "BTDF".to_owned(),
            kind => kind.replace('_', " "),
        }
    }

    pub(super) fn color_at(&self, index: usize) -> Option<&[f64]> {
        let channels = self.color.channels();
        let from = index.checked_mul(channels)?;
        self.values.get(from..from.checked_add(channels)?)
    }

    /// The number of colours; `None` where it is beyond any file.
    fn count(&self) -> Option<usize> {
        let lengths = self.lists.iter().take(4).map(Vec::len);
        lengths.into_iter().try_fold(1_usize, usize::checked_mul)
    }
}

/// The blocks of a file, with the metadata of its comments and names.
#[derive(Default)]
pub(super) struct File {
    pub(super) metadata: Metadata,
    pub(super) blocks: Vec<Block>,
}

impl File {
    /// # Errors
    ///
    /// The file is not in the format, or ends too early.
    pub(super) fn read(text: &Text<'_>, bytes: &[u8]) -> Result<Self, ReadError> {
        let mut source = Source::new(*text, bytes);
        let mut file = Self::default();
        file.read_header(&mut source)?;
        while let Some(line) = source.next(&mut file.metadata)? {
            let block = source.block(line, &mut file.metadata)?;
            file.blocks.push(block);
        }
        if file.blocks.is_empty() {
            return Err(text.error("ends too early: expected DATA_TYPE"));
        }
        Ok(file)
    }

    /// Reads the lines up to the first block.
    fn read_header(&mut self, source: &mut Source<'_>) -> Result<(), ReadError> {
        while let Some(line) = source.next(&mut self.metadata)? {
            let (key, value) = line.key_and_value();
            match key {
                "DATA_TYPE" => {
                    source.back = Some(line);
                    return Ok(());
                }
                "VERSION" => {}
                "SOFTWARE" | "API" | "DATE" => {
                    self.metadata.0.push((key.to_lowercase(), value.to_owned()));
                }
                _ => {
                    let message = format!(
                        "\"{}\": expected SOFTWARE, API, DATE or DATA_TYPE",
                        quotable(key.as_bytes())
                    );
                    return Err(source.text.line_error(line.number, message));
                }
            }
        }
        Ok(())
    }
}

/// A line that is neither blank nor a comment.
#[derive(Clone)]
struct Line {
    number: u64,
    content: String,
}

impl Line {
    fn key_and_value(&self) -> (&str, &str) {
        let line = self.content.trim();
        let (key, value) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        (key, value.trim())
    }

    /// The value without a comment behind it.
    fn value(&self) -> &str {
        let (_, value) = self.key_and_value();
        value.split("# ").next().unwrap_or_default().trim()
    }
}

/// The lines of a file, and the binary values between them.
struct Source<'a> {
    text: Text<'a>,
    rest: &'a [u8],
    number: u64,
    /// A line that is taken again.
    back: Option<Line>,
}

impl<'a> Source<'a> {
    fn new(text: Text<'a>, bytes: &'a [u8]) -> Self {
        Self {
            text,
            rest: crate::read::text::without_byte_order_mark(bytes),
            number: 0,
            back: None,
        }
    }

    /// The next line that is neither blank nor a comment. Comments are added to the metadata.
    ///
    /// # Errors
    ///
    /// The line is too long.
    fn next(&mut self, metadata: &mut Metadata) -> Result<Option<Line>, ReadError> {
        if let Some(line) = self.back.take() {
            return Ok(Some(line));
        }
        while let Some(line) = self.line()? {
            let content = line.content.trim();
            match content.strip_prefix('#') {
                Some(comment) => metadata.0.extend(key_and_value(comment)),
                None if content.is_empty() => {}
                None => return Ok(Some(line)),
            }
        }
        Ok(None)
    }

    fn line(&mut self) -> Result<Option<Line>, ReadError> {
        if self.rest.is_empty() {
            return Ok(None);
        }
        self.number += 1;
        let end = self.rest.iter().position(|byte| *byte == b'\n');
        let (line, rest) = match end.and_then(|end| self.rest.split_at_checked(end)) {
            Some((line, rest)) => (line, rest.get(1..).unwrap_or_default()),
            None => (self.rest, &[][..]),
        };
        if line.len() > MAX_LINE {
            let message = format!("the line is longer than {MAX_LINE} bytes");
            return Err(self.text.line_error(self.number, message));
        }
        self.rest = rest;
        Ok(Some(Line {
            number: self.number,
            content: String::from_utf8_lossy(line).into_owned(),
        }))
    }

    /// The block that begins with a line.
    fn block(&mut self, first: Line, metadata: &mut Metadata) -> Result<Block, ReadError> {
        let mut head = Head::default();
        let (number, mut line) = (first.number, first);
        loop {
            let (key, value) = line.key_and_value();
            match key {
                "DATA" => break,
                "NAME" if !value.is_empty() => {
                    metadata.0.push(("sample".to_owned(), value.to_owned()));
                }
                "SOURCE_TYPE" | "DEVICE" | "CREATION_DATE" | "MEASUREMENT_DATE" | "NAME" => {
                    metadata.0.push((key.to_lowercase(), value.to_owned()));
                }
                _ => head.set(&self.text, &line)?,
            }
            let next = self.next(metadata)?;
            line = next.ok_or_else(|| self.text.error("ends too early: expected DATA"))?;
        }
        let mut block = head.block(&self.text, number)?;
        let Some(count) = block.count() else {
            return Err(self
                .text
                .line_error(number, "the lists of angles are too long"));
        };
        block.values = match line.value() {
            "ascii" => self.colors(count, block.color.channels())?,
            "binary" => self.binary(count, block.color.channels())?,
            other => {
                let message = format!(
                    "DATA \"{}\": expected ascii or binary",
                    quotable(other.as_bytes())
                );
                return Err(self.text.line_error(line.number, message));
            }
        };
        Ok(block)
    }

    /// Lines of values. Memory is allocated for the values in the file, not for those that the lists claim.
    fn colors(&mut self, count: usize, channels: usize) -> Result<Vec<f64>, ReadError> {
        let mut values = Vec::new();
        // The comments between the values name the angles.
        let mut comments = Metadata::default();
        for done in 0..count {
            let line = self.next(&mut comments)?;
            comments.0.clear();
            let Some(line) = line else {
                let message = format!("ends too early: {done} colours, expected {count}");
                return Err(self.text.error(message));
            };
            let content = line.content.split("# ").next().unwrap_or_default();
            let fields: Vec<&[u8]> = words(content.as_bytes()).collect();
            if fields.len() != channels {
                let message = format!(
                    "{} values: expected {channels}, one for each channel",
                    fields.len()
                );
                return Err(self.text.line_error(line.number, message));
            }
            for field in fields {
                values.push(self.value(line.number, field)?);
            }
        }
        Ok(values)
    }

    fn value(&self, line: u64, field: &[u8]) -> Result<f64, ReadError> {
        if was_not_taken(field) {
            return Ok(f64::NAN);
        }
        let expected = "expected a value in 1/sr";
        self.text
            .number(line, "value", &Field::plain(field), expected, is_reading)
    }

    /// Single-precision numbers, the least significant byte first. Those that are no numbers become NaN.
    fn binary(&mut self, count: usize, channels: usize) -> Result<Vec<f64>, ReadError> {
        let length = count
            .checked_mul(channels)
            .and_then(|count| count.checked_mul(4));
        let parts = length.and_then(|length| self.rest.split_at_checked(length));
        let Some((data, rest)) = parts else {
            let message = format!(
                "ends too early: {} bytes of binary values, expected {count} colours of {channels} numbers of 4 \
                 bytes",
                self.rest.len()
            );
            return Err(self.text.line_error(self.number, message));
        };
        self.rest = rest;
        let (numbers, _) = data.as_chunks::<4>();
        let number = |bytes: &[u8; 4]| f64::from(f32::from_le_bytes(*bytes));
        Ok(numbers.iter().map(number).collect())
    }
}

/// The keywords of a block that its values depend on.
#[derive(Default)]
struct Head {
    kind: String,
    color: String,
    wavelengths: Vec<f64>,
    parameters: String,
    lists: [Vec<f64>; 5],
}

impl Head {
    fn set(&mut self, text: &Text<'_>, line: &Line) -> Result<(), ReadError> {
        const KINDS: [&str; 4] = [
            "brdf",
            "btdf",
            "specular_reflectance",
            "specular_transmittance",
        ];
        const COLORS: [&str; 4] = ["monochrome", "rgb", "xyz", "spectrum"];
        const REDUCTIONS: [&str; 2] = ["bilateral_symmetry", "reciprocity"];
        let value = line.value();
        let one_of = |known: &[&str], value: &str| {
            let is_known = known.contains(&value);
            let message = || {
                format!(
                    "\"{}\": expected {}",
                    quotable(value.as_bytes()),
                    known.join(" or ")
                )
            };
            if is_known {
                Ok(value.to_owned())
            } else {
                Err(text.line_error(line.number, message()))
            }
        };
        let key = line.key_and_value().0;
        match key {
            "DATA_TYPE" => self.kind = one_of(&KINDS, value)?,
            "COLOR_MODEL" => self.color = one_of(&COLORS, value)?,
            "WAVELENGTH_LIST" => {
                let accepts = |nm: f64| (1e-3..=1e9).contains(&nm);
                self.wavelengths = list(text, line, "expected nanometres above 0", accepts)?;
            }
            "PARAM_TYPE" => value.clone_into(&mut self.parameters),
            "REDUCTION_TYPE" => {
                for word in value.split_whitespace() {
                    one_of(&REDUCTIONS, word)?;
                }
            }
            _ => {
                const LISTS: [&str; 5] = [
                    "PARAM0_LIST",
                    "PARAM1_LIST",
                    "PARAM2_LIST",
                    "PARAM3_LIST",
                    "PARAM4_LIST",
                ];
                let found = LISTS.iter().position(|list| *list == key);
                let Some(slot) = found.and_then(|i| self.lists.get_mut(i)) else {
                    let message = format!(
                        "\"{}\": expected a keyword of a block such as PARAM0_LIST or DATA",
                        quotable(key.as_bytes())
                    );
                    return Err(text.line_error(line.number, message));
                };
                *slot = list(text, line, "expected degrees", is_angle)?;
            }
        }
        Ok(())
    }

    fn block(self, text: &Text<'_>, line: u64) -> Result<Block, ReadError> {
        let color = match self.color.as_str() {
            "monochrome" => Color::Monochrome,
            "rgb" => Color::Rgb,
            "xyz" => Color::Xyz,
            "spectrum" if !self.wavelengths.is_empty() => Color::Spectrum(self.wavelengths),
            "spectrum" => return Err(text.line_error(line, "the block has no WAVELENGTH_LIST")),
            _ => return Err(text.line_error(line, "the block has no COLOR_MODEL")),
        };
        if self.kind.is_empty() {
            return Err(text.line_error(line, "expected DATA_TYPE"));
        }
        let list = |list: Vec<f64>| if list.is_empty() { vec![0.0] } else { list };
        Ok(Block {
            line,
            kind: self.kind,
            color,
            parameters: self.parameters,
            lists: self.lists.map(list),
            values: Vec::new(),
        })
    }
}

/// The numbers of a list.
fn list(
    text: &Text<'_>,
    line: &Line,
    expected: &str,
    accepts: impl Fn(f64) -> bool,
) -> Result<Vec<f64>, ReadError> {
    let name = line.key_and_value().0;
    let fields = words(line.value().as_bytes());
    let number = |field| text.number(line.number, name, &Field::plain(field), expected, &accepts);
    let numbers: Vec<f64> = fields.map(number).collect::<Result<_, _>>()?;
    if numbers.is_empty() {
        return Err(text.line_error(line.number, format!("{name} is empty: {expected}")));
    }
    Ok(numbers)
}
