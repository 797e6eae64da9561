//! The time of a frame on the CPU, without the graphics card.
//!
//! `cargo bench -p brdf-viewer --bench frames`

use std::fmt::Write as _;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use brdf_fit::Model;
use brdf_viewer::Viewer;
use brdf_viewer::intent::{Command, Intent};
use brdf_viewer::platform::current::NativeDialogs;
use brdf_viewer::screenshot::OffscreenWindow;
use brdf_viewer::state::fit_settings::{Scope, Stages};
use brdf_viewer::state::saved::Settings;
use criterion::{Criterion, criterion_group, criterion_main};

/// 20 incidences, 200,000 readings with noise.
fn large() -> String {
    let mut text = "psi_deg,theta_deg,brdf_per_sr\n".to_owned();
    for i in 0..20 {
        for j in 0..10_000 {
            let theta = -85.0 + 0.017 * f64::from(j);
            let away = (theta + 4.0 * f64::from(i)).to_radians();
            let noise = 1.0 + 0.2 * (f64::from(j) * 12.9898).sin();
            let brdf = (0.02 + 0.2 * (-8.0 * away * away).exp()) * noise;
            let _ = writeln!(text, "{},{theta:.3},{brdf:.6}", 4 * i);
        }
    }
    text
}

/// A window with a sample.
fn window(sample: Intent) -> (OffscreenWindow, Viewer) {
    window_of([1280.0, 800.0], sample)
}

