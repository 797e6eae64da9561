//! Arrays of points, one array for each coordinate.

use std::ops::Range;

use crate::numeric::Primitive;

/// Arrays of different lengths.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("an array has {found} elements: expected {expected}")]
pub struct LengthError {
    /// The length of the first array, or of the grid that two arrays span.
    pub expected: usize,
    /// The length of the array that differs from it.
    pub found: usize,
}

/// Points at which a BRDF is evaluated: one array for each coordinate, all of the same length.
///
/// The value at a point outside the domain is NaN. These are points with a zenith angle outside
/// [0, 90 deg) or a direction that is not above the surface.
#[derive(Debug, Clone, Copy)]
pub enum Points<'a, T> {
    /// The cosines of the incidence angle psi and of the view angle theta, in (0, 1], and of the
    /// azimuth phi between them, which is 1 back towards the source. Cosines beyond 1 or -1 by a
    /// rounding error are treated as 1 or -1.
    Cosines {
        /// cos psi.
        psi: &'a [T],
        /// cos theta.
        theta: &'a [T],
        /// cos phi.
        phi: &'a [T],
    },
    /// psi, signed theta and phi in radians, as in [`Geometry::new`](crate::Geometry::new).
    Angles {
        /// psi.
        psi: &'a [T],
        /// theta.
        theta: &'a [T],
        /// phi.
        phi: &'a [T],
    },
    /// Unit vectors away from the surface, as the arrays of x, y and z, with z along its normal.
    Directions {
        /// Towards the source.
        source: [&'a [T]; 3],
        /// Towards the viewer.
        view: [&'a [T]; 3],
    },
}

impl<'a, T: Primitive> Points<'a, T> {
    /// The number of points.
    ///
    /// # Errors
    ///
    /// [`LengthError`] if the arrays have different lengths.
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

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.arrays().0[0].is_empty()
    }

    /// Checks that all arrays and an array of `values` values have the same length.
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

    /// The points of a range of indices.
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

    /// The arrays, and the number of those that are used.
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

/// The number of points that are converted at once, so that their arrays stay in the nearest cache.
const BLOCK: usize = 512;

/// Does the work in blocks of points.
fn in_blocks<T: Primitive>(
    points: &Points<T>,
    out: &mut [T],
    mut work: impl FnMut(&Points<T>, &mut [T]),
) {
    for (block, out) in out.chunks_mut(BLOCK).enumerate() {
        let from = block * BLOCK;
        work(&points.part(from..from + out.len()), out);
    }
}

/// Evaluates points of one precision by a function of another precision, block by block.
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
