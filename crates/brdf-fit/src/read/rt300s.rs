//! Exports of the goniophotometer RT-300S (`.jdv`): blocks of one incidence each, with lines that end
//! with CR and fields that are separated by tabs.
//!
//! ```text
//! DataType:   BRDF(RT-300S)
//! SampleID:   Test paint
//! Date:       1/2/2025
//! Incidence:  30
//! Polar:      -60,60,30
//! Azimuth:    -90,90,90
//!
//! Raw data
//!         -60     -30     0       30      60
//! -90     14.1    24.3    29.0    31.2    20.4
//! 0       ...
//! ```
//!
//! (The numbers are made up.) `Polar` and `Azimuth` state the first angle, the last one and the step, in
//! degrees; the angles themselves stand above and before the values. There is no wavelength: the
//! instrument measures white light.
//!
//! # Conventions
//!
//! The plane of incidence is that of the azimuths -90 and 90 deg. The source is at the azimuth 90 deg: at
//! -90 deg, positive polar angles are the forward side. A value is the radiant intensity relative to that
//! of a perfect diffuser along its normal, in percent:
//!
//! ```text
//! value = 100 pi f_r cos theta
//! ```
//!
//! # What is left out, and what is an error
//!
//! Left out and counted are blocks in which all values are 0, which the instrument's program writes where
//! nothing was measured, cells without a value, and directions at or beyond 90 deg. Negative values, which
//! remain where the dark signal is larger, are kept. BTDF and the export for Raywiz, which has only the
//! ends of the angles, are errors.
//!
//! Sources: `processing/matlab/core/util` of github.com/ua-loft/bsdf-tools (University of Arizona LOFT):
//! `process_rt300s.m` divides the quantity RT of the instrument's workbooks by pi cos theta, and removes
//! directions near polar = incidence at the azimuth 90 deg, where the detector shades the source;
//! `rt300s_frame_to_fred.m` has the same azimuths. The exports of one measurement below
//! `docs/instruments/rt300s` there show that the values of a `.jdv` are 100 RT.

use std::collections::HashMap;
use std::f64::consts::PI;

use super::angles::{AngleUnit, TwoDirections};
use super::conversion::{BEYOND_HORIZON, NOT_TAKEN, left_out};
use super::error::ReadError;
use super::number::{Field, is_angle, is_reading, was_not_taken};
use super::options::ReadOptions;
use super::reader::{Content, Reader};
use super::text::{Text, head_lines, quotable, words};
use crate::format::counted;
use crate::scan::{Convention, Format, Measurement, Measurements, Metadata};

pub(super) const READER: Reader = Reader {
    format: Format::Rt300s,
    extensions: &["jdv"],
    recognises: |bytes| {
        let first = head_lines(bytes).find(|line| !line.trim_ascii().is_empty());
        first.is_some_and(|line| matches!(words(line).next(), Some(b"DataType:")))
    },
    content: Content::Text(read),
};

/// The azimuth of the source in degrees.
const SOURCE_AZIMUTH: f64 = 90.0;

/// What the values are when they are divided by pi f_r cos theta.
const PERCENT: f64 = 100.0;

/// Readings are mirrored at a plane where their differences are smaller by this factor than at another.
const TURNED: f64 = 5.0;

/// # Errors
///
/// The text is not such a file, or has no readings above the surface, or `options` set another angular
/// convention.
pub(super) fn read(text: Text<'_>, options: &ReadOptions) -> Result<Measurements, ReadError> {
    let why = "in exports of the RT-300S, the source is at azimuth 90 deg, and theta is counted from \
               the normal";
    let convention = options.fixed_convention(text.path, Convention::default(), why)?;
    let mut file = File::default();
    for line in text.checked_lines() {
        let (number, line) = line?;
        file.add_line(&text, number, line)?;
    }
    file.end_block();
    if file.readings.is_empty() {
        let message = if file.zero_blocks > 0 {
            "all values are 0: expected readings"
        } else {
            "has no readings: expected a line \"Raw data\", polar angles, and rows of values"
        };
        return Err(text.error(message));
    }
    if is_turned(&file.readings) {
        return Err(text.error(
            "is not in the convention of the instrument's exports: its values are mirrored at the azimuths 0 \
             and 180 deg, expected the plane of incidence at -90 and 90 deg (export the readings as a table)",
        ));
    }
    Ok(Measurements {
        source: text.path.display().to_string(),
        conversions: file.conversions(),
        metadata: file.metadata,
        convention,
        format: Format::Rt300s,
        readings: file.readings,
        ..Measurements::default()
    })
}

