//! ASTM E1392 and E2387 text, as optical instruments write it, and the layout of the Cornell light
//! measurement laboratory: lines `KEY value`, the last of which is `VARS` and names the columns, and a
//! row for each pair of directions.
//!
//! ```text
//! LAB_NAME     a laboratory
//! SAMPLE_NAME  Test paint
//! NUM_POINTS   2
//! VARS         theta_i,phi_i,theta_s,phi_s,400nm,410nm
//! 0.3490659,0,0.3490659,3.1415927,0.31,0.30
//! 0.3490659,0,0.5235988,3.1415927,0.11,0.12
//! ```
//!
//! (The numbers are made up.)
//!
//! | column or key | |
//! |---|---|
//! | `theta_i` | zenith angle of the source |
//! | `phi_i` | azimuth of the source |
//! | `theta_s` | zenith angle of the view (s for scatter), also `theta_r` |
//! | `phi_s` | azimuth of the view, also `phi_r`; 0 where it is not given |
//! | `400nm` | the value at that wavelength; any number of columns, 31 or 65 in Cornell's files |
//! | `X,Y,Z` | tristimulus values: Y is read, the BRDF weighted by the luminous efficiency |
//! | `sigma` | standard deviation of the value, where a row has one value |
//! | any other | the value, if it is the only column left and no other is a value; otherwise it is not read, but listed |
//!
//! An angle that is the same in all rows, and `WAVELENGTH`, may be given as a key instead.
//!
//! **Units.** `ANGLE_UNIT` is `deg` or `rad`. Where it is missing, angles are in radians, as in Cornell's
//! files (and as libbsdf and ALTA read all files), unless one exceeds the range of angles in radians:
//! then they are in degrees. `WAVELENGTH` is in um or nm by its unit; without a unit it is in um below
//! 100, and in nm otherwise.
//!
//! **Azimuth.** The model's phi is phi_s - phi_i: where it is 0, the view looks back at the source.
//! Cornell's files give the azimuths of both directions, phi_i = 0 and phi_s from -pi to pi, with the
//! specular lobe at pi. E1392 prefers coordinates of the beam, in which phi_i is always 180 deg and the
//! specular direction is theta_s = theta_i at phi_s = 0: these are assumed where phi_i is not given, and
//! phi = phi_s + 180 deg. [`ReadOptions::phi_zero`] sets the side of azimuth zero for files that follow
//! neither.
//!
//! **Quantity.** In E1392 and E2387, the BRDF in 1/sr has the cosine of the view angle divided out. The
//! cosine-corrected BRDF of the former, which the latter calls differential scattering function (DSF),
//! is f_r cos theta_s. The names of columns and the keys `QUANTITY` and `MEAS_NAME` are read as
//!
//! | name | value | conversion |
//! |---|---|---|
//! | `BRDF`, `BSDF`, `Integrated` | f_r | none |
//! | `BRDF_COS`, `DSF`, `ARS`, or one with `cosine` | f_r cos theta_s | f_r = value / cos theta_s |
//! | `BRF`, `REFLECTANCE_FACTOR`, `RADIANCE_FACTOR` | reflectance factor, pi f_r | f_r = value / pi |
//! | `R%`, `REFLECTANCE_FACTOR_PERCENT` | reflectance factor in percent | f_r = value / (100 pi) |
//! | `LOG_BRDF`, `BRDF_DB` | decadic logarithm, decibels | f_r = 10^value, 10^(value/10) |
//!
//! A single column of another name is an error unless a key gives its quantity. `BTDF` is an error, and so are the display colours `R,G,B`.
//!
//! Sources: "Data file formats" of graphics.cornell.edu/online/measurements/reflectance; libbsdf's
//! `AstmReader` and ALTA's `data_astm`, which read these files; the public abstracts of ASTM E1392-96
//! and E2387-05; J. C. Stover, Optical Scattering, for theta_s = theta_i, phi_s = 0 as the specular
//! direction.

mod header;
mod rows;

use super::comments::comment_of;
use super::error::ReadError;
use super::options::ReadOptions;
use super::reader::{Content, Reader};
use super::text::{Text, first_words};
use crate::scan::{Format, Measurements};
use header::Header;
use rows::Rows;

pub(super) const READER: Reader = Reader {
    format: Format::Astm,
    extensions: &["astm"],
    recognises: |bytes| first_words(bytes).any(|word| word == b"VARS"),
    content: Content::Text(read),
};

