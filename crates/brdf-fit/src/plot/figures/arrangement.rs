//! One figure of a view, of one or several samples, arranged as the view says.

use brdf_core::AnyBrdf;

use super::{polar, residuals, theory};
use crate::measurement::Measurements;
use crate::plot::axis::Axis;
use crate::plot::canvas::{Canvas, Stands};
use crate::plot::curves::{Curves, Sigma, Source, Styled};
use crate::plot::error::PlotError;
use crate::plot::figure::Figure;
use crate::plot::frame::{Area, Frame, WHOLE, draw_title, drawn_with_samples, shortened_within};
use crate::plot::style::TEXT;
use crate::plot::title::Title;
use crate::plot::view::{Layout, Scale, View};

/// The part of the height that the residuals take.
const RESIDUALS: f64 = 0.28;

/// Between two planes: room for the numbers at their axes.
const GAP: (f64, f64) = (46.0, 40.0);

/// Room for the titles of the uppermost panels.
const TITLES: f64 = 16.0;

/// What a figure shows of one sample.
pub struct Layer<'a> {
    /// Its name.
    pub name: String,
    /// Its readings; none where only the theory is known.
    pub measurements: &'a Measurements,
    /// The theory.
    pub brdf: AnyBrdf,
    /// The theory in words: the model and its parameters.
    pub theory: String,
    /// The standard error of the theory in 1/sr at a geometry.
    pub sigma: Sigma<'a>,
    /// The incidences that are shown, psi in radians; `None` shows up to 8 of those with readings.
    pub incidences: Option<&'a [f64]>,
    /// The family of colours, where there are several samples: see [`colour`](super::colour).
    pub family: Option<usize>,
}

/// One figure of a view, `view`, of one or several samples: together, in panels or in the polar
/// form, with the residuals below where the view asks for them.
pub fn figure_of(layers: &[Layer], view: &View) -> Result<Figure, PlotError> {
    let several = layers.len() > 1;
    let sources: Vec<Source> = layers
        .iter()
        .map(|layer| Source {
            name: several.then_some(layer.name.as_str()),
            measurements: layer.measurements,
            brdf: &layer.brdf,
            sigma: layer.sigma,
            incidences: layer.incidences,
            family: layer.family,
        })
        .collect();
    let curves = Curves::of(&sources, view);
    let title = title(layers);
    let axis = theory::axis(&curves, view.scale);
    let note = match (view.layout, view.scale) {
        (Layout::Polar, _) => polar::note_on_lost(&curves),
        (_, Scale::Linear) => None,
        (_, Scale::Logarithmic) => theory::note_on_lost(&curves, &axis),
    };
    let svg = if view.layout == Layout::Polar {
        polar::svg(&title, &curves, note.as_deref())?
    } else {
        drawn_with_samples(&title, |canvas| {
            draw_title(canvas, &title)?;
            for panel in panels(&curves) {
                panel.draw(canvas, &curves, &axis)?;
            }
            if view.layout == Layout::Panels {
                name_axes(canvas, view)?;
            }
            theory::legend(&curves, note.as_deref()).draw(canvas)
        })?
    };
    let note = note.map_or_else(String::new, |note| format!(" {note}."));
    Ok(Figure {
        name: "view".to_owned(),
        caption: format!(
            "Theory against experiment: {} over the view angle. Marks: readings. Lines: {}.{}{note}",
            view.quantity.axis_name(),
            title.theory,
            curves.left_out
        ),
        svg,
    })
}

fn title(layers: &[Layer]) -> Title {
    let join = |of: &dyn Fn(&Layer) -> String| layers.iter().map(of).collect::<Vec<_>>().join("; ");
    let theory = join(&|layer: &Layer| layer.theory.clone());
    match layers {
        [one] => {
            let sample = one.measurements.metadata.get("sample").unwrap_or_default();
            let colon = if sample.is_empty() { "" } else { ": " };
            Title {
                sample: shortened(&format!("{}{colon}{sample}", one.title()), 100),
                details: theory.clone(),
                theory,
                samples: Vec::new(),
            }
        }
        _ => Title {
            sample: shortened_within(&join(&|layer: &Layer| layer.title()), 100),
            details: String::new(),
            theory,
            samples: layers.iter().map(Layer::line).collect(),
        },
    }
}

impl Layer<'_> {
    /// Its name and its wavelength.
    fn title(&self) -> String {
        self.named(usize::MAX)
    }

    /// What a line says of it: its name and wavelength, the model and its parameters.
    fn line(&self) -> String {
        format!("{}: {}", self.named(50), self.theory)
    }

    fn named(&self, longest: usize) -> String {
        let wavelength = self.measurements.wavelengths().first().copied().flatten();
        let wavelength = wavelength.map_or_else(String::new, |w| format!(", {w} um"));
        format!("{}{wavelength}", shortened_within(&self.name, longest))
    }
}

/// A text that is not longer than so many letters.
fn shortened(text: &str, longest: usize) -> String {
    if text.chars().count() <= longest {
        return text.to_owned();
    }
    let start: String = text.chars().take(longest - 3).collect();
    format!("{start}...")
}

/// A plane of theory and experiment, with the residuals below it where they are shown.
struct Panel<'a> {
    area: Area,
    curves: Vec<&'a Styled>,
    /// The incidence, where every panel has one of its own.
    name: Option<String>,
    /// One of many: without the names of the axes, which stand once for all.
    small: bool,
}

