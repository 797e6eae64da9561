//! The check that all fuzz targets share: the bytes are read as a file, and the readings are valid.

use brdf_fit::Measurements;
use brdf_fit::read::ReadOptions;
use brdf_fit::{Format, Side};

/// Reads the bytes in a format, or in the format that is detected: as they are, with the angular
/// convention reversed, and with 3 readings kept. The result is an error, or readings in the model's
/// domain.
///
/// # Panics
///
/// A scan has no readings, or one outside the model's domain: that is a fault in the reader.
pub fn read(bytes: &[u8], format: Option<Format>, name: &str) {
    for (side, sample) in [(None, None), (Some(Side::Forward), None), (None, Some(3))] {
        let options = ReadOptions {
            format,
            phi_zero: side,
            theta_positive: side,
            sample,
            ..ReadOptions::default()
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
