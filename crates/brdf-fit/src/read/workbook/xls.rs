//! Workbooks of Excel from 97 to 2003 (`.xls`): a stream of records (BIFF8) in a compound file.
//!
//! The stream begins with the records of the workbook: the list of sheets with the place of each, the table
//! of all strings, and the number formats. A sheet is a further run of records, one for each cell or for
//! several numbers in a row. A record that is too long for its 16-bit length goes on in records `CONTINUE`.
//!
//! The crate `cfb` reads the compound file, and finds chains of sectors that have a loop. (`calamine` 0.38
//! follows them without end.)
//!
//! Source: [MS-XLS], Excel Binary File Format (.xls) Structure, Microsoft; the numbers of sections stand at
//! the records.

use std::io::{Cursor, Read as _};

use cfb::CompoundFile;

use super::archive::PASSWORD;
use super::biff::{Characters, Record, Records};
use super::number_format::Shown;
use super::sheet::{Budget, Sheet, Value};

/// # Errors
///
/// The file is not such a workbook, is protected by a password, damaged or too large.
pub(super) fn sheets(bytes: &[u8], budget: &mut Budget) -> Result<Vec<Sheet>, String> {
    let damaged = |error| format!("is damaged: {error}");
    let mut file = CompoundFile::open(Cursor::new(bytes)).map_err(damaged)?;
    // Workbooks of later versions of Excel are in a compound file where they are encrypted.
    if file.exists("/EncryptedPackage") {
        return Err(PASSWORD.to_owned());
    }
    let path = ["/Workbook", "/Book"].into_iter();
    let Some(path) = path.into_iter().find(|path| file.exists(path)) else {
        return Err("is a compound file of Microsoft Office without a workbook".to_owned());
    };
    let stream = file.open_stream(path).map_err(damaged)?;
    let mut content = Vec::new();
    let longest = bytes.len() as u64;
    stream
        .take(longest)
        .read_to_end(&mut content)
        .map_err(damaged)?;
    let globals = Globals::read(&content)?;
    // Sheets do not overlap, so that all of them together are no longer than the stream.
    let mut left = content.len();
    let listed = globals.sheets.iter();
    listed
        .map(|listed| {
            let mut sheet = Sheet::new(listed.name.as_str(), listed.hidden);
            let mut records = Records::from(&content, listed.start)?;
            read_sheet(&mut records, &globals, &mut sheet, budget)?;
            let length = records.position().saturating_sub(listed.start);
            left = left
                .checked_sub(length)
                .ok_or("is damaged: its sheets overlap")?;
            Ok(sheet)
        })
        .collect()
}

/// A sheet in the list of the workbook.
struct Listed {
    name: String,
    hidden: bool,
    /// The place of its first record in the stream.
    start: usize,
}

/// The records of the workbook as a whole.
#[derive(Default)]
struct Globals {
    sheets: Vec<Listed>,
    strings: Vec<String>,
    /// The codes of the number formats that are not built in.
    formats: Vec<(u16, Shown)>,
    /// What the cells with each format of cells (XF) show.
    shown: Vec<Shown>,
    is_1904: bool,
}

impl Globals {
    fn read(stream: &[u8]) -> Result<Self, String> {
        let mut globals = Self::default();
        let mut formats_of_cells = Vec::new();
        let mut records = Records::from(stream, 0)?;
        while let Some(record) = records.next()? {
            match record.kind {
                Record::BOF => check_version(&record)?,
                Record::FILE_PASS => return Err(PASSWORD.to_owned()),
                Record::DATE_MODE => globals.is_1904 = record.fields().u16()? == 1,
                Record::BOUND_SHEET => globals.sheets.extend(listed(&record)?),
                Record::FORMAT => {
                    let mut fields = record.fields();
                    let number = fields.u16()?;
                    let length = fields.u16()?;
                    let code = Characters::of(vec![fields.rest()]).text(usize::from(length))?;
                    globals.formats.push((number, Shown::of_code(&code)));
                }
                Record::XF => {
                    let mut fields = record.fields();
                    fields.skip(2)?;
                    formats_of_cells.push(fields.u16()?);
                }
                Record::SST => globals.strings = strings(records.continued(&record)?)?,
                Record::EOF => break,
                _ => {}
            }
        }
        globals.formats.sort_by_key(|(number, _)| *number);
        let shown = |number: &u16| globals.shown_by(*number);
        globals.shown = formats_of_cells.iter().map(shown).collect();
        Ok(globals)
    }

