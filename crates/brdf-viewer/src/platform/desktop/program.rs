//! The program of the desktop: opens a window, or with `--screenshot` renders one to a file.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::rc::Rc;

use brdf_fit::output::resolved;
use brdf_fit::{Convention, Model, Side};
use clap::{Parser, ValueEnum};
use eframe::egui;

use super::dialogs::NativeDialogs;
use super::storage::SettingsFile;
use crate::Viewer;
use crate::intent::{Command, Intent};
use crate::platform::Storage;
use crate::screenshot::{OffscreenWindow, write_png};
use crate::state::fit_settings::{Scope, Stages};
use crate::state::interface::ResultTab;
use crate::state::saved::{SMALLEST_WINDOW, Settings};

/// Theory and measurement for each incidence angle, with interactive parameters.
///
/// Opens scans (tables with the columns psi_deg, theta_deg and brdf_per_sr) and fits as JSON, shows
/// readings and theory, and fits. Without a file it opens the files of the last session, or a
/// built-in measured sample.
#[derive(Parser)]
#[command(name = "viewer", version, max_term_width = 100)]
#[expect(clippy::struct_excessive_bools, reason = "flags of a command line")]
struct Arguments {
    /// Scans, or fits as JSON
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,

    /// Write a picture of the window to this file, as PNG, and exit; needs no display
    #[arg(long, value_name = "FILE")]
    screenshot: Option<PathBuf>,

    /// The side of the surface normal on which theta is positive in the scans, source or forward
    /// [default: that of the last session, or source]
    #[arg(long, value_name = "SIDE")]
    theta_positive: Option<Side>,

    /// The side on which the azimuth phi is zero in the scans, source or forward [default: that of
    /// the last session, or source]
    #[arg(long, value_name = "SIDE")]
    phi_zero: Option<Side>,

    /// Size of the window in points, at least 900x600 [default: that of the last session,
    /// or 1280x800]
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size)]
    size: Option<[f32; 2]>,

    /// Pixels per point of the picture
    #[arg(long, value_name = "SCALE", default_value_t = 1.0, value_parser = parse_scale)]
    scale: f32,

    /// Colour theme [default: that of the last session, or that of the system]
    #[arg(long, value_enum, value_name = "THEME")]
    theme: Option<Theme>,

    /// Fit every file after opening
    #[arg(long)]
    fit: bool,

    /// Model to show and to fit
    #[arg(long, value_name = "MODEL")]
    model: Option<Model>,

    /// Use a logarithmic axis
    #[arg(long)]
    log: bool,

    /// Show f_r cos theta
    #[arg(long)]
    cosine: bool,

    /// Show residuals below the plot
    #[arg(long)]
    residuals: bool,

    /// Arrangement of the incidences
    #[arg(long, value_enum, value_name = "LAYOUT")]
    layout: Option<Arrangement>,

    /// Tab of the results
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
    Lobe,
    Surface,
}

#[derive(Clone, Copy, ValueEnum)]
enum Results {
    None,
    Summary,
    Models,
    Wavelengths,
    Residuals,
    #[value(alias = "tables")]
    Report,
    Convergence,
    Profile,
    Reflectance,
}

/// The largest side of a picture, in points.
const LARGEST_SIDE: f32 = 8192.0;

/// The largest picture, in pixels. Rendering takes about 20 bytes per pixel.
const MOST_PIXELS: f32 = 8192.0 * 8192.0;

