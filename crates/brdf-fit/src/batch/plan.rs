//! What scans of the same angles share.

use brdf_core::N_DOMAIN;

use super::own::OwnTable;
use super::table::Table;
use crate::format::in_degrees;
use crate::model::{Model, Parameter, ReducedModel};
use crate::objective::weights::{AssumedErrors, Weights};
use crate::objective::{Objective, ObjectiveError};
use crate::scan::{Measurement, MeasurementError, Measurements, up_to};

/// What the fits of a plan have in common.
#[derive(Debug, Clone, PartialEq)]
pub struct BatchOptions {
    /// The model.
    pub model: Model,
    /// The refractive index, in [1, 1e5]. Where n is free, it has no effect.
    pub n: f64,
    /// The weights of the readings in E. Weights of relative errors depend on the readings and are refused.
    pub weights: Weights,
    /// The largest incidence angle of the readings that are fitted, in radians: with the limit of the
    /// paper's first stage, the fits are the optima of that stage. `None` fits all readings.
    pub stage1_limit: Option<f64>,
}

impl Default for BatchOptions {
    /// The paper's model at n = 1.5, with the E of the paper.
    fn default() -> Self {
        Self {
            model: Model::Three,
            n: crate::model::DEFAULT_N,
            weights: Weights::default(),
            stage1_limit: None,
        }
    }
}

/// Why a plan cannot be made, or scans cannot be fitted with it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BatchError {
    /// There is no angle.
    #[error("there are no readings: expected the angles of at least one")]
    NoReadings,
    /// The angles of a reading are outside their domain.
    #[error("reading {index}: {error}")]
    Reading {
        /// The index of the reading, from 0.
        index: usize,
        /// What is wrong.
        error: MeasurementError,
    },
    /// No incidence is within the limit of the first stage.
    #[error("no incidence angle is up to {0} deg, the limit of stage 1")]
    Stage1Limit(f64),
    /// The refractive index is outside the domain of the model.
    #[error("n = {0}: expected a number from 1 to 1e5")]
    RefractiveIndex(f64),
    /// The weights depend on the readings.
    #[error(
        "weights of relative errors depend on the readings: expected weights that all scans share"
    )]
    RelativeErrors,
    /// The weights of the readings are not defined.
    #[error(transparent)]
    Weights(#[from] ObjectiveError),
    /// The scans have another number of readings than the plan.
    #[error("the scans have {found} readings each: expected {expected}, as the plan has angles")]
    Readings {
        /// The number of readings of the scans.
        found: usize,
        /// The number of readings of the plan.
        expected: usize,
    },
    /// The values do not fill the shape of the scans.
    #[error("{found} values: expected {expected} for this number of scans, readings and strides")]
    Length {
        /// The number of values.
        found: usize,
        /// The number that the shape needs.
        expected: usize,
    },
    /// The weights of the scans are of another shape.
    #[error("there are weights of {found} scans: expected those of {expected}, or of one for all")]
    WeightRows {
        /// The number of rows of weights.
        found: usize,
        /// The number of scans.
        expected: usize,
    },
    /// A weight is negative or not a number.
    #[error(
        "scan {scan}, reading {reading}: weight {weight}: expected a finite number of at least 0"
    )]
    Weight {
        /// The index of the scan, from 0.
        scan: usize,
        /// The index of the reading, from 0.
        reading: usize,
        /// The weight.
        weight: f64,
    },
    /// The observer cancelled the fits.
    #[error("cancelled")]
    Cancelled,
}

/// The angles, the weights and the model of many scans, with what their fits share.
///
/// It costs as much as some thousand fits, and is then the same for any number of scans and threads.
///
/// # Examples
///
/// ```
/// use brdf_core::Parameters;
/// use brdf_fit::batch::{BatchOptions, BatchPlan, Scans};
/// use brdf_fit::synthetic::scan;
///
/// let truths = [(0.3, 0.1, 0.2), (0.1, 0.3, 0.5)];
/// let scans = truths.map(|(k2, kd, k1)| scan(Parameters::new(k2, kd, k1).unwrap(), 1.5));
/// let plan = BatchPlan::new(scans[0].readings(), &BatchOptions::default()).unwrap();
/// let readings: Vec<f64> = scans
///     .iter()
///     .flat_map(|scan| scan.readings().iter().map(|reading| reading.brdf))
///     .collect();
/// let fits = plan.fit_many(Scans::new(&readings, plan.readings()).unwrap()).unwrap();
/// assert!((fits.k1[1] - 0.5).abs() < 1e-6);
/// ```
#[derive(Debug, Clone)]
pub struct BatchPlan {
    pub(super) model: ReducedModel,
    pub(super) readings: usize,
    /// The objective of readings of 1/sr.
    pub(super) objective: Objective,
    /// The number of readings with a weight.
    pub(super) used: usize,
    /// Whether the rows are in the order of the readings.
    in_order: bool,
    /// The factor of each row on its reading.
    pub(super) factors: Vec<f64>,
    /// The tables; `None` for a model without a lobe, and where a lobe cannot be told from the diffuse part:
    /// all scans are then searched as those with their own weights.
    pub(super) table: Option<Table>,
    /// The tables of scans with gaps or with their own weights, which are made when they are needed.
    pub(super) own: std::sync::OnceLock<OwnTable>,
}

