//! Ticks of linear and logarithmic axes: where their grid lines lie, and the labels of these.
//!
//! Nothing here draws, so that figures and interactive plots can share it.
//!
//! ```
//! use brdf_fit::plot::ticks::{linear, logarithmic};
//!
//! let labels = |ticks: &[brdf_fit::plot::ticks::Tick]| -> Vec<String> {
//!     ticks.iter().map(|tick| tick.label.clone()).collect()
//! };
//! let ticks = linear(0.0, 0.47, 6.0);
//! assert_eq!(labels(&ticks.labelled), ["0", "0.1", "0.2", "0.3", "0.4", "0.5"]);
//! let ticks = logarithmic(0.03, 0.42).unwrap();
//! assert_eq!(labels(&ticks.labelled), ["0.02", "0.05", "0.1", "0.2", "0.5"]);
//! ```

/// Over more decades than this a logarithmic axis has labels at whole decades only, otherwise at 1,
/// 2 and 5 times a power of ten. It is two decades and a margin for rounding.
const MOST_LABELLED_DECADES: f64 = 2.01;

/// A logarithmic axis has no more labels than this.
const MOST_LABELS: usize = 11;

/// With more labels than this a logarithmic axis has no grid lines between them.
const MOST_LABELS_WITH_FINE_GRID: usize = 8;

/// From this absolute value on the labels of a linear axis are in exponential notation.
const EXPONENTIAL_FROM: f64 = 1e5;

/// The smallest value on a logarithmic axis; on a linear axis, the smallest range.
pub const SMALLEST: f64 = 1e-290;

/// The largest absolute value on an axis: differences and decades of values up to it are finite.
pub const LARGEST: f64 = 1e290;

/// A labelled value.
#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// The value.
    pub value: f64,
    /// The value as text.
    pub label: String,
}

/// The ticks over a range.
#[derive(Debug, Clone, PartialEq)]
pub struct Ticks {
    /// The low end of the range, rounded outwards.
    pub low: f64,
    /// The high end of the range, rounded outwards.
    pub high: f64,
    /// Labelled values, in ascending order.
    pub labelled: Vec<Tick>,
    /// Values of grid lines between them, without a label.
    pub unlabelled: Vec<f64>,
}

/// The ticks of a linear axis over a range: multiples of [`linear_step`], from the last one that is
/// not above `low` to the first one that is not below `high`. Grid lines divide each step into four
/// or five parts.
///
/// There are no ticks where the step is less than the distance of neighbouring floating-point
/// numbers, or an end is not finite.
pub fn linear(low: f64, high: f64, most_steps: f64) -> Ticks {
    let step = linear_step(high - low, most_steps);
    let (first, last) = ((low / step).floor(), (high / step).ceil());
    let is_resolved = |index: f64| index + 1.0 != index && index - 1.0 != index;
    if !(first <= last && is_resolved(first) && is_resolved(last)) {
        return Ticks {
            low,
            high,
            labelled: Vec::new(),
            unlabelled: Vec::new(),
        };
    }
    let largest = low.abs().max(high.abs());
    let (mut labelled, mut unlabelled) = (Vec::new(), Vec::new());
    let parts = parts_of_step(step);
    let mut index = first;
    while index <= last {
        let value = index * step;
        labelled.push(Tick {
            value,
            label: linear_label(value, step, largest),
        });
        if index < last {
            let part = |i: u32| (index + f64::from(i) / f64::from(parts)) * step;
            unlabelled.extend((1..parts).map(part));
        }
        index += 1.0;
    }
    Ticks {
        low: first * step,
        high: last * step,
        labelled,
        unlabelled,
    }
}

