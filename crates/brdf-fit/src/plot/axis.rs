//! Axes: their range, chosen from the values, and their labels.

/// About so many labelled steps are on a linear axis.
const STEPS: f64 = 6.0;

/// What is smaller than this is zero on a linear axis, and below a logarithmic one.
const SMALLEST: f64 = 1e-290;

/// What is larger has no place on an axis: differences and decades stay finite.
const LARGEST: f64 = 1e290;

/// Over more decades than this a logarithmic axis has labels at whole decades only, otherwise at 1,
/// 2 and 5. Two decades, whatever their rounding.
const LABELLED_DECADES: f64 = 2.01;

/// A logarithmic axis has no more labels than this.
const MOST_LABELS: usize = 11;

/// With more labels than this a logarithmic axis has no lines between them.
const MOST_WITH_FINE_GRID: usize = 8;

/// A digit and the power of ten that it is multiplied with.
type Round = (u8, i32);

/// An axis from `low` to `high`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Axis {
    low: f64,
    high: f64,
    logarithmic: bool,
    /// The labelled values.
    pub(super) ticks: Vec<Tick>,
    /// Values of grid lines without a label.
    pub(super) fine: Vec<f64>,
}

/// A labelled value.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tick {
    pub(super) value: f64,
    pub(super) label: String,
}

impl Axis {
    /// A linear axis with given ends and labels at multiples of a step, both whole numbers.
    pub(super) fn fixed(low: i32, high: i32, step: usize) -> Self {
        let tick = |value: i32| Tick {
            value: f64::from(value),
            label: value.to_string(),
        };
        Self {
            low: f64::from(low),
            high: f64::from(high),
            logarithmic: false,
            ticks: (low..=high).step_by(step).map(tick).collect(),
            fine: Vec::new(),
        }
    }

    /// A linear axis over values and zero, with ends at labels. Values that are not numbers are
    /// passed over.
    pub(super) fn linear(values: impl Iterator<Item = f64>) -> Self {
        let finite = values.filter(|value| !value.is_nan());
        let (low, high) = finite
            .map(|value| value.clamp(-LARGEST, LARGEST))
            .fold((0.0, 0.0), |(low, high): (f64, f64), value| {
                (low.min(value), high.max(value))
            });
        if high - low < SMALLEST {
            return Self::between(0.0, 1.0);
        }
        Self::between(low, high)
    }

    fn between(low: f64, high: f64) -> Self {
        let exponent = ((high - low) / STEPS).log10().floor();
        let unit = power_of_ten(exponent);
        let factors = [1.0, 2.0, 5.0, 10.0];
        let fits = |factor: &&f64| (high - low) / (**factor * unit) <= STEPS;
        let step = factors
            .iter()
            .find(fits)
            .map_or(unit, |factor| factor * unit);
        let (first, last) = ((low / step).floor(), (high / step).ceil());
        let label = LinearLabel::new(step, low.abs().max(high.abs()));
        let mut ticks = Vec::new();
        let mut i = first;
        while i <= last {
            let value = i * step;
            let label = label.of(value);
            ticks.push(Tick { value, label });
            i += 1.0;
        }
        Self {
            low: first * step,
            high: last * step,
            logarithmic: false,
            ticks,
            fine: Vec::new(),
        }
    }

