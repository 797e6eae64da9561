//! The figure of a view of one or several samples: together, in panels or in the polar form.

use brdf_core::AnyBrdf;

use super::{polar, residuals, theory};
use crate::plot::axis::Axis;
use crate::plot::canvas::Canvas;
use crate::plot::curves::StandardError;
use crate::plot::figure::Figure;
use crate::plot::frame::{Area, Frame, WHOLE};
use crate::plot::style::TEXT;
use crate::plot::styled::{Curves, Source, Styled};
use crate::plot::svg::Anchor;
use crate::plot::text::{shortened, shortened_in_the_middle};
use crate::plot::title::Title;
use crate::plot::view::{Layout, Scale, View};
use crate::scan::Measurements;

/// The fraction of the height of a panel that the residuals take.
const RESIDUALS: f64 = 0.28;

/// The horizontal and the vertical gap between panels: room for the numbers at their axes.
const GAP: (f64, f64) = (46.0, 40.0);

/// Room for the names of the uppermost panels.
const NAMES: f64 = 16.0;

/// The most letters above the figure.
const LONGEST_TITLE: usize = 100;

/// The most letters of the name of a sample below the figure.
const LONGEST_NAME: usize = 50;

/// The incidences of panels that differ by less than this angle in degrees share a panel.
const SAME_INCIDENCE_DEG: f64 = 0.05;

/// What a figure shows of one sample.
pub struct Layer<'a> {
    /// Its name.
    pub name: String,
    /// Its readings; none where only the theory is known.
    pub measurements: &'a Measurements,
    /// The theory.
    pub brdf: AnyBrdf,
    /// The theory as text: the model and its parameters.
    pub theory: String,
    /// The standard error of the theory in 1/sr at a geometry.
    pub sigma: StandardError<'a>,
    /// The incidence angles psi in radians that are shown; `None` shows up to 8 of those with
    /// readings.
    pub incidences: Option<&'a [f64]>,
    /// The family of colours, where there are several samples: see [`colour`](crate::plot::colour).
    pub family: Option<usize>,
}

/// The figure of one or several samples, arranged as `view` asks for: together, in panels or in the
/// polar form, with or without the residuals below.
pub fn figure_of(layers: &[Layer], view: &View) -> Figure {
    let curves = curves(layers, view);
    let title = Title {
        ground: view.ground,
        ..title(layers)
    };
    let axis = theory::axis(&curves, view.scale);
    let axis = match view.zoom.filter(|_| view.layout != Layout::Polar) {
        Some(zoom) => axis.within(zoom.value),
        None => axis,
    };
    let note = match (view.layout, view.scale) {
        (Layout::Polar, _) => polar::note_on_missing(&curves),
        (_, Scale::Linear) => None,
        (_, Scale::Logarithmic) => theory::note_on_missing(&curves, &axis),
    };
    let svg = if view.layout == Layout::Polar {
        polar::svg(&title, &curves, note.as_deref())
    } else {
        panels_svg(&title, &curves, &axis, note.as_deref())
    };
    let note = note.map_or_else(String::new, |note| format!(" {note}."));
    Figure {
        name: "view".to_owned(),
        caption: format!(
            "Theory against experiment: {} over the view angle. Marks: readings. Lines: {}.{}{note}",
            view.quantity.axis_name(),
            title.theory,
            curves.left_out
        ),
        svg,
    }
}

fn curves(layers: &[Layer], view: &View) -> Curves {
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
    Curves::of(&sources, view)
}

fn panels_svg(title: &Title, curves: &Curves, axis: &Axis, note: Option<&str>) -> String {
    title.render(|canvas| {
        for panel in panels(curves) {
            panel.draw(canvas, curves, axis);
        }
        if curves.view.layout == Layout::Panels {
            name_axes(canvas, &curves.view);
        }
        theory::legend(curves, note).draw(canvas);
    })
}

