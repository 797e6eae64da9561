//! f_r over the signed view angle: all incidences in one plot, or one plot for each, with the
//! residuals below.

use brdf_fit::plot::{Layout, Reading, View};
use egui::{Align2, Id, Rangef, TextStyle, Ui, Vec2, vec2};
use egui_plot::{AxisHints, Plot, PlotResponse};

use super::hover::{Plots, read_out, read_out_residuals};
use super::items::{self, Drawing};
use super::{Drawn, title};
use crate::axis::{Axis, degrees};
use crate::state::State;

/// The part of the height that the residuals take.
const RESIDUALS: f32 = 0.3;

/// The axes are at least so wide that plots above each other line up, in points.
const AXIS_WIDTH: f32 = 62.0;

/// Room above a panel, in points.
const ABOVE_PANEL: f32 = 7.0;

/// Numbers at the axis of view angles are at least so far apart, in points.
const LEAST_APART: f64 = 34.0;

/// A panel is not lower than this, in points.
const LEAST_PANEL: f32 = 80.0;

/// All incidences in one plot.
pub fn together(ui: &mut Ui, plots: &Plots) {
    let all: Vec<&Drawn> = plots.drawn.iter().collect();
    let place = Place {
        state: plots.state,
        name: "theory",
        size: ui.available_size(),
        group: Some((Id::unique("theta"), [true, false])),
        named: true,
    };
    pair(ui, plots, &all, "residuals", &place);
}

/// Theory and experiment, and where they are asked for the residuals below.
fn pair(ui: &mut Ui, plots: &Plots, drawn: &[&Drawn], residuals: &str, place: &Place) {
    if !place.state.view.residuals {
        theory(ui, plots, drawn, place);
        return;
    }
    let Vec2 { x, y } = place.size;
    let below = y * RESIDUALS;
    let above = Place {
        size: vec2(x, y - below),
        ..*place
    };
    theory(ui, plots, drawn, &above);
    let gap = ui.spacing().item_spacing.y;
    let below = Place {
        name: residuals,
        size: vec2(x, (below - gap).max(1.0)),
        ..*place
    };
    residual(ui, plots, drawn, &below);
}

/// One plot for each incidence, with the same axes.
pub fn panels(ui: &mut Ui, plots: &Plots) {
    let panels = by_incidence(plots.drawn);
    name_axes(ui, &plots.state.view);
    let whole = ui.available_size();
    let columns = columns(panels.len(), whole);
    let rows = panels.len().div_ceil(columns);
    let gap = ui.spacing().item_spacing;
    let least = LEAST_PANEL * if plots.state.view.residuals { 2.0 } else { 1.0 };
    let size = vec2(
        (whole.x - gap.x * (columns - 1) as f32) / columns as f32,
        ((whole.y - gap.y * rows as f32) / rows as f32).max(least),
    );
    egui::ScrollArea::vertical()
        .auto_shrink(false)
        .show(ui, |ui| {
            for (row, chunk) in panels.chunks(columns).enumerate() {
                ui.horizontal(|ui| {
                    for (column, panel) in chunk.iter().enumerate() {
                        let place = row * columns + column;
                        ui.allocate_ui(size, |ui| show_panel(ui, plots, panel, place, size));
                    }
                });
            }
        });
}

/// The names of the axes, once for all panels.
fn name_axes(ui: &mut Ui, view: &View) {
    let below = if view.residuals {
        "; below: measured - theory"
    } else {
        ""
    };
    let narrow = ui.available_width() < 1.5 * NARROW;
    let [value, theta] = axis_names(view, narrow);
    ui.label(format!("{value} over {theta}{below}"));
}

