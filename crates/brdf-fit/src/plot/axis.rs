//! Axes: their ends, chosen from the values, and the positions of values between them.

use super::ticks::{self, LARGEST, SMALLEST, Tick, Ticks, power_of_ten};

/// The most labelled steps between the values of a linear axis.
const MOST_STEPS: f64 = 6.0;

/// An axis with its ticks.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Axis {
    is_logarithmic: bool,
    ticks: Ticks,
}

impl Axis {
    /// A linear axis with given ends and labels at multiples of a step, all whole numbers.
    pub(super) fn fixed(low: i32, high: i32, step: usize) -> Self {
        let tick = |value: i32| Tick {
            value: f64::from(value),
            label: value.to_string(),
        };
        Self {
            is_logarithmic: false,
            ticks: Ticks {
                low: f64::from(low),
                high: f64::from(high),
                labelled: (low..=high).step_by(step).map(tick).collect(),
                unlabelled: Vec::new(),
            },
        }
    }

    /// A linear axis over values and zero, with labels at both ends. NaNs are ignored.
    pub(super) fn linear(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = values
            .filter(|value| !value.is_nan())
            .map(|value| value.clamp(-LARGEST, LARGEST))
            .fold((0.0, 0.0), |(low, high): (f64, f64), value| {
                (low.min(value), high.max(value))
            });
        let (low, high) = if high - low < SMALLEST {
            (0.0, 1.0)
        } else {
            (low, high)
        };
        Self {
            is_logarithmic: false,
            ticks: Ticks {
                unlabelled: Vec::new(),
                ..ticks::linear(low, high, MOST_STEPS)
            },
        }
    }

    /// A logarithmic axis over the positive ones of the values, of at most `decades` decades below
    /// the largest one; `None` where no value is positive. Its ends are at 1, 2 or 5 times a power of
    /// ten.
    pub(super) fn logarithmic(values: impl Iterator<Item = f64>, decades: i32) -> Option<Self> {
        let (lowest, highest) = values
            .filter(|&value| value > SMALLEST)
            .map(|value| value.min(LARGEST))
            .fold((f64::INFINITY, 0.0_f64), |(low, high), value| {
                (low.min(value), high.max(value))
            });
        if highest == 0.0 {
            return None;
        }
        let bottom = highest / power_of_ten(f64::from(decades));
        Some(Self {
            is_logarithmic: true,
            ticks: ticks::logarithmic(lowest.max(bottom).max(SMALLEST), highest)?,
        })
    }

    /// The part of the axis between two values, with labels of its own; the axis itself where the part is
    /// empty, or not positive and logarithmic.
    pub(super) fn within(&self, [low, high]: [f64; 2]) -> Self {
        let ticks = if self.is_logarithmic {
            (low > SMALLEST)
                .then(|| ticks::logarithmic(low, high))
                .flatten()
        } else {
            Some(ticks::linear(low, high, MOST_STEPS))
        };
        let Some(mut ticks) = ticks.filter(|_| low < high && high <= LARGEST) else {
            return self.clone();
        };
        ticks
            .labelled
            .retain(|tick| (low..=high).contains(&tick.value));
        ticks
            .unlabelled
            .retain(|value| (low..=high).contains(value));
        (ticks.low, ticks.high) = (low, high);
        Self {
            is_logarithmic: self.is_logarithmic,
            ticks,
        }
    }

    /// The position of a value as a fraction of the axis: 0 at its low end, 1 at its high end.
    pub(super) fn fraction(&self, value: f64) -> f64 {
        let (low, high) = (self.low(), self.high());
        // Comparisons would turn NaN into a number.
        if value.is_nan() {
            return value;
        }
        let value = value.clamp(-LARGEST, LARGEST);
        if self.is_logarithmic {
            let log = |value: f64| value.max(SMALLEST).log10();
            (log(value) - log(low)) / (log(high) - log(low))
        } else {
            (value - low) / (high - low)
        }
    }

