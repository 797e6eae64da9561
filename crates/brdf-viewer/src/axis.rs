//! Linear and logarithmic axes: egui_plot knows the linear one only, so that the other one is drawn
//! in decades.

use brdf_fit::plot::Scale;
use egui_plot::{GridInput, GridMark};

/// The height of a number, in the smallest steps of a grid.
const HEIGHT: f64 = 2.6;

/// The width of a number, in these steps.
const WIDTH: f64 = 6.0;

/// How a value is placed on an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// Where it is.
    Linear,
    /// At its decimal logarithm.
    Logarithmic,
}

impl From<Scale> for Axis {
    fn from(scale: Scale) -> Self {
        match scale {
            Scale::Linear => Self::Linear,
            Scale::Logarithmic => Self::Logarithmic,
        }
    }
}

impl Axis {
    /// Where a value stands on the axis; `None` where there is no place for it.
    pub fn place(self, value: f64) -> Option<f64> {
        let place = match self {
            Self::Linear => value,
            Self::Logarithmic if value > 0.0 => value.log10(),
            Self::Logarithmic => return None,
        };
        place.is_finite().then_some(place)
    }

    /// The value that stands at a place.
    pub fn value(self, place: f64) -> f64 {
        match self {
            Self::Linear => place,
            Self::Logarithmic => 10_f64.powf(place),
        }
    }

    /// The lines of its grid, where its numbers stand above each other.
    pub fn grid(self, input: &GridInput) -> Vec<GridMark> {
        self.grid_with(input, HEIGHT)
    }

    /// The lines of its grid, where its numbers stand beside each other.
    pub fn grid_along(self, input: &GridInput) -> Vec<GridMark> {
        self.grid_with(input, WIDTH)
    }

    fn grid_with(self, input: &GridInput, number: f64) -> Vec<GridMark> {
        match self {
            Self::Linear => linear(input, number),
            Self::Logarithmic => logarithmic(input),
        }
    }

    /// The number beside a line of the grid, where one stands.
    pub fn label(self, mark: GridMark, range: &std::ops::RangeInclusive<f64>) -> String {
        match self {
            Self::Linear => number(mark.value, mark.step_size),
            Self::Logarithmic => {
                let decades = range.end() - range.start();
                let whole = (mark.value - mark.value.round()).abs() < 1e-9;
                if whole || decades < 1.5 {
                    in_powers(self.value(mark.value))
                } else {
                    String::new()
                }
            }
        }
    }
}

/// Lines at round values with room for a number at each, and finer ones between them.
fn linear(input: &GridInput, number: f64) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let numbered = round_number_above(number * input.base_step_size);
    let leading = numbered / 10_f64.powf(numbered.log10().floor());
    let parts = if (1.5..4.0).contains(&leading) {
        4.0
    } else {
        5.0
    };
    let mut marks = marks_every(low, high, numbered / parts);
    for mark in &mut marks {
        let steps = (mark.value / mark.step_size).round();
        if steps.rem_euclid(parts) == 0.0 {
            mark.step_size = numbered;
        }
    }
    marks
}

/// Decades, and between them 2 to 9; within less than a decade, equal steps of the value.
fn logarithmic(input: &GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let mark = |value: f64, step_size: f64| GridMark { value, step_size };
    if high - low < 0.7 {
        let apart = (high - low) / 10.0;
        let (low, high) = (10_f64.powf(low), 10_f64.powf(high));
        let steps = marks_every(low, high, round_number_above((high - low) / 10.0));
        let inside = steps.into_iter().filter(|step| step.value > 0.0);
        return inside.map(|step| mark(step.value.log10(), apart)).collect();
    }
    let (first, last) = (low.floor(), high.ceil());
    let decades = last - first;
    let every = (decades / 12.0).ceil().max(1.0);
    let mut marks = marks_every((first / every).floor() * every, last, every);
    if decades <= 8.0 {
        let parts = |decade: f64| (2..10).map(move |m| mark(decade + f64::from(m).log10(), 0.1));
        let parts: Vec<GridMark> = marks.iter().flat_map(|m| parts(m.value)).collect();
        marks.extend(parts);
    }
    marks.retain(|mark| (low..=high).contains(&mark.value));
    marks
}

/// The multiples of a step from low to high; none where they would be too many, or where numbers of
/// this size are further apart than the step.
fn marks_every(low: f64, high: f64, step: f64) -> Vec<GridMark> {
    let (first, last) = ((low / step).ceil(), (high / step).floor());
    let count = last - first;
    if !(0.0..2000.0).contains(&count) || first + 1.0 == first || last + 1.0 == last {
        return Vec::new();
    }
    let mark = |i: u32| GridMark {
        value: (first + f64::from(i)) * step,
        step_size: step,
    };
    (0..=count as u32).map(mark).collect()
}

