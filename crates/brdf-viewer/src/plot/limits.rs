//! The limits of a fit as lines in the plot, with grips that can be dragged: the largest incidence
//! angle of stage 1, and the range of view angles.

use egui::{
    Align2, Color32, CursorIcon, Pos2, Rect, Role, Sense, Shape, Stroke, TextStyle, Ui, pos2, vec2,
};
use egui_plot::{PlotPoint, PlotResponse, PlotTransform};

use super::context::PlotContext;
use crate::intent::Intent;
use crate::state::State;
use crate::state::angle_range::End;
use crate::state::fit_settings::FitSettings;
use crate::widgets::named;

/// The size of a grip, in points.
const GRIP: [f32; 2] = [11.0, 18.0];

/// How far around a grip the pointer takes it, in points.
const REACH: f32 = 3.0;

/// A limit of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Limit {
    /// The largest incidence angle of stage 1, drawn at its mirror direction.
    Stage1,
    /// An end of the range of view angles.
    Angle(End),
}

/// Draws the limits that are shown: all if the user has asked for them, else those that are not at
/// their defaults. Requests the changes of those that are dragged.
pub(super) fn show(ui: &Ui, context: &PlotContext, response: &PlotResponse<()>) {
    let all = [
        Limit::Angle(End::Low),
        Limit::Angle(End::High),
        Limit::Stage1,
    ];
    for limit in all {
        let state = context.state;
        if state.interface.limits || limit.is_changed(state) {
            show_limit(ui, context, response, limit);
        }
    }
}

fn show_limit(ui: &Ui, context: &PlotContext, response: &PlotResponse<()>, limit: Limit) {
    let state = context.state;
    let Some(at_deg) = limit.position_deg(state) else {
        return;
    };
    let transform = &response.transform;
    let id = response.response.id.with(("limit", limit));
    let dragged = ui.data(|data| data.get_temp::<f64>(id));
    let shown_deg = dragged.unwrap_or(at_deg);
    let Some(grip) = limit.grip(transform, shown_deg) else {
        // A grip that is no longer visible is not dragged any more.
        ui.data_mut(|data| data.remove_temp::<f64>(id));
        return;
    };
    let name = limit.name(state, shown_deg);
    let grip_response = ui.interact(grip.expand(REACH), id, Sense::DRAG);
    let grip_response = named(grip_response, Role::Slider, &name);
    let grip_response = grip_response.on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
    let pointer = grip_response.interact_pointer_pos();
    if grip_response.dragged() {
        if let Some(to_deg) = pointer.and_then(|at| limit.dragged_to(state, transform, at)) {
            ui.data_mut(|data| data.insert_temp(id, to_deg));
            if let Some(intent) = limit.while_dragged(state, to_deg) {
                context.request(intent);
            }
        }
    } else if let Some(to_deg) = dragged {
        ui.data_mut(|data| data.remove_temp::<f64>(id));
        if let Some(intent) = limit.when_dropped(state, to_deg) {
            context.request(intent);
        }
    }
    let is_held = grip_response.hovered() || grip_response.dragged();
    draw(
        ui,
        transform,
        limit,
        shown_deg,
        grip,
        is_held.then_some(&*name),
    );
    grip_response.on_hover_text(limit.explanation(state, at_deg));
}

impl Limit {
    /// Whether the limit is not at its default.
    fn is_changed(self, state: &State) -> bool {
        match self {
            Self::Stage1 => {
                let limit = state.fit_settings.stage1_limit_deg;
                limit != FitSettings::default().stage1_limit_deg
            }
            Self::Angle(end) => {
                let range = state.active_angle_range();
                range.is_some_and(|range| range.is_limited(end))
            }
        }
    }

    /// The view angle at which the limit is drawn, in degrees with the sign of the view. `None` where
    /// the plot does not show it: there is no reading, or the plane has no mirror direction.
    fn position_deg(self, state: &State) -> Option<f64> {
        match self {
            Self::Stage1 => {
                let has_readings = state.active_sample()?.scan().reading_count() > 0;
                let limit = state.fit_settings.stage1_limit_deg;
                has_readings
                    .then(|| Some(mirror_sign(state)? * limit))
                    .flatten()
            }
            Self::Angle(end) => Some(end.of(state.active_angle_range()?.used)),
        }
    }

    /// The grip of the limit at a view angle: for the range at the top, on the side that is used; for
    /// stage 1 at the bottom. `None` outside the plot.
    fn grip(self, transform: &PlotTransform, at_deg: f64) -> Option<Rect> {
        let frame = transform.frame();
        let x = transform.position_from_point_x(at_deg);
        if !(frame.left() - 0.5..=frame.right() + 0.5).contains(&x) {
            return None;
        }
        let [width, height] = GRIP;
        let (left, top) = match self {
            Self::Angle(End::Low) => (x, frame.top()),
            Self::Angle(End::High) => (x - width, frame.top()),
            Self::Stage1 => (x - 0.5 * width, frame.bottom() - height),
        };
        Some(Rect::from_min_size(pos2(left, top), vec2(width, height)))
    }

