//! What the number format of a cell in Excel shows: a number, a percentage, or a date or time.

use calamine::ExcelDateTime;

use super::sheet::Value;

/// What the cells with a number format show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shown {
    Number,
    Percentage,
    /// A date, a time or a duration.
    Moment,
}

impl Shown {
    /// What a built-in format shows, by its number; `None` where it is not one of percentages or dates.
    ///
    /// Source: [MS-XLS] 2.4.126 and ECMA-376 part 1, 18.8.30. The numbers from 27 to 36 and from 50 to 58
    /// are dates in East Asian editions, and not used in others.
    pub(super) fn built_in(number: u16) -> Option<Self> {
        match number {
            9 | 10 => Some(Self::Percentage),
            14..=22 | 27..=36 | 45..=47 | 50..=58 => Some(Self::Moment),
            _ => None,
        }
    }

    /// What a format shows, by its code such as `0.00%` or `[h]:mm:ss`. Its first section, for positive
    /// numbers, decides.
    pub(super) fn of_code(code: &str) -> Self {
        if code.eq_ignore_ascii_case("general") {
            return Self::Number;
        }
        let mut shown = Self::Number;
        let mut chars = code.chars();
        while let Some(c) = chars.next() {
            match c {
                ';' => break,
                '"' => drop(chars.by_ref().find(|c| *c == '"')),
                // The next character is shown as it is, gives the width of a space, fills the cell, or is the sign
                // of an exponent.
                '\\' | '_' | '*' | 'E' | 'e' => drop(chars.next()),
                '[' => {
                    let within: String = chars.by_ref().take_while(|c| *c != ']').collect();
                    let unit = within.trim_matches(|c: char| "hHmMsS".contains(c));
                    if unit.is_empty() && !within.is_empty() {
                        shown = Self::Moment;
                    }
                }
                '%' if shown == Self::Number => shown = Self::Percentage,
                c if "yYmMdDhHsS".contains(c) => shown = Self::Moment,
                _ => {}
            }
        }
        shown
    }

    /// The value of a number in a cell with the format.
    pub(super) fn value(self, number: f64, is_1904: bool) -> Value {
        match self {
            Self::Number => Value::Number(number),
            Self::Percentage => Value::Percent(number),
            Self::Moment => moment(number, is_1904),
        }
    }
}

/// A date and time from the number of days since the epoch of the workbook.
fn moment(days: f64, is_1904: bool) -> Value {
    let kind = calamine::ExcelDateTimeType::DateTime;
    of_date(&ExcelDateTime::new(days, kind, is_1904))
}

/// A date as text: no reading is one, which an error then says. Below one day it is a time of the day.
pub(super) fn of_date(date: &ExcelDateTime) -> Value {
    let (year, month, day, hour, minute, second, milli) = date.to_ymd_hms_milli();
    let fraction = match milli {
        0 => String::new(),
        milli => format!(".{milli:03}"),
    };
    let time = format!("{hour:02}:{minute:02}:{second:02}{fraction}");
    let days = date.as_f64();
    Value::Text(match days {
        0.0..1.0 => time.into(),
        days if days.fract() == 0.0 => format!("{year}-{month:02}-{day:02}").into(),
        _ => format!("{year}-{month:02}-{day:02} {time}").into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_of_numbers_percentages_or_dates() {
        for (code, shown) in [
            ("General", Shown::Number),
            ("0.000E+00", Shown::Number),
            ("#,##0.00 [$EUR];[Red]-#,##0.00", Shown::Number),
            ("0.0\" mm\"", Shown::Number),
            ("0\\d", Shown::Number),
            ("[Red]0.0", Shown::Number),
            ("0.0 %", Shown::Percentage),
            ("_(0.00%_)", Shown::Percentage),
            ("0\"%\"", Shown::Number),
            ("0;0%", Shown::Number),
            ("yyyy-mm-dd", Shown::Moment),
            ("[h]:mm:ss", Shown::Moment),
            ("[$-409]d-mmm-yy", Shown::Moment),
            ("", Shown::Number),
            ("\"open", Shown::Number),
        ] {
            assert_eq!(Shown::of_code(code), shown, "{code}");
        }
        assert_eq!(Shown::built_in(10), Some(Shown::Percentage));
        assert_eq!(Shown::built_in(14), Some(Shown::Moment));
        assert_eq!(Shown::built_in(2), None);
    }

    #[test]
    fn dates_are_written_in_full() {
        let text = |days, is_1904| match moment(days, is_1904) {
            Value::Text(text) => text.into_string(),
            other => panic!("{other:?}"),
        };
        assert_eq!(text(45_000.0, false), "2023-03-15");
        assert_eq!(text(45_000.25, false), "2023-03-15 06:00:00");
        assert_eq!(text(43_538.0, true), "2023-03-15");
        assert_eq!(text(0.5, false), "12:00:00");
        for odd in [f64::NAN, f64::INFINITY, -1.0, 1e300] {
            assert!(!text(odd, false).is_empty());
        }
    }
}
