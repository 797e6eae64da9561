//! How values are distances from a centre, in the polar plot and in a lobe.

use brdf_fit::plot::Scale;

use super::ticks::{linear_label, logarithmic_label, round_up};

/// The largest number of circles. There are at least three, except for the smallest numbers.
const MOST_CIRCLES: f64 = 5.0;

/// How values are distances from the centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Radius {
    /// In proportion, up to the outermost circle, with a circle at each step.
    Linear {
        /// The value of the outermost circle.
        outermost: f64,
        /// The step.
        step: f64,
    },
    /// By their logarithm: the exponents of ten at the centre and at the outermost circle.
    Logarithmic {
        /// The exponent of the centre.
        centre: f64,
        /// The exponent of the outermost circle.
        outermost: f64,
    },
}

impl Radius {
    /// The radius for values in a range.
    pub fn new((least, most): (f64, f64), scale: Scale) -> Self {
        match scale {
            Scale::Linear => {
                let (outermost, step) = circles(most);
                Self::Linear { outermost, step }
            }
            Scale::Logarithmic => {
                let outermost = most.log10().ceil();
                Self::Logarithmic {
                    centre: least.log10().floor().min(outermost - 1.0),
                    outermost,
                }
            }
        }
    }

    /// The distance of a value from the centre; `None` where it has none. On a logarithmic axis, values
    /// below that of the centre are at the centre.
    pub fn of(self, value: f64) -> Option<f64> {
        match self {
            Self::Linear { .. } => (value >= 0.0).then_some(value),
            Self::Logarithmic { centre, .. } => {
                (value > 0.0).then(|| (value.log10() - centre).max(0.0))
            }
        }
    }

    /// [`Self::of`] as a fraction of the distance of the outermost circle.
    pub fn fraction(self, value: f64) -> Option<f64> {
        Some(self.of(value)? / self.outermost())
    }

    /// The distance of the outermost circle.
    pub fn outermost(self) -> f64 {
        match self {
            Self::Linear { outermost, .. } => outermost,
            Self::Logarithmic { centre, outermost } => outermost - centre,
        }
    }

    /// The values of the circles, with their labels.
    pub fn circles(self) -> Vec<(f64, String)> {
        match self {
            Self::Linear { outermost, step } => {
                let values = values(outermost, step);
                values
                    .map(|value| (value, linear_label(value, step)))
                    .collect()
            }
            Self::Logarithmic { centre, outermost } => {
                let decades = (outermost - centre) as u32;
                let value = |i: u32| 10_f64.powf(centre + f64::from(i));
                let values = (1..=decades).map(value);
                values
                    .map(|value| (value, logarithmic_label(value)))
                    .collect()
            }
        }
    }
}

/// The radius of the outermost circle, and the step from circle to circle.
fn circles(largest: f64) -> (f64, f64) {
    let step = round_up(if largest > 0.0 { largest } else { 1.0 } / MOST_CIRCLES);
    ((largest / step).ceil().max(1.0) * step, step)
}

/// The values of the circles.
fn values(radius: f64, step: f64) -> impl Iterator<Item = f64> {
    let count = (radius / step).round() as u32;
    (1..=count).map(move |i| f64::from(i) * step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_value_uses_most_of_the_radius() {
        for largest in [0.021, 0.1, 0.21, 0.33, 0.51, 0.9, 1.01, 7e-5, 3e4] {
            let (radius, step) = circles(largest);
            assert!(
                largest <= radius * (1.0 + 1e-12) && largest > 0.66 * radius,
                "{largest}"
            );
            assert!((2..=5).contains(&values(radius, step).count()), "{largest}");
        }
        assert_eq!(circles(0.0).1, 0.2);
    }

    #[test]
    fn a_logarithmic_radius_has_a_circle_for_each_decade() {
        let radius = Radius::new((0.004, 0.7), Scale::Logarithmic);
        assert_eq!(radius.outermost(), 3.0);
        assert_eq!(radius.circles().len(), 3);
        assert!((radius.of(0.1).unwrap() - 2.0).abs() < 1e-12);
        assert_eq!(radius.of(1e-9), Some(0.0));
        assert_eq!(radius.of(0.0), None);
    }
}
