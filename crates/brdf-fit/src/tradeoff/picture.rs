//! The picture of a trade: cost against error, both logarithmic, with the Pareto front.
//!
//! It is drawn as the other figures are, in [`crate::plot`].

pub use crate::plot::{TradePoint, trade_picture as picture};
