//! Figs. 3 to 10 of Li, Yan and Wu (2002), drawn from the parameters of its Table 1.

use brdf_core::published::{PUBLISHED, PublishedSample};
use brdf_core::{AnyBrdf, Family, ModelParameters};

use super::{polar, theory};
use crate::plot::error::PlotError;
use crate::plot::figure::Figure;
use crate::plot::styled::Curves;
use crate::plot::title::Title;

/// The incidence angles in degrees of the figures with several.
const SEVERAL: &[f64] = &[0.0, 15.0, 30.0, 45.0, 60.0, 75.0];

/// A figure of the paper.
struct PaperFigure {
    number: u32,
    sample: &'static str,
    wavelength_um: f64,
    psi_deg: &'static [f64],
    /// A sentence on what the paper does not specify, with a blank before it.
    unspecified: &'static str,
}

const NOTE: &str = "theory only: the readings were never published";

const POLAR: &str = "BRDF in 1/sr as radius at the view angle from the surface normal, in the \
                     plane of incidence, the source's side to the right";

const LOGARITHMIC: &str = "BRDF over the view angle in the plane of incidence, on a logarithmic \
                           axis, because in polar form the largest incidence would hide the others";

const SET_NOT_LEGIBLE: &str = " The paper's own set of incidence angles is not legible.";

const FIGURES: [PaperFigure; 8] = [
    of(3, "001", 0.91, &[0.0], ""),
    of(4, "001", 0.91, SEVERAL, SET_NOT_LEGIBLE),
    of(5, "001", 0.44, &[70.0], ""),
    of(6, "001", 0.44, SEVERAL, SET_NOT_LEGIBLE),
    of(
        7,
        "002",
        0.62,
        &[0.0],
        " The paper's text does not say at which incidence angle this figure is.",
    ),
    of(8, "002", 0.62, SEVERAL, SET_NOT_LEGIBLE),
    of(9, "003", 1.04, &[10.0], ""),
    of(10, "003", 1.04, &[60.0], ""),
];

const fn of(
    number: u32,
    sample: &'static str,
    wavelength_um: f64,
    psi_deg: &'static [f64],
    unspecified: &'static str,
) -> PaperFigure {
    PaperFigure {
        number,
        sample,
        wavelength_um,
        psi_deg,
        unspecified,
    }
}

/// Figs. 3 to 10 of Li, Yan and Wu (2002) from the parameters of its Table 1, named `figure-3` to
/// `figure-10`: f_r as radius at the view angle, as in the paper, or for several incidences over the
/// view angle on a logarithmic axis. They show the theory without readings, because the measured
/// points of the paper were never published.
///
/// # Errors
///
/// Where brdf-core rejects the parameters of a row, which it does for none of them.
pub fn paper_figures() -> Result<Vec<Figure>, PlotError> {
    let mut figures = Vec::new();
    for figure in &FIGURES {
        let row = PUBLISHED
            .iter()
            .find(|row| row.sample == figure.sample && row.wavelength_um == figure.wavelength_um);
        if let Some(row) = row {
            figures.push(figure.draw(row)?);
        }
    }
    Ok(figures)
}

impl PaperFigure {
    fn draw(&self, row: &PublishedSample) -> Result<Figure, PlotError> {
        let at = ModelParameters::three(row.parameters, row.n);
        let brdf = AnyBrdf::new(Family::Paper, &at)?;
        let curves = Curves::of_theory(&brdf, self.psi_deg);
        let title = self.title(row);
        let (form, svg) = if self.psi_deg.len() == 1 {
            (POLAR, polar::svg(&title, &curves, Some(NOTE)))
        } else {
            (LOGARITHMIC, theory::svg_of_theory(&title, &curves, NOTE))
        };
        let caption = format!(
            "Fig. {} of Li, Yan and Wu (2002) from the parameters of its Table 1: {form}. {}, {}. \
             Dashed: mirror directions. Theory only: the measured points were never published.{}",
            self.number, title.sample, title.details, self.unspecified
        );
        Ok(Figure {
            name: format!("figure-{}", self.number),
            caption,
            svg,
        })
    }

    fn title(&self, row: &PublishedSample) -> Title {
        let parameters = row.parameters;
        Title {
            sample: format!(
                "Fig. {}: sample {}, {} on {}",
                self.number, row.sample, row.coating, row.base
            ),
            details: format!(
                "{} um, k2 = {}, kD = {}, k1 = {}, n = {}",
                row.wavelength_um, parameters.k2, parameters.kd, parameters.k1, row.n
            ),
            theory: "the paper's model".to_owned(),
            ..Title::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_figures_are_drawn_and_their_captions_name_them_theory_only() {
        let figures = paper_figures().unwrap();
        let names: Vec<String> = (3..=10).map(|number| format!("figure-{number}")).collect();
        assert!(figures.iter().map(|figure| &figure.name).eq(&names));
        for figure in figures {
            assert!(figure.caption.contains("never published"));
        }
    }
}
