//! Many points, one array for each coordinate.

use std::ops::Range;

use crate::numeric::Primitive;

/// Arrays of different lengths.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("an array has {found} elements: expected {expected}, as many as the others have")]
pub struct LengthError {
    /// The length of the first array.
    pub expected: usize,
    /// That of the other.
    pub found: usize,
}

/// Points at which a BRDF is evaluated, as arrays of one coordinate each, all of the same length.
///
/// What is outside the domain gives NaN: a zenith angle that is not in [0, 90 deg), a direction that
/// is not above the surface.
#[derive(Debug, Clone, Copy)]
pub enum Points<'a, T> {
    /// The cosines of the incidence angle psi and of the view angle theta, in (0, 1], and that of
    /// the azimuth phi between them, 1 back towards the source. What is outside by its rounding
    /// counts as 1 or -1.
    Cosines {
        /// cos psi.
        psi: &'a [T],
        /// cos theta.
        theta: &'a [T],
        /// cos phi.
        phi: &'a [T],
    },
    /// psi, signed theta and phi in radians, as of [`Geometry::new`](crate::Geometry::new).
    Angles {
        /// psi.
        psi: &'a [T],
        /// theta.
        theta: &'a [T],
        /// phi.
        phi: &'a [T],
    },
    /// Unit vectors away from the surface, x, y and z each, z along its normal.
    Directions {
        /// Towards the source.
        source: [&'a [T]; 3],
        /// Towards the viewer.
        view: [&'a [T]; 3],
    },
}

impl<'a, T: Primitive> Points<'a, T> {
    /// How many points there are.
    ///
    /// Errors: arrays of different lengths.
    pub fn len(&self) -> Result<usize, LengthError> {
        let (arrays, count) = self.arrays();
        let expected = arrays[0].len();
        match arrays[..count].iter().find(|a| a.len() != expected) {
            Some(other) => Err(LengthError {
                expected,
                found: other.len(),
            }),
            None => Ok(expected),
        }
    }

    /// Whether there is no point.
    pub fn is_empty(&self) -> bool {
        self.arrays().0[0].is_empty()
    }

    /// Checks that all arrays, and an array of as many values, have the same length.
    pub(crate) fn check(&self, values: usize) -> Result<(), LengthError> {
        let expected = self.len()?;
        if values == expected {
            Ok(())
        } else {
            Err(LengthError {
                expected,
                found: values,
            })
        }
    }

    /// Some of the points.
    pub(crate) fn part(&self, range: Range<usize>) -> Self {
        self.with(|array| &array[range.clone()])
    }

    /// The same coordinates in other arrays.
    fn with<'b, U>(&self, mut other: impl FnMut(&'a [T]) -> &'b [U]) -> Points<'b, U> {
        match *self {
            Self::Cosines { psi, theta, phi } => Points::Cosines {
                psi: other(psi),
                theta: other(theta),
                phi: other(phi),
            },
            Self::Angles { psi, theta, phi } => Points::Angles {
                psi: other(psi),
                theta: other(theta),
                phi: other(phi),
            },
            Self::Directions { source, view } => Points::Directions {
                source: source.map(&mut other),
                view: view.map(&mut other),
            },
        }
    }

    /// The arrays, and how many of them there are.
    fn arrays(&self) -> ([&'a [T]; 6], usize) {
        match *self {
            Self::Cosines { psi, theta, phi } | Self::Angles { psi, theta, phi } => {
                ([psi, theta, phi, psi, theta, phi], 3)
            }
            Self::Directions {
                source: [a, b, c],
                view: [d, e, f],
            } => ([a, b, c, d, e, f], 6),
        }
    }
}

/// Checks the lengths of the arrays of a grid.
pub(crate) fn check_grid(
    psi: usize,
    theta: usize,
    phi: usize,
    out: usize,
) -> Result<(), LengthError> {
    let lengths = [(theta, phi), (psi * theta, out)];
    match lengths
        .into_iter()
        .find(|(expected, found)| expected != found)
    {
        Some((expected, found)) => Err(LengthError { expected, found }),
        None => Ok(()),
    }
}

/// How many points are taken at once where that needs arrays: they stay in the nearest cache.
pub(crate) const BLOCK: usize = 512;

/// Works on a block of points at a time.
pub(crate) fn in_blocks<T: Primitive>(
    points: &Points<T>,
    out: &mut [T],
    mut work: impl FnMut(&Points<T>, &mut [T]),
) {
    for (block, out) in out.chunks_mut(BLOCK).enumerate() {
        let from = block * BLOCK;
        work(&points.part(from..from + out.len()), out);
    }
}

/// Evaluates points of one precision by an evaluator of the other, block by block.
pub(crate) fn converted<T: Primitive, U: Primitive>(
    points: &Points<T>,
    out: &mut [T],
    mut evaluate: impl FnMut(&Points<U>, &mut [U]),
) {
    let mut arrays = [[U::default(); BLOCK]; 6];
    let mut values = [U::default(); BLOCK];
    in_blocks(points, out, |points, out| {
        let mut free = arrays.iter_mut();
        let other = points.with(|array| match free.next() {
            Some(to) => convert(array, to),
            None => &[],
        });
        let values = &mut values[..out.len()];
        evaluate(&other, values);
        convert(values, out);
    });
}

fn convert<'b, T: Primitive, U: Primitive>(from: &[T], to: &'b mut [U]) -> &'b [U] {
    let to = &mut to[..from.len()];
    for (to, from) in to.iter_mut().zip(from) {
        *to = U::narrow(from.widen());
    }
    to
}