    fn shown_by(&self, format: u16) -> Shown {
        let stated = self
            .formats
            .binary_search_by_key(&format, |(number, _)| *number);
        let stated = stated.ok().and_then(|i| self.formats.get(i));
        stated.map_or_else(
            || Shown::built_in(format).unwrap_or(Shown::Number),
            |(_, shown)| *shown,
        )
    }

    fn number(&self, number: f64, format_of_cell: u16) -> Value {
        let shown = self.shown.get(usize::from(format_of_cell));
        shown
            .copied()
            .unwrap_or(Shown::Number)
            .value(number, self.is_1904)
    }
}

/// # Errors
///
/// The workbook is of an earlier version.
fn check_version(record: &Record<'_>) -> Result<(), String> {
    const BIFF8: u16 = 0x0600;
    match record.fields().u16()? {
        BIFF8 => Ok(()),
        _ => Err(
            "is a workbook of Excel 95 or earlier, which cannot be read: save it as .xlsx"
                .to_owned(),
        ),
    }
}

/// A sheet in the list, BoundSheet8 (2.4.28); `None` where it is not a table.
fn listed(record: &Record<'_>) -> Result<Option<Listed>, String> {
    let mut fields = record.fields();
    let start = fields.u32()?;
    let visibility = fields.u8()? & 3;
    let kind = fields.u8()?;
    let length = fields.u8()?;
    let name = Characters::of(vec![fields.rest()]).text(usize::from(length))?;
    let start = usize::try_from(start).map_err(|_| "is damaged: a sheet is missing")?;
    Ok((kind == 0).then_some(Listed {
        name,
        hidden: visibility != 0,
        start,
    }))
}

/// The table of all strings, SST (2.4.265). The strings are XLUnicodeRichExtendedString (2.5.293).
fn strings(parts: Vec<&[u8]>) -> Result<Vec<String>, String> {
    let mut characters = Characters::of(parts);
    characters.skip(4)?;
    let count = characters.u32()?;
    let mut strings = Vec::new();
    for _ in 0..count {
        let length = characters.u16()?;
        strings.push(characters.rich_text(usize::from(length))?);
    }
    Ok(strings)
}

fn read_sheet(
    records: &mut Records<'_>,
    globals: &Globals,
    sheet: &mut Sheet,
    budget: &mut Budget,
) -> Result<(), String> {
    // The number of runs of records that are not at their end: charts within the sheet are runs.
    let mut depth = 0_u64;
    // The cell of a formula whose result is the next string.
    let mut formula = None;
    while let Some(record) = records.next()? {
        match record.kind {
            Record::BOF => depth += 1,
            Record::EOF if depth <= 1 => return Ok(()),
            Record::EOF => depth -= 1,
            _ if depth > 1 => {}
            Record::STRING => {
                let parts = records.continued(&record)?;
                let mut characters = Characters::of(parts);
                let length = characters.u16()?;
                let value = Value::of_text(&characters.text(usize::from(length))?);
                if let (Some((row, column)), Some(value)) = (formula.take(), value) {
                    sheet.add(row, column, value, budget)?;
                }
            }
            _ if depth == 0 => return Err("is damaged: a sheet is missing".to_owned()),
            Record::MERGE_CELLS => add_merged(&record, sheet)?,
            _ => {
                let cells = Cells { globals, record };
                formula = cells.add(sheet, budget)?.or(formula);
            }
        }
    }
    Err("is damaged: a sheet ends too early".to_owned())
}

/// MergeCells (2.4.168).
fn add_merged(record: &Record<'_>, sheet: &mut Sheet) -> Result<(), String> {
    let mut fields = record.fields();
    for _ in 0..fields.u16()? {
        let (first_row, last_row) = (fields.u16()?, fields.u16()?);
        let (first_column, _) = (fields.u16()?, fields.u16()?);
        sheet.merge(first_row.into(), last_row.into(), first_column.into());
    }
    Ok(())
}

/// The record of a cell, or of several numbers in a row.
struct Cells<'a> {
    globals: &'a Globals,
    record: Record<'a>,
}