/// Whether the readings are mirrored at the plane across that of incidence, and not at the plane of
/// incidence, as those of every isotropic surface are.
fn is_turned(readings: &[Measurement]) -> bool {
    // The components of the view in both planes, to 1e-6.
    let place = |reading: &Measurement, along: f64, across: f64| {
        let (sin_phi, cos_phi) = reading.phi.sin_cos();
        // Zero has one sign.
        let rounded = |x: f64| ((1e6 * x).round() + 0.0).to_bits();
        let component = |x: f64| rounded(reading.theta.sin() * x);
        (
            rounded(reading.psi),
            component(along * cos_phi),
            component(across * sin_phi),
        )
    };
    let at: HashMap<_, f64> = readings
        .iter()
        .map(|reading| (place(reading, 1.0, 1.0), reading.brdf))
        .collect();
    let difference = |along: f64, across: f64| -> f64 {
        let differences = readings.iter().filter_map(|reading| {
            let mirrored = at.get(&place(reading, along, across))?;
            Some((mirrored - reading.brdf).abs())
        });
        differences.sum()
    };
    TURNED * difference(-1.0, 1.0) < difference(1.0, -1.0)
}

/// What the next line is.
#[derive(Default, PartialEq)]
enum Next {
    /// A key of a block.
    #[default]
    Key,
    /// The polar angles.
    Polars,
    /// An azimuth with values.
    Row,
}

/// What was read so far.
#[derive(Default)]
struct File {
    next: Next,
    incidence: Option<f64>,
    polars: Vec<f64>,
    /// The readings of the block, which are kept if one of them is not 0.
    block: Vec<Measurement>,
    readings: Vec<Measurement>,
    metadata: Metadata,
    samples: Vec<String>,
    zero_blocks: usize,
    not_taken: usize,
    beyond: usize,
}

impl File {
    fn add_line(&mut self, text: &Text<'_>, number: u64, line: &[u8]) -> Result<(), ReadError> {
        let Some(first) = words(line).next() else {
            // The rows of a block end with an empty line.
            if self.next == Next::Row {
                self.end_block();
            }
            return Ok(());
        };
        if first == b"DataType:" {
            self.end_block();
            return check_type(text, number, line);
        }
        match self.next {
            Next::Key => self.add_key(text, number, line),
            Next::Polars => self.add_polars(text, number, line),
            Next::Row => self.add_row(text, number, line),
        }
    }

    fn add_key(&mut self, text: &Text<'_>, number: u64, line: &[u8]) -> Result<(), ReadError> {
        let line_text = String::from_utf8_lossy(line).trim().to_owned();
        if line_text.eq_ignore_ascii_case("raw data") {
            if self.incidence.is_none() {
                let message = "Incidence is not given before Raw data: expected \"Incidence:\" and an \
                               angle in degrees";
                return Err(text.line_error(number, message));
            }
            self.next = Next::Polars;
            return Ok(());
        }
        let Some((key, value)) = line_text.split_once(':') else {
            let message = format!(
                "\"{}\": expected a key such as Incidence:, or Raw data",
                quotable(line)
            );
            return Err(text.line_error(number, message));
        };
        let value = value.trim();
        match key {
            "Incidence" => {
                let field = Field::plain(value.as_bytes());
                let expected = "expected degrees";
                let degrees = text.number(number, "Incidence", &field, expected, is_angle)?;
                self.incidence = Some(degrees);
            }
            // The angles stand at the values.
            "Polar" | "Azimuth" => {}
            "SampleID" => {
                if !self.samples.iter().any(|sample| sample == value) {
                    self.samples.push(value.to_owned());
                }
                self.add_metadata("sample", value);
            }
            _ => self.add_metadata(&key.to_lowercase(), value),
        }
        Ok(())
    }

