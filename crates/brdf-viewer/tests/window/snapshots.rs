//! Snapshots of the window. They are rendered on the CPU, with the same pixels on every machine.
//!
//! `UPDATE_SNAPSHOTS=1 cargo test -p brdf-viewer --test window snapshots` updates them; inspect each
//! changed one.

use crate::common::{NoDialogs, Window, drop_file, settle, window_with};
use brdf_fit::Model;
use brdf_viewer::intent::{Command, Intent};
use brdf_viewer::state::angle_range::End;
use brdf_viewer::state::fit_settings::Scope;
use brdf_viewer::state::id::{SampleId, ScanId};
use brdf_viewer::state::interface::ResultTab;
use brdf_viewer::state::saved::Settings;

const SIZES: [[f32; 2]; 2] = [[900.0, 600.0], [1280.0, 800.0]];

/// The states of the window of which there are snapshots.
const STATES: [&str; 13] = [
    "empty",
    "loaded",
    "fitted",
    "logarithmic",
    "panels",
    "polar",
    "lobe",
    "surface",
    "compared",
    "limits",
    "wavelengths",
    "planned",
    "error",
];

fn bring_to(window: &mut Window, state: &str) {
    let mut apply = |intent: Intent| {
        window.state_mut().state.apply(intent);
        settle(window);
    };
    if state == "empty" {
        return;
    }
    apply(Intent::OpenBuiltIn(0));
    if state != "loaded" {
        apply(Intent::Command(Command::Fit));
    }
    match state {
        "logarithmic" => {
            apply(Intent::Command(Command::Logarithmic));
            apply(Intent::Command(Command::Residuals));
        }
        "panels" => apply(Intent::Command(Command::Panels)),
        "polar" => {
            apply(Intent::Command(Command::Polar));
            apply(Intent::Command(Command::Logarithmic));
        }
        "lobe" => {
            apply(Intent::Command(Command::Pin));
            apply(Intent::Model(Model::SmithN, Scope::All));
            apply(Intent::Command(Command::Fit));
            apply(Intent::Command(Command::Lobe));
        }
        "surface" => {
            apply(Intent::OpenBuiltIn(3));
            apply(Intent::Command(Command::Fit));
            apply(Intent::Command(Command::Surface));
        }
        "compared" => {
            apply(Intent::Tab(ResultTab::Models));
            apply(Intent::ToggleModel(Model::SmithN));
            apply(Intent::UseIncidence(SampleId(0), 1, false));
        }
        "limits" => {
            apply(Intent::Command(Command::Limits));
            let state = &window.state().state;
            let scan = state.active_sample().unwrap().scan_id();
            let limited = Intent::LimitAngles(scan, End::High, 52.0);
            window.state_mut().state.apply(limited);
            settle(window);
        }
        "wavelengths" => {
            apply(Intent::Command(Command::FitAll));
            apply(Intent::Tab(ResultTab::Wavelengths));
        }
        "planned" => {
            let scan = ScanId {
                sample: SampleId(0),
                wavelength: 0,
            };
            let most = (0..112).filter(|i| i % 12 != 0).collect();
            apply(Intent::ToggleReadings(scan, most));
            apply(Intent::Tab(ResultTab::Plan));
            apply(Intent::Plan);
        }
        "error" => {
            let text = "psi_deg,theta_deg,brdf_per_sr\n10,0,0.1\n10,9x,0.2\n";
            drop_file(window, "lacquer.csv", text);
        }
        _ => {}
    }
}

fn check(dark: bool) {
    let theme = if dark { "dark" } else { "light" };
    let mut results = Vec::new();
    for size in SIZES {
        for state in STATES {
            let mut window = window_with(size, NoDialogs, Settings::in_memory());
            window.state_mut().state.interface.dark = Some(dark);
            bring_to(&mut window, state);
            mask_times(&mut window);
            window.remove_cursor();
            settle(&mut window);
            let name = format!("{state}_{theme}_{}x{}", size[0], size[1]);
            results.push(window.try_snapshot(&name));
        }
    }
    for result in results {
        result.unwrap();
    }
}

/// Replaces times, which differ from run to run.
fn mask_times(window: &mut Window) {
    let state = &mut window.state_mut().state;
    "ready".clone_into(&mut state.status);
    for scan in state
        .samples
        .iter_mut()
        .flat_map(|sample| &mut sample.scans)
    {
        let Some(report) = &mut scan.last_fit else {
            continue;
        };
        let fit = std::sync::Arc::make_mut(report).fit.as_mut().unwrap();
        fit.seconds = 0.0;
        for stage in [&mut fit.stage1, &mut fit.stage2].into_iter().flatten() {
            stage.seconds = 0.0;
        }
    }
}

/// The window of a screen with two pixels per point.
#[test]
fn fine_screen() {
    let mut window = window_with([1280.0, 720.0], NoDialogs, Settings::in_memory());
    let viewports = &mut window.input_mut().viewports;
    let own = viewports.entry(egui::ViewportId::ROOT).or_default();
    own.native_pixels_per_point = Some(2.0);
    bring_to(&mut window, "compared");
    mask_times(&mut window);
    window.remove_cursor();
    settle(&mut window);
    window.try_snapshot("compared_light_2x").unwrap();
}

#[test]
fn light() {
    check(false);
}

#[test]
fn dark() {
    check(true);
}
