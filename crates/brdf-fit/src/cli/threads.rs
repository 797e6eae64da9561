//! The threads of a program.

use rayon::ThreadPoolBuilder;

/// Prepares the threads on which fits run: as many as there are processors, or the program's own thread
/// alone where the system allows no others.
pub(super) fn prepare() {
    if ThreadPoolBuilder::new().build().is_ok() {
        return;
    }
    // Another error means that a pool exists already.
    let _ = ThreadPoolBuilder::new()
        .num_threads(1)
        .use_current_thread()
        .build_global();
}
