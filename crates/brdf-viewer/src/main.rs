//! The program: a window, or with `--screenshot` a picture of one.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use brdf_fit::model::Model;
use brdf_fit::output::resolved;
use brdf_fit::scan::{Convention, Side};
use brdf_viewer::Viewer;
use brdf_viewer::dialogs::Native;
use brdf_viewer::intent::{Command, Intent};
use brdf_viewer::screenshot::{Unseen, write_png};
use brdf_viewer::state::fitting::{Scope, Stages};
use brdf_viewer::state::interface::ResultTab;
use brdf_viewer::state::saved::{SMALLEST_WINDOW, Settings};
use clap::{Parser, ValueEnum};
use eframe::egui;

/// Theory against experiment for each incidence angle, with live parameters.
///
/// Opens scans (tables with the columns psi_deg, theta_deg and brdf_per_sr) and fits as JSON, shows
/// readings and theory, and fits. Without a file it opens what was open the last time, or a
/// measured sample of its own.
#[derive(Parser)]
#[command(name = "viewer", version, max_term_width = 100)]
#[expect(clippy::struct_excessive_bools, reason = "flags of a command line")]
struct Arguments {
    /// Scans, or fits as JSON
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,

    /// Write a picture of the window to this file, as PNG, and leave; needs no display
    #[arg(long, value_name = "FILE")]
    screenshot: Option<PathBuf>,

    /// The side of the surface normal on which the scans count theta positive, source or forward
    /// [default: as it was left, or source]
    #[arg(long, value_name = "SIDE")]
    theta_positive: Option<Side>,

    /// The side on which the azimuth phi of the scans is zero, source or forward [default: as it was
    /// left, or source]
    #[arg(long, value_name = "SIDE")]
    phi_zero: Option<Side>,

    /// Size of the window in points, at least 900x600 [default: as it was left, or 1280x800]
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size)]
    size: Option<[f32; 2]>,

    /// Pixels for each point of the picture
    #[arg(long, value_name = "SCALE", default_value_t = 1.0, value_parser = parse_scale)]
    scale: f32,

    /// Colours of the window [default: as it was left, or what the system says]
    #[arg(long, value_enum, value_name = "THEME")]
    theme: Option<Theme>,

    /// Fit every file first
    #[arg(long)]
    fit: bool,

    /// The model to show and to fit
    #[arg(long, value_name = "MODEL")]
    model: Option<Model>,

    /// A logarithmic axis
    #[arg(long)]
    log: bool,

    /// f_r cos theta
    #[arg(long)]
    cosine: bool,

    /// Residuals below
    #[arg(long)]
    residuals: bool,

    /// How the incidences are arranged
    #[arg(long, value_enum, value_name = "LAYOUT")]
    layout: Option<Arrangement>,

    /// What of the results is shown
    #[arg(long, value_enum, value_name = "TAB")]
    results: Option<Results>,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Theme {
    Light,
    Dark,
    System,
}

#[derive(Clone, Copy, ValueEnum)]
enum Arrangement {
    Together,
    Panels,
    Polar,
}

#[derive(Clone, Copy, ValueEnum)]
enum Results {
    None,
    Tables,
    Convergence,
    Profile,
    Reflectance,
}

/// The largest picture, in points a side.
const LARGEST: f32 = 8192.0;

/// The largest picture, in pixels: each takes some 20 bytes while it is drawn.
const MOST_PIXELS: f32 = 8192.0 * 8192.0;

fn parse_size(text: &str) -> Result<[f32; 2], String> {
    let expected = || format!("\"{text}\": expected WIDTHxHEIGHT from 900x600 to 8192x8192");
    let (width, height) = text.split_once('x').ok_or_else(expected)?;
    let side = |text: &str, least: f32| {
        let side: f32 = text.parse().map_err(|_| expected())?;
        if (least..=LARGEST).contains(&side) {
            Ok(side)
        } else {
            Err(expected())
        }
    };
    let [least_width, least_height] = SMALLEST_WINDOW;
    Ok([side(width, least_width)?, side(height, least_height)?])
}

fn parse_scale(text: &str) -> Result<f32, String> {
    let scale: f32 = text.parse().map_err(|_| "expected a number".to_owned())?;
    if (0.5..=4.0).contains(&scale) {
        Ok(scale)
    } else {
        Err("expected a number from 0.5 to 4".to_owned())
    }
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let result = match arguments.screenshot.clone() {
        Some(path) => take_screenshot(&arguments, &path),
        None => open_window(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::from(2)
        }
    }
}