/// The objective over the readings of the first stage.
fn up_to_limit(objective: Objective, limit: Option<f64>) -> Result<Objective, BatchError> {
    let Some(limit) = limit else {
        return Ok(objective);
    };
    match up_to(objective.segments(), |segment| segment.psi, limit).len() {
        0 => Err(BatchError::Stage1Limit(in_degrees(limit))),
        count => Ok(objective.subset(|i| i < count)?),
    }
}

impl BatchPlan {
    /// The plan of the angles of these readings, in their order, whose values have no effect. Angles are in
    /// radians, in the convention of [`Measurement`]; standard deviations are used where the weights ask for them.
    ///
    /// # Errors
    ///
    /// There is no reading, angles or n are outside their domain, or the weights are not defined or depend
    /// on the readings.
    pub fn new(angles: &[Measurement], options: &BatchOptions) -> Result<Self, BatchError> {
        if angles.is_empty() {
            return Err(BatchError::NoReadings);
        }
        if !(N_DOMAIN.0..=N_DOMAIN.1).contains(&options.n) {
            return Err(BatchError::RefractiveIndex(options.n));
        }
        if options.weights.errors == AssumedErrors::Relative {
            return Err(BatchError::RelativeErrors);
        }
        let of_one = angles.iter().enumerate().map(|(index, reading)| {
            let reading = Measurement {
                brdf: 1.0,
                wavelength_um: None,
                ..*reading
            };
            let valid = reading.validated().and_then(|reading| {
                reading.geometry()?;
                Ok(reading)
            });
            valid.map_err(|error| BatchError::Reading { index, error })
        });
        let readings = of_one.collect::<Result<Vec<_>, _>>()?;
        let scan = Measurements::new("angles", readings).map_err(|_| BatchError::NoReadings)?;
        let model = ReducedModel::from(options.model);
        let objective = Objective::new(&scan, options.model.family(), options.n, &options.weights)?;
        let objective = up_to_limit(objective, options.stage1_limit)?;
        let factors = objective.fixed_columns().0.to_vec();
        let table = model
            .frees(Parameter::K1)
            .then(|| Table::new(&objective, model, &factors, angles.len()))
            .flatten();
        let in_order = objective
            .readings()
            .iter()
            .enumerate()
            .all(|(row, i)| row == *i);
        Ok(Self {
            in_order,
            used: objective.count() - objective.zero_weight(),
            model,
            readings: angles.len(),
            objective,
            factors,
            table,
            own: std::sync::OnceLock::new(),
        })
    }

    /// The number of readings of a scan.
    pub fn readings(&self) -> usize {
        self.readings
    }

    /// y of each row: the readings times the factors of the rows and a common one.
    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a function that is not inlined is not compiled for the present processor"
    )]
    pub(super) fn weighted(&self, readings: &[f64], common: f64, y: &mut [f64]) {
        if self.in_order {
            for ((y, factor), reading) in y.iter_mut().zip(&self.factors).zip(readings) {
                *y = factor * reading * common;
            }
        } else {
            let rows = self.factors.iter().zip(self.objective.readings());
            for (y, (factor, &reading)) in y.iter_mut().zip(rows) {
                *y = factor * readings[reading] * common;
            }
        }
    }

    /// The number of parameters that are fitted.
    pub(super) fn free(&self) -> usize {
        self.model.free().len()
    }

    /// Whether n and p are not free, so that at most k1 is searched.
    pub(super) fn is_along_k1(&self) -> bool {
        !self.model.frees(Parameter::N) && !self.model.frees(Parameter::P)
    }

    /// Whether k1 is searched: not for the Lambertian model.
    pub(super) fn has_lobe(&self) -> bool {
        self.model.frees(Parameter::K1)
    }

    pub(super) fn own(&self) -> &OwnTable {
        self.own
            .get_or_init(|| OwnTable::new(&self.objective, self.model))
    }
}
