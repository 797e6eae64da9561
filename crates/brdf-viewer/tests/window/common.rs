//! What the tests of the window share: a window that nobody sees, and ways to read back what it
//! shows.

#![allow(dead_code, reason = "the random events use a part of it")]

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use brdf_viewer::Viewer;
use brdf_viewer::dialogs::Dialogs;
use brdf_viewer::intent::Export;
use brdf_viewer::raster::Rasteriser;
use brdf_viewer::state::saved::Settings;
use brdf_viewer::worker::Events;
use egui::accesskit::Role;
use egui::epaint::{ColorMode, Shape};
use egui::{Color32, Pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use egui_plot::{PlotMemory, PlotPoint};

/// A window of the tests.
pub(crate) type Window = Harness<'static, Viewer>;

/// The processor draws, not a graphics card.
#[derive(Default)]
struct OnProcessor(Rasteriser);

impl egui_kittest::TestRenderer for OnProcessor {
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

/// A system without dialogs for files.
pub(crate) struct NoDialogs;

impl Dialogs for NoDialogs {
    fn available(&self) -> bool {
        false
    }
    fn open(&self, _: Events) {}
    fn export(&self, _: Export, _: &Path, _: Events) {}
}

/// A window with what `dialogs` and `settings` say.
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
        .renderer(OnProcessor::default())
        .build_eframe(|creation| {
            let mut viewer = Viewer::new(&creation.egui_ctx, Box::new(dialogs), settings);
            viewer.state.interface.dark = Some(false);
            viewer
        });
    settle(&mut window);
    window
}

/// An empty window of 1280 x 800.
pub(crate) fn empty() -> Window {
    window_with([1280.0, 800.0], NoDialogs, Settings::unkept())
}

/// A window with the first of the built-in samples: Z307, measured.
pub(crate) fn with_z307() -> Window {
    let mut window = empty();
    open_built_in(&mut window, "z307_on_aluminium.csv");
    window
}

/// Opens an entry of the built-in menu by the mouse.
pub(crate) fn open_built_in(window: &mut Window, name: &str) {
    window.get_by_label("Built-in").click();
    window.run();
    window.get_by_label(name).click();
    settle(window);
}

/// Frames until all work is done.
pub(crate) fn settle(window: &mut Window) {
    let started = Instant::now();
    loop {
        window.step();
        if !window.state().is_busy() {
            break;
        }
        assert!(
            started.elapsed() < Duration::from_mins(1),
            "the work does not end"
        );
        std::thread::sleep(Duration::from_millis(2));
    }
    window.run();
}

/// Clicks on what has this label.
pub(crate) fn click(window: &mut Window, label: &str) {
    window.get_by_label(label).click();
    settle(window);
}

/// Clicks on a control of a kind.
pub(crate) fn click_role(window: &mut Window, role: Role, label: &str) {
    window.get_by_role_and_label(role, label).click();
    settle(window);
}

/// Whether these words are to be read somewhere.
pub(crate) fn shows(window: &Window, words: &str) -> bool {
    window.query_all_by_label_contains(words).next().is_some()
}

/// Chooses an entry of a menu, and waits for what it does.
pub(crate) fn menu(window: &mut Window, title: &str, entry: &str) {
    open_menu_and_click(window, title, entry);
    settle(window);
}

/// Chooses an entry of a menu.
pub(crate) fn open_menu_and_click(window: &mut Window, title: &str, entry: &str) {
    window.get_by_role_and_label(Role::Button, title).click();
    window.run();
    // The key stands behind the name. A button of the same name may stand elsewhere, too.
    let starts = format!("{entry} ");
    let entries = window.get_all_by(|node| {
        let label = node.label().unwrap_or_default();
        node.role() == Role::Button && (label == entry || label.starts_with(&starts))
    });
    let found = entries.last().unwrap();
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
        reason = "the type of the node is of a crate that is not ours to name"
    )]
    let focused = window.get_by(|node| node.is_focused());
    focused.type_text(text);
    window.run();
    window.key_press(egui::Key::Enter);
    settle(window);
}

/// A dropped file that has no place of its own.
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

/// Drops a file onto the window.
pub(crate) fn drop_file(window: &mut Window, name: &str, text: &str) {
    let file = InMemory(PathBuf::from(name), text.as_bytes().to_vec());
    window.input_mut().dropped_files.push(Arc::new(file));
    settle(window);
}

/// A dropped file of the system.
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

/// Drops a file of the system onto the window.
pub(crate) fn drop_path(window: &mut Window, path: &Path) {
    let file = OnDisk(path.to_owned());
    window.input_mut().dropped_files.push(Arc::new(file));
    settle(window);
}

/// Opens a path by the box.
pub(crate) fn open_path(window: &mut Window, path: &Path) {
    menu(window, "File", "Open path...");
    enter_path(window, path);
    click_role(window, Role::Button, "Open");
}

/// Puts another path into the box of the dialog.
pub(crate) fn enter_path(window: &mut Window, path: &Path) {
    window
        .get_by_role_and_label(Role::TextInput, "Path of the file")
        .focus();
    window.run();
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    window.run();
    let text = path.display().to_string();
    window
        .get_by_role_and_label(Role::TextInput, "Path of the file")
        .type_text(&text);
    window.run();
}

/// Every shape that is painted, those within others by themselves.
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

/// Every text that is painted, with its place.
pub(crate) fn painted_texts(window: &Window) -> Vec<(String, egui::Rect)> {
    let text = |shape: &Shape| match shape {
        Shape::Text(text) => Some((text.galley.text().to_owned(), text.visual_bounding_rect())),
        _ => None,
    };
    painted(window).into_iter().filter_map(text).collect()
}

/// The painted lines of a colour, on the screen.
pub(crate) fn painted_lines(window: &Window, colour: Color32) -> Vec<Vec<Pos2>> {
    let line = |shape: &Shape| match shape {
        Shape::Path(path) if path.stroke.color == ColorMode::Solid(colour) => {
            Some(path.points.clone())
        }
        _ => None,
    };
    painted(window).into_iter().filter_map(line).collect()
}

/// The ends of the painted segments of a colour, on the screen.
pub(crate) fn painted_segments(window: &Window, colour: Color32) -> Vec<[Pos2; 2]> {
    let segment = |shape: &Shape| match shape {
        Shape::LineSegment { points, stroke } if stroke.color == colour => Some(*points),
        _ => None,
    };
    painted(window).into_iter().filter_map(segment).collect()
}

/// The corners of the painted areas of a colour, on the screen.
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

/// The middles of the painted marks of a colour: filled circles and polygons.
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

/// The colour of an incidence of the only sample.
pub(crate) fn colour_of(window: &Window, i: usize) -> Color32 {
    let state = &window.state().state;
    let sample = state.active_sample().unwrap();
    let shown = sample.scan().shown_psi().len();
    let [r, g, b] = brdf_fit::plot::colour(
        state.family_of(sample),
        i,
        shown,
        brdf_fit::plot::Ground::Light,
    );
    Color32::from_rgb(r, g, b)
}

/// The Z307 sample of the project as text.
pub(crate) fn z307() -> String {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/measured/z307_on_aluminium.csv");
    std::fs::read_to_string(path).unwrap()
}