fn open_window(arguments: &Arguments) -> Result<(), String> {
    let settings = Settings::of(settings_file());
    let viewport = egui::ViewportBuilder::default()
        .with_title("brdf-viewer")
        .with_app_id("brdf-viewer")
        .with_min_inner_size(SMALLEST_WINDOW)
        .with_inner_size(arguments.size.unwrap_or(settings.saved.window));
    let options = eframe::NativeOptions {
        viewport,
        renderer: eframe::Renderer::Glow,
        ..eframe::NativeOptions::default()
    };
    let create = |creation: &eframe::CreationContext| {
        let mut viewer = Viewer::new(&creation.egui_ctx, Box::new(Native), settings);
        start(&mut viewer, arguments);
        Ok(Box::new(viewer) as Box<dyn eframe::App>)
    };
    eframe::run_native("brdf-viewer", options, Box::new(create)).map_err(|error| {
        format!("no window can be opened: {error} (--screenshot OUT.png needs no display)")
    })
}

/// Where the settings are kept; `None` where the system has no place for them.
fn settings_file() -> Option<PathBuf> {
    let folders = directories::ProjectDirs::from("", "", "brdf-viewer")?;
    Some(folders.config_dir().join("state.json"))
}

fn take_screenshot(arguments: &Arguments, path: &Path) -> Result<(), String> {
    let size = arguments.size.unwrap_or(Settings::unkept().saved.window);
    check_picture(size, arguments.scale)?;
    if arguments
        .files
        .iter()
        .any(|file| resolved(file) == resolved(path))
    {
        return Err(is_input(path));
    }
    let mut window = Unseen::new(size, arguments.scale);
    let mut viewer = Viewer::new(window.context(), Box::new(Native), Settings::unkept());
    start(&mut viewer, arguments);
    let image = window.picture(&mut viewer)?;
    // A fit has opened its scan as well.
    if viewer.state.is_open(path) {
        return Err(is_input(path));
    }
    write_png(&image, path)?;
    let errors = viewer.state.errors();
    if errors.is_empty() {
        Ok(())
    } else {
        Err(errors.join("\n"))
    }
}

/// No picture takes the place of what it is of.
fn is_input(path: &Path) -> String {
    let path = path.display();
    format!("{path}: is an input of this command: expected a file of its own for the picture")
}

fn check_picture([width, height]: [f32; 2], scale: f32) -> Result<(), String> {
    let pixels = width * height * scale * scale;
    if pixels <= MOST_PIXELS {
        return Ok(());
    }
    Err(format!(
        "--size {width}x{height} with --scale {scale}: {:.0} million pixels: expected {:.0} million \
         at most",
        pixels / 1e6,
        MOST_PIXELS / 1e6
    ))
}

/// What the options say is to be done.
fn start(viewer: &mut Viewer, arguments: &Arguments) {
    let left = viewer.state.convention;
    viewer.state.apply(Intent::Convention(Convention {
        theta_positive: arguments.theta_positive.unwrap_or(left.theta_positive),
        phi_zero: arguments.phi_zero.unwrap_or(left.phi_zero),
    }));
    viewer.open_at_start(arguments.files.clone());
    set_view(viewer, arguments);
    let model = arguments
        .model
        .map(|model| Intent::Model(model, Scope::All));
    let fit = arguments
        .fit
        .then_some(Intent::Fit(Stages::Both, Scope::All));
    viewer.when_read(model.into_iter().chain(fit).collect());
}

/// What the options say of the view.
fn set_view(viewer: &mut Viewer, arguments: &Arguments) {
    let state = &mut viewer.state;
    let layout = match arguments.layout {
        Some(Arrangement::Together) => Some(Command::Together),
        Some(Arrangement::Panels) => Some(Command::Panels),
        Some(Arrangement::Polar) => Some(Command::Polar),
        None => None,
    };
    let switched = [
        (arguments.log, Command::Logarithmic),
        (arguments.cosine, Command::TimesCosine),
        (arguments.residuals, Command::Residuals),
    ];
    let switched = switched.into_iter().filter(|(on, _)| *on);
    for command in switched.map(|(_, command)| command).chain(layout) {
        if state.is_on(command) == Some(false) {
            state.apply(Intent::Do(command));
        }
    }
    if let Some(theme) = arguments.theme {
        state.interface.dark = match theme {
            Theme::Light => Some(false),
            Theme::Dark => Some(true),
            Theme::System => None,
        };
    }
    if let Some(results) = arguments.results {
        state.interface.results = !matches!(results, Results::None);
        let tab = match results {
            Results::None | Results::Tables => ResultTab::Tables,
            Results::Convergence => ResultTab::Convergence,
            Results::Profile => ResultTab::Profile,
            Results::Reflectance => ResultTab::Reflectance,
        };
        state.apply(Intent::Tab(tab));
    }
}
