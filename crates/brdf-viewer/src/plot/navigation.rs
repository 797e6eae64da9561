//! Zooming with the wheel, limits of panning and zooming, and the keys that move a picture.

use egui::{EventFilter, Key, Response, Ui};
use egui_plot::PlotUi;

/// How much a turn of the wheel by one point zooms.
const ZOOM_PER_POINT: f32 = 0.004;

/// A plot can be zoomed out to this multiple of its initial range.
const MOST_ZOOM_OUT: f64 = 3.0;

/// A plot can be zoomed in to this part of its initial range.
const MOST_ZOOM_IN: f64 = 1e-6;

/// Zooms around the pointer by the wheel, and moves bounds back that have left the `home` of the plot:
/// its ranges along x and y.
pub(super) fn navigate(plot_ui: &mut PlotUi<'_>, home: [[f64; 2]; 2]) {
    if plot_ui.response().hovered() {
        let scroll = plot_ui.ctx().input(|input| input.smooth_scroll_delta.y);
        if scroll != 0.0 {
            plot_ui.zoom_bounds_around_hovered(egui::Vec2::splat((scroll * ZOOM_PER_POINT).exp()));
        }
    }
    // A plot that fits its content has no bounds to limit.
    if plot_ui.auto_bounds().all() {
        return;
    }
    let bounds = plot_ui.plot_bounds();
    if let Some([from, to]) = limited(bounds.min()[0], bounds.max()[0], home[0]) {
        plot_ui.set_plot_bounds_x(from..=to);
    }
    if let Some([from, to]) = limited(bounds.min()[1], bounds.max()[1], home[1]) {
        plot_ui.set_plot_bounds_y(from..=to);
    }
}

/// The range nearest to one from `low` to `high` that overlaps the home range; `None` where it is
/// within the limits already.
fn limited(low: f64, high: f64, [home_low, home_high]: [f64; 2]) -> Option<[f64; 2]> {
    let home = home_high - home_low;
    let width = high - low;
    if !(home > 0.0 && width.is_finite()) {
        return None;
    }
    let limited_width = width.clamp(MOST_ZOOM_IN * home, MOST_ZOOM_OUT * home);
    let centre = (0.5 * (low + high)).clamp(home_low, home_high);
    let limited = [centre - 0.5 * limited_width, centre + 0.5 * limited_width];
    let moved = (limited[0] - low).abs().max((limited[1] - high).abs());
    (moved > 1e-9 * limited_width).then_some(limited)
}

/// How often the arrow keys were pressed in this frame, to the right and upwards; a widget that has the focus
/// keeps them from moving it.
pub(super) fn arrow_presses(ui: &Ui, response: &Response) -> [f64; 2] {
    let filter = EventFilter {
        horizontal_arrows: true,
        vertical_arrows: true,
        ..EventFilter::default()
    };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    [
        presses(ui, Key::ArrowRight) - presses(ui, Key::ArrowLeft),
        presses(ui, Key::ArrowUp) - presses(ui, Key::ArrowDown),
    ]
}

/// How often a key was pressed in this frame.
pub(super) fn presses(ui: &Ui, key: Key) -> f64 {
    ui.input(|input| f64::from(input.num_presses(key) as u32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_is_moved_back_only_where_it_has_left_the_plot() {
        let home = [-90.0, 90.0];
        assert_eq!(limited(-90.0, 90.0, home), None);
        assert_eq!(limited(-10.0, 5.0, home), None);
        assert_eq!(limited(100.0, 120.0, home), Some([80.0, 100.0]));
        let out = limited(-900.0, 900.0, home).unwrap();
        assert_eq!(out, [-270.0, 270.0]);
        let within = limited(1.0, 1.0 + 1e-12, home).unwrap();
        assert!(within[1] - within[0] > 1e-5);
        assert_eq!(limited(0.0, f64::INFINITY, home), None);
    }
}
