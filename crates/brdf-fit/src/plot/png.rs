//! PNG of an SVG, with a bundled typeface.

use std::sync::{Arc, LazyLock};

use png::{BitDepth, ColorType, Compression, Encoder, EncodingError};
use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::fontdb::Database;
use resvg::usvg::{Options, Tree};

use super::error::PlotError;

/// The largest side of an image, in pixels.
const LARGEST_SIDE: f32 = 20_000.0;

/// The bundled typeface, so that a PNG does not depend on the typefaces of the machine.
static TYPEFACES: LazyLock<Arc<Database>> = LazyLock::new(|| {
    let mut typefaces = Database::new();
    typefaces.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
    let family = typefaces
        .faces()
        .find_map(|face| face.families.first().map(|(name, _)| name.clone()));
    if let Some(family) = family {
        typefaces.set_sans_serif_family(family);
    }
    Arc::new(typefaces)
});

/// The PNG on white, with `scale` pixels for each unit of the SVG.
///
/// # Errors
///
/// Where `scale` does not give an image of 1 to 20,000 pixels a side, or resvg fails.
pub(super) fn png(svg: &str, scale: f32) -> Result<Vec<u8>, PlotError> {
    let options = Options {
        fontdb: Arc::clone(&TYPEFACES),
        ..Options::default()
    };
    let tree = Tree::from_str(svg, &options).map_err(|error| PlotError::Svg(error.to_string()))?;
    let size = tree.size();
    let pixels = |side: f32| {
        let pixels = (side * scale).round();
        (1.0..=LARGEST_SIDE)
            .contains(&pixels)
            .then(|| whole(pixels))
    };
    let sides = pixels(size.width()).zip(pixels(size.height()));
    let mut image = sides
        .and_then(|(width, height)| Pixmap::new(width, height))
        .ok_or(PlotError::Scale {
            scale,
            largest_side: LARGEST_SIDE,
        })?;
    image.fill(Color::WHITE);
    let transform = Transform::from_scale(scale, scale);
    resvg::render(&tree, transform, &mut image.as_mut());
    encoded(&image).map_err(|error| PlotError::Png(error.to_string()))
}

/// The file of an opaque image.
///
/// The usual compression takes a quarter of the time of a report with pictures. The fast one makes files
/// that are 1.6 times as large.
fn encoded(image: &Pixmap) -> Result<Vec<u8>, EncodingError> {
    let rgb: Vec<u8> = image
        .pixels()
        .iter()
        .flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()])
        .collect();
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, image.width(), image.height());
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Fast);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&rgb)?;
    writer.finish()?;
    Ok(bytes)
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "from 1 to the largest side"
)]
fn whole(pixels: f32) -> u32 {
    pixels as u32
}
