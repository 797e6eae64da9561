//! The numbers that a formula is evaluated in.
//!
//! A loop over a formula in plain arithmetic, without a call or a branch, becomes vector code. Every
//! function here is therefore inlined and free of branches.

#![expect(
    clippy::inline_always,
    reason = "a function that is not inlined does not become vector code"
)]

mod elementary;
mod fused;
mod number;
mod primitive;

pub use elementary::Elementary;
pub use fused::Fused;
pub use number::Real;
pub use primitive::Primitive;

pub(crate) use number::horner;
