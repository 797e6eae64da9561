//! Surface scattering distribution data (`.ssdd`), the format of libbsdf and BSDF Processor: blocks of
//! keywords and lists of angles, each with the values for all combinations of them.
//!
//! ```text
//! VERSION 0.2
//! DATA_TYPE brdf
//! COLOR_MODEL spectrum
//! WAVELENGTH_LIST 450 650
//! PARAM_TYPE specular_coordinate_system
//! REDUCTION_TYPE bilateral_symmetry
//! PARAM0_LIST 10 30
//! PARAM2_LIST 0 20
//! PARAM3_LIST 0 90 180
//! NAME Red paint
//! DATA ascii
//! 0.05 0.31
//! ...
//! ```
//!
//! (The numbers are made up.) A line of values holds a colour; the first list runs fastest, the last one
//! slowest. Angles are in degrees, the BRDF is in 1/sr. The values may also be binary: single-precision
//! numbers, the least significant byte first. By `PARAM_TYPE` the angles of the lists 0, 2 and 3 are
//!
//! | `PARAM_TYPE` | angles |
//! |---|---|
//! | `spherical_coordinate_system` | zenith angles of source and view, azimuth of the view; equal azimuths are the source's side |
//! | `specular_coordinate_system` | zenith angle of the source; polar angle and azimuth about the specular direction, azimuth 0 towards the normal, as in [`zemax`](super::zemax) |
//! | `half_difference_coordinate_system` | zenith angle of the half vector; polar angle and azimuth of the source about it, as in [`merl`](super::merl) |
//!
//! List 1 is the azimuth of the source, or of the half vector, for anisotropic samples: its rows are read as
//! those of one isotropic sample, which is reported. With a `REDUCTION_TYPE`, a list ends where the values repeat
//! by symmetry; each value is read once.
//!
//! By `COLOR_MODEL`, the values of `spectrum` are at wavelengths in nm; red, green and blue of `rgb`, whose
//! colour space the format does not define, are assigned to 0.611, 0.549 and 0.464 um as in MERL tables; of
//! `xyz`, Y is read, the BRDF for light as the eye weights it. `monochrome` has no wavelength: a comment
//! `# wavelength_um: 0.63` gives it, and `# refractive_index: 1.5` the index.
//!
//! Directions at or beyond the horizon, values that are no numbers, and values that repeat that of one
//! direction (at a pole, or a whole turn on) are left out and counted. Blocks of other data (BTDF, specular
//! reflectance and transmittance) are not read, which is reported. Offsets of the specular direction
//! (`PARAM4_LIST`), which are for refraction, and parameters that the specification does not have are errors.
//!
//! Sources: `doc/SsddFileFormatSpecification.md`, version 0.2, of github.com/KimuraRyo/libbsdf; for the
//! coordinates and for the width of binary numbers, that project's coordinate systems and `SsddReader`.

mod block;
mod grid;

use std::path::Path;

use super::comments::number_of_key;
use super::conversion::{LeftOut, left_out};
use super::error::ReadError;
use super::merl::Channel;
use super::number::{is_wavelength, shifted};
use super::options::ReadOptions;
use super::reader::{Content, Reader};
use super::text::{Text, first_words};
use crate::scan::{Convention, Format, Measurement, Measurements};
use block::{Block, Color, File};
use grid::Grid;

pub(super) const READER: Reader = Reader {
    format: Format::Ssdd,
    extensions: &["ssdd"],
    recognises: |bytes| {
        let mut words = first_words(bytes).filter(|word| !word.is_empty() && *word != b"#");
        words.next() == Some(b"VERSION") && words.any(|word| word == b"DATA_TYPE")
    },
    content: Content::Bytes(read),
};

