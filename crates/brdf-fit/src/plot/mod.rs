//! The pictures of a fit: theory against experiment, residuals, the polar form of the paper, the
//! profile of E over k1 and the reflectance; and the paper's own figures from its Table 1.
//!
//! ```no_run
//! use std::path::Path;
//!
//! use brdf_fit::plot::{figures, write_figures};
//! use brdf_fit::{FitOptions, Measurements, RefractiveIndex, fit};
//!
//! let scan = Measurements::read_csv("data/measured/z307_on_aluminium.csv")?
//!     .by_wavelength()
//!     .remove(0);
//! let options = FitOptions {
//!     refractive_index: Some(RefractiveIndex::Same(1.5)),
//!     ..FitOptions::default()
//! };
//! let fit = fit(&scan, &options)?;
//! write_figures(&figures(&scan, &fit, None)?, Path::new("pictures"), "z307")?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The data flow one way: a `view` says how data are looked at, a `selection` which readings are
//! shown, `curves` what of the theory stands beside them, for a screen as for a figure; a figure's
//! file draws it in a `frame` on a `canvas`, `raster` makes a PNG of the SVG.

mod axis;
mod canvas;
mod clip;
mod curves;
mod error;
mod figure;
mod figures;
mod frame;
mod labels;
mod legend;
mod palette;
mod png;
mod selection;
mod style;
mod styled;
mod svg;
mod text;
pub mod ticks;
mod title;
mod view;
mod write;

pub use curves::{Curve, Reading, Theory, curves, theory_curves, value_range};
pub use error::PlotError;
pub use figure::Figure;
pub use figures::{Layer, TradePoint, figure_of, figures, paper_figures, trade_picture};
pub use palette::{FAMILIES, Ground, MarkShape, colour, family_colour, mark};
pub use selection::{Selection, Trace};
pub use view::{Layout, Quantity, Scale, View};
pub use write::write_figures;
