//! What an evaluation costs on the machine at hand.

use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::Probe;
use crate::evaluator::{Evaluator, Precision};
use crate::real::Primitive;

/// For how long an evaluator is timed, if one pass is not longer.
const WATCHED: Duration = Duration::from_millis(3);

/// Passes of the shortest of which the time is taken: whatever else the machine does only adds.
const LEAST_PASSES: u32 = 5;

/// Nanoseconds for each evaluation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// On one core, with arrays of the evaluator's own precision.
    pub nanoseconds: f64,
}

/// What an evaluation at the points of a probe costs, with arrays of the evaluator's own precision:
/// the shortest of several passes. Probes of fewer than 2^14 points are evaluated by one thread,
/// larger ones by all of the current rayon pool.
pub fn cost(evaluator: &dyn Evaluator, probe: &Probe) -> Cost {
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

fn shortest<T: Primitive>(count: usize, mut pass: impl FnMut(&mut [T])) -> Cost {
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
    Cost {
        nanoseconds: least.as_secs_f64() * 1e9 / count.max(1) as f64,
    }
}
