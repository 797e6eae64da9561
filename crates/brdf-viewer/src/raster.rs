//! Rasterises the triangles of an egui frame on the CPU.
//!
//! Screenshots and tests therefore need neither a display nor a graphics card, and get the same
//! pixels on every machine.

use std::collections::HashMap;

use egui::epaint::{ImageData, ImageDelta, Mesh, Primitive, Vertex};
use egui::{ColorImage, Context, FullOutput, Rect, TextureId, TexturesDelta};
use image::RgbaImage;

/// A rasteriser with the current textures.
#[derive(Default)]
pub struct Rasteriser {
    textures: HashMap<TextureId, ColorImage>,
}

/// An image. Colour channels are premultiplied by alpha and range from 0 to 1.
struct Canvas {
    width: usize,
    height: usize,
    pixels: Vec<[f32; 4]>,
}

/// Half-open ranges of columns and rows.
#[derive(Clone, Copy)]
struct Window {
    x: (i32, i32),
    y: (i32, i32),
}

impl Rasteriser {
    /// Applies changes of the textures.
    pub fn update(&mut self, delta: &mut TexturesDelta) {
        for (id, deltas) in delta.set.drain() {
            for delta in &deltas {
                self.set(id, delta);
            }
        }
        for id in delta.free.drain() {
            self.textures.remove(&id);
        }
    }

    fn set(&mut self, id: TextureId, delta: &ImageDelta) {
        let ImageData::Color(image) = &delta.image;
        let Some([x, y]) = delta.pos else {
            self.textures.insert(id, (**image).clone());
            return;
        };
        // A partial update needs the texture that it changes.
        let Some(texture) = self.textures.get_mut(&id) else {
            return;
        };
        let [width, height] = image.size;
        for row in 0..height {
            let to = (y + row) * texture.size[0] + x;
            texture.pixels[to..to + width]
                .copy_from_slice(&image.pixels[row * width..(row + 1) * width]);
        }
    }

    /// Renders a frame.
    pub fn draw(&self, ctx: &Context, output: &FullOutput) -> RgbaImage {
        let scale = output.pixels_per_point;
        let size = ctx.content_rect().size() * scale;
        let mut canvas = Canvas::new(size.x.round() as usize, size.y.round() as usize);
        for clipped in ctx.tessellate(output.shapes.clone(), scale) {
            let Primitive::Mesh(mesh) = &clipped.primitive else {
                continue;
            };
            if let Some(texture) = self.textures.get(&mesh.texture_id) {
                let window = canvas.window(clipped.clip_rect * scale);
                canvas.draw(mesh, texture, scale, window);
            }
        }
        canvas.into_image()
    }
}

impl Canvas {
    fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            pixels: vec![[0.0; 4]; width * height],
        }
    }

    fn window(&self, clip: Rect) -> Window {
        let within = |from: f32, to: f32, size: usize| {
            let pixel = |x: f32| x.round().clamp(0.0, size as f32) as i32;
            (pixel(from), pixel(to))
        };
        Window {
            x: within(clip.min.x, clip.max.x, self.width),
            y: within(clip.min.y, clip.max.y, self.height),
        }
    }

    fn draw(&mut self, mesh: &Mesh, texture: &ColorImage, scale: f32, window: Window) {
        for corners in mesh.indices.chunks_exact(3) {
            let corners = [0, 1, 2].map(|i| mesh.vertices[corners[i] as usize]);
            if let Some(triangle) = Triangle::new(corners, scale) {
                self.fill(&triangle, texture, window);
            }
        }
    }

    fn fill(&mut self, triangle: &Triangle, texture: &ColorImage, window: Window) {
        let (x, y) = triangle.within(window);
        for row in y.0..y.1 {
            for column in x.0..x.1 {
                let at = [f64::from(column) + 0.5, f64::from(row) + 0.5];
                let Some(parts) = triangle.barycentric(at) else {
                    continue;
                };
                let source = triangle.colour(parts, texture);
                let target = &mut self.pixels[row as usize * self.width + column as usize];
                for (target, source_channel) in target.iter_mut().zip(source) {
                    *target = source_channel + *target * (1.0 - source[3]);
                }
            }
        }
    }

    fn into_image(self) -> RgbaImage {
        let bytes = self.pixels.iter().flatten();
        let bytes = bytes.map(|x| (x * 255.0 + 0.5).clamp(0.0, 255.0) as u8);
        let (width, height) = (self.width as u32, self.height as u32);
        RgbaImage::from_raw(width, height, bytes.collect()).unwrap_or_default()
    }
}

/// A triangle in pixel coordinates, with its corners ordered such that its area is positive.
struct Triangle {
    corners: [Vertex; 3],
    at: [[f64; 2]; 3],
    area: f64,
    /// Whether all corners have the same texture coordinates, as in most triangles.
    untextured: bool,
}

impl Triangle {
    /// `None` if the area is zero or not finite.
    fn new(corners: [Vertex; 3], scale: f32) -> Option<Self> {
        let position = |v: &Vertex| [v.pos.x, v.pos.y].map(|x| f64::from(x) * f64::from(scale));
        let at = corners.each_ref().map(position);
        let area = edge(at[0], at[1], at[2]);
        if area == 0.0 || !area.is_finite() {
            return None;
        }
        let untextured = corners.iter().all(|corner| corner.uv == corners[0].uv);
        let [a, b, c] = corners;
        let [p, q, r] = at;
        Some(if area > 0.0 {
            Self {
                corners,
                at,
                area,
                untextured,
            }
        } else {
            Self {
                corners: [a, c, b],
                at: [p, r, q],
                area: -area,
                untextured,
            }
        })
    }