fn show_panel(ui: &mut Ui, plots: &Plots, panel: &[&Drawn], place: usize, size: Vec2) {
    ui.vertical(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        // The uppermost number at the axis stands half above it.
        ui.add_space(ABOVE_PANEL);
        let names = [format!("theory {place}"), format!("residuals {place}")];
        let place = Place {
            state: plots.state,
            name: &names[0],
            size: vec2(size.x, size.y - ABOVE_PANEL),
            // Panels with residuals share the view angle only: the two kinds have other heights.
            group: Some((Id::unique("panels"), [true, !plots.state.view.residuals])),
            named: false,
        };
        pair(ui, plots, panel, &names[1], &place);
    });
}

/// The curves of each incidence, of all samples together.
fn by_incidence<'a>(drawn: &'a [Drawn<'a>]) -> Vec<Vec<&'a Drawn<'a>>> {
    let mut all: Vec<&Drawn> = drawn.iter().collect();
    all.sort_by(|a, b| a.curve.psi.total_cmp(&b.curve.psi));
    let same = |a: &&Drawn, b: &&Drawn| (b.curve.psi - a.curve.psi).to_degrees() < 0.05;
    all.chunk_by(same).map(<[_]>::to_vec).collect()
}

/// So many columns that the panels are about half again as wide as high.
pub(super) fn columns(count: usize, size: Vec2) -> usize {
    let columns = (count as f32 * size.x / (1.5 * size.y.max(1.0))).sqrt();
    (columns.round() as usize).clamp(1, count.clamp(1, 6))
}

type Group = Option<(Id, [bool; 2])>;

/// The names of the axes of values and of view angles, short ones where there is little room.
fn axis_names(view: &View, narrow: bool) -> [String; 2] {
    let (quantity, theta) = (view.quantity, view.theta_name());
    if narrow {
        let theta = theta.trim_start_matches("view angle ").to_owned();
        [quantity.short_name().to_owned(), theta]
    } else {
        [quantity.axis_name().to_owned(), theta]
    }
}

/// Where a plot is, and what it shares with others.
struct Place<'a> {
    state: &'a State,
    name: &'a str,
    size: Vec2,
    group: Group,
    /// Whether its axes have names; those of panels stand once for all.
    named: bool,
}

/// A plot that is narrower has short names at its axes, in points.
const NARROW: f32 = 400.0;

/// A plot over the view angle. `lowest` of those above each other has the name of the axis.
fn over_theta<'a>(place: &Place<'a>, axis: Axis, value: &str, lowest: bool) -> Plot<'a> {
    let narrow = place.size.x < NARROW;
    let width = f64::from(place.size.x);
    let mut x = AxisHints::new_x()
        .formatter(move |mark, range| {
            let apart = mark.step_size / (range.end() - range.start()) * width;
            if apart < LEAST_APART {
                return String::new();
            }
            Axis::Linear.label(mark, range)
        })
        .label_spacing(Rangef::new(8.0, 12.0));
    let mut y = AxisHints::new_y()
        .formatter(move |mark, range| axis.label(mark, range))
        .label_spacing(Rangef::new(11.0, 15.0))
        .min_thickness(if narrow { 36.0 } else { AXIS_WIDTH });
    if place.named {
        y = y.label(value);
        if lowest {
            let [_, theta] = axis_names(&place.state.view, narrow);
            x = x.label(theta);
        }
    }
    let mut plot = Plot::new(place.name)
        .id(super::id(place.state, place.name))
        .width(place.size.x)
        .height(place.size.y)
        .include_x(-90.0)
        .include_x(90.0)
        .set_margin_fraction(Vec2::ZERO)
        .x_grid_spacer(|input| degrees(&input))
        .y_grid_spacer(move |input| axis.grid(&input))
        .custom_x_axes(vec![x])
        .custom_y_axes(vec![y])
        .show_crosshair(false)
        .label_formatter(|_| None);
    if let Some((id, axes)) = place.group {
        plot = plot.link_axis(id, axes);
    }
    plot
}