    /// A logarithmic axis over the positive ones of the values, with ends at 1, 2 or 5 times a power
    /// of ten; `None` where no value is positive. It goes down no more than so many decades from
    /// the largest value.
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
        let ends = rounded_outwards(lowest.max(bottom).max(SMALLEST), highest)?;
        let (low, high) = (value_of(ends.0), value_of(ends.1));
        let wide = (high / low).log10() > LABELLED_DECADES;
        let (labelled, between): (Vec<Round>, Vec<Round>) = (ends.0.1..=ends.1.1)
            .flat_map(|decade| (1..10).map(move |digit| (digit, decade)))
            .filter(|round| (low..=high).contains(&value_of(*round)))
            .partition(|(digit, _)| *digit == 1 || !wide && matches!(digit, 2 | 5));
        let every = labelled.len().div_ceil(MOST_LABELS);
        let ticks = labelled.iter().step_by(every).map(|&round| Tick {
            value: value_of(round),
            label: label_of(round),
        });
        let fine = between.into_iter().map(value_of);
        Some(Self {
            low,
            high,
            logarithmic: true,
            fine: fine
                .filter(|_| labelled.len() <= MOST_WITH_FINE_GRID)
                .collect(),
            ticks: ticks.collect(),
        })
    }

    /// The place of a value on the axis: 0 at its low end, 1 at its high end.
    pub(super) fn height(&self, value: f64) -> f64 {
        let value = if value.is_nan() {
            value
        } else {
            value.clamp(-LARGEST, LARGEST)
        };
        if self.logarithmic {
            let log = |value: f64| {
                if value.is_nan() {
                    value
                } else {
                    value.max(SMALLEST).log10()
                }
            };
            (log(value) - log(self.low)) / (log(self.high) - log(self.low))
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    /// Whether a value is on the axis.
    pub(super) fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// Whether it goes in decades.
    pub(super) fn is_logarithmic(&self) -> bool {
        self.logarithmic
    }

    /// The low end.
    pub(super) fn low(&self) -> f64 {
        self.low
    }

    /// The high end.
    pub(super) fn high(&self) -> f64 {
        self.high
    }
}

/// Ten to a whole power, as it is written: a product of tens would differ in the last digit.
fn power_of_ten(exponent: f64) -> f64 {
    format!("1e{exponent:.0}")
        .parse()
        .unwrap_or(f64::MIN_POSITIVE)
}

fn value_of((digit, decade): Round) -> f64 {
    let written = format!("{digit}e{decade}");
    written.parse().unwrap_or(f64::MIN_POSITIVE)
}

/// The closest 1, 2 or 5 times a power of ten that are not above `low` and not below `high`, and
/// not the same.
fn rounded_outwards(low: f64, high: f64) -> Option<(Round, Round)> {
    // One decade more to both sides: the logarithm of a value at an end may be rounded across it.
    let round: Vec<Round> = (decade_of(low) - 1..=decade_of(high) + 1)
        .flat_map(|decade| [1, 2, 5].map(|digit| (digit, decade)))
        .collect();
    let from = round.iter().rposition(|round| value_of(*round) <= low)?;
    let to = round.iter().position(|round| value_of(*round) >= high)?;
    let from = if from == to {
        from.checked_sub(1)?
    } else {
        from
    };
    Some((round[from], round[to]))
}

#[expect(clippy::cast_possible_truncation, reason = "the logarithm of a double")]
fn decade_of(value: f64) -> i32 {
    value.log10().floor() as i32
}

fn label_of((digit, decade): Round) -> String {
    if (-4..=4).contains(&decade) {
        value_of((digit, decade)).to_string()
    } else {
        format!("{digit}e{decade}")
    }
}

/// How the labels of a linear axis are written: all with the same decimals.
enum LinearLabel {
    Plain { decimals: usize },
    Scientific { step_decade: i32 },
}

impl LinearLabel {
    fn new(step: f64, largest: f64) -> Self {
        // A step of 1, 2 or 5 times a power of ten, but for its rounding.
        let step_decade = decade_of(1.001 * step);
        if largest >= 1e5 || step_decade < -4 {
            return Self::Scientific { step_decade };
        }
        Self::Plain {
            decimals: usize::try_from(-step_decade).unwrap_or(0),
        }
    }

    fn of(&self, value: f64) -> String {
        match self {
            _ if value == 0.0 => "0".to_owned(),
            Self::Plain { decimals } => format!("{value:.decimals$}"),
            Self::Scientific { step_decade } => {
                let digits = decade_of(1.001 * value.abs()) - step_decade;
                let digits = usize::try_from(digits).unwrap_or(0).min(15);
                format!("{value:.digits$e}")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<&str> {
        axis.ticks.iter().map(|tick| tick.label.as_str()).collect()
    }

    fn linear(values: &[f64]) -> Axis {
        Axis::linear(values.iter().copied())
    }

    fn logarithmic(values: &[f64]) -> Option<Axis> {
        Axis::logarithmic(values.iter().copied(), 6)
    }

    #[test]
    fn linear_axes_end_at_labels_and_hold_zero() {
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
    fn axes_of_odd_values_have_a_range() {
        for values in [
            &[][..],
            &[0.0],
            &[f64::NAN],
            &[-0.0, 1e-320],
            &[f64::MAX, f64::MIN],
            &[f64::INFINITY],
        ] {
            let axis = linear(values);
            assert!(axis.low < axis.high && axis.ticks.len() >= 2, "{values:?}");
            assert!(axis.ticks.len() < 12);
            assert!(axis.height(0.0).is_finite());
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
            assert!(axis.low < axis.high && axis.ticks.len() >= 2, "{values:?}");
            assert!(axis.height(0.0).is_finite() && axis.height(-1.0) <= 0.0);
        }
        assert_eq!(logarithmic(&[0.0, -1.0, f64::NAN]), None);
    }

    #[test]
    fn logarithmic_axes_end_at_1_2_5() {
        let wide = logarithmic(&[0.0035, 0.42]).unwrap();
        assert_eq!((wide.low, wide.high), (0.002, 0.5));
        assert_eq!(labels(&wide), ["0.01", "0.1"]);
        let narrow = logarithmic(&[0.03, 0.42]).unwrap();
        assert_eq!(labels(&narrow), ["0.02", "0.05", "0.1", "0.2", "0.5"]);
        assert_eq!(labels(&logarithmic(&[0.1]).unwrap()), ["0.05", "0.1"]);
        let deep = logarithmic(&[1e-12, 3.0]).unwrap();
        assert_eq!((deep.low, deep.high), (2e-6, 5.0));
        assert_eq!(labels(&deep)[..2], ["1e-5", "0.0001"]);
    }
}
