//! Why a scan cannot be fitted.

use brdf_core::ParameterError;

use crate::format::counted;
use crate::model::FixedError;
use crate::objective::ObjectiveError;
use crate::progress::Cancelled;
use crate::solver::SolverError;

/// Why a scan cannot be fitted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// More than one wavelength in a scan: each wavelength has its own parameters.
    #[error("{0} wavelengths in one fit: expected the readings of one wavelength")]
    SeveralWavelengths(usize),
    /// No refractive index is stated for the wavelength, in micrometres.
    #[error(
        "no refractive index{}: state it in the options of the fit, in a column n, or in a line \
         \"# refractive_index: 1.5\" of the file",
        at_wavelength(*.0)
    )]
    NoRefractiveIndex(Option<f64>),
    /// The refractive index is outside the domain of the model.
    #[error(transparent)]
    RefractiveIndex(#[from] ParameterError),
    /// The limit of the energy constraint is not an incidence angle; in degrees.
    #[error("rho(psi) <= 1 up to {0} deg: expected a limit from 0 to below 90 deg")]
    EnergyLimit(f64),
    /// The readings that influence the fit do not outnumber the free parameters.
    #[error(
        "{}: {} need at least {}", counted(*.count, "reading"),
        counted(*.parameters, "free parameter"), .parameters + 1
    )]
    TooFewReadings {
        /// The number of readings.
        count: usize,
        /// The number of free parameters.
        parameters: usize,
    },
    /// All readings have the same value.
    #[error(
        "all {count} readings are {value} 1/sr: such data determine only kD, as pi times this value, \
         and neither k2 nor k1 (saturated detector, constant column?)"
    )]
    AllEqual {
        /// The number of readings.
        count: usize,
        /// The value in 1/sr.
        value: f64,
    },
    /// E is not defined for the readings and weights.
    #[error(transparent)]
    Objective(#[from] ObjectiveError),
    /// Neither stage is requested.
    #[error("no stage: expected stage 1, stage 2, or both")]
    NoStage,
    /// Stage 1 is requested alone, but has too few readings.
    #[error("stage 1 alone cannot be fitted: {0}")]
    Stage1Alone(String),
    /// A parameter cannot be fixed.
    #[error(transparent)]
    Fixed(#[from] FixedError),
    /// The fixed parameters contradict the energy constraint; the limit in degrees.
    #[error(
        "with the fixed parameters rho(psi) exceeds 1 below {0} deg for all values of the other \
         parameters"
    )]
    FixedAboveEnergy(f64),
    /// A minimiser failed.
    #[error("the minimiser failed: {0}")]
    Solver(String),
    /// An [`Observer`](crate::progress::Observer) cancelled the fit.
    #[error("cancelled")]
    Cancelled,
}

impl From<Cancelled> for FitError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl From<SolverError> for FitError {
    fn from(error: SolverError) -> Self {
        match error {
            SolverError::Failed(reason) => Self::Solver(reason),
            SolverError::Cancelled => Self::Cancelled,
        }
    }
}

impl FitError {
    /// Whether other options can avoid the error for the same readings.
    pub fn is_usage(&self) -> bool {
        matches!(
            self,
            Self::NoRefractiveIndex(_)
                | Self::RefractiveIndex(_)
                | Self::EnergyLimit(_)
                | Self::Objective(ObjectiveError::NoSigma)
                | Self::NoStage
                | Self::Stage1Alone(_)
                | Self::Fixed(_)
                | Self::FixedAboveEnergy(_)
        )
    }
}

fn at_wavelength(wavelength_um: Option<f64>) -> String {
    wavelength_um.map_or_else(String::new, |w| format!(" at {w} um"))
}
