//! The worker of the browser, which fits beside the page. Files are read and written by the page itself, because
//! they are in its memory.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use brdf_fit::report::Depth;
use wasm_bindgen::closure::Closure;
use wasm_bindgen::{JsCast as _, JsValue};
use web_sys::{MessageEvent, Worker, WorkerOptions, WorkerType};

use super::order::{Answer, order};
use crate::events::EventSender;
use crate::job::{Event, FitJob, Job};
use crate::platform::Threads;
use crate::worker::work_on_file;

/// The script of the worker, which starts this program. It finds no window there, and serves.
const SCRIPT: &str = "worker.js";

/// The worker of the browser with the fits that wait for it.
pub struct WebWorker {
    events: EventSender,
    fits: Rc<RefCell<Fits>>,
}

/// The fits, and the worker that makes them.
struct Fits {
    events: EventSender,
    queue: VecDeque<Queued>,
    current: Option<(Box<FitJob>, Depth)>,
    worker: Option<Running>,
}

/// An entry of the queue.
enum Queued {
    Fit(Box<FitJob>, Depth),
    /// The end of a run, by its number.
    End(u64),
}

/// A worker that was started. It ends when this is dropped.
struct Running {
    worker: Worker,
    is_ready: bool,
    /// The functions that the browser calls.
    _listeners: [Closure<dyn FnMut(MessageEvent)>; 2],
}

impl Threads for WebWorker {
    fn new(events: EventSender) -> Self {
        let fits = Rc::new(RefCell::new(Fits {
            events: events.clone(),
            queue: VecDeque::new(),
            current: None,
            worker: None,
        }));
        // It takes a moment to start, and is ready when the first fit is asked for.
        start_worker(&fits);
        Self { events, fits }
    }

    fn start(&self, job: Job) {
        match job {
            Job::File(job) => self.events.send(work_on_file(job)),
            Job::Fit(jobs) => {
                let fits = jobs.fits.into_iter();
                let fits = fits.map(|job| Queued::Fit(Box::new(job), jobs.depth));
                let end = Queued::End(jobs.run);
                self.fits.borrow_mut().queue.extend(fits.chain([end]));
                go_on(&self.fits);
            }
        }
    }

    /// A worker does not listen while it fits: it is ended, and another one is started.
    fn end_cancelled(&self) {
        let is_cancelled = |(job, _): &(Box<FitJob>, Depth)| job.cancel.is_cancelled();
        if self
            .fits
            .borrow()
            .current
            .as_ref()
            .is_some_and(is_cancelled)
        {
            let mut fits = self.fits.borrow_mut();
            (fits.current, fits.worker) = (None, None);
            drop(fits);
            go_on(&self.fits);
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.worker.set_onmessage(None);
        self.worker.set_onerror(None);
        self.worker.terminate();
    }
}

/// Starts a worker in place of the one before.
fn start_worker(fits: &Rc<RefCell<Fits>>) {
    let options = WorkerOptions::new();
    options.set_type(WorkerType::Module);
    let Ok(worker) = Worker::new_with_options(SCRIPT, &options) else {
        return;
    };
    let (of_answers, of_errors) = (Rc::clone(fits), Rc::clone(fits));
    let answered = Closure::<dyn FnMut(MessageEvent)>::new(move |message: MessageEvent| {
        let text = message.data().as_string().unwrap_or_default();
        let answer = serde_json::from_str(&text);
        let unreadable = |error| Answer::Aborted(format!("internal error: {error}"));
        take(&of_answers, answer.unwrap_or_else(unreadable));
    });
    let failed = Closure::<dyn FnMut(MessageEvent)>::new(move |error: MessageEvent| {
        // It does not end the page.
        error.prevent_default();
        let message = "the worker of the browser ended: its memory may be exhausted".to_owned();
        take(&of_errors, Answer::Aborted(message));
    });
    worker.set_onmessage(Some(answered.as_ref().unchecked_ref()));
    worker.set_onerror(Some(failed.as_ref().unchecked_ref()));
    fits.borrow_mut().worker = Some(Running {
        worker,
        is_ready: false,
        _listeners: [answered, failed],
    });
}

/// Takes over an answer of the worker.
fn take(fits: &Rc<RefCell<Fits>>, answer: Answer) {
    let events = fits.borrow().events.clone();
    let scan = fits.borrow().current.as_ref().map(|(job, _)| job.scan);
    match (answer, scan) {
        (Answer::Ready, _) => {
            let mut fits = fits.borrow_mut();
            if let Some(running) = &mut fits.worker {
                running.is_ready = true;
            }
            fits.order();
        }
        (Answer::Step(step), Some(scan)) => events.send(Event::Step(scan, step)),
        (Answer::Found(report), Some(scan)) => events.send(Event::Found(scan, report)),
        (Answer::Fitted(report), Some(scan)) => {
            events.send(Event::Fitted(scan, report));
            fits.borrow_mut().current = None;
            go_on(fits);
        }
        (Answer::Aborted(message), scan) => {
            let source = fits.borrow_mut().current.take();
            let source = source.map(|(job, _)| job.measurements.source.clone());
            if let (Some(scan), Some(source)) = (scan, source) {
                events.send(Event::FitAborted(scan, format!("{source}: {message}")));
            }
            replace_worker(fits);
        }
        (Answer::Step(_) | Answer::Found(_) | Answer::Fitted(_), None) => {}
    }
}

/// Ends a worker that cannot go on. This happens outside of its own listener, which goes with it.
fn replace_worker(fits: &Rc<RefCell<Fits>>) {
    let fits = Rc::clone(fits);
    wasm_bindgen_futures::spawn_local(async move {
        fits.borrow_mut().worker = None;
        go_on(&fits);
    });
}

/// Starts the next fit, where none is being made.
fn go_on(fits: &Rc<RefCell<Fits>>) {
    loop {
        if fits.borrow().current.is_some() {
            break;
        }
        let Some(next) = fits.borrow_mut().queue.pop_front() else {
            break;
        };
        match next {
            Queued::Fit(job, _) if job.cancel.is_cancelled() => {}
            Queued::Fit(job, depth) => {
                fits.borrow_mut().current = Some((job, depth));
                fits.borrow().order();
            }
            Queued::End(run) => fits.borrow().events.send(Event::FitsEnded(run)),
        }
    }
    if fits.borrow().worker.is_none() {
        start_worker(fits);
    }
}

impl Fits {
    /// Orders the current fit of a worker that is ready. One that starts is ordered when it answers.
    fn order(&self) {
        let (Some((job, depth)), Some(running)) = (&self.current, &self.worker) else {
            return;
        };
        if !running.is_ready {
            return;
        }
        if let Ok(text) = order(job, *depth) {
            let _ = running.worker.post_message(&JsValue::from_str(&text));
        }
    }
}