    /// Whether a value is on the axis.
    pub(super) fn contains(&self, value: f64) -> bool {
        (self.low()..=self.high()).contains(&value)
    }

    pub(super) fn is_logarithmic(&self) -> bool {
        self.is_logarithmic
    }

    pub(super) fn low(&self) -> f64 {
        self.ticks.low
    }

    pub(super) fn high(&self) -> f64 {
        self.ticks.high
    }

    /// The labelled values.
    pub(super) fn ticks(&self) -> &[Tick] {
        &self.ticks.labelled
    }

    /// The values of grid lines without a label.
    pub(super) fn unlabelled(&self) -> &[f64] {
        &self.ticks.unlabelled
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<&str> {
        axis.ticks()
            .iter()
            .map(|tick| tick.label.as_str())
            .collect()
    }

    fn ends(axis: &Axis) -> (f64, f64) {
        (axis.low(), axis.high())
    }

    fn linear(values: &[f64]) -> Axis {
        Axis::linear(values.iter().copied())
    }

    fn logarithmic(values: &[f64]) -> Option<Axis> {
        Axis::logarithmic(values.iter().copied(), 6)
    }

    #[test]
    fn linear_axes_end_at_labels_and_include_zero() {
        let axis = linear(&[0.013, 0.47]);
        assert_eq!(labels(&axis), ["0", "0.1", "0.2", "0.3", "0.4", "0.5"]);
        assert_eq!(
            labels(&linear(&[-2.9, 1e-7])),
            ["-3.0", "-2.5", "-2.0", "-1.5", "-1.0", "-0.5", "0", "0.5"]
        );
        assert_eq!(labels(&linear(&[2.2e-7]))[..3], ["0", "5e-8", "1.0e-7"]);
        assert_eq!(labels(&linear(&[3e6]))[1], "5e5");
    }

    #[test]
    fn axes_of_extreme_values_have_a_range() {
        for values in [
            &[][..],
            &[0.0],
            &[f64::NAN],
            &[-0.0, 1e-320],
            &[f64::MAX, f64::MIN],
            &[f64::INFINITY],
        ] {
            let axis = linear(values);
            let count = axis.ticks().len();
            assert!(axis.low() < axis.high() && count >= 2, "{values:?}");
            assert!(count < 12);
            assert!(axis.fraction(0.0).is_finite());
        }
        for values in [
            &[1.0][..],
            &[0.3],
            &[1e-300],
            &[1e-285, f64::MAX],
            &[f64::INFINITY],
            &[1e-4, 1e-4],
        ] {
            let Some(axis) = logarithmic(values) else {
                assert!(values[0] < SMALLEST);
                continue;
            };
            let count = axis.ticks().len();
            assert!(axis.low() < axis.high() && count >= 2, "{values:?}");
            assert!(axis.fraction(0.0).is_finite() && axis.fraction(-1.0) <= 0.0);
        }
        assert_eq!(logarithmic(&[0.0, -1.0, f64::NAN]), None);
    }

    #[test]
    fn logarithmic_axes_end_at_1_2_5() {
        let wide = logarithmic(&[0.0035, 0.42]).unwrap();
        assert_eq!(ends(&wide), (0.002, 0.5));
        assert_eq!(labels(&wide), ["0.01", "0.1"]);
        let narrow = logarithmic(&[0.03, 0.42]).unwrap();
        assert_eq!(labels(&narrow), ["0.02", "0.05", "0.1", "0.2", "0.5"]);
        assert_eq!(labels(&logarithmic(&[0.1]).unwrap()), ["0.05", "0.1"]);
        let deep = logarithmic(&[1e-12, 3.0]).unwrap();
        assert_eq!(ends(&deep), (2e-6, 5.0));
        assert_eq!(labels(&deep)[..2], ["1e-5", "0.0001"]);
    }
}
