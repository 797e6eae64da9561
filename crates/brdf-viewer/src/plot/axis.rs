//! Linear and logarithmic axes of egui_plot, which itself knows only linear ones: values on a
//! logarithmic axis are plotted at their decimal logarithms.

use brdf_fit::plot::Scale;
use egui_plot::{GridInput, GridMark};

use super::ticks::{self, Tick, linear_label, logarithmic_label};

/// The height of a label, as a multiple of the smallest grid step.
const LABEL_HEIGHT: f64 = 2.6;

/// The width of a label, as a multiple of the smallest grid step.
const LABEL_WIDTH: f64 = 6.0;

/// The scale of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// Values are at their own positions.
    Linear,
    /// Values are at their decimal logarithms.
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
    /// The position of a value; `None` if it is not finite, as for values on a logarithmic axis that
    /// are not positive.
    pub fn position(self, value: f64) -> Option<f64> {
        let position = match self {
            Self::Linear => value,
            Self::Logarithmic if value > 0.0 => value.log10(),
            Self::Logarithmic => return None,
        };
        position.is_finite().then_some(position)
    }

    /// The value at a position.
    pub fn value(self, position: f64) -> f64 {
        match self {
            Self::Linear => position,
            Self::Logarithmic => 10_f64.powf(position),
        }
    }

    /// The grid lines of a vertical axis.
    pub fn vertical_grid(self, input: &GridInput) -> Vec<GridMark> {
        self.grid(input, LABEL_HEIGHT)
    }

    /// The grid lines of a horizontal axis.
    pub fn horizontal_grid(self, input: &GridInput) -> Vec<GridMark> {
        self.grid(input, LABEL_WIDTH)
    }

    /// The grid lines of a horizontal axis of whole numbers.
    pub fn integer_grid(input: &GridInput) -> Vec<GridMark> {
        let mut grid = Self::Linear.horizontal_grid(input);
        grid.retain(|mark| (mark.value - mark.value.round()).abs() < 1e-9);
        grid
    }

    fn grid(self, input: &GridInput, label_size: f64) -> Vec<GridMark> {
        marks(match self {
            Self::Linear => linear(input, label_size),
            Self::Logarithmic => ticks::logarithmic(input.bounds),
        })
    }

    /// The label of a grid line; empty if it has none.
    pub fn label(self, mark: GridMark, range: &std::ops::RangeInclusive<f64>) -> String {
        match self {
            Self::Linear => linear_label(mark.value, mark.step_size),
            Self::Logarithmic => {
                let decades = range.end() - range.start();
                if ticks::is_labelled(mark.value, decades) {
                    logarithmic_label(self.value(mark.value))
                } else {
                    String::new()
                }
            }
        }
    }
}

/// The grid lines of a horizontal axis of an angle in degrees.
pub fn degrees_grid(input: &GridInput) -> Vec<GridMark> {
    marks(ticks::degrees(input.bounds).unwrap_or_else(|| linear(input, LABEL_WIDTH)))
}

fn linear(input: &GridInput, label_size: f64) -> Vec<Tick> {
    ticks::linear(input.bounds, label_size * input.base_step_size)
}

fn marks(ticks: Vec<Tick>) -> Vec<GridMark> {
    let mark = |tick: Tick| GridMark {
        value: tick.position,
        step_size: tick.spacing,
    };
    ticks.into_iter().map(mark).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn positions(axis: Axis, low: f64, high: f64) -> Vec<f64> {
        let marks = axis.vertical_grid(&GridInput {
            bounds: (low, high),
            base_step_size: (high - low) / 40.0,
        });
        marks.iter().map(|mark| mark.value).collect()
    }

    #[test]
    fn a_logarithmic_grid_has_decades_and_their_parts() {
        let marks = positions(Axis::Logarithmic, -3.0, 0.0);
        for value in [0.001, 0.002, 0.009, 0.01, 0.5, 1.0_f64] {
            assert!(
                marks.iter().any(|m| (m - value.log10()).abs() < 1e-12),
                "{value}"
            );
        }
        assert_eq!(positions(Axis::Logarithmic, -30.0, 30.0).len() % 2, 1);
    }

    #[test]
    fn within_a_decade_the_grid_has_round_values() {
        let marks = positions(Axis::Logarithmic, 0.02_f64.log10(), 0.03_f64.log10());
        assert!(marks.len() > 4, "{marks:?}");
        let is_round = |m: &f64| {
            let value = 10_f64.powf(*m) * 1000.0;
            (value - value.round()).abs() < 1e-9
        };
        assert!(marks.iter().all(is_round), "{marks:?}");
    }

    /// At bounds where a step is below the resolution of the numbers.
    #[test]
    fn far_from_zero_the_grid_stays_small() {
        for low in [1e15, 1e16, -1e17, 1e300] {
            for width in [0.5, 4.0, 64.0, 1e10] {
                for axis in [Axis::Linear, Axis::Logarithmic] {
                    assert!(positions(axis, low, low + width).len() < 2000);
                }
            }
        }
    }

    #[test]
    fn values_that_are_not_positive_have_no_position_on_a_logarithmic_axis() {
        assert_eq!(Axis::Logarithmic.position(0.0), None);
        assert_eq!(Axis::Logarithmic.position(-1.0), None);
        assert_eq!(Axis::Logarithmic.position(0.01), Some(-2.0));
        assert_eq!(Axis::Linear.position(f64::NAN), None);
    }
}
