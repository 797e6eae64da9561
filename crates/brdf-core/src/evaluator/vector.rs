//! The evaluation of a formula at many points: in the widest vectors of the processor, and on several
//! threads if that is faster.
//!
//! A loop over a formula without calls and branches becomes vector code by itself.

#![expect(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "a function that is not inlined is not compiled for the present processor, and with \
              iterators the last points are not evaluated in vectors"
)]

use super::formula::Formula;
use super::points::{LengthError, Points, converted};
use super::processor::{self, Kernel};
use crate::direction_pair::{DirectionPair, Zenith};
use crate::numeric::{Fused, Primitive, Real, sin2_cos2_of_any_half};
use crate::parallel;

/// The number of points from which on several threads share the work.
///
/// For the fastest formula, which takes 1 ns for each point, two threads took 24 us for 16 Ki points
/// and one thread 16 us; for 32 Ki points they took 28 us and 32 us
/// (`cargo bench -p brdf-core --bench evaluators`).
pub const PARALLEL_FROM: usize = 1 << 15;

/// The least number of points of one chunk of the work.
const LEAST_CHUNK: usize = 1 << 13;

/// The number of chunks for each thread. More than one lets an idle thread take over work; each
/// begins with waiting for the memory, so that there should not be more.
const CHUNKS_PER_THREAD: usize = 8;

/// A function of an index into arrays.
trait Indexed<T: Primitive>: Copy {
    /// The same function with all arrays cut to the length n. If this is done within the function of
    /// the loop, the loop needs no checks of the lengths.
    fn below(self, n: usize) -> Self;

    /// The value at an index below n.
    fn at<R: Real<Stored = T>>(&self, index: usize) -> R;
}

/// Sets each element of `out` to the value of f at its index.
fn fill<T: Primitive>(f: impl Indexed<T>, out: &mut [T]) {
    processor::run(Fill { f, out });
}

/// The loop of [`fill`].
struct Fill<'a, F, T> {
    f: F,
    out: &'a mut [T],
}

impl<T: Primitive, F: Indexed<T>> Kernel for Fill<'_, F, T> {
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let n = self.out.len();
        let f = self.f.below(n);
        let out = &mut self.out[..n];
        for i in 0..n {
            out[i] = if FUSED {
                f.at::<Fused<T>>(i).store()
            } else {
                f.at::<T>(i).store()
            };
        }
    }
}

/// Checks the lengths of the arrays and does the work in chunks, on several threads if there are many
/// points.
pub(crate) fn native<T: Primitive>(
    points: &Points<T>,
    out: &mut [T],
    work: impl Fn(&Points<T>, &mut [T]) + Sync,
) -> Result<(), LengthError> {
    points.check(out.len())?;
    let threads = parallel::threads();
    if out.len() < PARALLEL_FROM || threads == 1 {
        work(points, out);
        return Ok(());
    }
    let length = LEAST_CHUNK.max(out.len() / (CHUNKS_PER_THREAD * threads));
    parallel::for_each_chunk(out, length, |i, out| {
        work(&points.part(i * length..i * length + out.len()), out);
    });
    Ok(())
}

/// [`native`] for work that is done in another precision.
pub(crate) fn rounded<T: Primitive, U: Primitive>(
    points: &Points<T>,
    out: &mut [T],
    work: impl Fn(&Points<U>, &mut [U]) + Sync,
) -> Result<(), LengthError> {
    native(points, out, |points, out| converted(points, out, &work))
}

/// Evaluates the formula at the points. All arrays have the same length.
pub(crate) fn evaluate<T: Primitive>(formula: impl Formula, points: &Points<T>, out: &mut [T]) {
    match *points {
        Points::Cosines { psi, theta, phi } => {
            let cosines = [psi, theta, phi];
            fill(Cosines { formula, cosines }, out);
        }
        Points::Angles { psi, theta, phi } => {
            let angles = [psi, theta, phi];
            let whole_turn = T::narrow(std::f64::consts::TAU);
            if phi.iter().all(|phi| phi.magnitude() <= whole_turn) {
                fill(Angles { formula, angles }, out);
            } else {
                far_angles(formula, angles, out);
            }
        }
        Points::Directions { source, view } => {
            let directions = Directions {
                formula,
                source,
                view,
            };
            fill(directions, out);
        }
    }
}