/// The smallest of 1, 2, 5 and 10 times a power of ten that divides a range into at most
/// `most_steps` steps.
pub fn linear_step(range: f64, most_steps: f64) -> f64 {
    let unit = power_of_ten((range / most_steps).log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .find(|factor| range / (factor * unit) <= most_steps)
        .map_or(unit, |factor| factor * unit)
}

/// A step of 2 has four parts, one of 1 or 5 has five.
fn parts_of_step(step: f64) -> u32 {
    let leading = step / power_of_ten(f64::from(decade_of(1.001 * step)));
    if (1.5..4.0).contains(&leading) { 4 } else { 5 }
}

/// The label of a multiple of `step` on a linear axis where `largest` is the largest absolute value.
/// All labels of an axis have the same decimals.
pub fn linear_label(value: f64, step: f64, largest: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    // The factor compensates for the rounding of the step.
    let step_decade = decade_of(1.001 * step);
    if largest >= EXPONENTIAL_FROM || step_decade < -4 {
        let digits = decade_of(1.001 * value.abs()) - step_decade;
        let digits = usize::try_from(digits).unwrap_or(0).min(15);
        format!("{value:.digits$e}")
    } else {
        let decimals = usize::try_from(-step_decade).unwrap_or(0);
        format!("{value:.decimals$}")
    }
}

/// The ticks of a logarithmic axis over a positive range, whose ends are rounded outwards to 1, 2 or
/// 5 times a power of ten. `None` where the range is not between [`SMALLEST`] and [`LARGEST`].
///
/// Up to two decades the labels are at 1, 2 and 5 times a power of ten, otherwise at powers of ten;
/// grid lines are at 1 to 9 times a power of ten. Over less than a factor of 5, [`linear`] ticks
/// are the denser ones.
pub fn logarithmic(low: f64, high: f64) -> Option<Ticks> {
    if !(SMALLEST <= low && low <= high && high <= LARGEST) {
        return None;
    }
    let (from, to) = rounded_outwards(low, high)?;
    let (low, high) = (from.value(), to.value());
    let is_wide = (high / low).log10() > MOST_LABELLED_DECADES;
    let is_labelled = |round: &Round| round.digit == 1 || !is_wide && matches!(round.digit, 2 | 5);
    let (labelled, between): (Vec<Round>, Vec<Round>) = (from.decade..=to.decade)
        .flat_map(|decade| (1..10).map(move |digit| Round { digit, decade }))
        .filter(|round| (low..=high).contains(&round.value()))
        .partition(is_labelled);
    let every = labelled.len().div_ceil(MOST_LABELS);
    let has_fine_grid = labelled.len() <= MOST_LABELS_WITH_FINE_GRID;
    let unlabelled = between.into_iter().filter(|_| has_fine_grid);
    Some(Ticks {
        low,
        high,
        labelled: labelled
            .into_iter()
            .step_by(every)
            .map(Round::tick)
            .collect(),
        unlabelled: unlabelled.map(Round::value).collect(),
    })
}

/// A digit times a power of ten.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Round {
    digit: u8,
    decade: i32,
}

impl Round {
    /// Its value, parsed, because a product may differ in the last digit.
    fn value(self) -> f64 {
        let Self { digit, decade } = self;
        let written = format!("{digit}e{decade}");
        written.parse().unwrap_or(f64::MIN_POSITIVE)
    }

    fn tick(self) -> Tick {
        let Self { digit, decade } = self;
        let value = self.value();
        let label = if (-4..=4).contains(&decade) {
            value.to_string()
        } else {
            format!("{digit}e{decade}")
        };
        Tick { value, label }
    }
}

/// The closest 1, 2 or 5 times a power of ten that are not above `low` and not below `high`, and
/// different from each other.
fn rounded_outwards(low: f64, high: f64) -> Option<(Round, Round)> {
    // One more decade at both ends, because the logarithm of a value at an end may be rounded.
    let round: Vec<Round> = (decade_of(low) - 1..=decade_of(high) + 1)
        .flat_map(|decade| [1, 2, 5].map(|digit| Round { digit, decade }))
        .collect();
    let from = round.iter().rposition(|round| round.value() <= low)?;
    let to = round.iter().position(|round| round.value() >= high)?;
    let from = if from == to {
        from.checked_sub(1)?
    } else {
        from
    };
    Some((round[from], round[to]))
}

/// Ten to a whole power, parsed, because a product of tens may differ in the last digit.
pub(super) fn power_of_ten(exponent: f64) -> f64 {
    format!("1e{exponent:.0}")
        .parse()
        .unwrap_or(f64::MIN_POSITIVE)
}

#[expect(clippy::cast_possible_truncation, reason = "the logarithm of a double")]
fn decade_of(value: f64) -> i32 {
    value.log10().floor() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grid_lines_divide_a_step_of_2_into_four_and_others_into_five_parts() {
        for (high, step, parts) in [(6.0, 1.0, 5), (12.0, 2.0, 4), (30.0, 5.0, 5)] {
            let ticks = linear(0.0, high, 6.0);
            assert_eq!(ticks.labelled[1].value, step);
            assert_eq!(ticks.unlabelled.len(), 6 * (parts - 1));
            assert_eq!(ticks.unlabelled[0], step / parts as f64);
        }
    }

    #[test]
    fn ranges_without_resolution_have_no_ticks() {
        for (low, high) in [
            (1e17, 1e17 + 16.0),
            (0.0, f64::INFINITY),
            (f64::NAN, 1.0),
            (1.0, 1.0),
            (2.0, 1.0),
        ] {
            let ticks = linear(low, high, 6.0);
            assert!(ticks.labelled.is_empty(), "{low} {high}: {ticks:?}");
        }
        for (low, high) in [(0.0, 1.0), (-1.0, 1.0), (1.0, f64::INFINITY), (2.0, 1.0)] {
            assert_eq!(logarithmic(low, high), None);
        }
    }
}