fn parse_size(text: &str) -> Result<[f32; 2], String> {
    let expected = || format!("\"{text}\": expected WIDTHxHEIGHT from 900x600 to 8192x8192");
    let (width, height) = text.split_once('x').ok_or_else(expected)?;
    let side = |text: &str, least: f32| {
        let side: f32 = text.parse().map_err(|_| expected())?;
        if (least..=LARGEST_SIDE).contains(&side) {
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

/// Runs the program with the arguments of the command line.
pub fn main() -> ExitCode {
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

fn open_window(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let settings = Settings::load(settings_file());
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
        let mut viewer = Viewer::new(&creation.egui_ctx, Box::new(NativeDialogs), settings);
        start(&mut viewer, arguments);
        Ok(Box::new(viewer) as Box<dyn eframe::App>)
    };
    eframe::run_native("brdf-viewer", options, Box::new(create)).map_err(|error| {
        format!("cannot open a window: {error} (--screenshot OUT.png needs no display)").into()
    })
}

/// The file of the settings; `None` if the system has no folder for it.
fn settings_file() -> Option<Rc<dyn Storage>> {
    let folders = directories::ProjectDirs::from("", "", "brdf-viewer")?;
    let path = folders.config_dir().join("state.json");
    Some(Rc::new(SettingsFile::new(path)))
}

fn take_screenshot(arguments: &Arguments, path: &Path) -> Result<(), Box<dyn Error>> {
    let size = arguments.size.unwrap_or(Settings::in_memory().saved.window);
    check_picture(size, arguments.scale)?;
    if arguments
        .files
        .iter()
        .any(|file| resolved(file) == resolved(path))
    {
        return Err(is_input(path).into());
    }
    let mut window = OffscreenWindow::new(size, arguments.scale);
    let mut viewer = Viewer::new(
        window.context(),
        Box::new(NativeDialogs),
        Settings::in_memory(),
    );
    start(&mut viewer, arguments);
    let image = window.picture(&mut viewer)?;
    // Opening a fit opens its scan, too.
    if viewer.state.is_open(path) {
        return Err(is_input(path).into());
    }
    write_png(&image, path)?;
    let errors = viewer.state.errors();
    if errors.is_empty() {
        Ok(())
    } else {
        Err(errors.join("\n").into())
    }
}

/// The error message for a picture that would replace an input file.
fn is_input(path: &Path) -> String {
    let path = path.display();
    format!("{path}: is an input of this command: expected a different file for the picture")
}

fn check_picture([width, height]: [f32; 2], scale: f32) -> Result<(), Box<dyn Error>> {
    let pixels = width * height * scale * scale;
    if pixels <= MOST_PIXELS {
        return Ok(());
    }
    let message = format!(
        "--size {width}x{height} with --scale {scale}: {:.0} million pixels: expected {:.0} million \
         at most",
        pixels / 1e6,
        MOST_PIXELS / 1e6
    );
    Err(message.into())
}

/// Applies the options: opens the files, sets the view and starts the fit.
fn start(viewer: &mut Viewer, arguments: &Arguments) {
    let last = viewer.state.convention;
    viewer.state.apply(Intent::Convention(Convention {
        theta_positive: arguments.theta_positive.unwrap_or(last.theta_positive),
        phi_zero: arguments.phi_zero.unwrap_or(last.phi_zero),
    }));
    viewer.open_at_start(arguments.files.clone());
    set_view(viewer, arguments);
    let model = arguments
        .model
        .map(|model| Intent::Model(model, Scope::All));
    let fit = arguments
        .fit
        .then_some(Intent::Fit(Stages::Both, Scope::All));
    viewer.when_opened(model.into_iter().chain(fit).collect());
}

/// Applies the options of the view.
fn set_view(viewer: &mut Viewer, arguments: &Arguments) {
    let state = &mut viewer.state;
    let layout = match arguments.layout {
        Some(Arrangement::Together) => Some(Command::Together),
        Some(Arrangement::Panels) => Some(Command::Panels),
        Some(Arrangement::Polar) => Some(Command::Polar),
        Some(Arrangement::Lobe) => Some(Command::Lobe),
        Some(Arrangement::Surface) => Some(Command::Surface),
        None => None,
    };
    let toggles = [
        (arguments.log, Command::Logarithmic),
        (arguments.cosine, Command::TimesCosine),
        (arguments.residuals, Command::Residuals),
    ];
    let toggles = toggles.into_iter().filter(|(on, _)| *on);
    // The axes are those of what is shown.
    for command in layout
        .into_iter()
        .chain(toggles.map(|(_, command)| command))
    {
        if state.is_on(command) == Some(false) {
            state.apply(Intent::Command(command));
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
            Results::None | Results::Summary => ResultTab::Summary,
            Results::Models => ResultTab::Models,
            Results::Wavelengths => ResultTab::Wavelengths,
            Results::Residuals => ResultTab::Residuals,
            Results::Report => ResultTab::Report,
            Results::Convergence => ResultTab::Convergence,
            Results::Profile => ResultTab::Profile,
            Results::Reflectance => ResultTab::Reflectance,
        };
        state.apply(Intent::Tab(tab));
    }
}
