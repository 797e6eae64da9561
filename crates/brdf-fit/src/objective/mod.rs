//! The objective: E of eq. (5) as a function of the parameters, with its derivatives.
//!
//! `rows` holds what depends on the readings alone, `angles` what depends on their directions, `block` evaluates the columns of the model,
//! `evaluation` computes E, residuals and derivatives from them. `subset` and `condensed` make
//! objectives over fewer rows.

mod angles;
mod best_weights;
mod block;
mod condensed;
mod error;
mod evaluation;
mod rows;
mod subset;
pub(crate) mod weights;

pub(crate) use best_weights::{demand_for_lobe, solve, solve_for};
pub(crate) use block::{BLOCK, Block, LobeColumns, PROCESSOR, TakeBlock, WithLobe, dot, dot_of};
pub use error::ObjectiveError;
pub use evaluation::{NormalEquations, PARALLEL_FROM};
pub(crate) use evaluation::{ProfileSums, ROUNDING};
pub use rows::{IncidenceError, MOST_FOLDS, Objective};
pub(crate) use rows::{SIZES, Segment};
