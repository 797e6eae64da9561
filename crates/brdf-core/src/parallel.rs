//! Work on several threads, those of the current rayon pool. Without the feature `parallel` one
//! thread does all of it.

#[cfg(feature = "parallel")]
use rayon::prelude::*;

/// The number of threads that share the work.
pub(crate) fn threads() -> usize {
    #[cfg(feature = "parallel")]
    return rayon::current_num_threads();
    #[cfg(not(feature = "parallel"))]
    1
}

/// Calls `work` with the index of each chunk of `length` elements, the last of which may be
/// shorter, and the chunk.
pub(crate) fn for_each_chunk<T: Send>(
    values: &mut [T],
    length: usize,
    work: impl Fn(usize, &mut [T]) + Send + Sync,
) {
    #[cfg(feature = "parallel")]
    let chunks = values.par_chunks_mut(length);
    #[cfg(not(feature = "parallel"))]
    let chunks = values.chunks_mut(length);
    chunks.enumerate().for_each(|(i, chunk)| work(i, chunk));
}

/// The results of a function for each index below `count`, in this order.
pub(crate) fn map<T: Send>(count: usize, f: impl Fn(usize) -> T + Send + Sync) -> Vec<T> {
    #[cfg(feature = "parallel")]
    let indices = (0..count).into_par_iter();
    #[cfg(not(feature = "parallel"))]
    let indices = 0..count;
    indices.map(f).collect()
}
