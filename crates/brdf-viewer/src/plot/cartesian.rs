//! Cartesian plots against the signed view angle: all incidences in one plot, or one plot per
//! incidence, with optional residuals below.

use brdf_fit::plot::{Layout, Reading, Theory, View, Zoom};
use egui::{Align2, Id, Rangef, TextStyle, Ui, Vec2, vec2};
use egui_plot::{AxisHints, Plot, PlotResponse};

use super::axis::{Axis, degrees_grid};
use super::choice::choose;
use super::common::{self, describe, reset_on_demand};
use super::context::{DrawnCurve, PlotContext};
use super::hover::{show_residuals, show_values};
use super::items::{self, Drawing};
use super::limits;
use super::navigation::navigate;
use super::planned;
use crate::intent::Intent;

/// The fraction of the height that the residuals occupy.
const RESIDUALS: f32 = 0.3;

/// Least width of the vertical axis, in points, so that plots above each other are aligned.
const AXIS_WIDTH: f32 = 62.0;

/// Least width of the vertical axis of a narrow plot, in points.
const NARROW_AXIS_WIDTH: f32 = 36.0;

/// A plot narrower than this has short axis names, in points.
const NARROW: f32 = 400.0;

/// Space above a panel for the upper half of the topmost label, in points.
const ABOVE_PANEL: f32 = 7.0;

/// Least distance of labelled view angles, in points.
const LABEL_DISTANCE: f64 = 34.0;

/// Least height of a panel, in points.
const LEAST_PANEL: f32 = 80.0;

/// The position of a plot, and what it shares with others.
struct Placement<'a> {
    name: &'a str,
    /// The size in points.
    size: Vec2,
    /// The group of plots that share their bounds, and whether along x and y.
    group: (Id, [bool; 2]),
    /// Whether the axes are named; those of panels are named once for all.
    has_axis_names: bool,
}

/// All incidences in one plot.
pub(super) fn together(ui: &mut Ui, context: &PlotContext) {
    let all: Vec<&DrawnCurve> = context.curves.iter().collect();
    let placement = Placement {
        name: "theory",
        size: ui.available_size(),
        group: (Id::unique("theta"), [true, false]),
        has_axis_names: true,
    };
    show_pair(ui, context, &all, "residuals", &placement);
}

/// A plot of the values, and of the residuals below if they are shown.
fn show_pair(
    ui: &mut Ui,
    context: &PlotContext,
    curves: &[&DrawnCurve],
    residuals: &str,
    placement: &Placement,
) {
    if !context.state.view.residuals {
        show_values_plot(ui, context, curves, placement);
        return;
    }
    let Vec2 { x, y } = placement.size;
    let height_below = y * RESIDUALS;
    let above = Placement {
        size: vec2(x, y - height_below),
        ..*placement
    };
    show_values_plot(ui, context, curves, &above);
    let gap = ui.spacing().item_spacing.y;
    let below = Placement {
        name: residuals,
        size: vec2(x, (height_below - gap).max(1.0)),
        ..*placement
    };
    show_residual_plot(ui, context, curves, &below);
}

/// One plot per incidence, all with the same axes.
pub(super) fn panels(ui: &mut Ui, context: &PlotContext) {
    let panels = by_incidence(context.curves);
    let view = &context.state.view;
    show_axis_names(ui, view);
    let available = ui.available_size();
    let columns = panel_columns(panels.len(), available);
    let rows = panels.len().div_ceil(columns);
    let gap = ui.spacing().item_spacing;
    let least_height = LEAST_PANEL * if view.residuals { 2.0 } else { 1.0 };
    let size = vec2(
        (available.x - gap.x * (columns - 1) as f32) / columns as f32,
        ((available.y - gap.y * rows as f32) / rows as f32).max(least_height),
    );
    egui::ScrollArea::vertical()
        .auto_shrink(false)
        .show(ui, |ui| {
            for (row, chunk) in panels.chunks(columns).enumerate() {
                ui.horizontal(|ui| {
                    for (column, panel) in chunk.iter().enumerate() {
                        let index = row * columns + column;
                        ui.allocate_ui(size, |ui| show_panel(ui, context, panel, index, size));
                    }
                });
            }
        });
}

/// The names of the axes, once for all panels.
fn show_axis_names(ui: &mut Ui, view: &View) {
    let below = if view.residuals {
        "; below: residuals"
    } else {
        ""
    };
    let narrow = ui.available_width() < 1.5 * NARROW;
    let [value, theta] = axis_names(view, narrow);
    ui.label(format!("{value} over {theta}{below}"));
}