    /// Adds the first value of a key: the blocks repeat them.
    fn add_metadata(&mut self, key: &str, value: &str) {
        if self.metadata.get(key).is_none() && !value.is_empty() {
            self.metadata.0.push((key.to_owned(), value.to_owned()));
        }
    }

    fn add_polars(&mut self, text: &Text<'_>, number: u64, line: &[u8]) -> Result<(), ReadError> {
        let angle = |word| {
            let field = Field::plain(word);
            text.number(number, "polar angle", &field, "expected degrees", is_angle)
        };
        self.polars = words(line).map(angle).collect::<Result<_, _>>()?;
        self.next = Next::Row;
        Ok(())
    }

    fn add_row(&mut self, text: &Text<'_>, number: u64, line: &[u8]) -> Result<(), ReadError> {
        let mut fields: Vec<&[u8]> = line.split(|&byte| byte == b'\t').collect();
        // Programs append tabs to make all rows as long as the longest one.
        let is_empty = |field: &&[u8]| field.trim_ascii().is_empty();
        while fields.len() > self.polars.len() + 1 && fields.last().is_some_and(is_empty) {
            fields.pop();
        }
        let Some((azimuth, values)) = fields.split_first() else {
            return Ok(());
        };
        if values.len() != self.polars.len() {
            let message = format!(
                "{} after the azimuth: expected {}, one for each polar angle",
                counted(values.len(), "value"),
                self.polars.len()
            );
            return Err(text.line_error(number, message));
        }
        let field = Field::plain(azimuth);
        let azimuth = text.number(number, "azimuth", &field, "expected degrees", is_angle)?;
        for (&polar, value) in self.polars.iter().zip(values) {
            if was_not_taken(value) {
                self.not_taken += 1;
                continue;
            }
            let (field, expected) = (Field::plain(value), "expected a value in percent");
            let value = text.number(number, "Raw data", &field, expected, is_reading)?;
            let directions = TwoDirections {
                theta_i: self.incidence.unwrap_or(0.0),
                phi_i: SOURCE_AZIMUTH,
                theta_s: polar,
                phi_s: azimuth,
            };
            match directions.in_model(AngleUnit::Degrees) {
                None => self.beyond += 1,
                Some((psi, theta, phi)) => self.block.push(Measurement {
                    wavelength_um: None,
                    psi,
                    theta,
                    phi,
                    brdf: value / (PERCENT * PI * theta.cos()),
                    sigma: None,
                }),
            }
        }
        Ok(())
    }

    /// Keeps the readings of a block, unless all are 0.
    fn end_block(&mut self) {
        if self.next != Next::Key {
            self.incidence = None;
        }
        self.next = Next::Key;
        if self.block.iter().any(|reading| reading.brdf != 0.0) {
            self.readings.append(&mut self.block);
        } else if !self.block.is_empty() {
            self.zero_blocks += 1;
            self.block.clear();
        }
    }

    /// The sentences that report what was converted and what was left out.
    fn conversions(&self) -> Vec<String> {
        let mut conversions = vec![
            "values are intensities in percent of a perfect diffuser: they are divided by 100 pi cos \
             theta"
                .to_owned(),
            "azimuths are counted from that of the source, 90 deg".to_owned(),
        ];
        if self.samples.len() > 1 {
            conversions.push(format!(
                "{} are read as one sample",
                counted(self.samples.len(), "sample ID")
            ));
        }
        if self.zero_blocks > 0 {
            conversions.push(format!(
                "{} in which all values are 0, as nothing was measured, left out",
                counted(self.zero_blocks, "block")
            ));
        }
        conversions.extend(left_out(self.not_taken, NOT_TAKEN));
        conversions.extend(left_out(self.beyond, BEYOND_HORIZON));
        conversions
    }
}

