//! Workbooks in the OpenDocument format (`.ods`), as LibreOffice writes them.
//!
//! The sheets are in `content.xml`. Equal cells and equal rows that follow each other are written once,
//! with the number of repetitions. The type of a value stands in the cell (`float`, `percentage`, `date`,
//! ...), and its text in the paragraphs within.
//!
//! Source: Open Document Format for Office Applications 1.2, part 1, chapters 9 (tables) and 19 (their
//! attributes); for errors of formulas, the extension `calcext` of LibreOffice.

use std::collections::HashSet;
use std::io::{BufRead, BufReader, Read as _};

use quick_xml::escape::resolve_xml_entity;
use quick_xml::events::{BytesRef, BytesStart, Event};
use quick_xml::{Reader, XmlVersion};

use super::archive::{Archive, PASSWORD};
use super::sheet::{Budget, Sheet, Value};
use crate::read::text::quotable;

/// The most bytes of the list of files that is searched for the sign of a password.
const MAX_MANIFEST: u64 = 1 << 20;

/// # Errors
///
/// The workbook is protected by a password, damaged or too large.
pub(super) fn sheets(mut archive: Archive<'_>, budget: &mut Budget) -> Result<Vec<Sheet>, String> {
    if let Ok(manifest) = archive.by_name("META-INF/manifest.xml") {
        let mut text = Vec::new();
        let read = manifest.take(MAX_MANIFEST).read_to_end(&mut text);
        read.map_err(|error| format!("is damaged: {error}"))?;
        if String::from_utf8_lossy(&text).contains("encryption-data") {
            return Err(PASSWORD.to_owned());
        }
    }
    let content = archive.by_name("content.xml");
    let content = content.map_err(|error| format!("is damaged: content.xml: {error}"))?;
    let mut document = Document::new(BufReader::new(content));
    document.sheets(budget)
}

/// The text of `content.xml`.
struct Document<R> {
    xml: Reader<R>,
    buffer: Vec<u8>,
}

impl<R: BufRead> Document<R> {
    fn new(content: R) -> Self {
        let mut xml = Reader::from_reader(content);
        xml.config_mut().expand_empty_elements = true;
        Self {
            xml,
            buffer: Vec::new(),
        }
    }

