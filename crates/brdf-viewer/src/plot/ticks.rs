//! Ticks of linear and logarithmic axes, and their labels.
//!
//! Positions on a logarithmic axis are decimal logarithms of the values. Nothing here depends on
//! egui.

/// A grid line of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tick {
    /// The position on the axis.
    pub position: f64,
    /// The distance to lines of the same importance. Only a line with enough space has a label.
    pub spacing: f64,
}

/// Ticks at multiples of a round number that is at least `label_spacing`, and finer ones between
/// them.
pub fn linear((low, high): (f64, f64), label_spacing: f64) -> Vec<Tick> {
    let labelled = round_up(label_spacing);
    let leading = labelled / 10_f64.powf(labelled.log10().floor());
    let parts = if (1.5..4.0).contains(&leading) {
        4.0
    } else {
        5.0
    };
    let mut ticks = multiples(low, high, labelled / parts);
    for tick in &mut ticks {
        let index = (tick.position / tick.spacing).round();
        if index.rem_euclid(parts) == 0.0 {
            tick.spacing = labelled;
        }
    }
    ticks
}

/// Ticks at powers of ten, and at 2 to 9 times these. Over less than a decade, ticks at multiples of
/// a round value.
pub fn logarithmic((low, high): (f64, f64)) -> Vec<Tick> {
    if high - low < 0.7 {
        return within_a_decade(low, high);
    }
    let (first, last) = (low.floor(), high.ceil());
    let decades = last - first;
    let every = (decades / 12.0).ceil().max(1.0);
    let mut ticks = multiples((first / every).floor() * every, last, every);
    if decades <= 8.0 {
        let between = |decade: f64| {
            (2..10).map(move |digit| Tick {
                position: decade + f64::from(digit).log10(),
                spacing: 0.1,
            })
        };
        let between: Vec<Tick> = ticks
            .iter()
            .flat_map(|tick| between(tick.position))
            .collect();
        ticks.extend(between);
    }
    ticks.retain(|tick| (low..=high).contains(&tick.position));
    ticks
}

/// Whether a tick of a logarithmic axis has a label: powers of ten always, 2 and 5 times these over
/// fewer than four decades, and all over less than a decade.
pub fn is_labelled(position: f64, decades: f64) -> bool {
    let leading = 10_f64.powf(position - (position + 1e-9).floor());
    let is = |digit: f64| (leading - digit).abs() < 1e-6;
    decades < 0.7 || is(1.0) || (decades < 4.0 && (is(2.0) || is(5.0)))
}

fn within_a_decade(low: f64, high: f64) -> Vec<Tick> {
    let spacing = (high - low) / 10.0;
    let (low, high) = (10_f64.powf(low), 10_f64.powf(high));
    let values = multiples(low, high, round_up((high - low) / 10.0));
    let positive = values.into_iter().filter(|value| value.position > 0.0);
    positive
        .map(|value| Tick {
            position: value.position.log10(),
            spacing,
        })
        .collect()
}

/// Ticks of an angle in degrees, at multiples of 5°: the spacing of multiples of 15°, 30° and 90° is
/// larger. `None` over less than 40°, where [`linear`] ticks are finer.
pub fn degrees((low, high): (f64, f64)) -> Option<Vec<Tick>> {
    if high - low < 40.0 {
        return None;
    }
    let mut ticks = multiples(low, high, 5.0);
    for tick in &mut ticks {
        let is_multiple = |step: &f64| tick.position.rem_euclid(*step) == 0.0;
        let spacing = [90.0, 30.0, 15.0].into_iter().find(is_multiple);
        tick.spacing = spacing.unwrap_or(5.0);
    }
    Some(ticks)
}

/// The multiples of a step from `low` to `high`. There are none if there were more than 2000, or if
/// the step is below the resolution of the numbers.
fn multiples(low: f64, high: f64, step: f64) -> Vec<Tick> {
    let (first, last) = ((low / step).ceil(), (high / step).floor());
    let count = last - first;
    if !(0.0..2000.0).contains(&count) || first + 1.0 == first || last + 1.0 == last {
        return Vec::new();
    }
    let tick = |i: u32| Tick {
        position: (first + f64::from(i)) * step,
        spacing: step,
    };
    (0..=count as u32).map(tick).collect()
}

/// The smallest of 1, 2 and 5 times a power of ten that is not below a positive number.
pub fn round_up(least: f64) -> f64 {
    let decade = 10_f64.powf(least.log10().floor());
    let steps = [1.0, 2.0, 5.0].map(|step| step * decade);
    steps
        .into_iter()
        .find(|step| *step >= least)
        .unwrap_or(10.0 * decade)
}

/// A value on a linear axis, with the decimals of the step between labels.
pub fn linear_label(value: f64, step: f64) -> String {
    let decimals = -step.log10().floor();
    // A multiple of the step that should be zero may be a rounding error.
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

/// A value on a logarithmic axis: 10, 0.1, 2e-5.
pub fn logarithmic_label(value: f64) -> String {
    let exponent = value.log10();
    if (-3.5..4.5).contains(&exponent) {
        let text = format!("{value:.6}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        let text = format!("{value:.2e}");
        text.replace(".00e", "e").replace("0e", "e")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_have_the_decimals_of_their_step() {
        assert_eq!(linear_label(0.1 + 0.2, 0.1), "0.3");
        assert_eq!(linear_label(-1e-18, 0.1), "0.0");
        assert_eq!(linear_label(40.0, 20.0), "40");
        assert_eq!(linear_label(2e-7, 1e-7), "2.00e-7");
        assert_eq!(logarithmic_label(0.01), "0.01");
        assert_eq!(logarithmic_label(1e-6), "1e-6");
        assert_eq!(logarithmic_label(100.0), "100");
    }

    #[test]
    fn round_numbers_are_1_2_and_5_of_a_decade() {
        assert_eq!(round_up(1.0), 1.0);
        assert_eq!(round_up(1.1), 2.0);
        assert_eq!(round_up(0.046), 0.05);
        assert_eq!(round_up(70.0), 100.0);
    }
}