/// # Errors
///
/// A block is not reflection in the layout of the instrument's own export.
fn check_type(text: &Text<'_>, number: u64, line: &[u8]) -> Result<(), ReadError> {
    let kind = words(line).nth(1).unwrap_or_default();
    let message = match kind {
        b"BRDF(RT-300S)" => return Ok(()),
        b"BRDF(Raywiz)" => {
            "BRDF(Raywiz): the export for Raywiz cannot be read because it states the ends of its \
             angles only: expected BRDF(RT-300S)"
                .to_owned()
        }
        _ => format!(
            "\"{}\": cannot be read because the model describes reflection: expected BRDF(RT-300S)",
            quotable(kind)
        ),
    };
    Err(text.line_error(number, message))
}

#[cfg(test)]
mod tests {
    #[test]
    fn values_that_are_mirrored_at_the_wrong_plane_are_refused() {
        let block = |first: f64| {
            format!(
                "DataType:\tBRDF(RT-300S)\nIncidence:\t30\n\nRaw data\n\t-30\t0\t30\n\
                 -90\t10\t12\t{first}\n0\t11\t12\t11\n90\t{first}\t12\t10\n"
            )
        };
        let read_as = |content: &str| {
            let text = Text::new(Path::new("a.jdv"), content.as_bytes()).unwrap();
            read(text, &ReadOptions::default())
        };
        assert!(read_as(&block(20.0)).is_ok());
        // The forward side at azimuth 0, and both sides across it equal.
        let turned = "DataType:\tBRDF(RT-300S)\nIncidence:\t30\n\nRaw data\n\t-30\t0\t30\n\
                      -90\t10\t12\t10\n0\t11\t12\t20\n90\t10\t12\t10\n";
        let error = read_as(turned).unwrap_err().to_string();
        assert!(error.contains("mirrored at the azimuths 0"), "{error}");
    }

    use std::path::Path;

    use proptest::prelude::*;

    use super::*;
    use crate::scan::Side;

    const SMALL: &str = "DataType:\tBRDF(RT-300S)\t \t\rSampleID:\tpaint\t \t\rDate:\t1/2/2025\t\t\r\
        Incidence:\t30\t \t\rPolar:\t-60,60,60\t \t\rAzimuth:\t-90,90,90\t \t\r\t\t\t\rRaw data\t\t\t\r\
        \t-60\t0\t60\r-90\t10\t40\t20\r0\t12\t40\t13\r90\t21\t\t11\t\r\t\t\t\r\
        DataType:\tBRDF(RT-300S)\t \t\rSampleID:\tother\t \t\rIncidence:\t0\t \t\r\t\t\t\rRaw data\t\t\t\r\
        \t0\t90\r-90\t0\t0\r\t\t\t\r\
        DataType:\tBRDF(RT-300S)\rIncidence:\t50\rRaw data\r\t0\t90\r-90\t-3\t0\r";

    fn read_with(content: &str, options: &ReadOptions) -> Result<Measurements, ReadError> {
        read(Text::new(Path::new("a.jdv"), content.as_bytes())?, options)
    }

    fn scan(content: &str) -> Measurements {
        read_with(content, &ReadOptions::default()).unwrap()
    }

    fn error(content: &str) -> String {
        let read = read_with(content, &ReadOptions::default());
        read.unwrap_err().to_string()
    }

