//! The dark and the light theme, and the colours of samples in each.

use brdf_fit::Quality;
use brdf_fit::plot::Ground;
use egui::{Color32, Context, ThemePreference};

/// Sets the theme that the user chose; `None` follows the system.
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

/// The background of the current theme.
pub fn ground(ctx: &Context) -> Ground {
    match ctx.theme() {
        egui::Theme::Dark => Ground::Dark,
        egui::Theme::Light => Ground::Light,
    }
}

/// Whether the theme of the system is dark. Where the system has none, the default of this program.
pub fn system_is_dark(ctx: &Context) -> bool {
    let theme = ctx.system_theme();
    theme.unwrap_or_else(|| ctx.options(|options| options.fallback_theme)) == egui::Theme::Dark
}

/// The colour of incidence `i` of `count` of a sample in a colour family; `None` is the family of a
/// single sample.
pub fn colour(family: Option<usize>, i: usize, count: usize, ground: Ground) -> Color32 {
    rgb(brdf_fit::plot::colour(family, i, count, ground))
}

/// The colour that identifies a colour family among several samples.
pub fn family_colour(family: usize, ground: Ground) -> Color32 {
    rgb(brdf_fit::plot::family_colour(family, ground))
}

/// One of two colours for curves that belong to no sample.
pub fn series_colour(i: usize, ground: Ground) -> Color32 {
    colour(None, i, 2, ground)
}

/// The colour of a quality: green, amber or red, of which the lightness differs as well.
pub fn quality_colour(quality: Quality, ground: Ground) -> Color32 {
    let (light, dark) = match quality {
        Quality::Good => ([0x1b, 0x7f, 0x3b], [0x5f, 0xc9, 0x7e]),
        Quality::Fair => ([0xa8, 0x62, 0x00], [0xe8, 0xab, 0x3f]),
        Quality::Poor => ([0xb7, 0x1c, 0x1c], [0xff, 0x80, 0x76]),
    };
    rgb(match ground {
        Ground::Light => light,
        Ground::Dark => dark,
    })
}

fn rgb([r, g, b]: [u8; 3]) -> Color32 {
    Color32::from_rgb(r, g, b)
}
