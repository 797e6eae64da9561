//! `brdf plan`: which angles to measure next, and when to stop.

mod arguments;
mod text;

pub(super) use arguments::Arguments;

use std::path::Path;

use super::failure::Failure;
use super::outcome::{Outcome, print_failures};
use super::stream;
use crate::format::shortest;
use crate::output::print_text;
use crate::planning::{plan_readings, review};
use crate::read::{LazyScan, ReadOptions};
use crate::scan::{Measurements, WAVELENGTH_TOLERANCE};

pub(super) fn run(arguments: &Arguments) -> Outcome {
    print_failures(arguments.plan().err())
}

impl Arguments {
    fn plan(&self) -> Result<(), Failure> {
        let input = self.file.as_deref().map(|path| ("FILE", path));
        let outputs = [("--csv", &self.csv), ("--list", &self.list)];
        let outputs = outputs.into_iter();
        let outputs: Vec<_> = outputs
            .filter_map(|(name, path)| Some((name, path.as_deref()?)))
            .collect();
        stream::check(input, outputs.iter().copied(), None)?;
        let options = self.options()?;
        let scan = self
            .file
            .as_deref()
            .map(|path| self.scan(path))
            .transpose()?;
        if let (true, Some(scan)) = (self.review, &scan) {
            let review = review(&scan.measurements, &options)?;
            let text = text::review(&review, &scan.measurements, &scan.name, &options);
            return print_text(&text).map_err(Failure::Print);
        }
        let so_far = scan.as_ref().map(|scan| &scan.measurements);
        let plan = plan_readings(so_far, &options)?;
        if let Some(path) = &self.csv {
            stream::write(path, |writer| writer.write_all(plan.csv(so_far).as_bytes()))?;
        }
        if let Some(path) = &self.list {
            stream::write(path, |writer| writer.write_all(plan.list().as_bytes()))?;
        }
        if outputs.iter().any(|(_, path)| stream::is_stream(path)) {
            return Ok(());
        }
        let name = scan.as_ref().map(|scan| scan.name.as_str());
        print_text(&text::plan(&plan, name, &options)).map_err(Failure::Print)
    }

    /// The scan so far, of the one wavelength or that of `--wavelength`.
    fn scan(&self, path: &Path) -> Result<Scan, Failure> {
        let scans = stream::scans(path, &ReadOptions::default())?;
        let name = |um: Option<f64>| um.map_or_else(|| "no wavelength".to_owned(), shortest);
        let found: Vec<String> = scans
            .iter()
            .map(|scan| name(scan.wavelength_um()))
            .collect();
        let chosen = match self.wavelength {
            None if scans.len() > 1 => {
                let several = crate::planning::PlanError::Wavelengths(scans.len());
                return Err(Failure::from(several).in_file(path));
            }
            None => scans.into_iter().next(),
            Some(wavelength) => nearest(scans, wavelength),
        };
        let Some(chosen) = chosen else {
            let wavelength_um = self.wavelength.unwrap_or(f64::NAN);
            return Err(Failure::NoScan {
                wavelength_um,
                found,
            }
            .in_file(path));
        };
        let shown = stream::shown(path).display();
        let name = match chosen.wavelength_um() {
            Some(um) => format!("{shown} at {} um", shortest(um)),
            None => shown.to_string(),
        };
        let measurements = chosen.measurements()?.into_owned();
        Ok(Scan { measurements, name })
    }
}

/// The scan of the nearest wavelength within the tolerance.
fn nearest(scans: Vec<LazyScan>, wavelength: f64) -> Option<LazyScan> {
    let apart = |scan: &LazyScan| {
        let own = scan.wavelength_um().unwrap_or(f64::INFINITY);
        (own - wavelength).abs() / wavelength
    };
    let near = scans
        .into_iter()
        .filter(|scan| apart(scan) <= WAVELENGTH_TOLERANCE);
    near.min_by(|a, b| apart(a).total_cmp(&apart(b)))
}

/// A scan of one wavelength with its name.
struct Scan {
    measurements: Measurements,
    name: String,
}
