//! The viewer, on a desktop and as a page in a browser: theory and measurement for each incidence angle, with
//! interactive parameters.
//!
//! ```text
//!              draw                        jobs: open, fit, write
//!   panels <--------- State <------- app ----------------------> threads: worker
//!     |                 ^             ^                               |
//!     +--- intents -----+             +----------- events ------------+
//! ```
//!
//! - [`state`] holds the samples, the settings and the fits, and changes only by
//!   [`intent::Intent`]s and by [`job::Event`]s of the worker. It uses neither widgets nor threads,
//!   so that it can be tested by itself. Curves, E and reflectances are derived from it once per
//!   change, in [`state::derived`].
//! - [`panels`] draw the state, one panel per file, and answer with intents; [`plot`] is the
//!   central one. [`theme`] and `widgets` are shared by all of them.
//! - [`solid`] draws the lobe and the surface in three dimensions, by pure functions of the theory.
//! - [`worker`] opens files, fits and writes files, by calling `brdf_fit`, and answers with events. [`job`]
//!   defines the types of both directions.
//! - [`platform`] is what differs between a desktop and a page: threads, dialogs, files, the place of the
//!   settings, keys. Nothing else depends on where the viewer runs.
//! - [`app`] runs a frame: it takes events, applies intents, draws panels and starts jobs.
//!
//! The modules form layers without cycles. From the bottom: [`cancel`], [`output_kind`] and the types of
//! [`state`], with [`solid`] and the leaves [`plot::ticks`] and [`plot::radius`]; [`intent`], [`job`] and [`events`];
//! the traits of [`platform`]; [`state::State`]; [`worker`], [`plot`], [`panels`]; the implementations of the
//! traits; [`app`].
//!
//! The viewer contains no formula of the model: curves, errors and reflectances come from
//! `brdf_fit` and `brdf_core`, exported figures from `brdf_fit::plot`.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "numbers of pixels, columns and iterations are small and positive"
)]

pub mod app;
pub mod cancel;
pub mod events;
pub mod fonts;
pub mod intent;
pub mod job;
pub mod output_kind;
pub mod panels;
pub mod platform;
pub mod plot;
pub mod raster;
pub mod screenshot;
pub mod shortcuts;
pub mod solid;
pub mod state;
pub mod theme;
mod widgets;
pub mod worker;

pub use app::Viewer;
