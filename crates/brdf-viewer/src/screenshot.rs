//! Renders the window to an image, without a display.

use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use brdf_fit::output::{WriteError, write_file};
use egui::epaint::Primitive;
use egui::{Context, RawInput, Rect, Vec2, ViewportId, ViewportInfo, pos2, vec2};
use image::{ImageError, ImageFormat, RgbaImage};

use crate::app::Viewer;
use crate::raster::Rasteriser;

/// Number of frames after the last change within which the layout settles.
const FRAMES: usize = 8;

/// Longest time that the jobs of a screenshot may take.
const TIMEOUT: Duration = Duration::from_mins(10);

/// Why a screenshot cannot be taken or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ScreenshotError {
    /// The jobs take too long.
    #[error("the fit takes longer than ten minutes")]
    Timeout,
    /// The image cannot be encoded as PNG.
    #[error("the picture cannot be encoded: {0}")]
    Encode(#[from] ImageError),
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// A window without a display.
pub struct OffscreenWindow {
    ctx: Context,
    rasteriser: Rasteriser,
    size: Vec2,
    scale: f32,
    started: Instant,
}

impl OffscreenWindow {
    /// A window with a size in points and a number of pixels per point.
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

    /// The egui context of the window.
    pub fn context(&self) -> &Context {
        &self.ctx
    }

    /// Draws frames until all jobs are done, and renders the last one.
    ///
    /// # Errors
    ///
    /// [`ScreenshotError::Timeout`] if the jobs take longer than ten minutes.
    pub fn picture(&mut self, viewer: &mut Viewer) -> Result<RgbaImage, ScreenshotError> {
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
            if started.elapsed() > TIMEOUT {
                return Err(ScreenshotError::Timeout);
            }
        }
    }

    /// Draws a frame up to the triangles for the graphics card, and returns their number.
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

/// Writes an image as PNG. The file is replaced only when it is complete.
///
/// # Errors
///
/// The image cannot be encoded, or the file cannot be written.
pub fn write_png(image: &RgbaImage, path: &Path) -> Result<(), ScreenshotError> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, ImageFormat::Png)?;
    write_file(path, |writer| writer.write_all(bytes.get_ref()))?;
    Ok(())
}
