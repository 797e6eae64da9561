//! The cells of a sheet, and the text table that they are.
//!
//! A row of the sheet is a line of the text, so that the lines of errors are the rows of the sheet. Cells
//! are separated by tabs. Columns that are empty in all rows to the left of the first cell are left out.

use std::fmt::Write as _;

use crate::read::number::shifted;

/// The most cells of all sheets together that are read: more than a full sheet of six columns.
const MAX_CELLS: usize = 10_000_000;

/// The most bytes of text in all cells together.
const MAX_TEXT: usize = 256 << 20;

/// The largest number of rows and columns of a sheet.
const MAX_ROWS: u32 = 1 << 20;
const MAX_COLUMNS: u32 = 1 << 14;

/// The errors that a cell of a spreadsheet may hold in place of a value.
const ERRORS: [&str; 8] = [
    "#N/A", "#DIV/0!", "#VALUE!", "#REF!", "#NAME?", "#NUM!", "#NULL!", "#SPILL!",
];

/// What a cell holds.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Number(f64),
    /// A number that the sheet shows in percent: 0.05 is shown as 5 %.
    Percent(f64),
    /// Text, a date or time, or a truth value.
    Text(Box<str>),
    /// An error such as `#N/A`.
    Error(Box<str>),
    /// A formula that was never calculated.
    NoResult,
}

impl Value {
    /// The value of a text; `None` where it is blank. A text that is an error is read as one.
    pub(super) fn of_text(text: &str) -> Option<Self> {
        let trimmed = text.trim();
        match trimmed {
            "" => None,
            _ if ERRORS.contains(&trimmed) => Some(Self::Error(trimmed.into())),
            _ => Some(Self::Text(text.into())),
        }
    }

    pub(super) fn of_bool(value: bool) -> Self {
        Self::Text(if value { "TRUE" } else { "FALSE" }.into())
    }

    fn text_length(&self) -> usize {
        match self {
            Self::Text(text) | Self::Error(text) => text.len(),
            _ => 0,
        }
    }
}

/// What the sheets of a workbook may still hold.
pub(super) struct Budget {
    cells: usize,
    text: usize,
}

impl Default for Budget {
    fn default() -> Self {
        Self {
            cells: MAX_CELLS,
            text: MAX_TEXT,
        }
    }
}

impl Budget {
    /// # Errors
    ///
    /// The workbook holds too much.
    pub(super) fn take(&mut self, cells: usize, text: usize) -> Result<(), String> {
        let left = self
            .cells
            .checked_sub(cells)
            .zip(self.text.checked_sub(text));
        let Some((cells, text)) = left else {
            return Err(format!(
                "holds more than {MAX_CELLS} cells or {} MiB of text: expected a sheet of readings, alone \
                 in a workbook or as CSV",
                MAX_TEXT >> 20
            ));
        };
        (self.cells, self.text) = (cells, text);
        Ok(())
    }
}

#[derive(Debug, Clone)]
struct Cell {
    /// The row and the column, counted from 0.
    row: u32,
    column: u32,
    value: Value,
}

/// Cells that are merged into one, whose value is that of the first.
#[derive(Debug, Clone, Copy)]
struct Merged {
    first_row: u32,
    last_row: u32,
    column: u32,
}

/// A sheet of a workbook.
#[derive(Debug, Clone, Default)]
pub(super) struct Sheet {
    pub(super) name: String,
    pub(super) hidden: bool,
    cells: Vec<Cell>,
    merged: Vec<Merged>,
}

