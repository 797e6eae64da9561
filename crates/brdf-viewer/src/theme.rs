//! Dark and light.

use brdf_fit::plot::Ground;
use egui::{Color32, Context, ThemePreference};

/// Sets what the user chose; `None` is what the system says.
pub fn set(ctx: &Context, dark: Option<bool>) {
    let wanted = match dark {
        None => ThemePreference::System,
        Some(true) => ThemePreference::Dark,
        Some(false) => ThemePreference::Light,
    };
    if ctx.options(|options| options.theme_preference) != wanted {
        ctx.set_theme(wanted);
    }
}

/// The ground that colours are seen on.
pub fn ground(ctx: &Context) -> Ground {
    match ctx.theme() {
        egui::Theme::Dark => Ground::Dark,
        egui::Theme::Light => Ground::Light,
    }
}

/// The colour of an incidence of a sample.
pub fn colour(family: usize, i: usize, count: usize, ground: Ground) -> Color32 {
    let [r, g, b] = brdf_fit::plot::colour(family, i, count, ground);
    Color32::from_rgb(r, g, b)
}
