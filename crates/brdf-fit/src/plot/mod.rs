//! Figures of a fit as SVG and PNG: theory against experiment, residuals, the polar form of the
//! paper, the profile of E over k1 and the reflectance; the paper's own figures from its Table 1; and
//! cost against error of a trade-off.
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
//! The data flow in one direction. [`View`] determines how the data are plotted, [`Selection`] which
//! readings are shown, and [`curves()`] adds the theory; screens and figures share these three. Each
//! figure has a file below `figures`, which draws within the axes of a `frame` on a `canvas`, the
//! `svg` writer produces the document, and `png` converts it.

mod axis;
mod canvas;
mod clip;
mod curves;
mod error;
mod figure;
mod figures;
mod folder;
mod frame;
mod legend;
mod palette;
mod png;
mod selection;
mod style;
mod styled;
mod svg;
mod text;
mod theory_csv;
pub mod ticks;
mod title;
mod view;
mod write;

pub use curves::{Curve, Reading, Theory, curves, theory_curves, value_range};
pub use error::PlotError;
pub use figure::Figure;
pub use figures::{
    DRAWING_AREA, FIGURE_SIZE, Layer, Shape, TradePoint, drawing, figure_of, figures,
    paper_figures, trade_picture,
};
pub use folder::{FolderError, PAGE, figure_files, report_figures, write_folder};
pub use palette::{FAMILIES, Ground, MarkShape, colour, family_colour, mark};
pub use selection::{Selection, Trace};
pub use theory_csv::write_theory_alone;
pub use view::{Layout, Quantity, Scale, View, Zoom};
pub use write::write_figures;
