//! The picture of the README: theory against experiment for one measured sample.

use std::error::Error;

use brdf_core::{Geometry, ThreeParameterBrdf};
use brdf_fit::measurement::Incidence;
use brdf_fit::{Fit, FitOptions, Measurements, RefractiveIndex, fit};
use plotters::element::DashedPathElement;
use plotters::prelude::*;

use crate::{in_workspace, one_wavelength};

/// Colours that colour-blind readers can tell apart (Okabe and Ito).
const COLOURS: [RGBColor; 4] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
];

/// The upper end of the axis in 1/sr: just above the largest reading.
const LARGEST: f64 = 0.5;

/// f_r over the signed view angle for each incidence of Z307 at 0.631 um and n = 1.5: readings as
/// points, the fit up to 60 deg and the fit of all as lines, on a logarithmic axis.
pub fn svg() -> Result<String, Box<dyn Error>> {
    let scan = one_wavelength(
        &in_workspace("data/measured/z307_on_aluminium.csv"),
        0.63079,
    );
    let options = FitOptions {
        refractive_index: Some(RefractiveIndex::Same(1.5)),
        ..FitOptions::default()
    };
    let fit = fit(&scan, &options)?;
    let mut svg = String::new();
    draw(&scan, &fit, &mut svg)?;
    Ok(svg)
}

fn draw(scan: &Measurements, fit: &Fit, svg: &mut String) -> Result<(), Box<dyn Error>> {
    let root = SVGBackend::with_string(svg, (900, 540)).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .margin(12)
        .caption(
            "Aeroglaze Z307 at 0.631 um: readings and fit",
            ("sans-serif", 20),
        )
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d(-90.0..90.0, (0.004..LARGEST).log_scale())?;
    chart
        .configure_mesh()
        .x_desc("view angle theta / deg (source side positive)")
        .y_desc("BRDF / (1/sr)")
        .x_labels(13)
        .x_label_formatter(&|x| format!("{x:.0}"))
        .light_line_style(RGBColor(240, 240, 240))
        .bold_line_style(RGBColor(215, 215, 215))
        .label_style(("sans-serif", 14))
        .draw()?;
    let last = ThreeParameterBrdf::new(fit.parameters, fit.n)?;
    let first = fit
        .stage1
        .map(|stage| ThreeParameterBrdf::new(stage.parameters.parameters(), fit.n))
        .transpose()?;
    let several: Vec<Incidence> = scan
        .incidences()
        .into_iter()
        .filter(|incidence| incidence.readings.len() > 1)
        .collect();
    for (incidence, colour) in several.iter().zip(COLOURS) {
        if let Some(first) = &first {
            let style = colour.mix(0.6).stroke_width(1);
            chart.draw_series(DashedLineSeries::new(
                theory(first, incidence.psi),
                5,
                4,
                style,
            ))?;
        }
        chart
            .draw_series(LineSeries::new(
                theory(&last, incidence.psi),
                colour.stroke_width(2),
            ))?
            .label(format!("psi = {:.0} deg", incidence.psi.to_degrees()))
            .legend(move |(x, y)| Circle::new((x + 10, y), 4, colour.filled()));
        chart.draw_series(incidence.readings.iter().map(|&i| {
            let reading = &scan.readings()[i];
            Circle::new(
                (reading.theta.to_degrees(), reading.brdf),
                3,
                colour.filled(),
            )
        }))?;
    }
    chart
        .draw_series(std::iter::empty::<Circle<(f64, f64), i32>>())?
        .label("fit of all incidences")
        .legend(|(x, y)| PathElement::new([(x, y), (x + 20, y)], BLACK.stroke_width(2)));
    let thin = BLACK.mix(0.6).stroke_width(1);
    chart
        .draw_series(std::iter::empty::<Circle<(f64, f64), i32>>())?
        .label("fit up to 60 deg")
        .legend(move |(x, y)| DashedPathElement::new([(x, y), (x + 20, y)], 5, 4, thin));
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .label_font(("sans-serif", 14))
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(200, 200, 200))
        .draw()?;
    root.present()?;
    Ok(())
}

fn theory(brdf: &ThreeParameterBrdf, psi: f64) -> Vec<(f64, f64)> {
    let half_degrees = (-170..=170).map(|half| 0.5 * f64::from(half));
    half_degrees
        .filter_map(|theta_deg: f64| {
            let geometry = Geometry::in_plane(psi, theta_deg.to_radians()).ok()?;
            let brdf = brdf.value(&geometry);
            // A line that leaves the axis would be drawn along its edge.
            (brdf <= LARGEST).then_some((theta_deg, brdf))
        })
        .collect()
}
