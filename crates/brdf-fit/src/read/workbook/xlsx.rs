//! Workbooks of Excel since 2007 (`.xlsx`, `.xlsm`), by the crate `calamine`.
//!
//! Only its stream of cells is used, which holds one cell at a time. The table of a whole sheet would be as
//! large as the rectangle around its cells, so that two cells in opposite corners would fill the memory.

use std::io::Cursor;

use calamine::{DataRef, Reader as _, Sheet as Listed, SheetType, SheetVisible, Xlsx, XlsxError};

use super::number_format::{Shown, of_date};
use super::sheet::{Budget, Sheet, Value};

type Workbook<'a> = Xlsx<Cursor<&'a [u8]>>;

/// # Errors
///
/// The workbook is damaged or too large.
pub(super) fn sheets(bytes: &[u8], budget: &mut Budget) -> Result<Vec<Sheet>, String> {
    let mut workbook = Xlsx::new(Cursor::new(bytes)).map_err(|error| damaged(&error))?;
    let list = workbook.sheets_metadata().to_vec();
    let tables = list
        .iter()
        .filter(|listed| listed.typ == SheetType::WorkSheet);
    tables
        .map(|listed| read(&mut workbook, listed, budget))
        .collect()
}

fn read(
    workbook: &mut Workbook<'_>,
    listed: &Listed,
    budget: &mut Budget,
) -> Result<Sheet, String> {
    let hidden = listed.visible != SheetVisible::Visible;
    let mut sheet = Sheet::new(listed.name.as_str(), hidden);
    let has_empty_cells = add_values(workbook, &mut sheet, budget)?;
    if has_empty_cells {
        add_formulas_without_result(workbook, &mut sheet, budget)?;
    }
    let merged = workbook.merge_cells_by_sheet_name(&listed.name);
    for area in merged.map_err(|error| damaged(&error))? {
        sheet.merge(area.start.0, area.end.0, area.start.1);
    }
    Ok(sheet)
}

/// Adds the cells with a value. Returns whether there are cells without one.
fn add_values(
    workbook: &mut Workbook<'_>,
    sheet: &mut Sheet,
    budget: &mut Budget,
) -> Result<bool, String> {
    let cells = workbook.worksheet_cells_reader(&sheet.name);
    let mut cells = cells.map_err(|error| damaged(&error))?;
    let code = |style: &calamine::Style| {
        let format = style.number_format.as_ref();
        format.map_or(Shown::Number, |format| Shown::of_code(&format.format_code))
    };
    let shown: Vec<Shown> = cells.styles().iter().map(code).collect();
    let mut has_empty_cells = false;
    while let Some((cell, style)) = cells
        .next_cell_with_style_id()
        .map_err(|error| damaged(&error))?
    {
        let shown = shown.get(style).copied().unwrap_or(Shown::Number);
        let (row, column) = cell.get_position();
        match value(cell.get_value(), shown) {
            Some(value) => sheet.add(row, column, value, budget)?,
            None => has_empty_cells |= *cell.get_value() == DataRef::Empty,
        }
    }
    Ok(has_empty_cells)
}

/// Adds the formulas that were never calculated: programs write them, and Excel only calculates them when
/// it opens the workbook.
fn add_formulas_without_result(
    workbook: &mut Workbook<'_>,
    sheet: &mut Sheet,
    budget: &mut Budget,
) -> Result<(), String> {
    let cells = workbook.worksheet_cells_reader(&sheet.name);
    let mut cells = cells.map_err(|error| damaged(&error))?;
    while let Some(cell) = cells
        .next_cell_with_formula_metadata()
        .map_err(|error| damaged(&error))?
    {
        if cell.formula.is_some() && cell.value == DataRef::Empty {
            sheet.add(cell.pos.0, cell.pos.1, Value::NoResult, budget)?;
        }
    }
    Ok(())
}

/// The value of a cell; `None` where it is blank.
fn value(data: &DataRef<'_>, shown: Shown) -> Option<Value> {
    match data {
        DataRef::Empty => None,
        // Excel holds every number as a floating-point number.
        DataRef::Int(number) => Some(shown.value(*number as f64, false)),
        DataRef::Float(number) if shown == Shown::Percentage => Some(Value::Percent(*number)),
        DataRef::Float(number) => Some(Value::Number(*number)),
        DataRef::DateTime(date) => Some(of_date(date)),
        DataRef::Bool(value) => Some(Value::of_bool(*value)),
        DataRef::Error(error) => Some(Value::Error(error.to_string().into())),
        DataRef::SharedString(text) => Value::of_text(text),
        DataRef::String(text) | DataRef::DateTimeIso(text) | DataRef::DurationIso(text) => {
            Value::of_text(text)
        }
    }
}

fn damaged(error: &XlsxError) -> String {
    match error {
        XlsxError::Password => super::archive::PASSWORD.to_owned(),
        error => format!("is damaged: {error}"),
    }
}