    /// The next event.
    ///
    /// # Errors
    ///
    /// The text is not XML, or ends.
    fn next(&mut self) -> Result<Event<'static>, String> {
        self.buffer.clear();
        let event = self.xml.read_event_into(&mut self.buffer);
        match event.map_err(|error| format!("is damaged: content.xml: {error}"))? {
            Event::Eof => Err("is damaged: content.xml ends too early".to_owned()),
            event => Ok(event.into_owned()),
        }
    }

    /// Skips what is within an element.
    fn skip(&mut self) -> Result<(), String> {
        let mut depth = 1_u64;
        while depth > 0 {
            match self.next()? {
                Event::Start(_) => depth += 1,
                Event::End(_) => depth -= 1,
                _ => {}
            }
        }
        Ok(())
    }

    fn sheets(&mut self, budget: &mut Budget) -> Result<Vec<Sheet>, String> {
        let mut sheets = Vec::new();
        let mut hidden_styles = HashSet::new();
        loop {
            match self.next()? {
                Event::Start(start) => match start.local_name().as_ref() {
                    "document-content" | "automatic-styles" | "body" | "spreadsheet" => {}
                    "style" => {
                        let name = attribute(&start, "style:name")?.unwrap_or_default();
                        if self.style_is_hidden()? {
                            hidden_styles.insert(name);
                        }
                    }
                    "table" => {
                        let name = attribute(&start, "table:name")?.unwrap_or_default();
                        let style = attribute(&start, "table:style-name")?;
                        let hidden = style.is_some_and(|style| hidden_styles.contains(&style));
                        let mut sheet = Sheet::new(name, hidden);
                        self.rows(&mut sheet, budget)?;
                        sheets.push(sheet);
                    }
                    _ => self.skip()?,
                },
                Event::End(end) if end.local_name().as_ref() == "document-content" => break,
                _ => {}
            }
        }
        Ok(sheets)
    }

    /// Whether a style hides the sheets that have it.
    fn style_is_hidden(&mut self) -> Result<bool, String> {
        let mut hidden = false;
        loop {
            match self.next()? {
                Event::Start(start) => {
                    if start.local_name().as_ref() == "table-properties" {
                        let display = attribute(&start, "table:display")?;
                        hidden = display.is_some_and(|display| display == "false");
                    }
                    self.skip()?;
                }
                Event::End(_) => return Ok(hidden),
                _ => {}
            }
        }
    }

    /// The rows of a sheet, some of which may be in groups.
    fn rows(&mut self, sheet: &mut Sheet, budget: &mut Budget) -> Result<(), String> {
        let (mut row, mut groups) = (0_u32, 0_u64);
        loop {
            match self.next()? {
                Event::Start(start) => match start.local_name().as_ref() {
                    "table-row" => {
                        let times = count(&start, "table:number-rows-repeated")?;
                        let runs = self.cells()?;
                        row = add_row(sheet, row, times, &runs, budget)?;
                    }
                    "table-row-group" | "table-header-rows" | "table-rows" => groups += 1,
                    _ => self.skip()?,
                },
                Event::End(_) if groups > 0 => groups -= 1,
                Event::End(_) => return Ok(()),
                _ => {}
            }
        }
    }

    fn cells(&mut self) -> Result<Vec<Run>, String> {
        let mut runs = Vec::new();
        let mut column = 0_u32;
        loop {
            match self.next()? {
                Event::Start(start) => match start.local_name().as_ref() {
                    "table-cell" | "covered-table-cell" => {
                        let times = count(&start, "table:number-columns-repeated")?;
                        let rows = count(&start, "table:number-rows-spanned")?;
                        let stated = Stated::of(&start)?;
                        let text = self.text_of_cell()?;
                        if let Some(value) = stated.value(&text) {
                            runs.push(Run {
                                column,
                                times,
                                rows,
                                value,
                            });
                        }
                        column = column.saturating_add(times);
                    }
                    _ => self.skip()?,
                },
                Event::End(_) => return Ok(runs),
                _ => {}
            }
        }
    }

    /// The paragraphs of a cell, without its notes and drawings.
    fn text_of_cell(&mut self) -> Result<String, String> {
        let mut text = String::new();
        loop {
            match self.next()? {
                Event::Start(start) if start.local_name().as_ref() == "p" => {
                    if !text.is_empty() {
                        text.push('\n');
                    }
                    self.paragraph(&mut text)?;
                }
                Event::Start(_) => self.skip()?,
                Event::End(_) => return Ok(text),
                _ => {}
            }
        }
    }

    fn paragraph(&mut self, text: &mut String) -> Result<(), String> {
        let mut depth = 1_u64;
        while depth > 0 {
            match self.next()? {
                Event::Start(start) => match start.local_name().as_ref() {
                    "span" | "a" => depth += 1,
                    "s" | "tab" | "line-break" => {
                        text.push(' ');
                        self.skip()?;
                    }
                    _ => self.skip()?,
                },
                Event::End(_) => depth -= 1,
                Event::Text(part) => text.push_str(&part.xml10_content()),
                Event::CData(part) => text.push_str(&part.xml10_content()),
                Event::GeneralRef(reference) => text.push_str(&character(&reference)?),
                _ => {}
            }
        }
        Ok(())
    }
}

/// Equal cells beside each other in a row.
struct Run {
    column: u32,
    times: u32,
    /// The number of rows that are merged with the cell, with its own.
    rows: u32,
    value: Value,
}

/// Adds a row that is repeated `times` times. Returns the row behind.
fn add_row(
    sheet: &mut Sheet,
    row: u32,
    times: u32,
    runs: &[Run],
    budget: &mut Budget,
) -> Result<u32, String> {
    let end = row.saturating_add(times);
    if runs.is_empty() {
        return Ok(end);
    }
    for row in row..end {
        for run in runs {
            for column in run.column..run.column.saturating_add(run.times) {
                sheet.add(row, column, run.value.clone(), budget)?;
            }
            sheet.merge(row, row.saturating_add(run.rows - 1), run.column);
        }
    }
    Ok(end)
}