fn title(layers: &[Layer]) -> Title {
    let join = |of: &dyn Fn(&Layer) -> String| layers.iter().map(of).collect::<Vec<_>>().join("; ");
    let theory = join(&|layer: &Layer| layer.theory.clone());
    if let [one] = layers {
        let sample = one.measurements.metadata.get("sample").unwrap_or_default();
        let colon = if sample.is_empty() { "" } else { ": " };
        let name = format!("{}{colon}{sample}", one.title());
        return Title {
            sample: shortened(&name, LONGEST_TITLE),
            details: theory.clone(),
            theory,
            ..Title::default()
        };
    }
    let names = join(&|layer: &Layer| layer.title());
    Title {
        sample: shortened_in_the_middle(&names, LONGEST_TITLE),
        details: String::new(),
        theory,
        samples: layers.iter().map(Layer::line).collect(),
        ..Title::default()
    }
}

impl Layer<'_> {
    /// Its name and its wavelength.
    fn title(&self) -> String {
        self.title_within(usize::MAX)
    }

    /// Its line below the figure: name and wavelength, the model and its parameters.
    fn line(&self) -> String {
        format!("{}: {}", self.title_within(LONGEST_NAME), self.theory)
    }

    fn title_within(&self, longest_name: usize) -> String {
        let wavelength = self.measurements.wavelengths().first().copied().flatten();
        let wavelength = wavelength.map_or_else(String::new, |w| format!(", {w} um"));
        let name = shortened_in_the_middle(&self.name, longest_name);
        format!("{name}{wavelength}")
    }
}

/// Theory and experiment within one area, with the residuals below where the view asks for them.
struct Panel<'a> {
    area: Area,
    curves: Vec<&'a Styled>,
    /// The incidence, where each panel shows a single one.
    name: Option<String>,
    /// Whether it is one of several, whose axes are named once for all.
    small: bool,
}

/// One panel with all curves, or a panel for each incidence.
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
    let same =
        |a: &&Styled, b: &&Styled| (b.curve.psi - a.curve.psi).to_degrees() < SAME_INCIDENCE_DEG;
    let groups: Vec<Vec<&Styled>> = all.chunk_by(same).map(<[_]>::to_vec).collect();
    let columns = columns(groups.len());
    let rows = groups.len().div_ceil(columns);
    groups
        .into_iter()
        .enumerate()
        .map(|(i, group)| Panel {
            area: cell((i % columns, columns), (i / columns, rows)),
            name: group.first().map(|styled| styled.curve.name()),
            curves: group,
            small: true,
        })
        .collect()
}

/// The names of the axes of all panels.
fn name_axes(canvas: &mut Canvas, view: &View) {
    WHOLE.draw_x_name(canvas, &view.theta_name());
    let residuals = if view.residuals {
        "; below: measured - theory"
    } else {
        ""
    };
    let name = format!("{}{residuals}", view.quantity.axis_name());
    WHOLE.draw_y_name(canvas, &name);
}

/// The number of columns with which panels are somewhat wider than high.
fn columns(panels: usize) -> usize {
    match panels {
        0 | 1 => 1,
        2..=4 => 2,
        5..=9 => 3,
        10..=16 => 4,
        _ => 5,
    }
}

/// The area of a panel, by the index and the number of its column and of its row.
fn cell((column, columns): (usize, usize), (row, rows): (usize, usize)) -> Area {
    let interval = |from: f64, to: f64, gap: f64, i: usize, count: usize| {
        let size = (to - from - gap * (count - 1) as f64) / count as f64;
        let start = from + (size + gap) * i as f64;
        (start, start + size)
    };
    let (left, right) = interval(WHOLE.left, WHOLE.right, GAP.0, column, columns);
    let (top, bottom) = interval(WHOLE.top + NAMES, WHOLE.bottom, GAP.1, row, rows);
    Area {
        left,
        right,
        top,
        bottom,
    }
}

