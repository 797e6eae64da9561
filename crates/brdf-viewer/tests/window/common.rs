//! Helpers for the tests of the window: offscreen windows, user input, and access to the painted
//! shapes.

#![allow(dead_code, reason = "the test of random events uses only some of them")]

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use brdf_viewer::Viewer;
use brdf_viewer::events::EventSender;
use brdf_viewer::output_kind::OutputKind;
use brdf_viewer::platform::Dialogs;
use brdf_viewer::raster::Rasteriser;
use brdf_viewer::state::saved::Settings;
use egui::accesskit::Role;
use egui::epaint::{ColorMode, Shape};
use egui::{Color32, Pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use egui_plot::{PlotMemory, PlotPoint};

/// An offscreen window.
pub(crate) type Window = Harness<'static, Viewer>;

/// Renders on the CPU.
#[derive(Default)]
struct CpuRenderer(Rasteriser);

impl egui_kittest::TestRenderer for CpuRenderer {
    fn handle_delta(&mut self, delta: &mut egui::TexturesDelta) {
        self.0.update(delta);
    }

    fn render(
        &mut self,
        ctx: &egui::Context,
        output: &egui::FullOutput,
    ) -> Result<image::RgbaImage, String> {
        Ok(self.0.draw(ctx, output))
    }
}

/// A system without file dialogs.
pub(crate) struct NoDialogs;

impl Dialogs for NoDialogs {
    fn available(&self) -> bool {
        false
    }
    fn open(&self, _: EventSender) {}
    fn export(&self, _: OutputKind, _: &Path, _: EventSender) {}
}

/// A window with dialogs and settings.
pub(crate) fn window_with(
    size: [f32; 2],
    dialogs: impl Dialogs + 'static,
    settings: Settings,
) -> Window {
    let mut window = Harness::builder()
        .with_size(size)
        .with_theme(egui::Theme::Light)
        .with_max_steps(60)
        .with_step_dt(1.0 / 60.0)
        .renderer(CpuRenderer::default())
        .build_eframe(|creation| {
            let mut viewer = Viewer::new(&creation.egui_ctx, Box::new(dialogs), settings);
            viewer.state.interface.dark = Some(false);
            // Most tests start from a scan that is not fitted.
            viewer.state.fit_settings.on_opening = false;
            viewer
        });
    settle(&mut window);
    window
}

/// A window of 1280 x 800 points without samples.
pub(crate) fn empty() -> Window {
    window_with([1280.0, 800.0], NoDialogs, Settings::in_memory())
}

/// A window with the first built-in sample, the measured Z307.
pub(crate) fn with_z307() -> Window {
    let mut window = empty();
    open_built_in(&mut window, "z307_on_aluminium.csv");
    window
}

/// Opens an entry of the built-in menu with the mouse.
pub(crate) fn open_built_in(window: &mut Window, name: &str) {
    window.get_by_label("Built-in").click();
    window.run();
    window.get_by_label(name).click();
    settle(window);
}

/// Runs frames until all jobs are done.
pub(crate) fn settle(window: &mut Window) {
    let started = Instant::now();
    loop {
        window.step();
        if !window.state().is_busy() {
            break;
        }
        assert!(
            started.elapsed() < Duration::from_mins(1),
            "the jobs do not end"
        );
        std::thread::sleep(Duration::from_millis(2));
    }
    window.run();
}

/// Clicks on the control with a label.
pub(crate) fn click(window: &mut Window, label: &str) {
    window.get_by_label(label).click();
    settle(window);
}

/// Clicks on the control with a role and a label.
pub(crate) fn click_role(window: &mut Window, role: Role, label: &str) {
    window.get_by_role_and_label(role, label).click();
    settle(window);
}

/// Presses the button of the mouse at a place.
pub(crate) fn press(window: &mut Window, at: Pos2) {
    window.hover_at(at);
    window.step();
    window.drag_at(at);
    window.step();
}

/// Moves the mouse to a place, and releases its button there.
pub(crate) fn release(window: &mut Window, at: Pos2) {
    window.hover_at(at);
    window.step();
    window.drop_at(at);
    settle(window);
}

/// Whether a text is shown anywhere.
pub(crate) fn shows(window: &Window, text: &str) -> bool {
    window.query_all_by_label_contains(text).next().is_some()
}

/// Chooses an entry of a menu, and waits for the jobs that it starts.
pub(crate) fn menu(window: &mut Window, title: &str, entry: &str) {
    open_menu_and_click(window, title, entry);
    settle(window);
}

/// Chooses an entry of a menu.
pub(crate) fn open_menu_and_click(window: &mut Window, title: &str, entry: &str) {
    window.get_by_role_and_label(Role::Button, title).click();
    window.run();
    // The key follows the name. Another button may have the same name.
    let prefix = format!("{entry} ");
    let entries = window.get_all_by(|node| {
        let label = node.label().unwrap_or_default();
        node.role() == Role::Button && (label == entry || label.starts_with(&prefix))
    });
    // The menu may cover a button of the same name.
    let entries: Vec<_> = entries.collect();
    let has_key = |node: &&egui_kittest::Node<'_>| {
        let label = node.accesskit_node().label().unwrap_or_default();
        label.starts_with(&prefix)
    };
    let found = entries.iter().rfind(has_key).or(entries.last()).unwrap();
    found.click();
}

