//! Zemax tabular BSDF (`.bsdf`), also called the BSDF data interchange format: a header of
//! keywords, lists of four kinds of angles, and the BRDF in 1/sr for all their combinations.
//!
//! ```text
//! # a comment
//! Source  Measured
//! Symmetry  PlaneSymmetrical
//! SpectralContent  Monochrome
//! ScatterType  BRDF
//! SampleRotation  1
//! 0
//! AngleOfIncidence  2
//! 10  30
//! ScatterAzimuth  3
//! 0  90  180
//! ScatterRadial  2
//! 0  20
//!
//! Monochrome
//! DataBegin
//! TIS  0.12
//! 0.10  0.09
//! ...
//! DataEnd
//! ```
//!
//! (The numbers are made up.) All angles are in degrees. For each rotation of the sample and each
//! angle of incidence there is a line `TIS`, the total integrated scatter, which is not used, and a
//! line for each azimuth with a value for each radial angle. Azimuth and radial angle are spherical
//! coordinates about the **specular** ray: radial 0 is the specular direction, azimuth 0 points from
//! it towards the surface normal, and azimuths increase counter-clockwise. In a plane-symmetrical
//! file the azimuths end at 180 deg and apply to both sides of the plane of incidence; the model has
//! that symmetry, and each value is read once. The format fixes the angular convention. The angles are
//! converted by
//!
//! ```text
//! cos theta = cos r cos psi + sin r cos a sin psi
//! tan phi   = sin r sin a / (sin r cos a cos psi - cos r sin psi)
//! ```
//!
//! with r the radial angle and a the scatter azimuth.
//!
//! Some files contain more than the BRDF of an isotropic surface:
//! - `BTDF` is an error.
//! - Of `XYZ` the section `TristimulusY` is read: Y is the spectrum weighted by the luminous
//!   efficiency, so that it is the BRDF for light as the eye weights it. X and Z are not read.
//! - Rotations of the sample are read as readings of one isotropic sample, which is reported.
//! - Directions of the grid below the surface are left out and counted. So are values of exactly 0:
//!   the format has no other mark for a direction that was not measured.
//! - All azimuths at radial angle 0 are one direction, and azimuths of 0 and 360 deg are one: equal
//!   values there are read once.
//!
//! The format has no place for a wavelength. Here, a comment `# wavelength_um: 0.63` gives it in um,
//! and a comment `# refractive_index: 1.5` gives the index.
//!
//! Sources: "Zemax Tabular BSDF data file format" of the Zemax knowledge base (article
//! 1500005486801; before, "BSDF Data Interchange File Format Specification" of Radiant Imaging);
//! libbsdf's `ZemaxBsdfReader`, which treats the keywords and azimuth 0 in the same way; and the
//! files below `data/processed/zemax` of github.com/ua-loft/bsdf-tools, where for an incidence of
//! 70 deg the values extend to radial 140 deg at azimuth 0 and to 10 deg at azimuth 180 deg.

mod readings;
mod sections;
mod specular;
pub(super) mod tokens;

use super::comments::number_of_key;
use super::error::ReadError;
use super::number::is_wavelength;
use super::options::ReadOptions;
use super::reader::{Content, Reader};
use super::text::{Text, first_words};
use crate::scan::{Convention, Format, Measurements, Metadata, RefractiveIndex};
use readings::Readings;
use sections::Header;
pub(crate) use specular::from_specular;
use tokens::Tokens;

pub(super) const READER: Reader = Reader {
    format: Format::Zemax,
    extensions: &["bsdf"],
    recognises: has_keywords,
    content: Content::Text(read),
};

/// Whether two lines of a text begin with keywords of the format. LightTools shares some of them, but
/// calls the angle of incidence `AOI`.
fn has_keywords(bytes: &[u8]) -> bool {
    const KEYWORDS: [&[u8]; 4] = [
        b"Symmetry",
        b"SpectralContent",
        b"ScatterType",
        b"SampleRotation",
    ];
    let found = first_words(bytes).filter(|word| KEYWORDS.contains(word));
    found.take(2).count() == 2 && first_words(bytes).all(|word| word != b"AOI")
}