/// # Errors
///
/// The file is not in the format, has no BRDF or no reading above the surface, or `options` set another angular
/// convention.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    options: &ReadOptions,
) -> Result<Measurements, ReadError> {
    let text = Text::for_errors(path);
    let why = "the format states the coordinates of its directions";
    let convention = options.fixed_convention(path, Convention::default(), why)?;
    let File { metadata, blocks } = File::read(&text, bytes)?;
    let (brdf, others): (Vec<Block>, Vec<Block>) =
        blocks.into_iter().partition(|block| block.kind == "brdf");
    let block = match brdf.as_slice() {
        [block] => block,
        [] => return Err(text.error(without_brdf(&others))),
        [_, second, ..] => {
            return Err(text.line_error(second.line, "a second BRDF: expected one"));
        }
    };
    let grid = Grid::of(&text, block)?;
    let expected = "expected micrometres above 0";
    let wavelength = number_of_key(&text, &metadata, "wavelength_um", expected, is_wavelength)?;
    let mut readings = Readings::default();
    readings.add(block, &grid, &channels(&block.color, wavelength));
    if readings.kept.is_empty() {
        return Err(text.error("has no reading above the surface"));
    }
    let index = metadata.get("refractive_index").map(str::parse).transpose();
    let index = index.map_err(|error| text.error(format!("refractive_index: {error}")))?;
    Ok(Measurements {
        source: path.display().to_string(),
        refractive_index: index,
        metadata,
        convention,
        format: Format::Ssdd,
        conversions: readings.conversions(block, &grid, &others),
        readings: readings.kept,
        ..Measurements::default()
    })
}

fn without_brdf(blocks: &[Block]) -> String {
    let kinds: Vec<String> = blocks.iter().map(Block::in_words).collect();
    format!(
        "has no BRDF, but {}: the model describes reflection, expected DATA_TYPE brdf",
        kinds.join(" and ")
    )
}

/// The place of each channel that is read in a colour, and its wavelength in micrometres.
fn channels(color: &Color, stated_um: Option<f64>) -> Vec<(usize, Option<f64>)> {
    match color {
        Color::Monochrome => vec![(0, stated_um)],
        Color::Rgb => {
            let wavelengths = Channel::ALL.map(|channel| Some(channel.wavelength_um()));
            wavelengths.into_iter().enumerate().collect()
        }
        Color::Xyz => vec![(1, stated_um)],
        Color::Spectrum(nanometres) => {
            let wavelengths = nanometres.iter().map(|nm| Some(shifted(*nm, -3)));
            wavelengths.enumerate().collect()
        }
    }
}

/// The readings of a file, with the numbers of values that are left out.
#[derive(Default)]
struct Readings {
    kept: Vec<Measurement>,
    left: LeftOut,
    repeated: usize,
}

impl Readings {
    fn add(&mut self, block: &Block, grid: &Grid<'_>, channels: &[(usize, Option<f64>)]) {
        let colors = block.values.chunks(block.color.channels());
        for ((place, at), color) in grid.places().zip(colors) {
            let repeats = grid
                .earlier(place)
                .any(|earlier| block.color_at(grid.index(earlier)) == Some(color));
            if repeats {
                self.repeated += channels.len();
                continue;
            }
            let Some((psi, theta, phi)) = grid.directions(at) else {
                self.left.beyond += channels.len();
                continue;
            };
            for &(channel, wavelength_um) in channels {
                let value = color
                    .get(channel)
                    .copied()
                    .filter(|value| value.is_finite());
                let reading = value.map(|brdf| Measurement {
                    wavelength_um,
                    psi,
                    theta,
                    phi,
                    brdf,
                    sigma: None,
                });
                self.left.not_taken += usize::from(reading.is_none());
                self.kept.extend(reading);
            }
        }
    }

    fn conversions(&self, block: &Block, grid: &Grid<'_>, others: &[Block]) -> Vec<String> {
        let mut conversions = vec![grid.in_words().to_owned()];
        match block.color {
            Color::Rgb => conversions.push(
                "red, green and blue are assigned to 0.611, 0.549 and 0.464 um: the format does not define \
                 their colour space"
                    .to_owned(),
            ),
            Color::Xyz => conversions.push(
                "of X, Y and Z, Y is read: the BRDF weighted by the luminous efficiency".to_owned(),
            ),
            Color::Monochrome | Color::Spectrum(_) => {}
        }
        let azimuths = grid.rotations();
        if azimuths > 1 {
            conversions.push(format!(
                "{azimuths} azimuths of incidence are read as one isotropic sample"
            ));
        }
        let others = others
            .iter()
            .map(|block| format!("the {} is not read", block.in_words()));
        conversions.extend(others);
        conversions.extend(self.left.notes());
        conversions.extend(left_out(
            self.repeated,
            "with the value of the same direction before",
        ));
        conversions
    }
}

#[cfg(test)]
mod tests;