/// Types into the number box of a parameter.
pub(crate) fn type_number(window: &mut Window, label: &str, text: &str) {
    window
        .get_by_role_and_label(Role::SpinButton, label)
        .click();
    window.run();
    #[expect(
        clippy::redundant_closure_for_method_calls,
        reason = "the type of the node belongs to a crate that is not a direct dependency"
    )]
    let focused = window.get_by(|node| node.is_focused());
    focused.type_text(text);
    window.run();
    window.key_press(egui::Key::Enter);
    settle(window);
}

/// A dropped file with content but without an absolute path.
#[derive(Debug)]
struct InMemory(PathBuf, Vec<u8>);

impl egui::DroppedFile for InMemory {
    fn path(&self) -> &Path {
        &self.0
    }
    fn bytes(&self) -> Result<Vec<u8>, String> {
        Ok(self.1.clone())
    }
}

/// Drops a file with a content onto the window.
pub(crate) fn drop_file(window: &mut Window, name: &str, text: &str) {
    let file = InMemory(PathBuf::from(name), text.as_bytes().to_vec());
    window.input_mut().dropped_files.push(Arc::new(file));
    settle(window);
}

/// A dropped file with an absolute path.
#[derive(Debug)]
struct OnDisk(PathBuf);

impl egui::DroppedFile for OnDisk {
    fn path(&self) -> &Path {
        &self.0
    }
    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

/// Drops a file with an absolute path onto the window.
pub(crate) fn drop_path(window: &mut Window, path: &Path) {
    let file = OnDisk(path.to_owned());
    window.input_mut().dropped_files.push(Arc::new(file));
    settle(window);
}

/// Opens a path with the dialog.
pub(crate) fn open_path(window: &mut Window, path: &Path) {
    menu(window, "File", "Open path...");
    enter_path(window, path);
    click_role(window, Role::Button, "Open");
}

/// Replaces the path in the dialog.
pub(crate) fn enter_path(window: &mut Window, path: &Path) {
    window
        .get_by_role_and_label(Role::TextInput, "File path")
        .focus();
    window.run();
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    window.run();
    let text = path.display().to_string();
    window
        .get_by_role_and_label(Role::TextInput, "File path")
        .type_text(&text);
    window.run();
}

/// All painted shapes, without nesting.
pub(crate) fn painted(window: &Window) -> Vec<&Shape> {
    fn collect<'a>(shape: &'a Shape, all: &mut Vec<&'a Shape>) {
        match shape {
            Shape::Vec(shapes) => shapes.iter().for_each(|s| collect(s, all)),
            shape => all.push(shape),
        }
    }
    let mut all = Vec::new();
    for clipped in &window.output().shapes {
        collect(&clipped.shape, &mut all);
    }
    all
}

