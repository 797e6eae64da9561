//! The results of many fits, as columns.

use brdf_core::ModelParameters;

/// What became of a scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(u8)]
#[non_exhaustive]
pub enum Status {
    /// The fit is inside the range of each parameter.
    #[default]
    Fitted = 0,
    /// k2 = 0: the readings show no lobe. k1, and n and p where they are free, are NaN.
    NoLobe = 1,
    /// kD = 0: the readings show no diffuse part.
    NoDiffuse = 2,
    /// k1 is at an end of its range.
    WidthAtEnd = 3,
    /// There are not more readings with a weight than free parameters: nothing is fitted.
    TooFewReadings = 4,
    /// All readings are zero: E is not defined, and nothing is fitted.
    AllZero = 5,
    /// A reading is infinite, or the largest one is not within 1e-30 and 1e30 1/sr: nothing is fitted.
    OutOfRange = 6,
}

impl Status {
    /// All, in the order of their numbers.
    pub const ALL: [Self; 7] = [
        Self::Fitted,
        Self::NoLobe,
        Self::NoDiffuse,
        Self::WidthAtEnd,
        Self::TooFewReadings,
        Self::AllZero,
        Self::OutOfRange,
    ];

    /// Whether there are parameters.
    pub fn is_fitted(self) -> bool {
        matches!(
            self,
            Self::Fitted | Self::NoLobe | Self::NoDiffuse | Self::WidthAtEnd
        )
    }

    /// A short description.
    pub fn description(self) -> &'static str {
        match self {
            Self::Fitted => "fitted",
            Self::NoLobe => "k2 = 0: no lobe",
            Self::NoDiffuse => "kD = 0: no diffuse part",
            Self::WidthAtEnd => "k1 at an end of its range",
            Self::TooFewReadings => "too few readings",
            Self::AllZero => "all readings are zero",
            Self::OutOfRange => "a reading is out of range",
        }
    }
}

/// The result of one scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Row {
    pub(super) at: ModelParameters,
    /// E as a fraction.
    pub(super) error: f64,
    pub(super) readings: u32,
    pub(super) status: Status,
    /// The standard errors of k2, kD, k1, n and p.
    pub(super) errors: [f64; 5],
}

impl Row {
    /// A scan that is not fitted.
    pub(super) fn without_fit(status: Status, readings: u32) -> Self {
        let nan = f64::NAN;
        Self {
            at: ModelParameters {
                k2: nan,
                kd: nan,
                k1: nan,
                n: nan,
                p: nan,
            },
            error: nan,
            readings,
            status,
            errors: [nan; 5],
        }
    }
}

/// The fits of many scans: one value for each scan in each column.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct BatchFit {
    /// k2, dimensionless.
    pub k2: Vec<f64>,
    /// kD, dimensionless.
    pub kd: Vec<f64>,
    /// k1; NaN where k2 = 0.
    pub k1: Vec<f64>,
    /// The refractive index: as stated, or as fitted.
    pub n: Vec<f64>,
    /// The exponent of the facet distribution; 1 where the model has none.
    pub p: Vec<f64>,
    /// E of eq. (5) in percent.
    pub e_percent: Vec<f64>,
    /// The number of readings of each scan that were taken and have a weight.
    pub readings: Vec<u32>,
    /// What became of each scan.
    pub status: Vec<Status>,
    /// The standard errors for constant noise, where they were asked for.
    pub constant_noise: Option<StandardErrors>,
}

/// Standard errors of the parameters, under the assumption that the readings times cos theta and the root
/// of their weight have independent errors of one size:
///
/// ```text
/// cov = s^2 (J^T J)^-1,   s^2 = sum r^2 / (readings - free parameters)
/// ```
///
/// Real scans have other errors as well, and these are then too small: docs/validation.md measures by how
/// much. NaN for parameters that are not free or are at an end of their range.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct StandardErrors {
    /// Of k2.
    pub k2: Vec<f64>,
    /// Of kD.
    pub kd: Vec<f64>,
    /// Of k1.
    pub k1: Vec<f64>,
    /// Of n.
    pub n: Vec<f64>,
    /// Of p.
    pub p: Vec<f64>,
}

impl BatchFit {
    pub(super) fn with_capacity(scans: usize, errors: bool) -> Self {
        let column = || Vec::with_capacity(scans);
        Self {
            k2: column(),
            kd: column(),
            k1: column(),
            n: column(),
            p: column(),
            e_percent: column(),
            readings: Vec::with_capacity(scans),
            status: Vec::with_capacity(scans),
            constant_noise: errors.then(|| StandardErrors {
                k2: column(),
                kd: column(),
                k1: column(),
                n: column(),
                p: column(),
            }),
        }
    }

    /// The number of scans.
    pub fn len(&self) -> usize {
        self.k2.len()
    }

    /// Whether there are no scans.
    pub fn is_empty(&self) -> bool {
        self.k2.is_empty()
    }

    /// The rms of the residuals in percent of that of the readings, sqrt(E), of each scan.
    pub fn rms_percent(&self) -> impl Iterator<Item = f64> {
        self.e_percent.iter().map(|e| 10.0 * e.sqrt())
    }

    pub(super) fn push(&mut self, row: &Row) {
        let Row { at, error, .. } = row;
        self.k2.push(at.k2);
        self.kd.push(at.kd);
        self.k1.push(at.k1);
        self.n.push(at.n);
        self.p.push(at.p);
        self.e_percent.push(100.0 * error);
        self.readings.push(row.readings);
        self.status.push(row.status);
        if let Some(errors) = &mut self.constant_noise {
            let columns = [
                &mut errors.k2,
                &mut errors.kd,
                &mut errors.k1,
                &mut errors.n,
                &mut errors.p,
            ];
            for (column, error) in columns.into_iter().zip(row.errors) {
                column.push(error);
            }
        }
    }
}
