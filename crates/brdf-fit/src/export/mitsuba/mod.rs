//! Mitsuba 3 (<https://mitsuba.readthedocs.io>): a BSDF plugin in Python, and a scene that shows the
//! material on a sphere.
//!
//! In Mitsuba's terms: `eval` is f_r cos theta in 1/sr, wi the direction of the viewer and wo that of
//! the source, which the reciprocal f_r may exchange; directions are in the frame of the surface, z
//! its normal. The BRDFs of the colours are drawn from with equal probability, so that the density is
//! the mean of theirs.

use std::io::{self, Write};

use super::coating::{Coating, Fitted};
use super::rgb::COLOURS;
use super::source::python::drjit;
use super::source::{Source, check_name};
use super::target::{ExportError, ExportOptions};

const HEAD: &str = include_str!("head.py");
const PLUGIN: &str = include_str!("plugin.py");
const SCENE: &str = include_str!("scene.xml");

/// Writes the plugin.
pub(super) fn write_plugin(
    coating: &Coating,
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
        writeln!(writer, "LOBES = [{}]", lobes.join(", "))?;
        writeln!(writer, "CHANNELS = [{}]", channels.join(", "))
    }
}