    #[test]
    fn values_are_relative_intensities_with_the_source_at_90_deg() {
        let scan = scan(SMALL);
        let found = |psi: f64, theta: f64, phi: f64| {
            let found = scan.readings().iter().find(|r| {
                let is = |a: f64, b: f64| (a.to_degrees() - b).abs() < 1e-9;
                is(r.psi, psi) && is(r.theta, theta) && is(r.phi, phi)
            });
            found.unwrap().brdf
        };
        let percent =
            |value: f64, theta_deg: f64| value / (100.0 * PI * theta_deg.to_radians().cos());
        assert_eq!(found(30.0, 60.0, -180.0), percent(20.0, 60.0));
        assert_eq!(found(30.0, -60.0, -180.0), percent(10.0, 60.0));
        assert_eq!(found(30.0, 60.0, 0.0), percent(11.0, 60.0));
        assert_eq!(found(50.0, 0.0, -180.0), percent(-3.0, 0.0));
        // At the azimuth of -90 deg, positive polar angles are the forward side.
        let forward = scan
            .readings()
            .iter()
            .find(|r| r.in_plane_theta() == Some(-60_f64.to_radians()));
        assert_eq!(forward.map(|r| r.brdf), Some(percent(20.0, 60.0)));
        assert_eq!(scan.wavelengths(), [None]);
    }

    #[test]
    fn what_is_left_out_is_counted() {
        let scan = scan(SMALL);
        assert_eq!(scan.readings().len(), 9);
        let said = scan.conversions.join("; ");
        assert!(said.contains("divided by 100 pi cos theta"), "{said}");
        assert!(
            said.contains("2 sample IDs are read as one sample"),
            "{said}"
        );
        assert!(said.contains("1 block in which all values are 0"), "{said}");
        assert!(said.contains("1 reading not taken"), "{said}");
        assert!(said.contains("2 readings at or beyond 90 deg"), "{said}");
        assert_eq!(scan.metadata.get("sample"), Some("paint"));
        assert_eq!(scan.metadata.get("date"), Some("1/2/2025"));
    }

    #[test]
    fn errors_name_line_and_value() {
        let with = |from: &str, to: &str| error(&SMALL.replacen(from, to, 1));
        assert_eq!(
            with("BRDF(RT", "BTDF(RT"),
            "a.jdv, line 1: \"BTDF(RT-300S)\": cannot be read because the model describes reflection: \
             expected BRDF(RT-300S)"
        );
        assert!(
            with("RT-300S", "Raywiz")
                .contains("line 1: BRDF(Raywiz): the export for Raywiz cannot")
        );
        assert!(
            with("\t30\t", "\tx\t").contains("line 4, column Incidence: \"x\" is not a number")
        );
        assert!(
            with("Incidence:", "Other:").contains("line 8: Incidence is not given before Raw data")
        );
        assert!(
            with("Raw data", "Raw").contains("line 8: \"Raw\": expected a key such as Incidence:")
        );
        assert!(with("\t-60\t0", "\t-60\ty").contains("line 9, column polar angle: \"y\""));
        assert!(with("\t12\t", "\t").contains("line 11: 2 values after the azimuth: expected 3"));
        assert!(
            with("\t12\t", "\tz\t").contains("line 11, column Raw data: \"z\" is not a number")
        );
        assert!(with("\r0\t12", "\rw\t12").contains("line 11, column azimuth: \"w\""));
        assert!(error("DataType:\tBRDF(RT-300S)\r").contains("has no readings"));
        let zero = "DataType:\tBRDF(RT-300S)\rIncidence:\t5\rRaw data\r\t0\r0\t0\r";
        assert!(error(zero).contains("all values are 0"));
    }

    #[test]
    fn the_angular_convention_cannot_be_chosen() {
        let options = ReadOptions {
            theta_positive: Some(Side::Forward),
            ..ReadOptions::default()
        };
        let error = read_with(SMALL, &options).unwrap_err().to_string();
        assert!(error.contains("the source is at azimuth 90 deg"), "{error}");
    }

    proptest! {
        #[test]
        fn damaged_files_give_an_error_or_readings_in_the_domain(
            at in any::<proptest::sample::Index>(),
            length in 0..30_usize,
            by in "[0-9.\t\r:A-Z-]{0,6}",
        ) {
            let mut text = SMALL.to_owned();
            let from = at.index(text.len());
            text.replace_range(from..(from + length).min(text.len()), &by);
            if let Ok(scan) = read_with(&text, &ReadOptions::default()) {
                for reading in scan.readings() {
                    reading.validated().unwrap();
                }
            }
        }
    }
}
