//! Fits the three-parameter BRDF of Li, Yan and Wu (Acta Optica Sinica 22(7), 769, 2002), and its
//! relatives, to goniometer scans: in two stages, within physical bounds, and with a check of the
//! global optimum.
//!
//! ```no_run
//! use brdf_fit::{FitOptions, Measurements, RefractiveIndex, fit};
//!
//! let options = FitOptions {
//!     refractive_index: Some(RefractiveIndex::Same(1.5)),
//!     ..FitOptions::default()
//! };
//! for scan in Measurements::read_csv("data/measured/z307_on_aluminium.csv")?.by_wavelength() {
//!     let fit = fit(&scan, &options)?;
//!     println!("{:?}: E = {} %", fit.parameters, fit.e_percent);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The layers, each of which uses only those before it: `scan` holds the validated readings
//! ([`Measurements`]), [`read`] reads files into them, `model` has the models and their parameters
//! ([`Model`]), `objective` computes E ([`Objective`]), `solver` minimises it, `fit` runs the stages
//! ([`FitProblem`]), `inference` adds uncertainty, cross-validation and model comparison
//! ([`Assessment`]), and [`report`] presents the result ([`Report`]).
//!
//! An [`Observer`] receives each iteration of a fit, and may cancel it.
//!
//! Angles are in radians, wavelengths in micrometres, the BRDF in 1/sr; a value in degrees has
//! `_deg` in its name.
//!
//! # Features
//!
//! Without default features the crate has no programs, figures, exports or trade-offs: it reads,
//! fits, assesses and reports. `plot` adds figures, `export` forms for other programs, `tradeoff`
//! measured trade-offs, `planning` the next readings of a scan, `workbook` spreadsheets, `cube` arrays of NumPy; `cli` (the default) enables all of them
//! and adds the programs `brdf` and `fit`. `parquet` writes the fits of an array as Parquet as well.

pub mod batch;
#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "cube")]
pub mod cube;
#[cfg(feature = "export")]
pub mod export;
mod fit;
pub mod format;
mod inference;
mod model;
mod objective;
pub mod output;
#[cfg(feature = "planning")]
pub mod planning;
#[cfg(feature = "plot")]
pub mod plot;
mod progress;
pub mod read;
pub mod report;
mod scan;
mod solver;
#[cfg(feature = "tradeoff")]
pub mod tradeoff;

pub use fit::energy::{DEFAULT_LIMIT_DEG as ENERGY_LIMIT_DEG, EnergyConstraint};
pub use fit::grid_search::{ProfilePoint, best_weights};
pub use fit::relative::RelativeFit;
pub use fit::robust::{Loss, REJECTED, Rejected, RobustFit};
pub use fit::start::{InitialValues, WeightsRoute, WidthRoute};
pub use fit::{
    FORMAT_VERSION, Fit, FitError, FitOptions, FitProblem, GlobalCheck, OwnAndAll, Stage, fit,
    fit_observed, rms_percent,
};
pub use format::ParseError;
pub use inference::{
    ASSESSED_BINS, ASSESSED_READINGS, Assessment, Candidate, CrossValidation, Deviations,
    ErrorSizes, Estimate, Hint, Interval, Knowledge, LeftOut, NOT_PREDICTED_PERCENT, Noise,
    NoiseTests, ParameterIntervals, Physics, PredictedIncidence, Quality, Reflectance,
    RelativePrediction, Reliance, TEST_LEVEL, Uncertainty, VERDICT_MARGIN, Verdict, Warning,
    Without, assess, intervals_of_many, intervals_of_many_on_one_thread, most_influential,
    rests_on,
};
pub use model::{
    DEFAULT_N, FixedError, FixedParameters, K1_RANGE, Model, N_RANGE, Parameter, ReducedModel,
};
pub use objective::weights::{AngleWeight, AssumedErrors, RELATIVE_FLOOR, Weights, solid_angles};
pub use objective::{
    IncidenceError, MOST_FOLDS, NormalEquations, Objective, ObjectiveError, PARALLEL_FROM,
};
pub use progress::{Cancelled, NoObserver, Observer, Part, Phase, Step, Task};
pub use read::{LazyScan, ReadError, ReadOptions};
pub use report::{Depth, Document, DocumentError, ModelChoice, Report};
pub use scan::{
    Convention, Format, Incidence, Measurement, MeasurementError, Measurements, Metadata,
    ReadSettings, RefractiveIndex, Side, synthetic,
};
pub use solver::{Method, SolverError, Termination};

/// The example of the README, compiled as a documentation test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