/// A window of a size in points with a sample.
fn window_of(size: [f32; 2], sample: Intent) -> (OffscreenWindow, Viewer) {
    let mut window = OffscreenWindow::new(size, 1.0);
    let mut viewer = Viewer::new(
        window.context(),
        Box::new(NativeDialogs),
        Settings::in_memory(),
    );
    viewer.state.apply(sample);
    let mut longest = Duration::ZERO;
    loop {
        let frame = Instant::now();
        black_box(window.frame_and_triangles(&mut viewer));
        longest = longest.max(frame.elapsed());
        if !viewer.is_busy() {
            break;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    println!("longest frame while the sample is opened: {longest:.1?}");
    (window, viewer)
}

fn frames(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("frame at 1280x800");
    let samples = [
        ("z307, 112 readings", Intent::OpenBuiltIn(0)),
        (
            "200,000 readings, 20 incidences",
            Intent::OpenBytes("large.csv".to_owned(), large().into_bytes()),
        ),
    ];
    for (name, sample) in samples {
        let (mut window, mut viewer) = window(sample);
        if viewer
            .state
            .active_sample()
            .is_some_and(|s| s.scan().incidences.len() > 8)
        {
            let id = viewer.state.active.expect("a sample");
            viewer.state.apply(Intent::ShowAllIncidences(id, true));
        }
        let mut time = |viewer: &mut Viewer, what: &str, drag: bool| {
            group.bench_function(format!("{name}, {what}"), |bench| {
                bench.iter(|| {
                    if drag {
                        drag_k1(viewer);
                    }
                    black_box(window.frame_and_triangles(viewer))
                });
            });
        };
        let command = |viewer: &mut Viewer, command| viewer.state.apply(Intent::Command(command));
        time(&mut viewer, "nothing changes", false);
        time(&mut viewer, "k1 of three dragged", true);
        command(&mut viewer, Command::Residuals);
        time(&mut viewer, "with residuals, k1 of three dragged", true);
        let power = Intent::Model(Model::PowerN, Scope::All);
        viewer.state.apply(power);
        time(&mut viewer, "with residuals, k1 of power+n dragged", true);
        command(&mut viewer, Command::Panels);
        time(
            &mut viewer,
            "panels with residuals, k1 of power+n dragged",
            true,
        );
        command(&mut viewer, Command::Polar);
        time(&mut viewer, "polar, k1 of power+n dragged", true);
    }
}

/// Changes k1 a little in each frame.
fn drag_k1(viewer: &mut Viewer) {
    let mut parameters = viewer
        .state
        .active_sample()
        .expect("a sample")
        .scan()
        .parameters;
    parameters.values.k1 = if parameters.values.k1 > 0.3 {
        0.2
    } else {
        1.001 * parameters.values.k1
    };
    viewer.state.apply(Intent::SetParameters(parameters));
}

/// Prints the times of frames while all scans in ../shared/data are fitted.
fn while_fitting(_: &mut Criterion) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let files: Vec<PathBuf> = folder
        .read_dir()
        .into_iter()
        .flatten()
        .flatten()
        .filter_map(|entry| entry.path().read_dir().ok())
        .flat_map(|folder| folder.flatten().map(|entry| entry.path()))
        .filter(|path| path.extension().is_some_and(|e| e == "csv"))
        .collect();
    if files.is_empty() {
        println!("frames while fitting: skipped, no ../shared/data beside the project");
        return;
    }
    let (mut window, mut viewer) = window(Intent::Open(files));
    viewer.state.apply(Intent::Fit(Stages::Both, Scope::All));
    let started = Instant::now();
    let mut frames = Vec::new();
    while viewer.is_busy() {
        let frame = Instant::now();
        black_box(window.frame_and_triangles(&mut viewer));
        frames.push(frame.elapsed());
        std::thread::sleep(Duration::from_millis(1));
    }
    frames.sort();
    let run = viewer.state.fit_run.as_ref().expect("a run");
    println!(
        "frames while {} scans of {} samples are fitted in {:.1} s: {} frames, median {:.1?}, 99 % below {:.1?}, longest {:.1?}",
        run.fit_count(),
        viewer.state.samples.len(),
        started.elapsed().as_secs_f64(),
        frames.len(),
        frames[frames.len() / 2],
        frames[frames.len() * 99 / 100],
        frames[frames.len() - 1],
    );
}

/// Readings at the wavelengths of red, green and blue.
fn colourful() -> String {
    let mut text = "wavelength_um,psi_deg,theta_deg,brdf_per_sr\n".to_owned();
    for (um, diffuse) in [(0.46, 0.05), (0.55, 0.1), (0.61, 0.2)] {
        for psi in [10, 30, 50, 70] {
            for j in 0..33 {
                let theta = -80 + 5 * j;
                let away = f64::from(theta + psi).to_radians();
                let brdf = diffuse + 0.2 * (-8.0 * away * away).exp();
                let _ = writeln!(text, "{um},{psi},{theta},{brdf:.6}");
            }
        }
    }
    text
}

/// The lobe, and the surface at 512 x 512 pixels, in a large window.
fn solids(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("frame at 1920x1400");
    let colours = Intent::OpenBytes("colourful.csv".to_owned(), colourful().into_bytes());
    for (name, sample) in [("grey", Intent::OpenBuiltIn(0)), ("in colour", colours)] {
        let (mut window, mut viewer) = window_of([1920.0, 1400.0], sample);
        viewer.state.interface.results = false;
        let mut time = |viewer: &mut Viewer, what: &str| {
            // The first frames find the size of the pictures.
            for _ in 0..3 {
                window.frame_and_triangles(viewer);
            }
            let side = viewer.state.surface_side;
            group.bench_function(format!("{what}, k1 dragged"), |bench| {
                bench.iter(|| {
                    drag_k1(viewer);
                    black_box(window.frame_and_triangles(viewer))
                });
            });
            side
        };
        let command = |viewer: &mut Viewer, command| viewer.state.apply(Intent::Command(command));
        time(&mut viewer, &format!("plot, {name}"));
        command(&mut viewer, Command::Lobe);
        time(&mut viewer, &format!("lobe, {name}"));
        command(&mut viewer, Command::Surface);
        let side = time(&mut viewer, &format!("surface, {name}"));
        assert_eq!(side, 512);
    }
}

criterion_group!(benches, while_fitting, frames, solids);
criterion_main!(benches);