/// The next of 1, 2, 5 of any decade that is not below.
pub fn round_number_above(least: f64) -> f64 {
    let decade = 10_f64.powf(least.log10().floor());
    let steps = [1.0, 2.0, 5.0].map(|step| step * decade);
    steps
        .into_iter()
        .find(|step| *step >= least)
        .unwrap_or(10.0 * decade)
}

/// A number with the decimals of its step.
pub fn number(value: f64, step: f64) -> String {
    let decimals = -step.log10().floor();
    // The rounding of a multiple of the step is no number of its own.
    let value = if value.abs() < 1e-9 * step {
        0.0
    } else {
        value
    };
    if (0.0..5.0).contains(&decimals) {
        format!("{value:.0$}", decimals as usize)
    } else if value.abs() < 1e5 && decimals < 0.0 {
        format!("{value:.0}")
    } else {
        format!("{value:.2e}")
    }
}

/// 10, 0.1, 2e-5: a value on a logarithmic axis.
fn in_powers(value: f64) -> String {
    let exponent = value.log10();
    if (-3.5..4.5).contains(&exponent) {
        let text = format!("{value:.6}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        let text = format!("{value:.2e}");
        text.replace(".00e", "e").replace("0e", "e")
    }
}

/// The lines of the grid of an angle in degrees.
pub fn degrees(input: &GridInput) -> Vec<GridMark> {
    let width = input.bounds.1 - input.bounds.0;
    if width < 40.0 {
        return linear(input, WIDTH);
    }
    let mut marks = marks_every(input.bounds.0, input.bounds.1, 5.0);
    for mark in &mut marks {
        let is = |step: &f64| mark.value.rem_euclid(*step) == 0.0;
        let step = [90.0, 30.0, 15.0].into_iter().find(is);
        mark.step_size = step.unwrap_or(5.0);
    }
    marks
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(axis: Axis, low: f64, high: f64) -> Vec<f64> {
        let marks = axis.grid(&GridInput {
            bounds: (low, high),
            base_step_size: (high - low) / 40.0,
        });
        marks.iter().map(|mark| mark.value).collect()
    }

    #[test]
    fn a_logarithmic_grid_has_decades_and_their_parts() {
        let marks = values(Axis::Logarithmic, -3.0, 0.0);
        for value in [0.001, 0.002, 0.009, 0.01, 0.5, 1.0_f64] {
            assert!(
                marks.iter().any(|m| (m - value.log10()).abs() < 1e-12),
                "{value}"
            );
        }
        assert_eq!(values(Axis::Logarithmic, -30.0, 30.0).len() % 2, 1);
    }

    #[test]
    fn within_a_decade_the_grid_has_round_values() {
        let marks = values(Axis::Logarithmic, 0.02_f64.log10(), 0.03_f64.log10());
        assert!(marks.len() > 4, "{marks:?}");
        let round = |m: &f64| {
            let value = 10_f64.powf(*m) * 1000.0;
            (value - value.round()).abs() < 1e-9
        };
        assert!(marks.iter().all(round), "{marks:?}");
    }

    /// Where a zoom has gone astray: adding a step to such numbers changes nothing.
    #[test]
    fn far_away_there_is_no_grid_and_no_end_of_memory() {
        for low in [1e15, 1e16, -1e17, 1e300] {
            for width in [0.5, 4.0, 64.0, 1e10] {
                for axis in [Axis::Linear, Axis::Logarithmic] {
                    assert!(values(axis, low, low + width).len() < 2000);
                }
            }
        }
    }

    #[test]
    fn numbers_have_the_digits_of_their_step() {
        assert_eq!(number(0.1 + 0.2, 0.1), "0.3");
        assert_eq!(number(-1e-18, 0.1), "0.0");
        assert_eq!(number(40.0, 20.0), "40");
        assert_eq!(number(2e-7, 1e-7), "2.00e-7");
        assert_eq!(in_powers(0.01), "0.01");
        assert_eq!(in_powers(1e-6), "1e-6");
        assert_eq!(in_powers(100.0), "100");
    }

    #[test]
    fn round_numbers_are_1_2_and_5_of_a_decade() {
        assert_eq!(round_number_above(1.0), 1.0);
        assert_eq!(round_number_above(1.1), 2.0);
        assert_eq!(round_number_above(0.046), 0.05);
        assert_eq!(round_number_above(70.0), 100.0);
    }

    #[test]
    fn what_is_not_positive_has_no_place_on_a_logarithmic_axis() {
        assert_eq!(Axis::Logarithmic.place(0.0), None);
        assert_eq!(Axis::Logarithmic.place(-1.0), None);
        assert_eq!(Axis::Logarithmic.place(0.01), Some(-2.0));
        assert_eq!(Axis::Linear.place(f64::NAN), None);
    }
}
