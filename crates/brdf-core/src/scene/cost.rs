//! What an evaluation costs on the machine at hand.

use std::time::{Duration, Instant};

use super::probe::{Probe, single_value};
use crate::evaluator::{Evaluator, Precision};
use crate::family::AnyBrdf;
use crate::numeric::Primitive;

/// For how long an evaluator is timed, if one pass is not longer.
const WATCHED: Duration = Duration::from_millis(3);

/// Points by which the cost is measured: by one thread, in the caches. No power of two: arrays that lie
/// a multiple of 4 KiB apart get in each other's way, which doubled the time of `f32`.
pub const TIMED: usize = 3000;

/// Passes of the shortest of which the time is taken: whatever else the machine does only adds.
const LEAST_PASSES: u32 = 5;

/// What an evaluation at the points of a probe costs in nanoseconds, with arrays of the evaluator's
/// own precision: the shortest of several passes. Probes of fewer than
/// [`PARALLEL_FROM`](crate::evaluator::PARALLEL_FROM) points are evaluated by one thread, larger ones
/// by all of the current rayon pool.
pub fn cost(evaluator: &dyn Evaluator, probe: &Probe) -> f64 {
    // The arrays have one length.
    match evaluator.precision() {
        Precision::Double => shortest(probe.count(), |out: &mut [f64]| {
            let _ = evaluator.values(&probe.points(), out);
        }),
        Precision::Single => shortest(probe.count(), |out: &mut [f32]| {
            let _ = evaluator.values_f32(&probe.points_f32(), out);
        }),
    }
}

/// What [`AnyBrdf::value`] costs in nanoseconds, called for one point after the other, the geometry
/// included: what a user would write first.
pub fn cost_of_single_values(brdf: &AnyBrdf, probe: &Probe) -> f64 {
    let points = probe.points();
    shortest(probe.count(), |out: &mut [f64]| {
        for (i, out) in out.iter_mut().enumerate() {
            *out = single_value(brdf, &points, i);
        }
    })
}

fn shortest<T: Primitive>(count: usize, mut pass: impl FnMut(&mut [T])) -> f64 {
    let mut out = vec![T::default(); count];
    pass(&mut out);
    let begin = Instant::now();
    let mut least = Duration::MAX;
    let mut passes = 0;
    while passes < LEAST_PASSES || begin.elapsed() < WATCHED {
        let start = Instant::now();
        pass(&mut out);
        least = least.min(start.elapsed());
        passes += 1;
    }
    least.as_secs_f64() * 1e9 / count.max(1) as f64
}
