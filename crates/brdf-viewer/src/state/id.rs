//! Identifiers of samples and scans.

/// Identifies a sample while it is open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SampleId(pub u64);

/// Identifies a scan: one wavelength of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ScanId {
    /// The sample.
    pub sample: SampleId,
    /// The index of the wavelength among the scans of the sample.
    pub wavelength: usize,
}
