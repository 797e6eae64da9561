//! Why a scan cannot be fitted.

use brdf_core::ParameterError;

use crate::format::counted;
use crate::model::FixedError;
use crate::objective::ObjectiveError;
use crate::progress::Cancelled;
use crate::solver::SolverError;

/// Why a scan cannot be fitted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FitError {
    /// More than one wavelength: each has parameters of its own.
    #[error("{0} wavelengths in one fit: split them with Measurements::by_wavelength")]
    SeveralWavelengths(usize),
    /// No refractive index for the wavelength.
    #[error(
        "no refractive index{}: give it with --n 1.5 or --n 0.63=1.60,0.85=1.58, by a column n, \
         or by a line \"# refractive_index: 1.5\" in the file",
        at_wavelength(*.0)
    )]
    NoRefractiveIndex(Option<f64>),
    /// The refractive index is outside of the model's domain.
    #[error(transparent)]
    RefractiveIndex(#[from] ParameterError),
    /// The limit of rho(psi) <= 1 is no incidence.
    #[error("rho(psi) <= 1 up to {0} deg: expected a limit from 0 to below 90 deg")]
    EnergyLimit(f64),
    /// No more readings than free parameters.
    #[error(
        "{}: {} need at least {}", counted(*.count, "reading"),
        counted(*.parameters, "free parameter"), .parameters + 1
    )]
    TooFewReadings {
        /// How many there are.
        count: usize,
        /// How many parameters the model has free.
        parameters: usize,
    },
    /// All readings have one value.
    #[error(
        "all {count} readings are {value} 1/sr: such data are kD = pi times that, and say nothing \
         of k2 and k1 (a saturated detector, a constant column?)"
    )]
    AllEqual {
        /// How many there are.
        count: usize,
        /// Their value.
        value: f64,
    },
    /// E is not defined.
    #[error(transparent)]
    Objective(#[from] ObjectiveError),
    /// Neither stage is asked for.
    #[error("no stage: ask for stage 1, for stage 2, or for both")]
    NoStage,
    /// Stage 1 is asked for alone, and has no readings that could be fitted.
    #[error("stage 1 alone cannot be fitted: {0}")]
    Stage1Alone(String),
    /// A parameter cannot be fixed.
    #[error(transparent)]
    Fixed(#[from] FixedError),
    /// The fixed parameters leave no fit under rho(psi) <= 1.
    #[error(
        "with the fixed parameters rho(psi) is above 1 before {0} deg, whatever the others are"
    )]
    FixedAboveEnergy(f64),
    /// A minimiser failed.
    #[error("the minimiser failed: {0}")]
    Solver(String),
    /// A [`Observer`] has cancelled the fit.
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
    /// Whether the user can mend it by other arguments, the readings being what they are.
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
