//! Mitsuba 3 (<https://mitsuba.readthedocs.io>): a BSDF plugin in Python, and a scene that shows the
//! material on a sphere.
//!
//! In Mitsuba's terms: `eval` is f_r cos theta in 1/sr, wi the direction of the viewer and wo that of
//! the source, which the reciprocal f_r may exchange; directions are in the frame of the surface,
//! z its normal. One channel's lobes are chosen with equal probability, so that the density is the
//! mean of theirs; [`Sampler`] has the rest.

use std::io::{self, Write};

use brdf_core::{AnyBrdf, Sampler};

use super::coating::{Coating, Fitted};
use super::rgb::COLOURS;
use super::target::{ExportError, ExportOptions};

const FORMULAS: &str = include_str!("formulas.py");
const PLUGIN: &str = include_str!("plugin.py");
const SCENE: &str = include_str!("scene.xml");

/// Writes the plugin.
pub(super) fn write_plugin(
    coating: &Coating,
    options: &ExportOptions,
    writer: &mut dyn Write,
) -> Result<(), ExportError> {
    let fits = coating.rgb(options.rgb)?;
    write_head(&fits, &options.name, writer)?;
    write!(writer, "{FORMULAS}\n\n")?;
    write_lobes(&fits.map(|fit| fit.brdf), writer)?;
    write!(writer, "\n\n{PLUGIN}")?;
    Ok(())
}

/// Writes the scene.
pub(super) fn write_scene(options: &ExportOptions, writer: &mut dyn Write) -> io::Result<()> {
    writer.write_all(SCENE.replace("@NAME@", &options.name).as_bytes())
}

/// What the plugin is of, and what it needs.
fn write_head(fits: &[&Fitted; 3], name: &str, writer: &mut dyn Write) -> io::Result<()> {
    writeln!(writer, "# A fitted coating as a BSDF plugin of Mitsuba 3:")?;
    for (colour, fit) in COLOURS.iter().zip(fits) {
        let wavelength = fit.wavelength_um.map(|um| format!("{um} um of "));
        let wavelength = wavelength.unwrap_or_default();
        // A file's name may have anything in it: it is quoted.
        writeln!(
            writer,
            "#   {colour}: {wavelength}{:?}, E = {:.3} %, readings up to psi = {} deg",
            fit.file, fit.e_percent, fit.psi_max_deg
        )?;
    }
    writeln!(writer, "NAME = \"{name}\"\n\n")
}

/// The BRDFs of red, green and blue, each once.
fn write_lobes(channels: &[AnyBrdf; 3], writer: &mut dyn Write) -> io::Result<()> {
    let mut distinct: Vec<&AnyBrdf> = Vec::new();
    for channel in channels {
        if !distinct.contains(&channel) {
            distinct.push(channel);
        }
    }
    writeln!(writer, "LOBES = [")?;
    for brdf in &distinct {
        write_lobe(brdf, writer)?;
    }
    writeln!(writer, "]")?;
    let place = |channel: &AnyBrdf| distinct.iter().position(|brdf| *brdf == channel);
    let [red, green, blue] = channels
        .each_ref()
        .map(|channel| place(channel).unwrap_or(0));
    writeln!(
        writer,
        "CHANNELS = [LOBES[{red}], LOBES[{green}], LOBES[{blue}]]"
    )
}

fn write_lobe(brdf: &AnyBrdf, writer: &mut dyn Write) -> io::Result<()> {
    let at = brdf.model_parameters();
    let family = serde_json::to_string(&brdf.family())?;
    let weights = Sampler::new(brdf);
    writeln!(
        writer,
        "    Lobe({family}, {:?}, {:?}, {:?}, {:?}, {:?}, {:?}),",
        at.k2,
        at.kd,
        at.k1,
        at.n,
        at.p,
        weights.specular_weights()
    )
}
