//! What all fuzz targets do: read the bytes as a format and look at what came out.

use brdf_fit::Measurements;
use brdf_fit::read::ReadOptions;
use brdf_fit::scan::{Format, Side};

/// Reads the bytes as a format, on the sides that it has and on others: what is read is in the
/// model's domain, and what is not is an error.
pub fn read(bytes: &[u8], format: Option<Format>, name: &str) {
    for (side, sample) in [(None, None), (Some(Side::Forward), None), (None, Some(3))] {
        let options = ReadOptions {
            format,
            phi_zero: side,
            theta_positive: side,
            sample,
        };
        if let Ok(scan) = Measurements::from_bytes(name, bytes, &options) {
            assert!(!scan.readings().is_empty());
            for reading in scan.readings() {
                reading.validated().expect("a reading in the domain");
                reading.geometry().expect("a geometry in the domain");
            }
        }
    }
}
