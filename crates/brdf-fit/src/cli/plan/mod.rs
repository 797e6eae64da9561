//! `brdf plan`: which angles to measure next, and when to stop.

mod arguments;
mod text;

pub(super) use arguments::Arguments;

use super::failure::Failure;
use super::outcome::{Outcome, print_failures};
use super::reading::joined;
use super::stream;
use crate::format::{listed, shortest};
use crate::output::{print_note, print_text};
use crate::planning::{PlanError, plan_readings, review};
use crate::read::LazyScan;
use crate::scan::{Measurements, WAVELENGTH_TOLERANCE};

pub(super) fn run(arguments: &Arguments) -> Outcome {
    print_failures(arguments.plan().err())
}

impl Arguments {
    fn plan(&self) -> Result<(), Failure> {
        let inputs = self.files.iter().map(|path| ("FILE", path.as_path()));
        let outputs = [("--csv", &self.csv), ("--list", &self.list)];
        let outputs = outputs.into_iter();
        let outputs: Vec<_> = outputs
            .filter_map(|(name, path)| Some((name, path.as_deref()?)))
            .collect();
        stream::check(inputs, outputs.iter().copied(), None)?;
        let options = self.options()?;
        let scan = self.scan()?;
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
        let name = scan.as_ref().map(|scan| scan.name.as_str());
        let summary = text::summary(&plan, name, &options);
        if outputs.iter().any(|(_, path)| stream::is_stream(path)) {
            print_note(&summary);
            return Ok(());
        }
        let list = text::list(&plan, &options);
        print_text(&format!("{summary}{list}")).map_err(Failure::Print)
    }

    /// The scan so far, of the one wavelength or that of `--wavelength`; `None` without a file.
    fn scan(&self) -> Result<Option<Scan>, Failure> {
        let options = self.reading.options();
        let mut scans = Vec::new();
        for path in &self.files {
            scans.extend(stream::scans(path, &options)?);
        }
        let name = match &self.files[..] {
            [] => return Ok(None),
            [path] => stream::shown(path).display().to_string(),
            files if !self.reading.join => return Err(Failure::SeveralFiles(files.len())),
            files => {
                scans = joined(scans)?;
                let names = files
                    .iter()
                    .map(|path| stream::shown(path).display().to_string());
                listed(&names.collect::<Vec<_>>(), ", ")
            }
        };
        self.chosen(scans, &name)
            .map(Some)
            .map_err(|failure| failure.at(name))
    }

    /// The scan of the one wavelength or that of `--wavelength`.
    fn chosen(&self, scans: Vec<LazyScan>, name: &str) -> Result<Scan, Failure> {
        let wavelengths = scans.iter().filter_map(LazyScan::wavelength_um);
        let found: Vec<String> = wavelengths.map(shortest).collect();
        let count = scans.len();
        let chosen = match self.wavelength {
            None if count > 1 => return Err(PlanError::Wavelengths(count).into()),
            None => scans.into_iter().next(),
            Some(wavelength) => nearest(scans, wavelength),
        };
        let Some(chosen) = chosen else {
            let wavelength_um = self.wavelength.unwrap_or(f64::NAN);
            return Err(Failure::NoScan {
                wavelength_um,
                found,
            });
        };
        let name = match chosen.wavelength_um() {
            Some(um) => format!("{name} at {} um", shortest(um)),
            None => name.to_owned(),
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
