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

/// Whether the system's windows are dark, or else those of this program by default.
pub fn system_is_dark(ctx: &Context) -> bool {
    let theme = ctx.system_theme();
    theme.unwrap_or_else(|| ctx.options(|options| options.fallback_theme)) == egui::Theme::Dark
}

/// The colour of an incidence of a sample of this family; `None` where it is the only sample.
pub fn colour(family: Option<usize>, i: usize, count: usize, ground: Ground) -> Color32 {
    rgb(brdf_fit::plot::colour(family, i, count, ground))
}

/// The colour that a sample is known by, beside others.
pub fn family_colour(family: usize, ground: Ground) -> Color32 {
    rgb(brdf_fit::plot::family_colour(family, ground))
}

/// One of two colours for what is no sample.
pub fn plain(i: usize, ground: Ground) -> Color32 {
    colour(None, i, 2, ground)
}

fn rgb([r, g, b]: [u8; 3]) -> Color32 {
    Color32::from_rgb(r, g, b)
}