impl Cells<'_> {
    /// Adds the cells. Returns the place of a formula whose result is the next string.
    fn add(&self, sheet: &mut Sheet, budget: &mut Budget) -> Result<Option<(u32, u32)>, String> {
        if self.record.kind == Record::MUL_RK {
            self.add_numbers(sheet, budget)?;
            return Ok(None);
        }
        let is_cell = [
            Record::NUMBER,
            Record::RK,
            Record::LABEL_SST,
            Record::LABEL,
            Record::R_STRING,
            Record::BOOL_ERR,
            Record::FORMULA,
        ];
        if !is_cell.contains(&self.record.kind) {
            return Ok(None);
        }
        let mut fields = self.record.fields();
        let (row, column) = (u32::from(fields.u16()?), u32::from(fields.u16()?));
        let format = fields.u16()?;
        let value = match self.record.kind {
            Record::NUMBER => Some(self.globals.number(fields.f64()?, format)),
            Record::RK => Some(self.globals.number(rk(fields.u32()?), format)),
            Record::LABEL_SST => {
                let i = usize::try_from(fields.u32()?).ok();
                let text = i.and_then(|i| self.globals.strings.get(i));
                let text = text.ok_or("is damaged: a string of a cell is missing")?;
                Value::of_text(text)
            }
            Record::BOOL_ERR => {
                let (value, is_error) = (fields.u8()?, fields.u8()?);
                Some(bool_or_error(value, is_error != 0))
            }
            Record::FORMULA => match result(fields.array()?) {
                FormulaResult::Number(number) => Some(self.globals.number(number, format)),
                FormulaResult::Other(value) => value,
                FormulaResult::String => return Ok(Some((row, column))),
            },
            _ => {
                let length = fields.u16()?;
                let text = Characters::of(vec![fields.rest()]).text(usize::from(length))?;
                Value::of_text(&text)
            }
        };
        if let Some(value) = value {
            sheet.add(row, column, value, budget)?;
        }
        Ok(None)
    }

    /// MulRk (2.4.175): numbers in neighbouring columns.
    fn add_numbers(&self, sheet: &mut Sheet, budget: &mut Budget) -> Result<(), String> {
        let mut fields = self.record.fields();
        let (row, mut column) = (u32::from(fields.u16()?), u32::from(fields.u16()?));
        // The last column stands at the end.
        while fields.rest().len() >= 8 {
            let format = fields.u16()?;
            let value = self.globals.number(rk(fields.u32()?), format);
            sheet.add(row, column, value, budget)?;
            column += 1;
        }
        Ok(())
    }
}

/// A number in 32 bits, RkNumber (2.5.217): the upper bits of a floating-point number or an integer, which
/// may be a hundredfold.
fn rk(bits: u32) -> f64 {
    let number = if bits & 2 == 0 {
        f64::from_bits(u64::from(bits & !3) << 32)
    } else {
        f64::from(bits.cast_signed() >> 2)
    };
    if bits & 1 == 0 {
        number
    } else {
        number / 100.0
    }
}

/// The result of a formula.
enum FormulaResult {
    Number(f64),
    /// A truth value, an error, or nothing.
    Other(Option<Value>),
    /// The next record has it.
    String,
}

/// FormulaValue (2.5.133).
fn result(bytes: [u8; 8]) -> FormulaResult {
    match bytes {
        [0, .., 0xff, 0xff] => FormulaResult::String,
        [1, _, value, .., 0xff, 0xff] => FormulaResult::Other(Some(bool_or_error(value, false))),
        [2, _, value, .., 0xff, 0xff] => FormulaResult::Other(Some(bool_or_error(value, true))),
        [_, .., 0xff, 0xff] => FormulaResult::Other(None),
        number => FormulaResult::Number(f64::from_le_bytes(number)),
    }
}

/// Bes (2.5.10).
fn bool_or_error(value: u8, is_error: bool) -> Value {
    if !is_error {
        return Value::of_bool(value != 0);
    }
    let error = match value {
        0x00 => "#NULL!",
        0x07 => "#DIV/0!",
        0x0f => "#VALUE!",
        0x17 => "#REF!",
        0x1d => "#NAME?",
        0x24 => "#NUM!",
        0x2a => "#N/A",
        _ => "#ERROR",
    };
    Value::Error(error.into())
}
