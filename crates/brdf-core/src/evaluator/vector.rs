//! A formula at many points: in the widest vectors that the processor has, found when the program
//! runs, and on all its cores where that pays.
//!
//! A loop over a formula without calls and branches becomes vector code by itself; it is compiled
//! for several kinds of processor, and one of them is chosen at each call.

#![expect(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "what is not inlined is not compiled for the processor at hand, and over iterators the \
              last points are not done in vectors"
)]

use std::sync::LazyLock;

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use super::formula::Formula;
use super::points::{LengthError, Points, converted};
use crate::direction_pair::{DirectionPair, Zenith};
use crate::numeric::{Fused, Primitive, Real, sin2_cos2_of_any_half};

/// From this number of points on, several cores share the work: of the fastest formula, 1 ns a point,
/// two cores took 24 us for 16 Ki points, one 16 us; for 32 Ki points 28 us and 32 us
/// (`cargo bench -p brdf-core --bench evaluators`).
pub const PARALLEL_FROM: usize = 1 << 15;

/// The least points of one piece of the work.
const LEAST_PIECE: usize = 1 << 13;

/// Pieces for each thread: enough for one to help another out, and no more, since at the beginning of
/// a piece the memory is waited for.
const PIECES_A_THREAD: usize = 8;

/// A function of an index into arrays.
trait Indexed<T: Primitive, const N: usize>: Copy {
    /// The same for the indices below n, which all arrays have. Said within the loop's own function,
    /// it frees the loop from looking at the lengths of the arrays again.
    fn below(self, n: usize) -> Self;

    fn at<R: Real<Stored = T>>(&self, index: usize) -> [R; N];
}

/// What the processor can do, asked once.
static PROCESSOR: LazyLock<Arch> = LazyLock::new(Arch::new);

/// What the evaluators found in this processor: the widest vectors that they use.
pub fn vector_unit() -> &'static str {
    match *PROCESSOR {
        #[cfg(target_arch = "x86_64")]
        Arch::V3(_) => "AVX2",
        #[cfg(target_arch = "x86_64")]
        Arch::V4(_) => "AVX-512",
        #[cfg(target_arch = "aarch64")]
        Arch::Neon(_) => "NEON",
        _ => "the baseline",
    }
}

/// Array k of out gets value k of f at each index, in vectors.
fn fill<T: Primitive, const N: usize>(f: impl Indexed<T, N>, out: [&mut [T]; N]) {
    fill_by(*PROCESSOR, f, out);
}

/// The same as a processor of less than its abilities would do it.
fn fill_by<T: Primitive, const N: usize>(arch: Arch, f: impl Indexed<T, N>, out: [&mut [T]; N]) {
    if matches!(arch, Arch::Scalar) {
        Loop::<_, _, N, false> { f, out }.run();
    } else {
        arch.dispatch(Loop::<_, _, N, true> { f, out });
    }
}

/// The loop of [`fill`]; FUSED where the processor multiplies and adds at once.
struct Loop<'a, F, T, const N: usize, const FUSED: bool> {
    f: F,
    out: [&'a mut [T]; N],
}

impl<T, F, const N: usize, const FUSED: bool> Loop<'_, F, T, N, FUSED>
where
    T: Primitive,
    F: Indexed<T, N>,
{
    #[inline(always)]
    fn run(self) {
        let n = self.out[0].len();
        let f = self.f.below(n);
        let out = self.out.map(|out| &mut out[..n]);
        if N == 1 {
            for i in 0..n {
                out[0][i] = at::<_, _, N, FUSED>(&f, i)[0];
            }
        } else {
            in_columns::<_, _, N, FUSED>(&f, out);
        }
    }
}

#[inline(always)]
fn at<T, F, const N: usize, const FUSED: bool>(f: &F, i: usize) -> [T; N]
where
    T: Primitive,
    F: Indexed<T, N>,
{
    if FUSED {
        f.at::<Fused<T>>(i).map(Real::store)
    } else {
        f.at::<T>(i)
    }
}

/// Several values a point, by way of arrays of its own: of several that are handed in, the compiler
/// would have to find out first that they do not overlap.
#[inline(always)]
fn in_columns<T, F, const N: usize, const FUSED: bool>(f: &F, mut out: [&mut [T]; N])
where
    T: Primitive,
    F: Indexed<T, N>,
{
    const LENGTH: usize = 64;
    let n = out[0].len();
    let mut from = 0;
    while from < n {
        let length = LENGTH.min(n - from);
        let mut columns = [[T::default(); LENGTH]; N];
        for i in 0..length {
            let values = at::<_, _, N, FUSED>(f, from + i);
            for k in 0..N {
                columns[k][i] = values[k];
            }
        }
        for (out, column) in out.iter_mut().zip(&columns) {
            out[from..from + length].copy_from_slice(&column[..length]);
        }
        from += length;
    }
}

impl<T, F, const N: usize, const FUSED: bool> WithSimd for Loop<'_, F, T, N, FUSED>
where
    T: Primitive,
    F: Indexed<T, N>,
{
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.run();
    }
}

