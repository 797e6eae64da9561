//! Which angles to measure next, and when to stop.
//!
//! ```text
//! prior, setting, errors -> belief -> criterion -> state -> advice --+
//!                        instrument -> choice -----------------------+-> planner -> review
//!                        scene_points -------------------------------+
//! ```
//!
//! A plan chooses the readings whose fit has the smallest mean square error of ln f_r over the directions of a scene
//! (the integrated mean square error, I-optimality with the bias included). The error has three sources: the
//! noise of the readings, that of whole incidences, and the misfit of the model, which is a random function of the
//! directions and of the differences between models. Because of the last one a plan spreads over the scene, does not
//! repeat itself, and measures where models disagree; because of the second one it has several incidences.
//!
//! It assumes that the surface is isotropic and that the relative errors are alike everywhere; its predictions are
//! checked against measured scans in `docs/planning.md`.

mod advice;
mod belief;
mod choice;
mod criterion;
mod error;
mod errors;
mod instrument;
mod list;
mod planner;
mod prior;
mod review;
mod scene_points;
mod setting;
mod state;

pub use advice::{Advice, Region};
pub use error::PlanError;
pub use errors::ErrorModel;
pub use instrument::{Instrument, SlowAxis};
pub use list::{error_percent, error_percent_beside, rounded_deg};
pub use planner::{
    MeasurementPlan, PlanOptions, PlannedReading, Prediction, choose_readings, plan_readings,
    predict,
};
pub use prior::MaterialClass;
pub use review::{Gap, Review, ReviewStep, WITHIN as REVIEW_WITHIN, error_of, review};
pub use setting::Setting;
