//! The worker: carries out the jobs that take longer than a frame.
//!
//! One thread opens and writes files, another one fits. Both only call `brdf_fit`, so that their
//! numbers are those of the command line.

mod events;
mod fit;
mod open;
mod panics;
mod write;

use std::error::Error;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use crate::cancel::CancelFlag;
use crate::job::{Event, FileJob, FitJobs, Job, Output};
use panics::catch_panics;

pub use events::EventSender;

/// The threads of the worker. Dropping it cancels the fits.
pub struct Worker {
    files: Sender<FileJob>,
    fits: Sender<FitJobs>,
    events: EventSender,
    receiver: Receiver<Event>,
    closing: CancelFlag,
}

impl Worker {
    /// Starts the threads. `wake` is called after each event.
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> Self {
        let (sender, receiver) = channel();
        let events = EventSender::new(sender, wake);
        let (files, file_jobs) = channel::<FileJob>();
        let answers = events.clone();
        thread::spawn(move || {
            for job in file_jobs {
                answers.send(work_on_file(job));
            }
        });
        let (fits, fit_jobs) = channel::<FitJobs>();
        let closing = CancelFlag::default();
        let (answers, cancel) = (events.clone(), closing.clone());
        thread::spawn(move || {
            for jobs in fit_jobs {
                fit::fit_all(jobs, &cancel, &answers);
            }
        });
        Self {
            files,
            fits,
            events,
            receiver,
            closing,
        }
    }

    /// Queues a job.
    pub fn start(&self, job: Job) {
        // Sending cannot fail: the threads run until the queues are dropped with the worker.
        match job {
            Job::Fit(jobs) => {
                let _ = self.fits.send(jobs);
            }
            Job::File(job) => {
                let _ = self.files.send(job);
            }
        }
    }

    /// A sender of events, for dialogs.
    pub fn events(&self) -> EventSender {
        self.events.clone()
    }

    /// Removes and returns the events so far.
    pub fn take_events(&self) -> Vec<Event> {
        self.receiver.try_iter().collect()
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.closing.cancel();
    }
}

fn work_on_file(job: FileJob) -> Event {
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
    }
}

/// Runs a job, and turns a panic into an error.
fn run<T, E: Error + 'static>(job: impl FnOnce() -> Result<T, E>) -> Result<T, Box<dyn Error>> {
    Ok(catch_panics(job)??)
}
