//! The angles of the axes: each axis is refined on its own.

use std::cell::RefCell;

use super::{Angles, Tabulated, indices};

/// The largest number of angles on one axis: with more, the other axes would have almost none.
const MAX_ANGLES: usize = 2000;

/// How many of the points that limited the last steps of a refinement are tried first.
const LIMITS: usize = 6;

/// The axes for a maximum relative error along each of them; `None` where a table has more than `most`
/// points.
pub(super) fn axes(
    function: &impl Tabulated,
    failed: &[Angles],
    max_error: f64,
    most: usize,
) -> Option<[Vec<f64>; 3]> {
    let samples = function.samples();
    let mut points = 1;
    let mut axes: [Vec<f64>; 3] = Default::default();
    for (axis, angles) in axes.iter_mut().enumerate() {
        let refinement = Refinement::new(function, axis, &samples, failed, max_error);
        *angles = refinement.angles(most / points)?;
        points *= angles.len();
    }
    Some(axes)
}

/// The refinement of one axis.
struct Refinement<'a, F> {
    function: &'a F,
    axis: usize,
    /// The points at which the error along the axis is computed; their angle on the axis is
    /// ignored.
    points: Vec<Angles>,
    max_error: f64,
    /// Where the interpolation came closest to the maximum error, or exceeded it, in the last steps.
    limiting: RefCell<Vec<Limit>>,
}

/// The position of a point among those of a refinement, followed by those of a lobe, and a channel.
type Limit = (usize, usize);

impl<'a, F: Tabulated> Refinement<'a, F> {
    fn new(
        function: &'a F,
        axis: usize,
        samples: &[Vec<f64>; 3],
        failed: &[Angles],
        max_error: f64,
    ) -> Self {
        let mut lists = samples.clone();
        lists[axis] = vec![0.0];
        let product = indices(lists.each_ref().map(Vec::len));
        let at = |index: [usize; 3]| std::array::from_fn(|axis| lists[axis][index[axis]]);
        let points = product.map(at).chain(failed.iter().copied()).collect();
        Self {
            function,
            axis,
            points,
            max_error,
            limiting: RefCell::default(),
        }
    }

    /// The angles, as far apart as the maximum error allows; `None` where they are more than
    /// `most`.
    fn angles(&self, most: usize) -> Option<Vec<f64>> {
        let (from, to) = self.function.ranges()[self.axis];
        let smallest = (to - from) * 1e-6;
        let (mut angles, mut angle) = (vec![from], from);
        let most = most.min(MAX_ANGLES);
        let mut step = (to - from) / 64.0;
        while angle < to {
            step = (2.0 * step).min(to - angle);
            while step > smallest && !self.is_linear(angle, angle + step) {
                step *= 0.8;
            }
            let next = self.function.rounded(angle + step).min(to);
            angle = if next > angle {
                next
            } else {
                (angle + smallest).min(to)
            };
            if angles.len() >= most {
                return None;
            }
            angles.push(angle);
        }
        Some(angles)
    }

    /// Whether linear interpolation between two angles is within the maximum error at all points.
    ///
    /// The points that limited the last steps are tried first, because they are likely to limit this
    /// one: most steps that are too long are found to be so at one of them.
    fn is_linear(&self, from: f64, to: f64) -> bool {
        let lobe = self.function.lobe_points(self.axis, 0.5 * (from + to));
        let mut limiting = self.limiting.borrow_mut();
        let failing = |&(i, channel): &Limit| {
            let own = self.points.len();
            let point = self.points.get(i).or_else(|| lobe.get(i - own));
            let stretch = point.and_then(|point| self.stretch(point, from, to));
            stretch.is_some_and(|stretch| self.error(&stretch, channel).is_none())
        };
        if let Some(known) = limiting.iter().position(failing) {
            limiting[..=known].rotate_right(1);
            return false;
        }
        let (mut largest, mut limit) = (0.0, None);
        for (i, point) in self.points.iter().chain(&lobe).enumerate() {
            let Some(stretch) = self.stretch(point, from, to) else {
                continue;
            };
            for channel in 0..self.function.channels() {
                match self.error(&stretch, channel) {
                    None => {
                        remember(&mut limiting, (i, channel));
                        return false;
                    }
                    Some(error) if error > largest => {
                        (largest, limit) = (error, Some((i, channel)));
                    }
                    Some(_) => {}
                }
            }
        }
        if let Some(limit) = limit {
            remember(&mut limiting, limit);
        }
        true
    }

    /// What the interpolation between two angles at a point needs; `None` where the tolerance does not
    /// apply.
    fn stretch(&self, point: &Angles, from: f64, to: f64) -> Option<Stretch<F::Point>> {
        let at = |angle: f64| {
            let mut at = *point;
            at[self.axis] = angle;
            at
        };
        let between = [0.5, 0.25, 0.75].map(|within| {
            let point = self.function.point(at(from + within * (to - from)));
            let applies = self.function.tolerance_applies(&point);
            (within, applies.then_some(point))
        });
        let applies = between.iter().any(|(_, point)| point.is_some());
        applies.then(|| Stretch {
            ends: [from, to].map(|angle| self.function.point(at(angle))),
            between,
        })
    }

    /// The largest relative error of the interpolation of a channel; `None` where it exceeds the maximum.
    fn error(&self, stretch: &Stretch<F::Point>, channel: usize) -> Option<f64> {
        let value = |point| self.function.value(channel, point);
        let [first, last] = stretch.ends.each_ref().map(value);
        let mut largest = 0.0_f64;
        for (within, point) in &stretch.between {
            let Some(exact) = point.as_ref().map(value) else {
                continue;
            };
            let error = (first + within * (last - first) - exact).abs();
            let is_within = error <= self.max_error * exact.abs();
            if !is_within {
                return None;
            }
            largest = largest.max(error / exact.abs());
        }
        Some(largest)
    }
}

/// Puts a limit before those that are known, of which the oldest is forgotten.
fn remember(limiting: &mut Vec<Limit>, limit: Limit) {
    limiting.retain(|known| *known != limit);
    limiting.insert(0, limit);
    limiting.truncate(LIMITS);
}

/// The points between two angles at which the interpolation is checked.
struct Stretch<P> {
    ends: [P; 2],
    /// How far each point is from the first end, as a part of the distance, and the point where the
    /// tolerance applies.
    between: [(f64, Option<P>); 3],
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::interpolated::tests::Ridges;

    #[test]
    fn a_step_is_limited_by_the_points_that_limited_the_last_ones() {
        let ridge = Ridges::new([0.1]);
        let samples = ridge.samples();
        let refinement = Refinement::new(&ridge, 0, &samples, &[], 1e-3);
        let angles = refinement.angles(MAX_ANGLES).unwrap();
        // Each accepted step is checked at four points with five values, each refused one at hardly
        // more than one.
        let each = ridge.evaluations.get() as f64 / angles.len() as f64;
        assert!(each < 45.0, "{each}");
    }
}
