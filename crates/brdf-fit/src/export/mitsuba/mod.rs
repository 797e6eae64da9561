//! Mitsuba 3 (<https://mitsuba.readthedocs.io>): a BSDF plugin in Python, and a scene that shows the
//! material on a sphere.
//!
//! In Mitsuba's terms: `eval` is f_r cos theta in 1/sr, wi the direction of the viewer and wo that of
//! the source, which the reciprocal f_r may exchange; directions are in the frame of the surface, z
//! its normal. The BRDFs of the colours are drawn from with equal probability, so that the density is
//! the mean of theirs.

use std::io::{self, Write};

use super::material::{Fitted, Material};
use super::rgb::COLOURS;
use super::source::python::drjit;
use super::source::{Source, check_name};
use super::target::{ExportError, ExportOptions};

const HEAD: &str = include_str!("head.py");
const PLUGIN: &str = include_str!("plugin.py");
const SCENE: &str = include_str!("scene.xml");

/// Writes the plugin.
pub(super) fn write_plugin(
    coating: &Material,
    options: &ExportOptions,
    writer: &mut dyn Write,
) -> Result<(), ExportError> {
    check_name(&options.name)?;
    let lobes = Lobes::of(coating.rgb(options.rgb)?);
    write!(writer, "{}", HEAD.replace("@NAME@", &options.name))?;
    for (lobe, fit) in &lobes.distinct {
        write!(writer, "\n{}\n", drjit(&Source::new(lobe, fit)?))?;
    }
    lobes.write(writer)?;
    write!(writer, "\n\n{PLUGIN}")?;
    Ok(())
}

/// Writes the scene.
pub(super) fn write_scene(options: &ExportOptions, writer: &mut dyn Write) -> io::Result<()> {
    writer.write_all(SCENE.replace("@NAME@", &options.name).as_bytes())
}

/// The BRDFs of red, green and blue.
struct Lobes<'a> {
    /// Each once, with a name.
    distinct: Vec<(&'static str, &'a Fitted)>,
    /// The names of those of red, green and blue.
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

    /// Writes what of the formulas the plugin calls.
    fn write(&self, writer: &mut dyn Write) -> io::Result<()> {
        for (of, _) in &self.distinct {
            writeln!(writer, "\n{} = Lobe(", of.to_uppercase())?;
            writeln!(writer, "    value={of}_of_directions,")?;
            writeln!(writer, "    lambertian={of}_KD / {of}_PI,")?;
            writeln!(writer, "    specular_weight={of}_specular_weight,")?;
            writeln!(writer, "    mirrored_density={of}_mirrored_density,")?;
            writeln!(writer, "    draw={of}_draw,\n)")?;
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
    use brdf_core::{AnyBrdf, Family, ModelParameters, Parameters};

    use super::*;

    fn fitted(file: &str, kd: f64) -> Fitted {
        let at = ModelParameters::three(Parameters::new(0.3, kd, 0.2).unwrap(), 1.5);
        Fitted {
            file: file.to_owned(),
            wavelength_um: None,
            brdf: AnyBrdf::new(Family::Paper, &at).unwrap(),
            e_percent: 1.0,
            psi_max_deg: 70.0,
        }
    }

    #[test]
    fn each_fit_stands_once() {
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
        let coating = Material {
            fits: vec![fitted(file, 0.1)],
        };
        let options = ExportOptions {
            name: name.to_owned(),
            ..ExportOptions::default()
        };
        let mut bytes = Vec::new();
        write_plugin(&coating, &options, &mut bytes)?;
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
    fn a_name_that_is_none_is_refused() {
        for name in ["", "two words", "\"", "<a>", "1st"] {
            assert!(
                matches!(plugin(name, "scan.csv"), Err(ExportError::Name(_))),
                "{name}"
            );
        }
    }
}
