//! The course of E during a fit.

use brdf_fit::Phase;

/// E after one iteration of a stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConvergencePoint {
    /// The stage.
    pub phase: Phase,
    /// The iteration of the stage; 0 is its start.
    pub iteration: u64,
    /// E in percent, over the readings of the stage.
    pub e_percent: f64,
}