/// What the attributes of a cell state of its value.
enum Stated {
    Number(f64),
    Percent(f64),
    Bool(bool),
    Text(String),
    Error,
    /// The text of the cell is the value.
    Nothing {
        formula: bool,
    },
}

impl Stated {
    fn of(cell: &BytesStart<'_>) -> Result<Self, String> {
        if attribute(cell, "calcext:value-type")?.as_deref() == Some("error") {
            return Ok(Self::Error);
        }
        let number = || {
            let text = attribute(cell, "office:value")?.unwrap_or_default();
            let number = fast_float2::parse::<f64, _>(text.trim());
            number.map_err(|_| {
                let text = quotable(text.as_bytes());
                format!("is damaged: content.xml: the value \"{text}\" is not a number")
            })
        };
        let kind = attribute(cell, "office:value-type")?;
        let text = |name| attribute(cell, name);
        let stated = match kind.as_deref() {
            Some("float" | "currency") => return number().map(Self::Number),
            Some("percentage") => return number().map(Self::Percent),
            Some("boolean") => {
                let value = text("office:boolean-value")?;
                value.map(|value| Self::Bool(value == "true"))
            }
            Some("date") => text("office:date-value")?.map(Self::Text),
            Some("time") => text("office:time-value")?.map(Self::Text),
            Some("string") => text("office:string-value")?.map(Self::Text),
            _ => None,
        };
        let formula = kind.is_none() && attribute(cell, "table:formula")?.is_some();
        Ok(stated.unwrap_or(Self::Nothing { formula }))
    }

    /// The value of the cell, `text` being that of its paragraphs; `None` where it is empty.
    fn value(self, text: &str) -> Option<Value> {
        match self {
            Self::Number(number) => Some(Value::Number(number)),
            Self::Percent(number) => Some(Value::Percent(number)),
            Self::Bool(value) => Some(Value::of_bool(value)),
            Self::Text(stated) => Value::of_text(&stated),
            Self::Error => Some(Value::Error(text.trim().into())),
            Self::Nothing { formula: true } if text.trim().is_empty() => Some(Value::NoResult),
            Self::Nothing { .. } => Value::of_text(text),
        }
    }
}

fn attribute(start: &BytesStart<'_>, name: &str) -> Result<Option<String>, String> {
    let damaged = |error: &dyn std::fmt::Display| format!("is damaged: content.xml: {error}");
    let found = start.try_get_attribute(name);
    let Some(found) = found.map_err(|error| damaged(&error))? else {
        return Ok(None);
    };
    let value = found.normalized_value(XmlVersion::Implicit1_0);
    let value = value.map_err(|error| damaged(&error))?;
    Ok(Some(value.into_owned()))
}

/// The number of repetitions that an attribute states: 1 where it is missing.
fn count(start: &BytesStart<'_>, name: &str) -> Result<u32, String> {
    let Some(text) = attribute(start, name)? else {
        return Ok(1);
    };
    let count = text.trim().parse::<u32>().ok().filter(|count| *count > 0);
    count.ok_or_else(|| {
        let text = quotable(text.as_bytes());
        format!("is damaged: content.xml: {name}=\"{text}\": expected a number of cells")
    })
}

/// The text of `&amp;`, `&#10;` and the like.
fn character(reference: &BytesRef<'_>) -> Result<String, String> {
    let damaged =
        |what: &str| format!("is damaged: content.xml: the reference \"{what}\" is not known");
    let name = reference.xml10_content();
    match reference.resolve_char_ref() {
        Ok(Some(c)) => Ok(c.to_string()),
        Ok(None) => match resolve_xml_entity(&name) {
            Some(text) => Ok(text.to_owned()),
            None => Err(damaged(&quotable(name.as_bytes()))),
        },
        Err(_) => Err(damaged(&quotable(name.as_bytes()))),
    }
}
