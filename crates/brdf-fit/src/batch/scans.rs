//! Readings of many scans in memory.

use super::plan::BatchError;

/// Readings of many scans, `f64` or `f32`, as they lie in memory.
#[derive(Debug, Clone, Copy)]
pub struct Scans<'a, T> {
    values: &'a [T],
    count: usize,
    pub(super) readings: usize,
    scan_stride: usize,
    reading_stride: usize,
}

impl<'a, T> Scans<'a, T> {
    /// Scans whose readings are adjacent, one scan after the other.
    ///
    /// # Errors
    ///
    /// The number of values is not a multiple of the number of readings.
    pub fn new(values: &'a [T], readings: usize) -> Result<Self, BatchError> {
        let scans = values.len().checked_div(readings).unwrap_or(0);
        if scans * readings != values.len() {
            return Err(BatchError::Length {
                found: values.len(),
                expected: (scans + 1) * readings,
            });
        }
        Self::strided(values, [scans, readings], [readings, 1])
    }

    /// Reading j of scan i is at i times the first stride plus j times the second.
    ///
    /// # Errors
    ///
    /// There are fewer values than the shape needs.
    pub fn strided(
        values: &'a [T],
        [scans, readings]: [usize; 2],
        [scan_stride, reading_stride]: [usize; 2],
    ) -> Result<Self, BatchError> {
        let last = |count: usize, stride: usize| count.saturating_sub(1).saturating_mul(stride);
        let expected = if scans == 0 || readings == 0 {
            0
        } else {
            last(scans, scan_stride)
                .saturating_add(last(readings, reading_stride))
                .saturating_add(1)
        };
        if values.len() < expected {
            return Err(BatchError::Length {
                found: values.len(),
                expected,
            });
        }
        Ok(Self {
            values,
            count: scans,
            readings,
            scan_stride,
            reading_stride,
        })
    }

    /// The number of scans.
    pub fn len(&self) -> usize {
        self.count
    }

    /// # Errors
    ///
    /// The scans have another number of readings.
    pub(crate) fn check(&self, readings: usize) -> Result<(), BatchError> {
        if self.readings == readings || self.is_empty() {
            return Ok(());
        }
        Err(BatchError::Readings {
            found: self.readings,
            expected: readings,
        })
    }

    /// Whether there are no scans.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }
}

impl<T: Copy + Into<f64>> Scans<'_, T> {
    /// Copies the readings of a scan.
    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a function that is not inlined is not compiled for the present processor"
    )]
    pub(crate) fn load(&self, scan: usize, to: &mut [f64]) {
        let start = scan * self.scan_stride;
        if self.reading_stride == 1 {
            let values = &self.values[start..start + to.len()];
            for (to, value) in to.iter_mut().zip(values) {
                *to = (*value).into();
            }
        } else {
            for (j, to) in to.iter_mut().enumerate() {
                *to = self.values[start + j * self.reading_stride].into();
            }
        }
    }
}
