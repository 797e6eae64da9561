//! The choice of the processor's vectors at run time.

#[cfg(feature = "simd")]
use std::sync::LazyLock;

#[cfg(feature = "simd")]
use pulp::{Arch, Simd, WithSimd};

/// A loop that is compiled for several kinds of processor.
pub(super) trait Kernel {
    /// Runs the loop; FUSED if the processor multiplies and adds in one instruction. It must be
    /// inlined, with all that it calls.
    fn run<const FUSED: bool>(self);
}

/// The abilities of the processor, which are determined once.
#[cfg(feature = "simd")]
pub(super) static PROCESSOR: LazyLock<Arch> = LazyLock::new(Arch::new);

/// Runs a loop in the widest vectors of the processor.
#[cfg(feature = "simd")]
pub(super) fn run(kernel: impl Kernel) {
    run_on(*PROCESSOR, kernel);
}

/// Runs a loop as it is compiled for the target of the build.
#[cfg(not(feature = "simd"))]
pub(super) fn run(kernel: impl Kernel) {
    kernel.run::<false>();
}

/// Runs a loop as a processor of the given abilities does.
#[cfg(feature = "simd")]
pub(super) fn run_on(arch: Arch, kernel: impl Kernel) {
    if matches!(arch, Arch::Scalar) {
        kernel.run::<false>();
    } else {
        arch.dispatch(FusedKernel(kernel));
    }
}

#[cfg(feature = "simd")]
struct FusedKernel<K>(K);

#[cfg(feature = "simd")]
impl<K: Kernel> WithSimd for FusedKernel<K> {
    type Output = ();

    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a function that is not inlined is not compiled for the present processor"
    )]
    fn with_simd<S: Simd>(self, _: S) {
        self.0.run::<true>();
    }
}

/// The name of the widest vectors that the evaluators use on this processor: "AVX-512", "AVX2",
/// "NEON", or "the baseline" of the target that the program is compiled for.
pub fn vector_unit() -> &'static str {
    #[cfg(feature = "simd")]
    match *PROCESSOR {
        #[cfg(target_arch = "x86_64")]
        Arch::V3(_) => return "AVX2",
        #[cfg(target_arch = "x86_64")]
        Arch::V4(_) => return "AVX-512",
        #[cfg(target_arch = "aarch64")]
        Arch::Neon(_) => return "NEON",
        _ => {}
    }
    "the baseline"
}
