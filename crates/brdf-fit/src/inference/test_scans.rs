//! Scans and options that the tests of this layer share.

use brdf_core::Parameters;

use crate::fit::FitOptions;
use crate::scan::synthetic::scan;
use crate::scan::{Measurements, RefractiveIndex};

/// A scan of the paper's model with k2, kD and k1, each reading changed by up to the fraction
/// `ripple`, which no parameter follows.
pub(super) fn rippled([k2, kd, k1]: [f64; 3], n: f64, ripple: f64) -> Measurements {
    let truth = Parameters::new(k2, kd, k1).unwrap();
    let mut readings = scan(truth, n).readings().to_vec();
    for (i, reading) in readings.iter_mut().enumerate() {
        reading.brdf *= 1.0 + ripple * (2.4 * i as f64).sin();
    }
    Measurements::new("test", readings).unwrap()
}

/// The default options at n = 1.5.
pub(super) fn options() -> FitOptions {
    FitOptions {
        refractive_index: Some(RefractiveIndex::Same(1.5)),
        ..FitOptions::default()
    }
}
