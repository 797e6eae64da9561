//! The figures, a file for each of them, and all figures of a fit.

mod arrangement;
mod drawing;
mod paper;
mod polar;
mod profile;
mod reflectance;
mod residuals;
mod theory;
mod tradeoff;

use brdf_core::{AnyBrdf, Geometry};

use crate::fit::Fit;
use crate::plot::error::PlotError;
use crate::plot::figure::Figure;
use crate::plot::styled::{Curves, Source};
use crate::plot::title::Title;
use crate::plot::view::View;
use crate::scan::Measurements;

pub use arrangement::{Layer, figure_of};
pub use drawing::{DRAWING_AREA, FIGURE_SIZE, Shape, drawing};
pub use paper::paper_figures;
pub use tradeoff::{TradePoint, trade_picture};

/// The names of all figures that [`figures`] may draw.
pub(in crate::plot) const FIGURES: [&str; 6] = [
    "theory-linear",
    "theory-log",
    "residuals",
    "polar",
    "profile-k1",
    "reflectance",
];

/// The figures of a fit of one wavelength:
///
/// - `theory-linear` and `theory-log`: readings and theory over the signed view angle;
/// - `residuals`: measured value minus theory;
/// - `polar`: f_r as radius at the view angle;
/// - `profile-k1`: the lowest E over k1;
/// - `reflectance`: hemispherical reflectance over the incidence angle.
///
/// `sigma` is the standard error of the theory in 1/sr at a geometry. It is drawn as a band of one
/// standard error to both sides, which is interrupted where `sigma` is not a positive number.
///
/// The first four kinds show the readings in the plane of incidence at up to 8 incidences; the
/// caption lists what is left out. They are omitted where no reading lies in the plane, and the
/// logarithmic figure also where no value is positive. The profile is omitted where the fit has none
/// or no specular part.
///
/// # Errors
///
/// [`PlotError::Parameters`] where the parameters of the fit are outside the domain of the model.
pub fn figures(
    measurements: &Measurements,
    fit: &Fit,
    sigma: Option<&dyn Fn(&Geometry) -> f64>,
) -> Result<Vec<Figure>, PlotError> {
    let brdf = AnyBrdf::new(fit.model().family(), &fit.at())?;
    let title = Title::of(measurements, fit);
    let source = Source {
        name: None,
        measurements,
        brdf: &brdf,
        sigma,
        incidences: None,
        family: None,
    };
    let curves = Curves::of(&[source], &View::default());
    let mut figures = Vec::new();
    if !curves.all.is_empty() {
        figures.push(theory::linear(&title, &curves));
        figures.extend(theory::logarithmic(&title, &curves));
        figures.push(residuals::figure(&title, &curves));
        figures.push(polar::figure(&title, &curves));
    }
    figures.extend(profile::figure(&title, fit));
    figures.push(reflectance::figure(&title, &brdf, fit)?);
    Ok(figures)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use brdf_core::Parameters;
    use resvg::tiny_skia::Pixmap;
    use resvg::usvg::{Options, Tree};

    use super::*;
    use crate::fit::{FitOptions, fit};
    use crate::model::Model;
    use crate::plot::write::write_figures;
    use crate::scan::Measurement;
    use crate::scan::synthetic::scan;
    use crate::scan::{Measurements, RefractiveIndex};

    fn lacquer() -> Measurements {
        scan(Parameters::new(0.3, 0.1, 0.2).unwrap(), 1.5)
    }

    fn fitted(measurements: &Measurements, model: Model) -> Fit {
        let options = FitOptions {
            model,
            refractive_index: Some(RefractiveIndex::Same(1.5)),
            ..FitOptions::default()
        };
        fit(measurements, &options).unwrap()
    }

    fn reading(psi_deg: f64, theta_deg: f64, brdf: f64) -> Measurement {
        Measurement {
            wavelength_um: None,
            psi: psi_deg.to_radians(),
            theta: theta_deg.to_radians(),
            phi: 0.0,
            brdf,
            sigma: None,
        }
    }

    /// The figures of readings with the fit of another scan, which figures do not check.
    fn report_figures(readings: Vec<Measurement>) -> Vec<Figure> {
        let fit = fitted(&lacquer(), Model::Three);
        let measurements = Measurements::new("test", readings).unwrap();
        let figures = figures(&measurements, &fit, None).unwrap();
        check(&figures);
        figures
    }

    fn names(figures: &[Figure]) -> Vec<&str> {
        figures.iter().map(|figure| figure.name.as_str()).collect()
    }

    /// Checks that every figure is valid XML of the expected size without undefined numbers.
    fn check(figures: &[Figure]) {
        for figure in figures {
            let tree = Tree::from_str(&figure.svg, &Options::default()).unwrap();
            assert_eq!((tree.size().width(), tree.size().height()), (960.0, 580.0));
            assert!(!figure.svg.contains("NaN") && !figure.svg.contains("inf<"));
            assert!(!figure.caption.is_empty());
        }
    }

    #[test]
    fn a_fit_of_every_model_has_all_figures() {
        for model in Model::ALL {
            let fit = fitted(&lacquer(), model);
            let figures = figures(&lacquer(), &fit, None).unwrap();
            check(&figures);
            if model == Model::Lambert {
                assert!(!names(&figures).contains(&"profile-k1"));
            } else {
                assert_eq!(names(&figures), FIGURES, "{model}");
            }
        }
    }

    #[test]
    fn bands_and_error_bars_are_drawn_and_captioned() {
        let fit = fitted(&lacquer(), Model::Three);
        let mut measurements = lacquer();
        for reading in &mut measurements.readings {
            reading.sigma = Some(0.1 * reading.brdf);
        }
        let plain = figures(&measurements, &fit, None).unwrap();
        // A tenth of the theory, and undefined close to grazing.
        let brdf = AnyBrdf::new(fit.model().family(), &fit.at()).unwrap();
        let sigma = |at: &Geometry| match at.cos_theta() {
            cos if cos < 0.1 => f64::NAN,
            _ => 0.1 * brdf.value(at),
        };
        let banded = figures(&measurements, &fit, Some(&sigma)).unwrap();
        check(&banded);
        assert!(banded[0].caption.contains("standard error"));
        assert!(banded[0].caption.contains("standard deviation"));
        assert!(!plain[0].caption.contains("standard error"));
        assert!(
            banded[0].svg.matches("<polygon").count() > plain[0].svg.matches("<polygon").count()
        );
    }

    #[test]
    fn few_and_extreme_readings_have_figures() {
        assert_eq!(
            names(&report_figures(vec![reading(30.0, -30.0, 0.2)])),
            FIGURES
        );
        let zeros = report_figures(
            (0..9)
                .map(|i| reading(30.0, 10.0 * f64::from(i), 0.0))
                .collect(),
        );
        assert!(zeros[1].caption.contains("9 readings <= 0 not shown"));
        let negative = report_figures(vec![reading(10.0, 5.0, -0.1), reading(10.0, 9.0, 0.2)]);
        assert!(negative[1].caption.contains("1 reading <= 0 not shown"));
        assert!(negative[3].caption.contains("1 reading < 0 not shown"));
        let small = report_figures(vec![reading(10.0, 5.0, 1e-30), reading(10.0, 9.0, 0.2)]);
        assert!(
            small[1]
                .caption
                .contains("1 reading below the axis not shown")
        );
        report_figures(vec![
            reading(0.0, 0.0, f64::MAX),
            reading(0.0, 5.0, f64::MIN),
        ]);
        let mut grazing = reading(0.0, 0.0, 1.0);
        (grazing.psi, grazing.theta) = (FRAC_PI_2, -FRAC_PI_2);
        report_figures(vec![grazing]);
    }

    #[test]
    fn without_positive_values_there_is_no_logarithmic_figure() {
        let mut fit = fitted(&lacquer(), Model::Lambert);
        fit.parameters.kd = 0.0;
        let measurements = Measurements::new("test", vec![reading(10.0, 5.0, 0.0)]).unwrap();
        let figures = figures(&measurements, &fit, None).unwrap();
        check(&figures);
        assert_eq!(
            names(&figures),
            ["theory-linear", "residuals", "polar", "reflectance"]
        );
    }

    #[test]
    fn readings_out_of_the_plane_are_counted_and_not_drawn() {
        let mut out = reading(30.0, 40.0, 0.1);
        out.phi = 1.0;
        let mut forward = reading(30.0, 40.0, 0.1);
        forward.phi = PI;
        let figures = report_figures(vec![out, out, forward]);
        assert!(
            figures[0]
                .caption
                .contains("2 readings out of the plane of incidence are not")
        );
        assert_eq!(
            names(&report_figures(vec![out])),
            ["profile-k1", "reflectance"]
        );
        assert_eq!(
            names(&report_figures(vec![])),
            ["profile-k1", "reflectance"]
        );
    }

    #[test]
    fn only_some_of_many_incidences_are_shown() {
        let readings = (0..90).flat_map(|psi| {
            (-80..=80)
                .step_by(20)
                .map(move |theta| reading(f64::from(psi), f64::from(theta), 0.1))
        });
        let figures = report_figures(readings.collect());
        assert!(figures[0].caption.contains("8 of 90 incidences are shown"));
        assert!(figures[0].svg.contains("psi = 89 deg"));
    }

    #[test]
    fn very_many_readings_do_not_inflate_the_figure() {
        let many = (0..200_000).map(|i| reading(10.0, 8e-4 * f64::from(i) - 80.0, 0.1));
        let figures = report_figures(many.collect());
        assert!(figures[0].svg.len() < 1_000_000);
        assert!(figures[0].caption.contains("readings are drawn"));
    }

    #[test]
    fn parameters_outside_the_domain_are_an_error() {
        let mut fit = fitted(&lacquer(), Model::Three);
        fit.parameters.k1 = f64::NAN;
        assert!(matches!(
            figures(&lacquer(), &fit, None),
            Err(PlotError::Parameters(_))
        ));
    }

    #[test]
    fn figures_are_written_as_svg_and_as_png_of_twice_the_size() {
        let folder = tempfile::tempdir().unwrap();
        let inner = folder.path().join("new");
        let fit = fitted(&lacquer(), Model::Three);
        let mut measurements = lacquer();
        let name = ("sample".to_owned(), "<&\">".to_owned());
        measurements.metadata.0.push(name);
        let figures = figures(&measurements, &fit, None).unwrap();
        check(&figures);
        let files = write_figures(&figures[..1], &inner, "a").unwrap();
        assert_eq!(
            files,
            [
                inner.join("a-theory-linear.svg"),
                inner.join("a-theory-linear.png")
            ]
        );
        let image = Pixmap::decode_png(&std::fs::read(&files[1]).unwrap()).unwrap();
        assert_eq!((image.width(), image.height()), (1920, 1160));
        // The letters of the title are dark pixels on white.
        let title = image.pixels().iter().take(1920 * 60);
        assert!(title.filter(|pixel| pixel.red() < 128).count() > 50);
    }

    #[test]
    fn a_folder_that_cannot_be_created_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        std::fs::write(&file, "").unwrap();
        let message = write_figures(&[], &file.join("sub"), "a")
            .unwrap_err()
            .to_string();
        assert!(
            message.contains("sub: cannot create the output folder"),
            "{message}"
        );
    }

    #[test]
    fn a_scale_without_pixels_is_an_error() {
        let figure = &paper_figures().unwrap()[0];
        for scale in [0.0, -1.0, 1e9, f32::NAN, f32::INFINITY] {
            assert!(matches!(figure.png(scale), Err(PlotError::Scale { .. })));
        }
    }
}