    /// The columns and rows of its bounding box.
    fn within(&self, window: Window) -> ((i32, i32), (i32, i32)) {
        let span = |i: usize, (from, to): (i32, i32)| {
            let of = self.at.map(|at| at[i]);
            let low = of.into_iter().fold(f64::INFINITY, f64::min);
            let high = of.into_iter().fold(f64::NEG_INFINITY, f64::max);
            ((low.floor() as i32).max(from), (high.ceil() as i32).min(to))
        };
        (span(0, window.x), span(1, window.y))
    }

    /// The barycentric coordinates of a point; `None` outside. A point on an edge shared by two
    /// triangles belongs to the one of which it is a top or a left edge.
    fn barycentric(&self, at: [f64; 2]) -> Option<[f64; 3]> {
        let [a, b, c] = self.at;
        let mut parts = [0.0; 3];
        for (part, (from, to)) in parts.iter_mut().zip([(b, c), (c, a), (a, b)]) {
            let side = edge(from, to, at);
            let owned = (from[1] == to[1] && to[0] > from[0]) || to[1] < from[1];
            if side < 0.0 || (side == 0.0 && !owned) {
                return None;
            }
            *part = side / self.area;
        }
        Some(parts)
    }

    fn colour(&self, parts: [f64; 3], texture: &ColorImage) -> [f32; 4] {
        let mix = |of: &dyn Fn(&Vertex) -> f64| {
            let corners = self.corners.iter().zip(parts);
            corners.map(|(corner, part)| of(corner) * part).sum::<f64>()
        };
        let uv = if self.untextured {
            let uv = self.corners[0].uv;
            [f64::from(uv.x), f64::from(uv.y)]
        } else {
            [mix(&|v| f64::from(v.uv.x)), mix(&|v| f64::from(v.uv.y))]
        };
        let texel = sample(texture, uv);
        std::array::from_fn(|i| {
            let of = mix(&|v| f64::from(v.color.to_array()[i]) / 255.0);
            (of * texel[i]) as f32
        })
    }
}

/// Twice the signed area of the triangle of three points.
fn edge(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The colour of a texture at texture coordinates, by bilinear interpolation.
fn sample(texture: &ColorImage, [u, v]: [f64; 2]) -> [f64; 4] {
    let [width, height] = texture.size;
    let (x, y) = (u * width as f64 - 0.5, v * height as f64 - 0.5);
    let (left, top) = (x.floor(), y.floor());
    let (right_part, lower_part) = (x - left, y - top);
    let at = |x: f64, y: f64| {
        let column = x.clamp(0.0, (width - 1) as f64) as usize;
        let row = y.clamp(0.0, (height - 1) as f64) as usize;
        let colour = texture.pixels[row * width + column].to_array();
        colour.map(|channel| f64::from(channel) / 255.0)
    };
    let corners = [
        (at(left, top), (1.0 - right_part) * (1.0 - lower_part)),
        (at(left + 1.0, top), right_part * (1.0 - lower_part)),
        (at(left, top + 1.0), (1.0 - right_part) * lower_part),
        (at(left + 1.0, top + 1.0), right_part * lower_part),
    ];
    std::array::from_fn(|i| corners.iter().map(|(colour, part)| colour[i] * part).sum())
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Color32, RawInput, pos2, vec2};

    fn picture(draw: impl Fn(&egui::Painter)) -> RgbaImage {
        let ctx = Context::default();
        let mut rasteriser = Rasteriser::default();
        let screen = Rect::from_min_size(pos2(0.0, 0.0), vec2(40.0, 20.0));
        let input = || RawInput {
            screen_rect: Some(screen),
            ..RawInput::default()
        };
        let mut output = ctx.run_ui(input(), |ui| draw(ui.painter()));
        rasteriser.update(&mut output.textures_delta);
        rasteriser.draw(&ctx, &output)
    }

    #[test]
    fn a_rectangle_fills_its_pixels_once() {
        let half = Color32::from_rgba_premultiplied(100, 0, 0, 128);
        let area = Rect::from_min_max(pos2(5.0, 5.0), pos2(15.0, 10.0));
        let image = picture(|painter| {
            painter.rect_filled(area, 0.0, half);
        });
        assert_eq!(image.dimensions(), (40, 20));
        assert_eq!(image.get_pixel(10, 7).0, [100, 0, 0, 128]);
        assert_eq!(image.get_pixel(30, 7).0, [0; 4]);
        // The two triangles share a diagonal: each pixel is drawn exactly once.
        let inside = (7..13).flat_map(|x| (6..9).map(move |y| (x, y)));
        for (x, y) in inside {
            assert_eq!(image.get_pixel(x, y).0, [100, 0, 0, 128], "{x} {y}");
        }
    }

    #[test]
    fn text_is_drawn() {
        let image = picture(|painter| {
            let font = egui::FontId::proportional(14.0);
            painter.text(
                pos2(2.0, 2.0),
                egui::Align2::LEFT_TOP,
                "BRDF",
                font,
                Color32::WHITE,
            );
        });
        assert!(image.pixels().filter(|pixel| pixel.0[3] > 200).count() > 20);
    }
}
