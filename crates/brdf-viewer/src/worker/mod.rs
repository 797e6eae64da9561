//! The worker: carries out the jobs that take longer than a frame, beside the window: see
//! [`Threads`](crate::platform::Threads).
//!
//! It only calls `brdf_fit`, so that its numbers are those of the command line.

mod fit;
mod open;
mod panics;
mod write;

use std::error::Error;

use brdf_fit::planning::{PlanOptions, plan_readings};

use crate::job::{Event, FileJob, Output};
use panics::catch_panics;

pub use fit::{fit_all, report};
pub use open::extensions;

/// Opens or writes a file, and answers with an event.
pub fn work_on_file(job: FileJob) -> Event {
    match job {
        FileJob::Open(path, convention) => match run(|| open::open(&path, convention)) {
            Ok(opened) => Event::Opened(Some(path), opened),
            Err(error) => Event::OpenFailed(error.to_string()),
        },
        FileJob::OpenBytes(name, bytes, convention) => {
            match run(|| open::open_bytes(&name, &bytes, convention)) {
                Ok(opened) => Event::Opened(None, vec![opened]),
                Err(error) => Event::OpenFailed(error.to_string()),
            }
        }
        FileJob::Draw(drawing) => match run(|| write::pixels(&drawing)) {
            Ok(image) => Event::Drawn(image),
            Err(error) => Event::WriteFailed(error.to_string()),
        },
        FileJob::Write(path, output) => match run(|| write::write(&path, &output)) {
            Ok(()) => {
                let saved = match output {
                    Output::Fit(_, samples) => samples,
                    _ => Vec::new(),
                };
                Event::Written(path, saved)
            }
            Err(error) => Event::WriteFailed(error.to_string()),
        },
        FileJob::Plan(scan, measurements) => {
            let options = PlanOptions::default().within(&measurements);
            let plan = run(|| plan_readings(Some(&measurements), &options));
            let plan = plan.map(Box::new).map_err(|error| error.to_string());
            Event::Planned(scan, measurements, plan)
        }
    }
}

/// Runs a job, and turns a panic into an error.
fn run<T, E: Error + 'static>(job: impl FnOnce() -> Result<T, E>) -> Result<T, Box<dyn Error>> {
    Ok(catch_panics(job)??)
}