#[derive(Clone, Copy)]
struct Cosines<'a, K, T> {
    formula: K,
    cosines: [&'a [T]; 3],
}

impl<K: Formula, T: Primitive> Indexed<T> for Cosines<'_, K, T> {
    #[inline(always)]
    fn below(self, n: usize) -> Self {
        Self {
            formula: self.formula,
            cosines: self.cosines.map(|array| &array[..n]),
        }
    }

    #[inline(always)]
    fn at<R: Real<Stored = T>>(&self, i: usize) -> R {
        let [psi, theta, phi] = self.cosines;
        let (psi, theta, phi) = (R::load(psi[i]), R::load(theta[i]), R::load(phi[i]));
        self.formula
            .at(&DirectionPair::from_cosines(psi, theta, phi))
    }
}

#[derive(Clone, Copy)]
struct Angles<'a, K, T> {
    formula: K,
    angles: [&'a [T]; 3],
}

impl<K: Formula, T: Primitive> Indexed<T> for Angles<'_, K, T> {
    #[inline(always)]
    fn below(self, n: usize) -> Self {
        Self {
            formula: self.formula,
            angles: self.angles.map(|array| &array[..n]),
        }
    }

    #[inline(always)]
    fn at<R: Real<Stored = T>>(&self, i: usize) -> R {
        let [psi, theta, phi] = self.angles;
        let (psi, theta, phi) = (R::load(psi[i]), R::load(theta[i]), R::load(phi[i]));
        self.formula
            .at(&DirectionPair::from_angles(psi, theta, phi))
    }
}

#[derive(Clone, Copy)]
struct Directions<'a, K, T> {
    formula: K,
    source: [&'a [T]; 3],
    view: [&'a [T]; 3],
}

impl<K: Formula, T: Primitive> Indexed<T> for Directions<'_, K, T> {
    #[inline(always)]
    fn below(self, n: usize) -> Self {
        Self {
            formula: self.formula,
            source: self.source.map(|array| &array[..n]),
            view: self.view.map(|array| &array[..n]),
        }
    }

    #[inline(always)]
    fn at<R: Real<Stored = T>>(&self, i: usize) -> R {
        let source = self.source.map(|array| R::load(array[i]));
        let view = self.view.map(|array| R::load(array[i]));
        self.formula
            .at(&DirectionPair::from_directions(source, view))
    }
}

/// Evaluates the formula at angles of which some azimuths exceed a whole turn: point by point, with
/// the sine of the library.
fn far_angles<T: Primitive>(formula: impl Formula, [psi, theta, phi]: [&[T]; 3], out: &mut [T]) {
    for i in 0..psi.len() {
        let view = View::new(theta[i], phi[i]);
        let pair =
            DirectionPair::from_zeniths(Zenith::checked(psi[i]), view.zenith, view.cos2_half_phi);
        out[i] = formula.at(&pair);
    }
}

/// Evaluates the formula for every view at each incidence: `out` contains the views of the first
/// incidence, then those of the second. The sines and cosines are computed once for each angle.
pub(crate) fn grid<T: Primitive>(
    formula: impl Formula,
    psi: &[T],
    theta: &[T],
    phi: &[T],
    out: &mut [T],
) {
    let views: Vec<View<T>> = theta
        .iter()
        .zip(phi)
        .map(|(&t, &p)| View::new(t, p))
        .collect();
    let views = ViewArrays::of(&views);
    let columns = theta.len().max(1);
    let row = |i: usize, out: &mut [T]| {
        let row = Row {
            formula,
            source: Zenith::checked(psi[i]),
            angle: &views.angle,
            sin: &views.sin,
            cos: &views.cos,
            cos2_half_phi: &views.cos2_half_phi,
        };
        fill(row, out);
    };
    if out.len() < PARALLEL_FROM {
        let rows = out.chunks_mut(columns).enumerate();
        rows.for_each(|(i, out)| row(i, out));
    } else {
        parallel::for_each_chunk(out, columns, row);
    }
}

/// A view: the magnitude of its zenith angle and cos^2(phi/2) of the azimuth that belongs to it.
struct View<T> {
    zenith: Zenith<T>,
    cos2_half_phi: T,
}

impl<T: Primitive> View<T> {
    fn new(theta: T, phi: T) -> Self {
        let (sin2, cos2) = sin2_cos2_of_any_half(phi.widen());
        let backward = theta < T::narrow(0.0);
        Self {
            zenith: Zenith::checked(theta.magnitude()),
            cos2_half_phi: T::narrow(if backward { sin2 } else { cos2 }),
        }
    }
}