fn show_panel(
    ui: &mut Ui,
    context: &PlotContext,
    curves: &[&DrawnCurve],
    index: usize,
    size: Vec2,
) {
    ui.vertical(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        ui.add_space(ABOVE_PANEL);
        let [name, residuals] = [format!("theory {index}"), format!("residuals {index}")];
        let placement = Placement {
            name: &name,
            size: vec2(size.x, size.y - ABOVE_PANEL),
            // Values and residuals have different ranges, and can share only the view angle.
            group: (Id::unique("panels"), [true, !context.state.view.residuals]),
            has_axis_names: false,
        };
        show_pair(ui, context, curves, &residuals, &placement);
    });
}

/// The curves grouped by incidence, over all samples.
fn by_incidence<'a>(curves: &'a [DrawnCurve<'a>]) -> Vec<Vec<&'a DrawnCurve<'a>>> {
    let mut all: Vec<&DrawnCurve> = curves.iter().collect();
    all.sort_by(|a, b| a.curve.psi.total_cmp(&b.curve.psi));
    let is_same = |a: &&DrawnCurve, b: &&DrawnCurve| is_same_incidence(a.curve.psi, b.curve.psi);
    all.chunk_by(is_same).map(<[_]>::to_vec).collect()
}

/// Whether ascending incidence angles in radians share a panel.
pub(super) fn is_same_incidence(lower: f64, upper: f64) -> bool {
    (upper - lower).to_degrees() < 0.05
}

/// The number of columns of panels with an aspect ratio of about 3:2.
pub(super) fn panel_columns(count: usize, size: Vec2) -> usize {
    let columns = (count as f32 * size.x / (1.5 * size.y.max(1.0))).sqrt();
    (columns.round() as usize).clamp(1, count.clamp(1, 6))
}

/// The names of the vertical and the horizontal axis, shortened for narrow plots.
fn axis_names(view: &View, narrow: bool) -> [String; 2] {
    let (quantity, theta) = (view.quantity, view.theta_name());
    if narrow {
        let theta = theta.trim_start_matches("view angle ").to_owned();
        [quantity.short_name().to_owned(), theta]
    } else {
        [quantity.axis_name().to_owned(), theta]
    }
}

/// An empty plot against the view angle. `name` is the name of the vertical axis; the horizontal one
/// is named in the lowest of plots above each other.
fn plot_over_theta<'a>(
    context: &PlotContext,
    placement: &Placement<'a>,
    axis: Axis,
    name: &str,
    is_lowest: bool,
) -> Plot<'a> {
    let (state, size) = (context.state, placement.size);
    let narrow = size.x < NARROW;
    let mut x = theta_axis(size.x);
    let mut y = AxisHints::new_y()
        .formatter(move |mark, range| axis.label(mark, range))
        .label_spacing(Rangef::new(11.0, 15.0))
        .min_thickness(if narrow {
            NARROW_AXIS_WIDTH
        } else {
            AXIS_WIDTH
        });
    if placement.has_axis_names {
        y = y.label(name);
        if is_lowest {
            let [_, theta] = axis_names(&state.view, narrow);
            x = x.label(theta);
        }
    }
    let (group, shared) = placement.group;
    Plot::new(placement.name)
        .id(common::id(state, placement.name))
        .width(size.x)
        .height(size.y)
        .include_x(-90.0)
        .include_x(90.0)
        .set_margin_fraction(Vec2::ZERO)
        .x_grid_spacer(|input| degrees_grid(&input))
        .y_grid_spacer(move |input| axis.vertical_grid(&input))
        .custom_x_axes(vec![x])
        .custom_y_axes(vec![y])
        .show_crosshair(false)
        .label_formatter(|_| None)
        .allow_scroll(false)
        .allow_drag(!state.choosing)
        .link_axis(group, shared)
}

/// The axis of view angles in a plot of a width, in points.
fn theta_axis<'a>(width: f32) -> AxisHints<'a> {
    let width = f64::from(width);
    AxisHints::new_x()
        .formatter(move |mark, range| {
            let distance = mark.step_size / (range.end() - range.start()) * width;
            if distance < LABEL_DISTANCE {
                return String::new();
            }
            Axis::Linear.label(mark, range)
        })
        .label_spacing(Rangef::new(8.0, 12.0))
}

