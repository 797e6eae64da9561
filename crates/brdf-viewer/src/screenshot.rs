//! A picture of the window without a person and without a display.

use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use brdf_fit::output::write_file;
use egui::epaint::Primitive;
use egui::{Context, RawInput, Rect, Vec2, ViewportId, ViewportInfo, pos2, vec2};
use image::{ImageFormat, RgbaImage};

use crate::Viewer;
use crate::raster::Rasteriser;

/// Layouts settle within so many frames after the last change.
const FRAMES: usize = 8;

/// Longer than this no fit of a picture takes.
const PATIENCE: Duration = Duration::from_mins(10);

/// A window that nobody sees.
pub struct Unseen {
    ctx: Context,
    rasteriser: Rasteriser,
    size: Vec2,
    scale: f32,
    started: Instant,
}

impl Unseen {
    /// A window of a size in points, with so many pixels for each.
    pub fn new(size: [f32; 2], scale: f32) -> Self {
        let ctx = Context::default();
        ctx.options_mut(|options| options.fallback_theme = egui::Theme::Light);
        Self {
            ctx,
            rasteriser: Rasteriser::default(),
            size: vec2(size[0], size[1]),
            scale,
            started: Instant::now(),
        }
    }

    /// The context of the window.
    pub fn context(&self) -> &Context {
        &self.ctx
    }

    /// Draws frames until all work is done, and the picture of the last one.
    ///
    /// Errors: the work takes longer than ten minutes.
    pub fn picture(&mut self, viewer: &mut Viewer) -> Result<RgbaImage, String> {
        let started = Instant::now();
        let mut left = FRAMES;
        loop {
            let output = self.frame(viewer);
            if viewer.is_busy() {
                left = FRAMES;
                thread::sleep(Duration::from_millis(5));
            } else {
                left -= 1;
            }
            if left == 0 {
                return Ok(self.rasteriser.draw(&self.ctx, &output));
            }
            if started.elapsed() > PATIENCE {
                return Err("the fit takes longer than ten minutes".to_owned());
            }
        }
    }

    /// A frame with its triangles, as a graphics card would get them; how many there are.
    pub fn frame_and_triangles(&mut self, viewer: &mut Viewer) -> usize {
        let output = self.frame(viewer);
        let scale = output.pixels_per_point;
        let primitives = self.ctx.tessellate(output.shapes, scale);
        let triangles = primitives
            .iter()
            .map(|primitive| match &primitive.primitive {
                Primitive::Mesh(mesh) => mesh.indices.len() / 3,
                Primitive::Callback(_) => 0,
            });
        triangles.sum()
    }

    fn frame(&mut self, viewer: &mut Viewer) -> egui::FullOutput {
        let viewport = ViewportInfo {
            native_pixels_per_point: Some(self.scale),
            ..ViewportInfo::default()
        };
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(pos2(0.0, 0.0), self.size)),
            viewports: std::iter::once((ViewportId::ROOT, viewport)).collect(),
            time: Some(self.started.elapsed().as_secs_f64()),
            ..RawInput::default()
        };
        let mut output = self.ctx.run_ui(input, |ui| viewer.frame(ui));
        self.rasteriser.update(&mut output.textures_delta);
        output
    }
}

/// Writes a picture as PNG, whole or not at all.
///
/// Errors: what the system says.
pub fn write_png(image: &RgbaImage, path: &Path) -> Result<(), String> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image
        .write_to(&mut bytes, ImageFormat::Png)
        .map_err(|error| error.to_string())?;
    write_file(path, |writer| writer.write_all(bytes.get_ref())).map_err(|error| error.to_string())
}