/// # Errors
///
/// The text is not such a file, or has no reading above the surface, or `options` set another angular
/// convention.
pub(super) fn read(text: Text<'_>, options: &ReadOptions) -> Result<Measurements, ReadError> {
    let why = "the format measures angles from the specular ray, with azimuth 0 towards the normal";
    let convention = options.fixed_convention(text.path, Convention::default(), why)?;
    let mut tokens = Tokens::new(text)?;
    let header = Header::read(&mut tokens)?;
    let blocks = header.read_sections(&mut tokens)?;
    let expected = "expected micrometres above 0";
    let metadata = tokens.metadata;
    let wavelength = number_of_key(&text, &metadata, "wavelength_um", expected, is_wavelength)?;
    let mut read = Readings::at(wavelength);
    for block in &blocks {
        read.add(block, &header);
    }
    if read.kept.is_empty() {
        return Err(text.error("has no reading above the surface"));
    }
    Ok(Measurements {
        source: text.path.display().to_string(),
        refractive_index: refractive_index(&text, &metadata)?,
        metadata,
        convention,
        format: Format::Zemax,
        conversions: read.conversions(&header),
        readings: read.kept,
        ..Measurements::default()
    })
}

fn refractive_index(
    text: &Text<'_>,
    metadata: &Metadata,
) -> Result<Option<RefractiveIndex>, ReadError> {
    let index = metadata.get("refractive_index").map(str::parse);
    index
        .transpose()
        .map_err(|error| text.error(format!("refractive_index: {error}")))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::scan::Side;

    const SMALL: &str = "# sample: Test paint\n# wavelength_um: 0.65\nSource\tMeasured\n\
        Symmetry\tPlaneSymmetrical\nSpectralContent\tMonochrome\nScatterType\tBRDF\n\
        SampleRotation\t1\n0\nAngleOfIncidence\t2\n10\t30\nScatterAzimuth\t2\n0\t180\n\
        ScatterRadial\t3\n0\t30\t70\n\nMonochrome\nDataBegin\n\
        TIS\t0.1\n0.10 0.11 0.12\n0.10 0.13 0.14\nTIS\t0.1\n0.20 0.21 0\n0.20 0.23 0.24\nDataEnd\n";

    fn read_with(content: &str, options: &ReadOptions) -> Result<Measurements, ReadError> {
        read(Text::new(Path::new("a.bsdf"), content.as_bytes())?, options)
    }

    fn scan(content: &str) -> Measurements {
        read_with(content, &ReadOptions::default()).unwrap()
    }

    fn error(content: &str) -> String {
        let read = read_with(content, &ReadOptions::default());
        read.unwrap_err().to_string()
    }

    #[test]
    fn angles_about_the_specular_ray_are_converted_to_view_angles() {
        let scan = scan(SMALL);
        let found: Vec<_> = scan
            .readings()
            .iter()
            .map(|r| {
                (
                    r.psi.to_degrees().round(),
                    r.in_plane_theta().unwrap().to_degrees().round(),
                    r.brdf,
                )
            })
            .collect();
        // Azimuth 0 leads towards the normal and beyond it to the source, azimuth 180 deg to the horizon.
        let expected = [
            (10.0, -10.0, 0.10),
            (10.0, 20.0, 0.11),
            (10.0, 60.0, 0.12),
            (10.0, -40.0, 0.13),
            (10.0, -80.0, 0.14),
            (30.0, -30.0, 0.20),
            (30.0, 0.0, 0.21),
            (30.0, -60.0, 0.23),
        ];
        assert_eq!(found, expected);
        assert_eq!(scan.wavelengths(), [Some(0.65)]);
        assert_eq!(scan.metadata.get("sample"), Some("Test paint"));
    }

    #[test]
    fn values_that_are_left_out_are_counted() {
        let sentences = scan(SMALL).conversions.join("; ");
        assert!(
            sentences.contains("1 reading at or beyond 90 deg from the normal is left out"),
            "{sentences}"
        );
        assert!(sentences.contains("1 reading of exactly 0"), "{sentences}");
        assert!(
            sentences.contains("2 readings that repeat the value of the same direction"),
            "{sentences}"
        );
    }

    #[test]
    fn of_xyz_the_section_of_y_is_read() {
        let (head, section) = SMALL.split_once("Monochrome\nDataBegin").unwrap();
        let section = format!("DataBegin{section}");
        let xyz = format!(
            "{}TristimulusX\n{section}\nTristimulusY\n{}TristimulusZ\n{section}",
            head.replace("Monochrome", "XYZ"),
            section.replace("0.11", "0.77"),
        );
        let scan = scan(&xyz);
        assert_eq!(scan.readings()[1].brdf, 0.77);
        assert!(scan.conversions[1].contains("of X, Y and Z, Y is read"));
    }

    #[test]
    fn rotations_are_read_as_one_isotropic_sample() {
        let block = "TIS 0.1\n1 2\n1 3\n1 2\n";
        let text = format!(
            "Symmetry Asymmetrical4D\nSampleRotation 2\n0 90\nAngleOfIncidence 1\n10\n\
             ScatterAzimuth 3\n0 180 360\nScatterRadial 2\n0 10\nMonochrome\nDataBegin\n{block}{block}DataEnd\n"
        );
        let scan = scan(&text);
        assert_eq!(scan.readings().len(), 2 * 3);
        let sentences = scan.conversions.join("; ");
        assert!(
            sentences.contains("2 rotations of the sample"),
            "{sentences}"
        );
        assert!(
            sentences.contains("6 readings that repeat the value"),
            "{sentences}"
        );
    }

    #[test]
    fn errors_name_line_and_word() {
        let with = |from: &str, to: &str| error(&SMALL.replacen(from, to, 1));
        assert_eq!(
            with("\tBRDF", "\tBTDF"),
            "a.bsdf, line 6: ScatterType BTDF: the model describes reflection, expected BRDF"
        );
        assert!(with("Source", "Origin").contains("line 3: \"Origin\": expected Source, Symmetry"));
        assert!(
            with("PlaneSymmetrical", "Round").contains("\"Round\": expected PlaneSymmetrical or")
        );
        assert!(
            with("ScatterRadial\t3", "ScatterRadial\t-3")
                .contains("line 13, column ScatterRadial: \"-3\"")
        );
        assert!(
            with("ScatterRadial\t3", "ScatterRadial\t2")
                .contains("line 14: \"70\": expected Source")
        );
        assert!(with("0.13", "x").contains("line 20, column BRDF: \"x\" is not a number"));
        assert!(with("0.13", "").contains("line 21, column BRDF: \"TIS\" is not a number"));
        assert!(with("DataEnd\n", "").contains("ends too early: expected DataEnd"));
        assert!(with("DataEnd", "DataEnd 5").contains("line 24: \"5\": expected nothing after"));
        assert!(error("Symmetry ASymmetrical\nMonochrome\n").contains("has no AngleOfIncidence"));
    }

    #[test]
    fn a_large_count_allocates_no_memory() {
        let claims = SMALL.replace("ScatterRadial\t3", "ScatterRadial\t18446744073709551615");
        assert!(error(&claims).contains("column ScatterRadial: \"Monochrome\" is not a number"));
    }

    #[test]
    fn the_angular_convention_cannot_be_chosen() {
        let options = ReadOptions {
            theta_positive: Some(Side::Forward),
            ..ReadOptions::default()
        };
        let error = read_with(SMALL, &options).unwrap_err().to_string();
        assert!(
            error.contains(
                "the angular convention cannot be chosen: the format measures angles from"
            ),
            "{error}"
        );
    }
}
