//! A few functions that stand for many, where a table of all of them may be too large.

use super::{Angles, Tabulated};

/// The number of functions that stand for many others where a table of these may be too large.
const FEW_CHANNELS: usize = 8;

/// Some functions that stand for many others. A table of all of them has about as many points as one of
/// these, or more.
pub(super) struct Few<'a, F> {
    function: &'a F,
    channels: [usize; FEW_CHANNELS],
}

impl<'a, F: Tabulated> Few<'a, F> {
    /// `None` where there are not many functions.
    pub(super) fn of(function: &'a F) -> Option<Self> {
        let (all, few) = (function.channels(), FEW_CHANNELS);
        (all > few).then(|| Self {
            function,
            channels: std::array::from_fn(|i| i * (all - 1) / (few - 1)),
        })
    }
}

impl<F: Tabulated> Tabulated for Few<'_, F> {
    type Point = F::Point;

    fn point(&self, at: Angles) -> F::Point {
        self.function.point(at)
    }

    fn channels(&self) -> usize {
        FEW_CHANNELS
    }

    fn ranges(&self) -> [(f64, f64); 3] {
        self.function.ranges()
    }

    fn value(&self, channel: usize, at: &F::Point) -> f64 {
        self.function.value(self.channels[channel], at)
    }

    fn tolerance_applies(&self, at: &F::Point) -> bool {
        self.function.tolerance_applies(at)
    }

    fn samples(&self) -> [Vec<f64>; 3] {
        self.function.samples()
    }

    fn lobe_points(&self, axis: usize, angle: f64) -> Vec<Angles> {
        self.function.lobe_points(axis, angle)
    }

    fn rounded(&self, angle: f64) -> f64 {
        self.function.rounded(angle)
    }

    fn is_defined(&self, at: Angles) -> bool {
        self.function.is_defined(at)
    }
}