/// All curves in one panel, or a panel for each incidence.
fn panels(curves: &Curves) -> Vec<Panel<'_>> {
    let mut all: Vec<&Styled> = curves.all.iter().collect();
    if curves.view.layout != Layout::Panels {
        return vec![Panel {
            area: WHOLE,
            curves: all,
            name: None,
            small: false,
        }];
    }
    all.sort_by(|a, b| a.curve.psi.total_cmp(&b.curve.psi));
    let same = |a: &&Styled, b: &&Styled| (b.curve.psi - a.curve.psi).to_degrees() < 0.05;
    let groups: Vec<Vec<&Styled>> = all.chunk_by(same).map(<[_]>::to_vec).collect();
    let count = groups.len();
    let columns = columns(count);
    let rows = count.div_ceil(columns);
    groups
        .into_iter()
        .enumerate()
        .map(|(i, group)| Panel {
            area: part(i % columns, columns, i / columns, rows),
            name: group.first().map(|styled| styled.curve.name()),
            curves: group,
            small: true,
        })
        .collect()
}

/// The names of the axes, once for all panels.
fn name_axes(canvas: &mut Canvas, view: &View) -> Result<(), PlotError> {
    let middle = |from: f64, to: f64| 0.5 * (from + to);
    let below = (middle(WHOLE.left, WHOLE.right), WHOLE.bottom + 42.0);
    canvas.text(&view.theta_name(), below, TEXT + 1.0, Stands::Centred)?;
    let beside = (WHOLE.left - 66.0, middle(WHOLE.top, WHOLE.bottom));
    let residuals = if view.residuals {
        "; below: measured - theory"
    } else {
        ""
    };
    let name = format!("{}{residuals}", view.quantity.axis_name());
    canvas.text(&name, beside, TEXT + 1.0, Stands::Upwards)
}

/// So many columns that panels are somewhat wider than high.
fn columns(count: usize) -> usize {
    match count {
        0 | 1 => 1,
        2..=4 => 2,
        5..=9 => 3,
        10..=16 => 4,
        _ => 5,
    }
}

/// A part of the figure.
fn part(column: usize, columns: usize, row: usize, rows: usize) -> Area {
    let along = |from: f64, to: f64, gap: f64, i: usize, count: usize| {
        let size = (to - from - gap * (count - 1) as f64) / count as f64;
        let start = from + (size + gap) * i as f64;
        (start, start + size)
    };
    let (left, right) = along(WHOLE.left, WHOLE.right, GAP.0, column, columns);
    let (top, bottom) = along(WHOLE.top + TITLES, WHOLE.bottom, GAP.1, row, rows);
    Area {
        left,
        right,
        top,
        bottom,
    }
}

impl Panel<'_> {
    fn draw(&self, canvas: &mut Canvas, curves: &Curves, y: &Axis) -> Result<(), PlotError> {
        let view = &curves.view;
        let below = view.residuals.then(|| self.below());
        let frame = Frame {
            x: self.theta_axis(),
            y: y.clone(),
            area: Area {
                bottom: below.map_or(self.area.bottom, |below| below.top - 28.0),
                ..self.area
            },
        };
        let named = |name: &str| {
            if self.small {
                String::new()
            } else {
                name.to_owned()
            }
        };
        let theta_name = named(&view.theta_name());
        let above_name = if below.is_some() {
            ""
        } else {
            theta_name.as_str()
        };
        frame.draw(canvas, above_name, &named(view.quantity.axis_name()))?;
        theory::draw_curves(canvas, &frame, &self.curves, view)?;
        if let Some(name) = &self.name {
            let place = (frame.area.left + 5.0, frame.area.top - 9.0);
            canvas.text(name, place, TEXT, Stands::Right)?;
        }
        let Some(area) = below else {
            return Ok(());
        };
        let frame = Frame {
            x: self.theta_axis(),
            y: residuals::axis(curves),
            area,
        };
        frame.draw(canvas, &theta_name, &named(residuals::RESIDUAL))?;
        residuals::draw_residuals(canvas, &frame, &self.curves, view)
    }

    fn theta_axis(&self) -> Axis {
        Axis::fixed(-90, 90, if self.small { 45 } else { 15 })
    }

    fn below(&self) -> Area {
        let height = self.area.bottom - self.area.top;
        Area {
            top: self.area.bottom - RESIDUALS * height,
            ..self.area
        }
    }
}

#[cfg(test)]
mod tests {
    use brdf_core::{Family, ModelParameters, Parameters};

    use super::*;

    #[test]
    fn a_figure_of_several_samples_names_every_curve_and_all_parameters() {
        let none = Measurements::default();
        let at = ModelParameters::three(Parameters::new(0.3, 0.1, 0.2).unwrap(), 1.5);
        let psi = [0.2, 0.4, 0.6, 0.8, 1.0];
        let layer = |i: usize| Layer {
            name: format!("a sample with a rather long name, piece {i}"),
            measurements: &none,
            brdf: AnyBrdf::new(Family::Paper, &at).unwrap(),
            theory: format!("three: k2 = 0.3000, kD = 0.1000, k1 = 0.200{i}, n = 1.5000"),
            sigma: None,
            incidences: Some(&psi),
            family: Some(i),
        };
        let layers: Vec<Layer> = (0..4).map(layer).collect();
        for layout in [Layout::Together, Layout::Panels, Layout::Polar] {
            let view = View {
                layout,
                ..View::default()
            };
            let svg = figure_of(&layers, &view).unwrap().svg;
            assert!(!svg.contains("curves are named"), "{layout:?}");
            for i in 0..4 {
                assert!(svg.contains(&format!("piece {i}: three: k2")), "{layout:?}");
                assert!(svg.contains(&format!("k1 = 0.200{i}, n = 1.5000")));
            }
        }
    }
}
