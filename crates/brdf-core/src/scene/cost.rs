//! The time of an evaluation on the present machine.

use web_time::{Duration, Instant};

use super::probe::{Probe, single_value};
use crate::evaluator::{Evaluator, Precision};
use crate::family::AnyBrdf;
use crate::numeric::Primitive;

/// The least time for which an evaluator is measured.
const LEAST_TIME: Duration = Duration::from_millis(3);

/// The number of points at which the cost on one thread is measured, with arrays in the caches. It is
/// not a power of two, because arrays at a distance of a multiple of 4 KiB share cache sets, which
/// doubled the time in `f32`.
pub const TIMED: usize = 3000;

/// The least number of passes. The time of the shortest pass counts, because other work of the machine
/// only adds to it.
const LEAST_PASSES: u32 = 5;

/// The time of one evaluation at the points of a probe, in nanoseconds, with arrays of the evaluator's
/// own precision.
///
/// It is taken from the shortest of several passes. Probes of fewer than
/// [`PARALLEL_FROM`](crate::evaluator::PARALLEL_FROM) points are evaluated on one thread, larger ones
/// on all threads of the current rayon pool.
pub fn cost(evaluator: &dyn Evaluator, probe: &Probe) -> f64 {
    // All arrays have the same length, so that there is no error.
    match evaluator.precision() {
        Precision::Double => shortest(probe.count(), |out: &mut [f64]| {
            let _ = evaluator.values(&probe.points(), out);
        }),
        Precision::Single => shortest(probe.count(), |out: &mut [f32]| {
            let _ = evaluator.values_f32(&probe.points_f32(), out);
        }),
    }
}

/// The time of one call of [`AnyBrdf::value`], in nanoseconds, including that of the geometry, in a
/// loop over the points.
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
    while passes < LEAST_PASSES || begin.elapsed() < LEAST_TIME {
        let start = Instant::now();
        pass(&mut out);
        least = least.min(start.elapsed());
        passes += 1;
    }
    least.as_secs_f64() * 1e9 / count.max(1) as f64
}
