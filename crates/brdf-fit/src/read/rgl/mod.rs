//! RGL tensor files (`.bsdf`): measured BRDFs in the adaptive parameterisation of Dupuy and Jakob.
//!
//! A tensor file begins with `tensor_file`, a zero byte and the version 1.0, and lists named tensors of
//! numbers, all little-endian (see `tensor.rs`). Those of an isotropic material are:
//!
//! | tensor | shape | content |
//! |---|---|---|
//! | `theta_i` | T | incidence angles in radians |
//! | `phi_i` | 1 | azimuth of the source in radians; 3 or more make the material anisotropic |
//! | `ndf` | rows, columns | the facet distribution D |
//! | `sigma` | rows, columns | the projected area of the facets |
//! | `vndf` | 1, T, rows, columns | for each incidence the density of visible facets, without its scale |
//! | `spectra` | 1, T, W, rows, columns | the values S |
//! | `wavelengths` | W | wavelengths in nm |
//! | `rgb` | 1, T, 3, rows, columns | in place of the last two: red, green and blue |
//! | `jacobian` | 1 | whether D / (4 sigma) is a factor of the values, as it is where this is missing |
//!
//! # Conventions
//!
//! Columns of `ndf`, `sigma` and `vndf` run over zenith angles, rows over azimuths, from end to end of
//! the unit square:
//!
//! ```text
//! theta = u^2 pi / 2,   phi = (2 v - 1) pi
//! ```
//!
//! Values between the nodes are interpolated linearly in u and v. The nodes of the values S cover the
//! unit square as well, but of the random numbers with which facets are drawn: the density `vndf`, drawn
//! by its marginal over v and its conditional density over u, takes a node to the facet m = (theta, phi),
//! with phi counted from the azimuth of the source. The view direction o is the source i mirrored at
//! this facet. There,
//!
//! ```text
//! f_r(i, o) cos theta_o = S D(m) / (4 sigma(i))
//! ```
//!
//! A reading is taken at each node of each incidence, where the file's definition needs no interpolation
//! of S. The reading is divided by cos theta_o. The channels of `rgb` are assigned the wavelengths of
//! those of a [MERL table](super::merl).
//!
//! # What is left out, and what is an error
//!
//! Left out and counted are nodes whose view direction is at or beyond the horizon, and values that are
//! no numbers. Where there would be more than 2 million readings, only every second node of each row and
//! column is read, or every third, and so on; the report says which. Anisotropic materials and other
//! tensor files are errors.
//!
//! Sources: Dupuy and Jakob, "An Adaptive Parameterization for Efficient Material Acquisition and
//! Rendering", ACM Trans. Graph. 37(6), 2018; the plugin `measured` of Mitsuba 3 and its
//! `MarginalContinuous2D`; `MeasuredBxDF` of pbrt-v4, which divides by the cosine.

mod nodes;
mod tensor;
mod warp;

use std::path::Path;

use super::conversion::{BEYOND_HORIZON, NOT_TAKEN, left_out};
use super::error::ReadError;
use super::options::ReadOptions;
use super::reader::{Content, Reader};
use crate::scan::{Convention, Format, Measurements, Metadata};
use nodes::Material;
use tensor::{MAGIC, TensorFile};

pub(super) const READER: Reader = Reader {
    format: Format::Rgl,
    // The usual extension, .bsdf, is that of Zemax.
    extensions: &[],
    recognises: |bytes| bytes.starts_with(MAGIC),
    content: Content::Bytes(read),
};

/// The largest number of readings.
const MOST_READINGS: usize = 2 << 20;

/// # Errors
///
/// The bytes are not a tensor file of an isotropic BRDF, or `options` set another angular convention.
fn read(path: &Path, bytes: &[u8], options: &ReadOptions) -> Result<Measurements, ReadError> {
    let why = "in RGL tensor files, angles are counted from the normal and from the source";
    let convention = options.fixed_convention(path, Convention::default(), why)?;
    let error = |message: String| ReadError::file(path, message);
    let file = TensorFile::new(bytes).map_err(error)?;
    let material = Material::new(&file).map_err(error)?;
    let found = material.readings(MOST_READINGS).map_err(error)?;
    if found.readings.is_empty() {
        return Err(error("has no reading above the surface".to_owned()));
    }
    let mut conversions = vec![
        "f_r at the nodes of the adaptive parameterisation: values are multiplied by D / (4 sigma cos \
         theta)"
            .to_owned(),
    ];
    conversions.extend(material.colours());
    conversions.extend(found.thinned);
    conversions.extend(left_out(found.beyond, BEYOND_HORIZON));
    conversions.extend(left_out(found.not_taken, NOT_TAKEN));
    let sample = file.text("description").filter(|text| !text.is_empty());
    Ok(Measurements {
        source: path.display().to_string(),
        metadata: Metadata(
            sample
                .map(|text| ("sample".to_owned(), text))
                .into_iter()
                .collect(),
        ),
        convention,
        format: Format::Rgl,
        conversions,
        readings: found.readings,
        ..Measurements::default()
    })
}

#[cfg(test)]
mod tests;
