//! Direction vectors in the public interface, and the operations on them that the crate needs.

/// A vector that a function accepts as a direction: `[f64; 3]`, `nalgebra::Vector3<f64>` (with the
/// feature `nalgebra`), or a reference to one of them.
///
/// The components are x, y and z, with z along the surface normal.
pub trait Direction: Copy + sealed::Sealed {
    /// The components x, y and z.
    fn components(self) -> [f64; 3];
}

impl Direction for [f64; 3] {
    #[inline]
    fn components(self) -> [f64; 3] {
        self
    }
}

#[cfg(feature = "nalgebra")]
impl Direction for nalgebra::Vector3<f64> {
    #[inline]
    fn components(self) -> [f64; 3] {
        self.into()
    }
}

impl<D: Direction> Direction for &D {
    #[inline]
    fn components(self) -> [f64; 3] {
        (*self).components()
    }
}

mod sealed {
    pub trait Sealed {}

    impl Sealed for [f64; 3] {}

    #[cfg(feature = "nalgebra")]
    impl Sealed for nalgebra::Vector3<f64> {}

    impl<D: Sealed> Sealed for &D {}
}

#[inline]
pub(crate) fn sum(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline]
pub(crate) fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline]
pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
pub(crate) fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// The vector divided by a number.
#[inline]
pub(crate) fn divided(a: [f64; 3], divisor: f64) -> [f64; 3] {
    a.map(|component| component / divisor)
}