fn show_values_plot(
    ui: &mut Ui,
    context: &PlotContext,
    curves: &[&DrawnCurve],
    placement: &Placement,
) {
    let (view, axis) = (&context.state.view, context.axis);
    let end = |value: f64| axis.position(value).unwrap_or(0.0);
    let [name, _] = axis_names(view, placement.size.x < NARROW);
    let plot = plot_over_theta(context, placement, axis, &name, !view.residuals)
        .include_y(end(context.range.0))
        .include_y(end(context.range.1));
    let plot = reset_on_demand(ui, context.state, placement.name, plot);
    let home = [[-90.0, 90.0], [end(context.range.0), end(context.range.1)]];
    let mut shows_all = true;
    let planned_colour = ui.visuals().strong_text_color();
    let response = plot.show(ui, |plot_ui| {
        navigate(plot_ui, home);
        for (i, drawn) in curves.iter().enumerate() {
            plot_ui.add(curve_item(format!("curve {i}"), view, axis, drawn));
        }
        let psi =
            (view.layout == Layout::Panels).then(|| curves.first().map(|drawn| drawn.curve.psi));
        let points = planned::points(context, psi.flatten());
        plot_ui.add(Drawing::new(
            "planned readings".to_owned(),
            move |transform, shapes| {
                planned::draw(transform, axis, &points, planned_colour, shapes);
            },
        ));
        shows_all = plot_ui.auto_bounds().any();
    });
    if view.layout == Layout::Together {
        tell_zoom(context, &response, shows_all);
    }
    let position = |theta_deg: f64, value: f64| Some([theta_deg, axis.position(value)?]);
    show_values(&response, view, curves, position);
    let of_reading = |reading: &Reading| position(reading.theta_deg, reading.value);
    choose(context, &response, curves, of_reading);
    match view.layout {
        Layout::Panels => show_panel_title(ui, view, &response, curves),
        Layout::Together | Layout::Polar => limits::show(ui, context, &response),
    }
    describe(&response, "BRDF plot", curves);
}

/// Tells the state which part of the plot is shown, for figures that are exported.
fn tell_zoom(context: &PlotContext, response: &PlotResponse<()>, shows_all: bool) {
    let bounds = response.transform.bounds();
    let value = |i: usize| context.axis.value([bounds.min()[1], bounds.max()[1]][i]);
    let zoom = (!shows_all).then(|| Zoom {
        theta_deg: [bounds.min()[0], bounds.max()[0]],
        value: [value(0), value(1)],
    });
    if context.state.zoom != zoom {
        context.request(Intent::Zoomed(zoom));
    }
}

/// A curve with its mirror direction, its band and its readings.
fn curve_item<'a>(name: String, view: &View, axis: Axis, drawn: &'a DrawnCurve) -> Drawing<'a> {
    let (curve, colour) = (drawn.curve, drawn.colour);
    let mirror = view.mirror_deg(curve.psi);
    Drawing::new(name, move |transform, shapes| {
        if let Some(mirror) = mirror {
            items::vertical_line(transform, mirror, colour, shapes);
        }
        items::band(transform, axis, &curve.theory, colour, shapes);
        items::readings(
            transform,
            axis,
            drawn,
            |reading| Some(reading.value),
            shapes,
        );
        items::theory(transform, axis, &curve.theory, colour, shapes);
        let position = |theory: &Theory| Some([theory.theta_deg, axis.position(theory.value)?]);
        items::ghosts(transform, drawn, position, shapes);
    })
}

fn show_residual_plot(
    ui: &mut Ui,
    context: &PlotContext,
    curves: &[&DrawnCurve],
    placement: &Placement,
) {
    let (axis, limit) = (Axis::Linear, context.residual_limit);
    let name = context.state.interface.residuals.axis_name();
    let plot = plot_over_theta(context, placement, axis, name, true)
        .include_y(-limit)
        .include_y(limit);
    let plot = reset_on_demand(ui, context.state, placement.name, plot);
    let home = [[-90.0, 90.0], [-limit, limit]];
    let response = plot.show(ui, |plot_ui| {
        navigate(plot_ui, home);
        for (i, drawn) in curves.iter().enumerate() {
            let name = format!("residuals {i}");
            plot_ui.add(Drawing::new(name, move |transform, shapes| {
                let value = |reading: &Reading| context.residual(reading);
                items::readings(transform, axis, drawn, value, shapes);
            }));
        }
    });
    let of_reading = |reading: &Reading| Some([reading.theta_deg, context.residual(reading)?]);
    show_residuals(&response, &context.state.view, curves, of_reading);
    choose(context, &response, curves, of_reading);
    describe(&response, "Residual plot", curves);
}

/// The incidence of a panel, in the upper corner opposite to the mirror direction.
fn show_panel_title(ui: &Ui, view: &View, response: &PlotResponse<()>, curves: &[&DrawnCurve]) {
    let Some(first) = curves.first() else {
        return;
    };
    let frame = response.transform.frame();
    let mirror_is_left = view
        .mirror_deg(first.curve.psi)
        .is_some_and(|mirror| mirror < 0.0);
    let (corner, align) = if mirror_is_left {
        (frame.right_top() + vec2(-5.0, 3.0), Align2::RIGHT_TOP)
    } else {
        (frame.left_top() + vec2(5.0, 3.0), Align2::LEFT_TOP)
    };
    let font = TextStyle::Body.resolve(ui.style());
    let colour = ui.visuals().strong_text_color();
    let title = common::title(first.curve.psi);
    ui.painter().text(corner, align, title, font, colour);
}