/// # Errors
///
/// The text is not such a file, or has no readings above the surface, or `options` set another side of
/// positive theta.
pub(super) fn read(text: Text<'_>, options: &ReadOptions) -> Result<Measurements, ReadError> {
    let mut lines = text.checked_lines();
    let header = Header::read(&text, &mut lines)?;
    let convention = header.convention(&text, options)?;
    let mut rows = Rows::default();
    for line in lines {
        let (number, line) = line?;
        if !line.trim_ascii().is_empty() && comment_of(line).is_none() {
            rows.add(&text, &header, number, line)?;
        }
    }
    header.check_count(&text, rows.directions.len())?;
    rows.measurements(&text, header, convention)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};
    use std::path::Path;

    use super::*;
    use crate::scan::Measurement;
    use crate::scan::Side;

    fn read_with(content: &str, options: &ReadOptions) -> Result<Measurements, ReadError> {
        read(Text::new(Path::new("a.astm"), content.as_bytes())?, options)
    }

    fn scan(content: &str) -> Measurements {
        read_with(content, &ReadOptions::default()).unwrap()
    }

    fn error(content: &str) -> String {
        let read = read_with(content, &ReadOptions::default());
        read.unwrap_err().to_string()
    }

    const DEG: f64 = PI / 180.0;

    #[test]
    fn cornell_files_have_radians_and_one_wavelength_per_column() {
        let text = "LAB_NAME x\r\nSAMPLE_NAME \"Test paint\"\r\n\r\nNUM_POINTS 2\r\n\
                    VARS theta_i,phi_i,theta_s,phi_s,400nm,632.8nm\r\n\
                    0.35,0,0.35,-3.141592653589793,0.3,0.4\r\n0.35,0,0.5,1.5,-0.01,0.2\r\n";
        let scan = scan(text);
        let first = scan.readings()[0];
        assert_eq!(scan.readings().len(), 4);
        assert_eq!(first.psi, 0.35);
        assert_eq!(first.in_plane_theta(), Some(-0.35));
        assert_eq!(scan.readings()[1].wavelength_um, Some(0.6328));
        assert_eq!(scan.readings()[2].brdf, -0.01);
        assert_eq!(scan.readings()[2].phi, 1.5);
        assert_eq!(scan.metadata.get("sample"), Some("Test paint"));
        assert!(scan.conversions[0].contains("assumed to be in radians"));
    }

    #[test]
    fn without_phi_i_the_coordinates_are_those_of_the_beam() {
        let text = "ANGLE_UNIT deg\nWAVELENGTH 0.6328 um\nTHETA_I 30\nVARS theta_s phi_s BRDF sigma\n\
                    30 0 0.5 0.01\n-20 0 0.1 0.02\n40 180 0.2 0.01\n";
        let scan = scan(text);
        let found: Vec<_> = scan
            .readings()
            .iter()
            .map(Measurement::in_plane_theta)
            .collect();
        let expected = [-30.0, 20.0, 40.0].map(|deg| Some(deg * DEG));
        for (found, expected) in found.iter().zip(expected) {
            assert!(
                (found.unwrap() - expected.unwrap()).abs() < 1e-15,
                "{found:?}"
            );
        }
        assert_eq!(scan.readings()[1].sigma, Some(0.02));
        assert_eq!(scan.wavelengths(), [Some(0.6328)]);
        assert_eq!(scan.convention.phi_zero, Side::Forward);
        let source = ReadOptions {
            phi_zero: Some(Side::Source),
            ..ReadOptions::default()
        };
        let other = read_with(text, &source).unwrap();
        assert!((other.readings()[0].in_plane_theta().unwrap() - 30.0 * DEG).abs() < 1e-15);
    }

    #[test]
    fn degrees_are_recognised_where_no_unit_is_given() {
        let scan =
            scan("VARS theta_i phi_i theta_s phi_s BSDF\n30 180 20 0 0.5\n30 180 95 0 0.4\n");
        assert_eq!(scan.readings().len(), 1);
        assert!((scan.readings()[0].psi - 30.0 * DEG).abs() < 1e-15);
        let sentences = scan.conversions.join("; ");
        assert!(
            sentences.contains("assumed to be in degrees"),
            "{sentences}"
        );
        assert!(
            sentences.contains("1 reading at or beyond 90 deg"),
            "{sentences}"
        );
    }

    #[test]
    fn cosine_corrected_values_are_divided_by_the_cosine() {
        let with = |head: &str, name: &str| {
            let text = format!("{head}ANGLE_UNIT deg\nVARS theta_i theta_s {name}\n30 60 0.5\n");
            scan(&text).readings()[0].brdf
        };
        for (head, name) in [
            ("", "DSF"),
            ("", "BRDF_COS"),
            ("", "cosine-corrected_BRDF"),
            ("MEAS_NAME \"BRDF, cosine-corrected\"\n", "BRDF"),
        ] {
            assert!((with(head, name) - 1.0).abs() < 1e-15, "{head}{name}");
        }
        assert_eq!(with("", "BRDF"), 0.5);
        assert_eq!(with("", "Integrated"), 0.5);
        assert_eq!(with("", "BRF"), 0.5 / PI);
        assert_eq!(with("", "REFLECTANCE_FACTOR"), 0.5 / PI);
        assert_eq!(with("", "R%"), 0.5 / 100.0 / PI);
        assert_eq!(with("", "LOG_BRDF"), 10_f64.powf(0.5));
        assert!((with("", "CCBRDF") - 1.0).abs() < 1e-15);
        assert_eq!(with("MEAS_NAME BRF\n", "value"), 0.5 / PI);
        let unknown = "VARS theta_i theta_s reflectance\n30 60 0.5\n";
        assert!(error(unknown).contains("the quantity of the column reflectance is not known"));
    }

    #[test]
    fn of_xyz_the_column_y_is_read_and_rgb_is_refused() {
        let xyz = "VARS theta_i,phi_i,theta_s,phi_s,X,Y,Z\n0,0,0.5,0,1,2,3\n";
        let scan = scan(xyz);
        assert_eq!(scan.readings()[0].brdf, 2.0);
        assert_eq!(scan.ignored_columns, ["X", "Z"]);
        let rgb = error(&xyz.replace("X,Y,Z", "R,G,B"));
        assert!(
            rgb.contains("line 1: R, G and B are display colours"),
            "{rgb}"
        );
    }

    #[test]
    fn negative_zenith_angles_are_on_the_opposite_side() {
        let scan = scan("VARS theta_i,phi_i,theta_s,phi_s,BRDF\n-0.3,0,0.5,0,1\n");
        let reading = scan.readings()[0];
        assert_eq!((reading.psi, reading.phi), (0.3, PI));
        assert!(reading.psi < FRAC_PI_2);
    }

    #[test]
    fn errors_name_line_column_and_value() {
        const HEAD: &str = "NUM_POINTS 1\nVARS theta_i,phi_i,theta_s,phi_s,400nm\n";
        let rows = |rows: &str| error(&format!("{HEAD}{rows}"));
        assert_eq!(
            rows("0,0,x,0,1\n"),
            "a.astm, line 3, column theta_s: \"x\" is not a number: expected an angle"
        );
        assert!(rows("0,0,0,0,inf\n").contains("column 400nm: \"inf\" is not a finite number"));
        assert!(rows("0,0,0,0\n").contains("line 3: 4 fields: expected 5, as in VARS"));
        assert!(rows("").contains("line 2: no rows follow VARS"));
        assert!(rows("0,0,0,0,1\n0,0,0,0,1\n").contains("2 rows follow: expected 1"));
        assert!(error("LAB_NAME x\n").contains("has no line VARS"));
        assert!(error("VARS theta_i,BRDF\n").contains("missing column theta_s"));
        assert!(error("VARS theta_i,theta_s\n").contains("no column of values"));
        assert!(error("VARS theta_i,theta_s,theta_r,BRDF\n").contains("theta_s is given twice"));
        assert!(
            error("VARS theta_i,theta_s,BTDF\n").contains("BTDF: the model describes reflection")
        );
        assert!(error("VARS theta_i,theta_s,1nm,2nm,sigma\n").contains("one column sigma"));
        assert!(error("VARS theta_i,theta_s,1nm,BRDF\n").contains("without wavelengths"));
        assert!(error("ANGLE_UNIT gon\n").contains("line 1, column angle_unit: \"gon\""));
        assert!(
            error("WAVELENGTH red\n").contains("column wavelength: \"red\" is not a wavelength")
        );
        assert!(error("NUM_POINTS many\n").contains("column num_points: \"many\" is not a number"));
    }

    #[test]
    fn the_side_of_positive_theta_cannot_be_chosen() {
        let options = ReadOptions {
            theta_positive: Some(Side::Forward),
            ..ReadOptions::default()
        };
        let error = read_with("VARS theta_i theta_s BRDF\n0 0 1\n", &options).unwrap_err();
        assert!(
            error
                .to_string()
                .contains("the angular convention cannot be chosen: theta_s counts"),
            "{error}"
        );
    }
}