/// Checks the lengths and works on pieces of the points, on several cores where there are many.
pub(crate) fn native<T: Primitive>(
    points: &Points<T>,
    out: &mut [T],
    work: impl Fn(&Points<T>, &mut [T]) + Sync,
) -> Result<(), LengthError> {
    points.check(out.len())?;
    let threads = rayon::current_num_threads();
    if out.len() < PARALLEL_FROM || threads == 1 {
        work(points, out);
        return Ok(());
    }
    let length = LEAST_PIECE.max(out.len() / (PIECES_A_THREAD * threads));
    let pieces = out.par_chunks_mut(length).enumerate();
    pieces.for_each(|(i, out)| work(&points.part(i * length..i * length + out.len()), out));
    Ok(())
}

/// The same for work that is done in numbers of another precision.
pub(crate) fn rounded<T: Primitive, U: Primitive>(
    points: &Points<T>,
    out: &mut [T],
    work: impl Fn(&Points<U>, &mut [U]) + Sync,
) -> Result<(), LengthError> {
    native(points, out, |points, out| converted(points, out, &work))
}

/// The formula at the points. All arrays have one length.
pub(crate) fn evaluate<T: Primitive>(formula: impl Formula, points: &Points<T>, out: &mut [T]) {
    evaluate_all(formula, points, [out]);
}

/// The same for a formula of several values, an array for each.
pub(crate) fn evaluate_all<T: Primitive, const N: usize>(
    formula: impl Formula<N>,
    points: &Points<T>,
    out: [&mut [T]; N],
) {
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

impl<K: Formula<N>, T: Primitive, const N: usize> Indexed<T, N> for Cosines<'_, K, T> {
    #[inline(always)]
    fn below(self, n: usize) -> Self {
        Self {
            formula: self.formula,
            cosines: self.cosines.map(|array| &array[..n]),
        }
    }

    #[inline(always)]
    fn at<R: Real<Stored = T>>(&self, i: usize) -> [R; N] {
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

impl<K: Formula<N>, T: Primitive, const N: usize> Indexed<T, N> for Angles<'_, K, T> {
    #[inline(always)]
    fn below(self, n: usize) -> Self {
        Self {
            formula: self.formula,
            angles: self.angles.map(|array| &array[..n]),
        }
    }

    #[inline(always)]
    fn at<R: Real<Stored = T>>(&self, i: usize) -> [R; N] {
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

impl<K: Formula<N>, T: Primitive, const N: usize> Indexed<T, N> for Directions<'_, K, T> {
    #[inline(always)]
    fn below(self, n: usize) -> Self {
        Self {
            formula: self.formula,
            source: self.source.map(|array| &array[..n]),
            view: self.view.map(|array| &array[..n]),
        }
    }

    #[inline(always)]
    fn at<R: Real<Stored = T>>(&self, i: usize) -> [R; N] {
        let source = self.source.map(|array| R::load(array[i]));
        let view = self.view.map(|array| R::load(array[i]));
        self.formula
            .at(&DirectionPair::from_directions(source, view))
    }
}

/// Azimuths beyond a whole turn are taken one by one, with the library's sine.
fn far_angles<T: Primitive, const N: usize>(
    formula: impl Formula<N>,
    [psi, theta, phi]: [&[T]; 3],
    mut out: [&mut [T]; N],
) {
    for i in 0..psi.len() {
        let view = View::new(theta[i], phi[i]);
        let pair =
            DirectionPair::from_zeniths(Zenith::checked(psi[i]), view.zenith, view.cos2_half_phi);
        for (out, value) in out.iter_mut().zip(formula.at(&pair)) {
            out[i] = value;
        }
    }
}

/// The formula for every view at each incidence: out has the views of the first incidence, then
/// those of the second. The sines and cosines are worked out once for each angle.
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
    let row = |(&psi, out): (&T, &mut [T])| {
        let source = Zenith::checked(psi);
        let row = Row {
            formula,
            source,
            angle: &views.angle,
            sin: &views.sin,
            cos: &views.cos,
            cos2_half_phi: &views.cos2_half_phi,
        };
        fill(row, [out]);
    };
    let (columns, count) = (theta.len().max(1), out.len());
    if count < PARALLEL_FROM {
        psi.iter().zip(out.chunks_mut(columns)).for_each(row);
    } else {
        psi.par_iter()
            .zip(out.par_chunks_mut(columns))
            .for_each(row);
    }
}

/// One view: its zenith angle without sign, and cos^2(phi/2) of the azimuth that belongs to it.
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

/// The views, an array for each number.
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

/// The views of one incidence.
#[derive(Clone, Copy)]
struct Row<'a, K, T> {
    formula: K,
    source: Zenith<T>,
    angle: &'a [T],
    sin: &'a [T],
    cos: &'a [T],
    cos2_half_phi: &'a [T],
}

impl<K: Formula, T: Primitive> Indexed<T, 1> for Row<'_, K, T> {
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
    fn at<R: Real<Stored = T>>(&self, i: usize) -> [R; 1] {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::family::each;
    use crate::{AnyBrdf, Family, ModelParameters};

    /// The processors that this one can stand for.
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
            each!(*brdf, formula => fill_by(arch, Angles { formula, angles }, [&mut out]));
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
    fn every_kind_of_processor_gives_the_same_but_for_roundings() {
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