    /// The view angle to which the pointer drags the limit. The limit of stage 1 stays between 0 and
    /// 90 degrees on its side, and at whole degrees.
    fn dragged_to(self, state: &State, transform: &PlotTransform, pointer: Pos2) -> Option<f64> {
        let PlotPoint { x: theta_deg, .. } = transform.value_from_position(pointer);
        Some(match self {
            Self::Stage1 => {
                let sign = mirror_sign(state)?;
                sign * (sign * theta_deg).round().clamp(0.0, 90.0)
            }
            Self::Angle(_) => theta_deg.clamp(-90.0, 90.0),
        })
    }

    /// The change while the limit is dragged: that of stage 1 is a setting, and follows the pointer.
    fn while_dragged(self, state: &State, to_deg: f64) -> Option<Intent> {
        if self != Self::Stage1 {
            return None;
        }
        let settings = FitSettings {
            stage1_limit_deg: to_deg.abs(),
            ..state.fit_settings.clone()
        };
        (settings != state.fit_settings).then_some(Intent::FitSettings(settings))
    }

    /// The change when the limit is dropped: readings are left out once, and undone at once.
    fn when_dropped(self, state: &State, to_deg: f64) -> Option<Intent> {
        let Self::Angle(end) = self else {
            return None;
        };
        let scan = state.active_sample()?.scan_id();
        Some(Intent::LimitAngles(scan, end, to_deg))
    }

    /// What the limit is, with its value.
    fn name(self, state: &State, at_deg: f64) -> String {
        match self {
            Self::Stage1 => format!("stage 1: ψ ≤ {}°", state.fit_settings.stage1_limit_deg),
            Self::Angle(End::Low) => format!("fit: θ ≥ {at_deg:.1}°"),
            Self::Angle(End::High) => format!("fit: θ ≤ {at_deg:.1}°"),
        }
    }

    /// What the limit means.
    fn explanation(self, state: &State, at_deg: f64) -> String {
        let beyond = match self {
            Self::Stage1 => {
                let limit = state.fit_settings.stage1_limit_deg;
                return format!(
                    "Stage 1 fits the incidences up to ψ = {limit}°: those whose mirror direction lies \
                     between 0° and this line. Drag to change the limit."
                );
            }
            Self::Angle(End::Low) => "below",
            Self::Angle(End::High) => "above",
        };
        format!(
            "Readings at view angles {beyond} {at_deg:.1}° are left out of the fit, at all incidences. \
             Drag inwards to leave more of them out, outwards to use them again."
        )
    }
}

/// The sign of the view angle of mirror directions; `None` outside the plane of incidence.
fn mirror_sign(state: &State) -> Option<f64> {
    state.view.mirror_deg(1.0).map(f64::signum)
}

/// Draws the line and the grip of a limit, and its value while it is held.
fn draw(
    ui: &Ui,
    transform: &PlotTransform,
    limit: Limit,
    at_deg: f64,
    grip: Rect,
    held: Option<&str>,
) {
    let visuals = ui.visuals();
    let (colour, line) = if held.is_some() {
        let colour = visuals.strong_text_color();
        (colour, Stroke::new(2.0, colour))
    } else {
        let colour = visuals.text_color();
        (colour, Stroke::new(1.0, colour))
    };
    let frame = transform.frame();
    let painter = ui.painter().with_clip_rect(frame.expand(1.0));
    let x = transform.position_from_point_x(at_deg);
    painter.vline(x, frame.y_range(), line);
    painter.rect_filled(grip, 2.0, colour);
    let ground = ui.visuals().extreme_bg_color;
    match limit {
        Limit::Stage1 => {
            let font = TextStyle::Body.resolve(ui.style());
            painter.text(grip.center(), Align2::CENTER_CENTER, "1", font, ground);
        }
        Limit::Angle(end) => {
            let sense = if end == End::Low { 1.0 } else { -1.0 };
            let corners = [[-2.5, -4.0], [2.5, 0.0], [-2.5, 4.0]];
            let corners = corners.map(|[x, y]| grip.center() + vec2(sense * x, y));
            let arrow = Shape::convex_polygon(corners.to_vec(), ground, Stroke::NONE);
            painter.add(arrow);
        }
    }
    if let Some(text) = held {
        draw_value(ui, frame, grip, text, colour);
    }
}

/// The value beside a grip, on the side of the middle of the plot.
fn draw_value(ui: &Ui, frame: &Rect, grip: Rect, text: &str, colour: Color32) {
    let painter = ui.painter().with_clip_rect(*frame);
    let font = TextStyle::Body.resolve(ui.style());
    let galley = painter.layout_no_wrap(text.to_owned(), font, colour);
    let y = grip.center().y - 0.5 * galley.size().y;
    let x = if grip.center().x < frame.center().x {
        grip.right() + 5.0
    } else {
        grip.left() - 5.0 - galley.size().x
    };
    let place = Rect::from_min_size(pos2(x, y), galley.size());
    painter.rect_filled(place.expand(2.0), 2.0, ui.visuals().extreme_bg_color);
    painter.galley(place.min, galley, colour);
}