/// All painted texts, with their rectangles.
pub(crate) fn painted_texts(window: &Window) -> Vec<(String, egui::Rect)> {
    let text = |shape: &Shape| match shape {
        Shape::Text(text) => Some((text.galley.text().to_owned(), text.visual_bounding_rect())),
        _ => None,
    };
    painted(window).into_iter().filter_map(text).collect()
}

/// The painted lines of a colour, in screen coordinates.
pub(crate) fn painted_lines(window: &Window, colour: Color32) -> Vec<Vec<Pos2>> {
    let line = |shape: &Shape| match shape {
        Shape::Path(path) if path.stroke.color == ColorMode::Solid(colour) => {
            Some(path.points.clone())
        }
        _ => None,
    };
    painted(window).into_iter().filter_map(line).collect()
}

/// The painted segments of a colour, in screen coordinates.
pub(crate) fn painted_segments(window: &Window, colour: Color32) -> Vec<[Pos2; 2]> {
    let segment = |shape: &Shape| match shape {
        Shape::LineSegment { points, stroke } if stroke.color == colour => Some(*points),
        _ => None,
    };
    painted(window).into_iter().filter_map(segment).collect()
}

/// The vertices of the painted meshes of a colour, in screen coordinates.
pub(crate) fn painted_areas(window: &Window, colour: Color32) -> Vec<Vec<Pos2>> {
    let area = |shape: &Shape| match shape {
        Shape::Mesh(mesh) if mesh.vertices.first().is_some_and(|v| v.color == colour) => {
            Some(mesh.vertices.iter().map(|vertex| vertex.pos).collect())
        }
        _ => None,
    };
    painted(window).into_iter().filter_map(area).collect()
}

/// The transform of a plot.
pub(crate) fn transform_of(window: &Window, plot: &str) -> egui_plot::PlotTransform {
    let id = brdf_viewer::plot::id(&window.state().state, plot);
    let memory = PlotMemory::load(&window.ctx, id).expect("no such plot");
    memory.transform()
}

/// The longest painted line of a colour in the coordinates of a plot.
pub(crate) fn painted_curve(window: &Window, plot: &str, colour: Color32) -> Vec<PlotPoint> {
    let transform = transform_of(window, plot);
    let lines = painted_lines(window, colour);
    let longest = lines.into_iter().max_by_key(Vec::len).unwrap_or_default();
    longest
        .into_iter()
        .map(|at| transform.value_from_position(at))
        .collect()
}

/// The centres of the painted marks of a colour: filled circles and polygons.
pub(crate) fn painted_marks(window: &Window, colour: Color32) -> Vec<Pos2> {
    let mark = |shape: &Shape| match shape {
        Shape::Circle(circle) if circle.fill == colour => Some(circle.center),
        Shape::Rect(rect) if rect.fill == colour => Some(rect.rect.center()),
        Shape::Path(path) if path.fill == colour => {
            let sum = path
                .points
                .iter()
                .fold(egui::Vec2::ZERO, |sum, p| sum + p.to_vec2());
            Some((sum / path.points.len() as f32).to_pos2())
        }
        _ => None,
    };
    painted(window).into_iter().filter_map(mark).collect()
}

/// The colour of an incidence of the active sample.
pub(crate) fn colour_of(window: &Window, i: usize) -> Color32 {
    let state = &window.state().state;
    let sample = state.active_sample().unwrap();
    let shown = sample.scan().visible_psi().len();
    let [r, g, b] = brdf_fit::plot::colour(
        state.family_of(sample),
        i,
        shown,
        brdf_fit::plot::Ground::Light,
    );
    Color32::from_rgb(r, g, b)
}

/// The content of the Z307 sample of the project.
pub(crate) fn z307() -> String {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/measured/z307_on_aluminium.csv");
    std::fs::read_to_string(path).unwrap()
}
