//! Mitsuba 3 (<https://mitsuba.readthedocs.io>): a BSDF plugin in Python, and a scene that shows
//! the material on a sphere as its companion file.
//!
//! In Mitsuba, `eval` is f_r cos theta in 1/sr, wi the direction to the viewer and wo that to the
//! source (f_r is reciprocal, so they may be exchanged); directions are in the frame of the surface
//! with z along its normal. The plugin samples the BRDFs of the colours with equal probability; its
//! density is the mean of their densities.

use std::io::{self, Write};

use super::error::ExportError;
use super::material::{Fitted, Material};
use super::options::ExportOptions;
use super::rgb::COLOURS;
use super::source::{Source, check_name, dr_jit_functions};

const HEAD: &str = include_str!("head.py");
const PLUGIN: &str = include_str!("plugin.py");
const SCENE: &str = include_str!("scene.xml");

/// Writes the plugin.
///
/// # Errors
///
/// The name cannot be used in source code; there is no fit for a colour; writing fails.
pub(super) fn write_plugin(
    material: &Material,
    options: &ExportOptions,
    writer: &mut dyn Write,
) -> Result<(), ExportError> {
    check_name(&options.name)?;
    let lobes = Lobes::of(material.rgb(options.rgb)?);
    write!(writer, "{}", HEAD.replace("@NAME@", &options.name))?;
    for (lobe, fit) in &lobes.distinct {
        write!(writer, "\n{}\n", dr_jit_functions(&Source::new(lobe, fit)?))?;
    }
    lobes.write(writer)?;
    write!(writer, "\n\n{PLUGIN}")?;
    Ok(())
}

/// Writes the scene.
///
/// # Errors
///
/// Writing fails.
pub(super) fn write_scene(options: &ExportOptions, writer: &mut dyn Write) -> io::Result<()> {
    writer.write_all(SCENE.replace("@NAME@", &options.name).as_bytes())
}

/// The BRDFs of red, green and blue.
struct Lobes<'a> {
    /// The distinct ones among them, with their names.
    distinct: Vec<(&'static str, &'a Fitted)>,
    /// For red, green and blue the name of its BRDF.
    channels: [&'static str; 3],
}

impl<'a> Lobes<'a> {
    fn of(fits: [&'a Fitted; 3]) -> Self {
        if fits.iter().all(|fit| *fit == fits[0]) {
            return Self {
                distinct: vec![("grey", fits[0])],
                channels: ["grey"; 3],
            };
        }
        let mut distinct: Vec<(&str, &Fitted)> = Vec::new();
        let mut channels = COLOURS;
        for (channel, fit) in channels.iter_mut().zip(fits) {
            match distinct.iter().find(|(_, other)| *other == fit) {
                Some((first, _)) => *channel = first,
                None => distinct.push((channel, fit)),
            }
        }
        Self { distinct, channels }
    }

    /// Writes the objects through which the plugin calls the functions of the BRDFs.
    fn write(&self, writer: &mut dyn Write) -> io::Result<()> {
        for (name, _) in &self.distinct {
            writeln!(writer, "\n{} = Lobe(", name.to_uppercase())?;
            writeln!(writer, "    value={name}_of_directions,")?;
            writeln!(writer, "    lambertian={name}_KD / {name}_PI,")?;
            writeln!(writer, "    specular_weight={name}_specular_weight,")?;
            writeln!(writer, "    mirrored_density={name}_mirrored_density,")?;
            writeln!(writer, "    draw={name}_draw,\n)")?;
        }
        let lobes = self.distinct.iter().map(|(lobe, _)| lobe.to_uppercase());
        let lobes: Vec<_> = lobes.collect();
        let channels = self.channels.map(str::to_uppercase);
        writeln!(writer, "\nLOBES = [{}]", lobes.join(", "))?;
        writeln!(writer, "CHANNELS = [{}]", channels.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::test_fits::of_paper;

    fn fitted(file: &str, kd: f64) -> Fitted {
        Fitted {
            file: file.to_owned(),
            ..of_paper([0.3, kd, 0.2, 1.5])
        }
    }

    #[test]
    fn each_distinct_fit_is_written_once() {
        let fits = [0.1, 0.2, 0.3].map(|kd| fitted("scan.csv", kd));
        let [a, b, c] = fits.each_ref();
        let lobes = |fits| {
            let lobes = Lobes::of(fits);
            let names: Vec<_> = lobes.distinct.iter().map(|(name, _)| *name).collect();
            (names, lobes.channels)
        };
        assert_eq!(lobes([a, a, a]), (vec!["grey"], ["grey"; 3]));
        assert_eq!(lobes([a, b, c]), (COLOURS.to_vec(), COLOURS));
        let two = (vec!["red", "blue"], ["red", "red", "blue"]);
        assert_eq!(lobes([a, a, b]), two);
        let two = (vec!["red", "green"], ["red", "green", "red"]);
        assert_eq!(lobes([a, b, a]), two);
    }

    fn plugin(name: &str, file: &str) -> Result<String, ExportError> {
        let material = Material {
            fits: vec![fitted(file, 0.1)],
        };
        let options = ExportOptions {
            name: name.to_owned(),
            ..ExportOptions::default()
        };
        let mut bytes = Vec::new();
        write_plugin(&material, &options, &mut bytes)?;
        Ok(String::from_utf8(bytes).unwrap())
    }

    #[test]
    fn the_name_of_a_scan_stays_in_its_comment() {
        let text = plugin("brdf", "a\nimport os\r\"\"\"#").unwrap();
        let lines: Vec<_> = text
            .lines()
            .filter(|line| line.contains("import os"))
            .collect();
        assert_eq!(lines.len(), 1);
        assert!(lines[0].starts_with("# ") && !text.contains('\r'));
    }

    #[test]
    fn a_name_that_is_no_identifier_is_refused() {
        for name in ["", "two words", "\"", "<a>", "1st"] {
            assert!(
                matches!(plugin(name, "scan.csv"), Err(ExportError::Name(_))),
                "{name}"
            );
        }
    }
}
