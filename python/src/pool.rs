//! The threads of the computations, and their interruption.

use std::ops::ControlFlow;
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use brdf_fit::{Observer, Step};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::value_error;

/// The time between two checks for Ctrl+C.
const CHECKED: Duration = Duration::from_millis(50);

/// The last pool with its process and its number of threads.
///
/// The threads of a pool do not exist in a forked child, where work that is given to it never ends:
/// a child makes its own pool. The lock is held only by a thread that holds the GIL, as one that forks
/// does, so that no child inherits it locked.
static POOL: Mutex<Option<(u32, usize, Arc<ThreadPool>)>> = Mutex::new(None);

/// The pool with a number of threads; `None` takes all cores, or the number of `RAYON_NUM_THREADS`.
fn pool(_attached: Python<'_>, threads: Option<usize>) -> PyResult<Arc<ThreadPool>> {
    if threads == Some(0) {
        return Err(value_error(
            "threads = 0: expected a number of at least 1, or None for all cores",
        ));
    }
    let wanted = threads.unwrap_or(0);
    let process = process::id();
    let mut kept = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((of, count, pool)) = kept.as_ref()
        && *of == process
        && *count == wanted
    {
        return Ok(Arc::clone(pool));
    }
    let built = ThreadPoolBuilder::new()
        .num_threads(wanted)
        .thread_name(|i| format!("brdf-fit-{i}"))
        .build()
        .map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
    let built = Arc::new(built);
    if let Some((of, _, old)) = kept.replace((process, wanted, Arc::clone(&built)))
        && of != process
    {
        // The threads that would end it are those of the parent.
        std::mem::forget(old);
    }
    Ok(built)
}

/// Whether the user has interrupted the computation.
#[derive(Default)]
pub(crate) struct Interrupt(AtomicBool);

impl Interrupt {
    pub(crate) fn flow(&self) -> ControlFlow<()> {
        if self.0.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

impl Observer for Interrupt {
    fn step(&self, _: &Step) -> ControlFlow<()> {
        self.flow()
    }
}

/// Takes the GIL and looks for Ctrl+C.
#[expect(
    clippy::redundant_closure_for_method_calls,
    reason = "the method is not general enough in its lifetime"
)]
pub(crate) fn check_signals() -> PyResult<()> {
    Python::attach(|py| py.check_signals())
}

/// Does work on a pool without the GIL. Meanwhile this thread looks for Ctrl+C, which only the main
/// thread of Python can see: it sets the interrupt, and its exception is returned when the work ends.
pub(crate) fn run<T: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    work: impl FnOnce(&Interrupt) -> T + Send,
) -> PyResult<T> {
    let pool = pool(py, threads)?;
    py.detach(|| {
        let interrupt = Interrupt::default();
        let (sender, receiver) = channel();
        pool.in_place_scope(|scope| {
            let interrupt = &interrupt;
            scope.spawn(move |_| {
                // The receiver waits for it.
                let _ = sender.send(work(interrupt));
            });
            let mut exception = None;
            loop {
                match receiver.recv_timeout(CHECKED) {
                    Ok(result) => return exception.map_or(Ok(result), Err),
                    // The work has panicked, which the end of the scope passes on.
                    Err(RecvTimeoutError::Disconnected) => {
                        return Err(PyRuntimeError::new_err("internal error"));
                    }
                    Err(RecvTimeoutError::Timeout) => {
                        if let Err(error) = check_signals() {
                            interrupt.0.store(true, Ordering::Relaxed);
                            exception = Some(error);
                        }
                    }
                }
            }
        })
    })
}
