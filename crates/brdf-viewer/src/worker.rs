//! What takes longer than a frame: reading, fitting and writing, each on a thread of its own.
//!
//! It calls `brdf_fit` and nothing else, so that the numbers are those of the command line.

use std::any::Any;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use brdf_fit::progress::{Observer, Step};
use brdf_fit::report::{Depth, ModelChoice, Report};

use crate::job::{Event, FitJob, Job, Stop};
use crate::state::sample::ScanId;
use crate::{reading, writing};

/// Where events go; the window is woken for each.
#[derive(Clone)]
pub struct Events {
    to: Sender<Event>,
    wake: Arc<dyn Fn() + Send + Sync>,
}

impl Events {
    /// Sends an event. Where nobody listens any more, nobody needs it.
    pub fn send(&self, event: Event) {
        let _ = self.to.send(event);
        (self.wake)();
    }
}

/// The threads that work.
pub struct Worker {
    files: Sender<Job>,
    fits: Sender<(Vec<FitJob>, Depth)>,
    events: Events,
    from: Receiver<Event>,
    closing: Stop,
}

impl Worker {
    /// Starts the threads. `wake` is called when there is an event to look at.
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> Self {
        let (to, from) = channel();
        let wake = Arc::new(wake);
        let events = Events { to, wake };
        let (files, file_jobs) = channel::<Job>();
        let (fits, fit_jobs) = channel::<(Vec<FitJob>, Depth)>();
        let answers = events.clone();
        thread::spawn(move || {
            for job in file_jobs {
                answers.send(work_on_file(job));
            }
        });
        let (answers, closing) = (events.clone(), Stop::default());
        let ended = closing.clone();
        thread::spawn(move || {
            for (jobs, depth) in fit_jobs {
                fit_all(jobs, depth, &ended, &answers);
            }
        });
        Self {
            files,
            fits,
            events,
            from,
            closing,
        }
    }

    /// Gives work to a thread.
    pub fn start(&self, job: Job) {
        // A thread ends with its queue only, so that someone takes the job.
        match job {
            Job::Fit(jobs, depth) => {
                let _ = self.fits.send((jobs, depth));
            }
            job => {
                let _ = self.files.send(job);
            }
        }
    }

    /// Where others than the worker send events.
    pub fn events(&self) -> Events {
        self.events.clone()
    }

    /// What has happened since the last time.
    pub fn take_events(&self) -> Vec<Event> {
        self.from.try_iter().collect()
    }
}

/// Ends what runs.
impl Drop for Worker {
    fn drop(&mut self) {
        self.closing.ask();
    }
}

/// Hands the steps of a fit on, and stops it.
struct Follow<'a> {
    scan: ScanId,
    stops: [&'a Stop; 2],
    events: &'a Events,
}

impl Follow<'_> {
    fn is_stopped(&self) -> bool {
        self.stops.iter().any(|stop| stop.is_asked())
    }
}

impl Observer for Follow<'_> {
    fn step(&self, step: &Step) -> ControlFlow<()> {
        self.events.send(Event::Step(self.scan, *step));
        if self.is_stopped() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

fn fit_all(jobs: Vec<FitJob>, depth: Depth, closing: &Stop, events: &Events) {
    for job in jobs {
        let observer = Follow {
            scan: job.scan,
            stops: [&job.stop, closing],
            events,
        };
        if observer.is_stopped() {
            continue;
        }
        let result = unbroken(|| {
            let choice = ModelChoice::Given;
            Report::observed(&job.measurements, &job.options, choice, depth, &observer).0
        });
        if observer.is_stopped() {
            continue;
        }
        events.send(match result {
            Ok(report) => Event::Fitted(job.scan, Box::new(report)),
            Err(words) => Event::Broken(job.scan, format!("{}: {words}", job.measurements.source)),
        });
    }
    events.send(Event::FitsEnded);
}

fn work_on_file(job: Job) -> Event {
    match job {
        Job::Read(path, convention) => {
            match unbroken(|| reading::read(&path, convention)).flatten() {
                Ok(opened) => Event::Opened(Some(path), opened),
                Err(error) => Event::NotOpened(error),
            }
        }
        Job::ReadBytes(name, bytes, convention) => {
            match unbroken(|| reading::read_bytes(&name, &bytes, convention)).flatten() {
                Ok(opened) => Event::Opened(None, vec![opened]),
                Err(error) => Event::NotOpened(error),
            }
        }
        Job::Write(path, what) => match unbroken(|| writing::write(&path, &what)).flatten() {
            Ok(()) => Event::Written(path),
            Err(error) => Event::NotWritten(error),
        },
        Job::Fit(..) => Event::NotOpened("a fit is no work for this thread".to_owned()),
    }
}

/// What a piece of work gives. A mistake in the program ends the piece and is told; the thread goes
/// on, so that nobody waits for it without end.
fn unbroken<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|cause| {
        let words = in_words(cause.as_ref());
        format!("broke off by a mistake in the program: {words}")
    })
}

fn in_words(cause: &(dyn Any + Send)) -> &str {
    let text = cause.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| cause.downcast_ref::<&str>().copied())
        .unwrap_or("without words")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_that_breaks_is_told_in_its_words() {
        assert_eq!(unbroken(|| 3), Ok(3));
        let number = 7;
        for (error, words) in [
            (unbroken(|| panic!("no such thing")), "no such thing"),
            (unbroken(|| panic!("thing {number}")), "thing 7"),
        ] {
            let error: Result<(), String> = error;
            assert!(error.unwrap_err().ends_with(words));
        }
    }
}
