//! The desktop viewer: theory against experiment for each incidence angle, with live parameters.
//!
//! Three parts, and what flows between them:
//!
//! ```text
//!              draw                        jobs: read, fit, write
//!   panels <--------- State <------- app ------------------------> worker (threads)
//!     |                 ^             ^                               |
//!     +--- intents -----+             +----------- events ------------+
//! ```
//!
//! - [`state`] holds what is loaded, chosen and fitted, and changes by [`intent::Intent`] only. It
//!   knows no widget and no thread, so that it can be tested by itself. What follows from it (the
//!   curves, E, the reflectance) is worked out once a change, in [`state::shown`].
//! - [`panels`] draw the state and answer with intents, a panel a file; [`plot`] is the one in the
//!   middle. What they share stands in [`axis`], [`theme`] and `widgets`.
//! - [`worker`] reads, fits and writes on threads of its own, calls `brdf_fit` for it, and answers
//!   with events. [`job`] has the types of both: neither knows the other.
//! - [`app`] is the round trip of a frame: events in, intents applied, panels drawn, jobs out.
//!
//! No formula of the model stands here: curves, errors and reflectances come from `brdf_fit` and
//! `brdf_core`, the figures that are written come from `brdf_fit::plot`.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "numbers of pixels, columns and iterations are small and positive"
)]

pub mod app;
pub mod axis;
pub mod dialogs;
pub mod intent;
pub mod job;
pub mod panels;
pub mod plot;
pub mod raster;
pub mod reading;
pub mod screenshot;
pub mod shortcuts;
pub mod state;
pub mod theme;
mod widgets;
pub mod worker;
pub mod writing;

pub use app::Viewer;
