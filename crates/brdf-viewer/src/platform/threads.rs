//! What works beside the window.

use crate::events::EventSender;
use crate::job::Job;

/// Carries out jobs beside the window. Dropping it cancels the fits.
pub trait Threads: Sized {
    /// Starts the threads, which answer with events.
    fn new(events: EventSender) -> Self;

    /// Queues a job. Fits are made one after the other.
    fn start(&self, job: Job);

    /// Ends the fits whose cancellation was requested, where they cannot notice it themselves. It is
    /// called in each frame.
    fn end_cancelled(&self);
}