/// Views as one array for each number.
struct ViewArrays<T> {
    angle: Vec<T>,
    sin: Vec<T>,
    cos: Vec<T>,
    cos2_half_phi: Vec<T>,
}

impl<T: Primitive> ViewArrays<T> {
    fn of(views: &[View<T>]) -> Self {
        let each = |number: fn(&View<T>) -> T| views.iter().map(number).collect();
        Self {
            angle: each(|view| view.zenith.angle),
            sin: each(|view| view.zenith.sin),
            cos: each(|view| view.zenith.cos),
            cos2_half_phi: each(|view| view.cos2_half_phi),
        }
    }
}

/// The formula for the views of one incidence.
#[derive(Clone, Copy)]
struct Row<'a, K, T> {
    formula: K,
    source: Zenith<T>,
    angle: &'a [T],
    sin: &'a [T],
    cos: &'a [T],
    cos2_half_phi: &'a [T],
}

impl<K: Formula, T: Primitive> Indexed<T> for Row<'_, K, T> {
    #[inline(always)]
    fn below(self, n: usize) -> Self {
        Self {
            angle: &self.angle[..n],
            sin: &self.sin[..n],
            cos: &self.cos[..n],
            cos2_half_phi: &self.cos2_half_phi[..n],
            ..self
        }
    }

    #[inline(always)]
    fn at<R: Real<Stored = T>>(&self, i: usize) -> R {
        let load = |zenith: Zenith<T>| Zenith {
            angle: R::load(zenith.angle),
            sin: R::load(zenith.sin),
            cos: R::load(zenith.cos),
        };
        let view = Zenith {
            angle: self.angle[i],
            sin: self.sin[i],
            cos: self.cos[i],
        };
        let cos2_half_phi = R::load(self.cos2_half_phi[i]);
        let pair = DirectionPair::from_zeniths(load(self.source), load(view), cos2_half_phi);
        self.formula.at(&pair)
    }
}

#[cfg(all(test, feature = "simd"))]
mod tests {
    use pulp::Arch;

    use super::super::processor::{PROCESSOR, run_on};
    use super::*;
    use crate::family::each;
    use crate::{AnyBrdf, Family, ModelParameters};

    /// The kinds of processor that this one can run as.
    fn processors() -> Vec<Arch> {
        let mut all = vec![Arch::Scalar, *PROCESSOR];
        #[cfg(target_arch = "x86_64")]
        all.extend(pulp::x86::V3::try_new().map(Arch::V3));
        all
    }

    fn on_each<T: Primitive>(brdf: &AnyBrdf) -> Vec<Vec<T>> {
        let array = |scale: f64, step: f64| -> Vec<T> {
            let at = |i| T::narrow(scale * (f64::from(i) * step).fract());
            (0..333).map(at).collect()
        };
        let angles = [array(1.5, 0.618), array(1.5, 0.755), array(6.2, 0.57)];
        let angles = angles.each_ref().map(Vec::as_slice);
        let on = |arch| {
            let mut out = vec![T::narrow(0.0); 333];
            each!(*brdf, formula => {
                let f = Angles { formula, angles };
                run_on(arch, Fill { f, out: &mut out });
            });
            out
        };
        processors().into_iter().map(on).collect()
    }

    fn worst<T: Primitive>(brdf: &AnyBrdf) -> f64 {
        let all = on_each::<T>(brdf);
        let pairs = all[1..].iter().flat_map(|other| other.iter().zip(&all[0]));
        pairs
            .map(|(a, b)| (a.widen() / b.widen() - 1.0).abs())
            .fold(0.0, f64::max)
    }

    #[test]
    fn every_kind_of_processor_gives_the_same_values_up_to_rounding() {
        for family in Family::ALL {
            let at = ModelParameters {
                k2: 0.3,
                kd: 0.1,
                k1: 0.15,
                n: 1.5,
                p: 1.4,
            };
            let brdf = AnyBrdf::new(family, &at).unwrap();
            let (double, single) = (worst::<f64>(&brdf), worst::<f32>(&brdf));
            assert!(double < 2e-14, "{family:?} {double}");
            assert!(single < 4e-6, "{family:?} {single}");
        }
    }
}