fn theory(ui: &mut Ui, plots: &Plots, drawn: &[&Drawn], place: &Place) {
    let (state, axis) = (place.state, plots.axis);
    let range = plots.range;
    let end = |value: f64| axis.place(value).unwrap_or(0.0);
    let lowest = !state.view.residuals;
    let [name, _] = axis_names(&state.view, place.size.x < NARROW);
    let plot = over_theta(place, axis, &name, lowest)
        .include_y(end(range.0))
        .include_y(end(range.1));
    let response = reset_on_demand(ui, place.state, place.name, plot).show(ui, |plot_ui| {
        for (i, one) in drawn.iter().enumerate() {
            let (curve, colour) = (one.curve, one.colour);
            plot_ui.add(Drawing::new(
                format!("curve {i}"),
                move |transform, shapes| {
                    if let Some(mirror) = state.view.mirror_deg(curve.psi) {
                        items::upright(transform, mirror, colour, shapes);
                    }
                    items::band(transform, axis, &curve.theory, colour, shapes);
                    let value = |reading: &Reading| reading.value;
                    items::readings(transform, axis, &curve.readings, value, one.look(), shapes);
                    items::theory(transform, axis, &curve.theory, colour, shapes);
                },
            ));
        }
    });
    let at = |theta_deg: f64, value: f64| Some([theta_deg, axis.place(value)?]);
    read_out(&response, plots, drawn, at);
    if plots.state.view.layout == Layout::Panels {
        name_panel(ui, &state.view, &response, drawn);
    }
    describe(&response, "BRDF plot", drawn);
}

fn residual(ui: &mut Ui, plots: &Plots, drawn: &[&Drawn], place: &Place) {
    let reach = plots.reach;
    let plot = over_theta(place, Axis::Linear, "measured - theory", true)
        .include_y(-reach)
        .include_y(reach);
    let response = reset_on_demand(ui, place.state, place.name, plot).show(ui, |plot_ui| {
        for (i, one) in drawn.iter().enumerate() {
            plot_ui.add(Drawing::new(
                format!("residuals {i}"),
                move |transform, shapes| {
                    let (axis, readings) = (Axis::Linear, &one.curve.readings);
                    let value = Reading::residual;
                    items::readings(transform, axis, readings, value, one.look(), shapes);
                },
            ));
        }
    });
    read_out_residuals(&response, plots, drawn);
    describe(&response, "Residual plot", drawn);
}

/// The plot with everything in view again, where the user asked for it since the last frame.
pub(super) fn reset_on_demand<'a>(ui: &Ui, state: &State, name: &str, plot: Plot<'a>) -> Plot<'a> {
    let key = super::id(state, name).with("resets");
    let seen = ui.data(|data| data.get_temp::<u64>(key)).unwrap_or(0);
    if seen == state.zoom_resets {
        return plot;
    }
    ui.data_mut(|data| data.insert_temp(key, state.zoom_resets));
    plot.reset()
}

/// The incidence of a panel, in the upper corner that is away from the mirror direction.
fn name_panel(ui: &Ui, view: &View, response: &PlotResponse<()>, drawn: &[&Drawn]) {
    let Some(first) = drawn.first() else {
        return;
    };
    let frame = response.transform.frame();
    let mirror_at_left = view
        .mirror_deg(first.curve.psi)
        .is_some_and(|mirror| mirror < 0.0);
    let (corner, align) = if mirror_at_left {
        (frame.right_top() + vec2(-5.0, 3.0), Align2::RIGHT_TOP)
    } else {
        (frame.left_top() + vec2(5.0, 3.0), Align2::LEFT_TOP)
    };
    let font = TextStyle::Body.resolve(ui.style());
    let colour = ui.visuals().strong_text_color();
    ui.painter()
        .text(corner, align, title(first.curve.psi), font, colour);
}

/// Says in words what the plot shows, for those who do not see it.
pub fn describe(response: &PlotResponse<()>, name: &str, drawn: &[&Drawn]) {
    let readings: usize = drawn.iter().map(|one| one.curve.readings.len()).sum();
    let words = format!("{} curves, {readings} readings", drawn.len());
    response
        .response
        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name));
    let ctx = &response.response.ctx;
    ctx.accesskit_node_builder(response.response.id, |node| node.set_description(words));
}
