//! The threads of the system.

use std::sync::mpsc::{Sender, channel};
use std::thread;

use crate::cancel::CancelFlag;
use crate::events::EventSender;
use crate::job::{FileJob, FitJobs, Job};
use crate::platform::Threads;
use crate::worker::{fit_all, work_on_file};

/// One thread that opens and writes files, and one that fits.
pub struct NativeThreads {
    files: Sender<FileJob>,
    fits: Sender<FitJobs>,
    closing: CancelFlag,
}

impl Threads for NativeThreads {
    fn new(events: EventSender) -> Self {
        let (files, file_jobs) = channel::<FileJob>();
        let answers = events.clone();
        thread::spawn(move || {
            for job in file_jobs {
                answers.send(work_on_file(job));
            }
        });
        let (fits, fit_jobs) = channel::<FitJobs>();
        let closing = CancelFlag::default();
        let cancel = closing.clone();
        thread::spawn(move || {
            for jobs in fit_jobs {
                fit_all(jobs, &cancel, &events);
            }
        });
        Self {
            files,
            fits,
            closing,
        }
    }

    fn start(&self, job: Job) {
        // Sending cannot fail: the threads run until the queues are dropped.
        match job {
            Job::Fit(jobs) => {
                let _ = self.fits.send(jobs);
            }
            Job::File(job) => {
                let _ = self.files.send(job);
            }
        }
    }

    /// The fits notice it themselves.
    fn end_cancelled(&self) {}
}

impl Drop for NativeThreads {
    fn drop(&mut self) {
        self.closing.cancel();
    }
}