impl Panel<'_> {
    fn draw(&self, canvas: &mut Canvas, curves: &Curves, y: &Axis) {
        let view = &curves.view;
        let below = view.residuals.then(|| self.residuals_area());
        let frame = Frame {
            x: self.theta_axis(view),
            y: y.clone(),
            area: Area {
                bottom: below.map_or(self.area.bottom, |below| below.top - 28.0),
                ..self.area
            },
        };
        let theta_name = self.axis_name(&view.theta_name());
        let x_name: &str = if below.is_some() { "" } else { &theta_name };
        frame.draw(canvas, x_name, &self.axis_name(view.quantity.axis_name()));
        theory::draw_curves(canvas, &frame, &self.curves, view);
        if let Some(name) = &self.name {
            let point = (frame.area.left + 5.0, frame.area.top - 9.0);
            canvas.text(name, point, TEXT, Anchor::Start);
        }
        if let Some(area) = below {
            let frame = Frame {
                x: self.theta_axis(view),
                y: residuals::axis(curves),
                area,
            };
            frame.draw(canvas, &theta_name, &self.axis_name(residuals::RESIDUAL));
            residuals::draw_residuals(canvas, &frame, &self.curves, view);
        }
    }

    /// The name of an axis; none in a small panel.
    fn axis_name(&self, name: &str) -> String {
        if self.small {
            String::new()
        } else {
            name.to_owned()
        }
    }

    fn theta_axis(&self, view: &View) -> Axis {
        let all = Axis::fixed(-90, 90, if self.small { 45 } else { 15 });
        view.zoom
            .map_or(all.clone(), |zoom| all.within(zoom.theta_deg))
    }

    fn residuals_area(&self) -> Area {
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
    use crate::plot::palette::Ground;
    use crate::plot::view::Zoom;

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
            let svg = figure_of(&layers, &view).svg;
            assert!(!svg.contains("curves are named"), "{layout:?}");
            for i in 0..4 {
                assert!(svg.contains(&format!("piece {i}: three: k2")), "{layout:?}");
                assert!(svg.contains(&format!("k1 = 0.200{i}, n = 1.5000")));
            }
        }
    }

    #[test]
    fn a_figure_shows_the_zoom_of_its_view_on_its_ground() {
        let truth = Parameters::new(0.3, 0.1, 0.2).unwrap();
        let scan = crate::scan::synthetic::scan(truth, 1.5);
        let at = ModelParameters::three(truth, 1.5);
        let layer = Layer {
            name: "sample".to_owned(),
            measurements: &scan,
            brdf: AnyBrdf::new(Family::Paper, &at).unwrap(),
            theory: String::new(),
            sigma: None,
            incidences: None,
            family: None,
        };
        let figure = |view: View| figure_of(std::slice::from_ref(&layer), &view).svg;
        let all = figure(View::default());
        assert!(all.contains("fill=\"#FFFFFF\"") && all.contains("\n-90\n"));
        for scale in [Scale::Linear, Scale::Logarithmic] {
            let zoom = Zoom {
                theta_deg: [-32.0, 12.0],
                value: [0.05, 0.2],
            };
            let svg = figure(View {
                zoom: Some(zoom),
                ground: Ground::Dark,
                scale,
                ..View::default()
            });
            assert!(svg.contains("fill=\"#1B1B1B\"") && !svg.contains("#FFFFFF"));
            assert!(svg.contains("\n-30\n") && !svg.contains("\n-90\n"));
            // Nothing is drawn beyond the axes: the area, in twentieths of a unit.
            let points = svg.split("points=\"").skip(1);
            let points = points.flat_map(|rest| rest.split('"').next().unwrap().split_whitespace());
            for point in points {
                let (x, y) = point.split_once(',').unwrap();
                let inside = |value: &str, low: f64, high: f64| {
                    let value = value.parse::<f64>().unwrap() / 20.0;
                    low - 4.0 <= value && value <= high + 4.0
                };
                // The keys of the legend are to the right of the area.
                let in_legend = inside(x, WHOLE.right + 5.0, 960.0);
                assert!(in_legend || inside(x, WHOLE.left, WHOLE.right), "{point}");
                assert!(inside(y, WHOLE.top, WHOLE.bottom), "{point}");
            }
        }
    }
}
