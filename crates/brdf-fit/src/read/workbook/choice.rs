//! Which sheet of a workbook is read, and its reading.

use std::path::{Path, PathBuf};

use super::sheet::{Budget, Sheet};
use super::{Kind, archive, ods, xls, xlsx};
use crate::read::error::{ReadError, Remedy};
use crate::read::options::{ReadOptions, SHEET};
use crate::read::reader::Read;
use crate::read::text::{Text, quotable};
use crate::read::{csv, goniometer};
use crate::scan::Format;

/// # Errors
///
/// The bytes are not a workbook that can be read, no sheet has readings or several have and none is chosen, or
/// the table of the sheet cannot be read.
pub(super) fn read(path: &Path, bytes: &[u8], options: &ReadOptions) -> Read {
    let of_file = |message: String| ReadError::file(path, message);
    let mut budget = Budget::default();
    let sheets = sheets(bytes, &mut budget).map_err(of_file)?;
    let names: Vec<String> = sheets.iter().map(listed_name).collect();
    let tables = sheets
        .into_iter()
        .filter(|sheet| !sheet.is_empty())
        .map(|sheet| Table::new(sheet, &options.columns, &mut budget));
    let tables: Vec<Table> = tables.collect::<Result<_, _>>().map_err(of_file)?;
    let declared = options.declarations.iter().find(|(key, _)| key == SHEET);
    let table = match declared {
        Some((_, name)) => chosen(tables, name, &names),
        None => only(tables),
    };
    let several = names.len() > 1;
    let table =
        table.map_err(|message| of_file(message).with_remedy(several.then_some(Remedy::Sheet)))?;
    let mut scan = table.read(path, options)?;
    scan.source = path.display().to_string();
    scan.format = Format::Workbook;
    let notes = table.notes(&names);
    scan.conversions.splice(0..0, notes);
    Ok(scan)
}

fn sheets(bytes: &[u8], budget: &mut Budget) -> Result<Vec<Sheet>, String> {
    match Kind::of(bytes) {
        Some(Kind::Xls) => xls::sheets(bytes, budget),
        Some(Kind::Ods) => ods::sheets(archive::open(bytes)?, budget),
        Some(Kind::Xlsx) => {
            let archive = archive::open(bytes)?;
            if archive.index_for_name("xl/workbook.bin").is_some() {
                return Err(
                    "is a binary Excel workbook (.xlsb), which cannot be read: save it as .xlsx"
                        .to_owned(),
                );
            }
            xlsx::sheets(bytes, budget)
        }
        None => Err("is not a workbook: expected .xlsx, .xls or .ods".to_owned()),
    }
}

/// A sheet as errors and notes call it.
fn listed_name(sheet: &Sheet) -> String {
    let hidden = if sheet.hidden { " (hidden)" } else { "" };
    format!("\"{}\"{hidden}", quotable(sheet.name.as_bytes()))
}

/// The form of the readings in a sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    /// A row for each pair of directions.
    Rows,
    /// Incidences or azimuths in columns.
    Columns,
}

/// A sheet as a table of text.
struct Table {
    name: String,
    /// The name as errors and notes call it.
    listed: String,
    hidden: bool,
    text: String,
    /// How many cells have the value of the cell that they are merged with.
    filled: usize,
    /// The form of the readings; `None` where the sheet has no table of readings.
    form: Option<Form>,
}

impl Table {
    fn new(
        sheet: Sheet,
        columns: &[(String, String)],
        budget: &mut Budget,
    ) -> Result<Self, String> {
        let (name, hidden) = (sheet.name.clone(), sheet.hidden);
        let listed = listed_name(&sheet);
        let (text, filled) = sheet.into_text(budget)?;
        let form = if csv::has_header(text.as_bytes(), columns) {
            Some(Form::Rows)
        } else if (goniometer::READER.recognises)(text.as_bytes()) {
            Some(Form::Columns)
        } else {
            None
        };
        Ok(Self {
            name,
            listed,
            hidden,
            text,
            filled,
            form,
        })
    }

    fn has_readings(&self) -> bool {
        self.form.is_some()
    }

    fn read(&self, path: &Path, options: &ReadOptions) -> Read {
        // Errors name the file, and so the sheet.
        let place = PathBuf::from(format!("{}, sheet {}", path.display(), self.listed));
        let mut options = options.clone();
        options.declarations.retain(|(key, _)| key != SHEET);
        let text = Text::new(&place, self.text.as_bytes())?;
        match self.form {
            Some(Form::Columns) => goniometer::read(text, &options),
            _ => csv::read(text, &options),
        }
    }

    /// The sentences that report which sheet of the workbook is read. A single sheet is not named.
    fn notes(&self, names: &[String]) -> Vec<String> {
        let others = names.iter().filter(|name| **name != self.listed);
        let others: Vec<&str> = others.map(String::as_str).collect();
        let which = match others.as_slice() {
            [] if self.hidden => Some(format!("the sheet {} is read", self.listed)),
            [] => None,
            [other] => Some(format!("the sheet {} is read, {other} is not", self.listed)),
            _ => {
                let others = others.join(", ");
                Some(format!(
                    "the sheet {} is read, {others} are not",
                    self.listed
                ))
            }
        };
        let merged = match self.filled {
            0 => None,
            1 => Some("1 cell has the value of the cell that it is merged with".to_owned()),
            count => Some(format!(
                "{count} cells have the value of the cell that they are merged with"
            )),
        };
        which.into_iter().chain(merged).collect()
    }
}

/// The sheet of a name, in upper or lower case.
///
/// # Errors
///
/// No sheet has the name, or the sheet is empty.
fn chosen(tables: Vec<Table>, name: &str, names: &[String]) -> Result<Table, String> {
    let wanted = name.trim().to_lowercase();
    let mut named = tables.into_iter();
    let found = named.find(|table| table.name.trim().to_lowercase() == wanted);
    found.ok_or_else(|| {
        format!(
            "has no sheet \"{}\" with cells: the sheets are {}",
            quotable(name.as_bytes()),
            names.join(", ")
        )
    })
}

/// The one sheet that has readings. Hidden sheets count where no other has.
///
/// # Errors
///
/// There are several, or none among several sheets.
fn only(mut tables: Vec<Table>) -> Result<Table, String> {
    for hidden in [false, true] {
        let wanted = |table: &Table| table.has_readings() && table.hidden == hidden;
        let with_readings = tables.iter().filter(|table| wanted(table));
        let with_readings: Vec<&str> = with_readings.map(|table| table.listed.as_str()).collect();
        if let [_, _, ..] = with_readings.as_slice() {
            return Err(format!(
                "several sheets hold readings: {}: expected a declaration of one, such as sheet={}",
                with_readings.join(", "),
                tables
                    .iter()
                    .find(|table| wanted(table))
                    .map_or("", |table| &table.name),
            ));
        }
        if let Some(i) = tables.iter().position(wanted) {
            return Ok(tables.swap_remove(i));
        }
    }
    match tables.len() {
        0 => Err("is empty: expected a sheet with names of columns and readings".to_owned()),
        // The error of the reader says what is missing.
        1 => Ok(tables.swap_remove(0)),
        _ => {
            let names: Vec<&str> = tables.iter().map(|table| table.listed.as_str()).collect();
            Err(format!(
                "no sheet holds readings with columns that are known: {}: expected a line that names the \
                 columns, such as psi_deg, theta_deg and brdf_per_sr, or a declaration of the sheet, such as \
                 sheet={}",
                names.join(", "),
                tables.first().map_or("", |table| &table.name),
            ))
        }
    }
}