impl Sheet {
    pub(super) fn new(name: impl Into<String>, hidden: bool) -> Self {
        Self {
            name: name.into(),
            hidden,
            ..Self::default()
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// Adds a cell. Row and column are counted from 0.
    ///
    /// # Errors
    ///
    /// The place is not on a sheet, or the workbook holds too much.
    pub(super) fn add(
        &mut self,
        row: u32,
        column: u32,
        value: Value,
        budget: &mut Budget,
    ) -> Result<(), String> {
        if row >= MAX_ROWS || column >= MAX_COLUMNS {
            return Err(format!(
                "has a cell beyond row {MAX_ROWS} or column {MAX_COLUMNS}, the largest of a sheet"
            ));
        }
        budget.take(1, value.text_length())?;
        self.cells.push(Cell { row, column, value });
        Ok(())
    }

    /// Merges the cells of a column from the first to the last row.
    ///
    /// Cells that are merged across columns are not noted: a title above several columns names none of
    /// them.
    pub(super) fn merge(&mut self, first_row: u32, last_row: u32, column: u32) {
        if last_row > first_row {
            self.merged.push(Merged {
                first_row,
                last_row,
                column,
            });
        }
    }

    /// The text of the sheet, and the number of cells that have the value of the cell that they are merged
    /// with.
    ///
    /// # Errors
    ///
    /// The merged cells are too many.
    pub(super) fn into_text(mut self, budget: &mut Budget) -> Result<(String, usize), String> {
        self.sort();
        let filled = self.fill_merged(budget)?;
        let first = self.cells.iter().map(|cell| cell.column).min().unwrap_or(0);
        let mut text = String::new();
        let (mut row, mut column) = (0, first);
        for cell in &self.cells {
            while row < cell.row {
                text.push('\n');
                row += 1;
                column = first;
            }
            while column < cell.column {
                text.push('\t');
                column += 1;
            }
            push_value(&mut text, &cell.value, cell.column == first);
        }
        text.push('\n');
        Ok((text, filled))
    }

    /// Sorts the cells by their places. Of cells at one place the last one is kept.
    fn sort(&mut self) {
        self.cells.reverse();
        self.cells.sort_by_key(|cell| (cell.row, cell.column));
        self.cells.dedup_by_key(|cell| (cell.row, cell.column));
    }

    /// Gives the rows of merged cells the value of the first row, where a person sees it: in a table, an
    /// incidence that is written once for all its readings. Rows without other cells remain empty.
    fn fill_merged(&mut self, budget: &mut Budget) -> Result<usize, String> {
        let mut rows: Vec<u32> = self.cells.iter().map(|cell| cell.row).collect();
        rows.dedup();
        let mut filled = Vec::new();
        for merged in &self.merged {
            let place = |row: u32| {
                let key = |cell: &Cell| (cell.row, cell.column);
                self.cells.binary_search_by_key(&(row, merged.column), key)
            };
            let Some(first) = place(merged.first_row).ok().and_then(|i| self.cells.get(i)) else {
                continue;
            };
            let from = rows.partition_point(|row| *row <= merged.first_row);
            let to = rows.partition_point(|row| *row <= merged.last_row);
            for &row in rows.get(from..to).unwrap_or_default() {
                budget.take(1, first.value.text_length())?;
                if place(row).is_err() {
                    filled.push(Cell {
                        row,
                        ..first.clone()
                    });
                }
            }
        }
        let count = filled.len();
        self.cells.extend(filled);
        self.sort();
        Ok(count)
    }
}

fn push_value(text: &mut String, value: &Value, is_first: bool) {
    // Writing to a string does not fail.
    let _ = match value {
        Value::Number(number) => write!(text, "{}", Shortest(*number)),
        Value::Percent(number) => write!(text, "{}%", Shortest(shifted(*number, 2))),
        Value::NoResult => write!(text, "(formula without a result)"),
        // A space keeps the line from being a comment.
        Value::Error(error) if is_first => write!(text, " {error}"),
        Value::Error(error) => write!(text, "{error}"),
        Value::Text(cell) => {
            push_text(text, cell, is_first);
            Ok(())
        }
    };
}

/// A text with spaces for line ends and other controls, quoted where it contains quotes. A comment, which
/// is in the first column, is not quoted.
fn push_text(text: &mut String, cell: &str, is_first: bool) {
    let is_comment = is_first && cell.starts_with('#');
    let quoted = cell.contains('"') && !is_comment;
    if quoted {
        text.push('"');
    }
    for c in cell.chars() {
        match c {
            '"' if quoted => text.push_str("\"\""),
            c if c.is_control() => text.push(' '),
            c => text.push(c),
        }
    }
    if quoted {
        text.push('"');
    }
}

/// A number with the fewest digits that give it back.
struct Shortest(f64);

impl std::fmt::Display for Shortest {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self(number) = self;
        if *number == 0.0 || (1e-5..1e16).contains(&number.abs()) {
            write!(f, "{number}")
        } else {
            write!(f, "{number:e}")
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn sheet(cells: &[(u32, u32, Value)]) -> Sheet {
        let mut sheet = Sheet::new("A", false);
        for (row, column, value) in cells {
            let added = sheet.add(*row, *column, value.clone(), &mut Budget::default());
            added.unwrap();
        }
        sheet
    }

    fn text(cells: &[(u32, u32, Value)]) -> String {
        sheet(cells).into_text(&mut Budget::default()).unwrap().0
    }

    fn word(text: &str) -> Value {
        Value::of_text(text).unwrap()
    }

    #[test]
    fn rows_are_lines_and_empty_columns_at_the_left_are_left_out() {
        let cells = [
            (3, 4, Value::Number(0.25)),
            (1, 2, word("psi_deg")),
            (1, 4, word("brdf")),
            (3, 2, Value::Number(10.0)),
            (3, 3, Value::Number(-630.79)),
        ];
        assert_eq!(text(&cells), "\npsi_deg\t\tbrdf\n\n10\t-630.79\t0.25\n");
        assert_eq!(text(&[]), "\n");
    }

    #[test]
    fn percentages_errors_and_formulas_without_a_result_show_as_such() {
        for (value, shown) in [
            (Value::Percent(0.07), "7%"),
            (Value::Percent(1e-9), "1e-7%"),
            (Value::NoResult, "(formula without a result)"),
            (word("#N/A"), "#N/A"),
            (word(" #DIV/0! "), "#DIV/0!"),
            (Value::of_bool(true), "TRUE"),
            (word("say \"x\"\nand\ty"), "\"say \"\"x\"\" and y\""),
            (Value::Number(f64::NAN), "NaN"),
        ] {
            let cells = [(0, 0, Value::Number(1.0)), (0, 1, value)];
            assert_eq!(text(&cells), format!("1\t{shown}\n"));
        }
        // In the first column, an error is not a comment, and a comment is not quoted.
        assert_eq!(text(&[(0, 0, word("#REF!"))]), " #REF!\n");
        let comment = word("# sample: \"x\"");
        assert_eq!(text(&[(0, 0, comment)]), "# sample: \"x\"\n");
        assert_eq!(Value::of_text(" \n"), None);
    }

    #[test]
    fn merged_rows_have_the_value_of_the_first() {
        let mut merged = sheet(&[
            (0, 0, word("psi")),
            (1, 0, Value::Number(10.0)),
            (1, 1, Value::Number(1.0)),
            (2, 1, Value::Number(2.0)),
            (4, 1, Value::Number(3.0)),
            (5, 1, Value::Number(4.0)),
        ]);
        merged.merge(1, 4, 0);
        merged.merge(7, 9, 0);
        let (text, filled) = merged.into_text(&mut Budget::default()).unwrap();
        assert_eq!(text, "psi\n10\t1\n10\t2\n\n10\t3\n\t4\n");
        assert_eq!(filled, 2);
    }

    #[test]
    fn merged_cells_of_all_rows_do_not_take_endless_time() {
        let cells: Vec<_> = (0..5000).map(|row| (row, 0, Value::Number(1.0))).collect();
        let mut merged = sheet(&cells);
        for _ in 0..5000 {
            merged.merge(0, 5000, 0);
        }
        let error = merged.into_text(&mut Budget::default()).unwrap_err();
        assert!(error.contains("more than 10000000 cells"), "{error}");
    }

    #[test]
    fn the_cells_and_their_text_are_limited() {
        let mut budget = Budget::default();
        let mut sheet = Sheet::new("A", false);
        let long = Value::Text("x".repeat(MAX_TEXT / 2).into());
        sheet.add(0, 0, long.clone(), &mut budget).unwrap();
        sheet.add(0, 1, long.clone(), &mut budget).unwrap();
        let error = sheet.add(0, 2, long, &mut budget).unwrap_err();
        assert!(error.contains("256 MiB of text"), "{error}");
        assert!(budget.take(MAX_CELLS, 0).is_err());
    }

    proptest! {
        #[test]
        fn numbers_come_back_to_the_last_bit(bits in any::<u64>()) {
            let number = f64::from_bits(bits);
            let shown = format!("{}", Shortest(number));
            let back: f64 = shown.parse().unwrap();
            prop_assert!(back == number || number.is_nan());
        }

        #[test]
        fn percentages_are_shown_with_the_digits_of_the_number(digits in 0_u32..100_000) {
            let percent = f64::from(digits) / 1000.0;
            let number: f64 = format!("{digits}e-5").parse().unwrap();
            prop_assert_eq!(shifted(number, 2), percent);
        }
    }
}
