//! Compares the drawn directions with their density, as the renderers pbrt and Mitsuba do: a
//! chi-square test of histograms against the integral of the density over each bin.
//!
//! All tests over all cases use the same draws. The generators are seeded, so that runs are
//! reproducible.

use std::f64::consts::{FRAC_PI_4, PI, TAU};
use std::sync::LazyLock;

use brdf_core::published::PUBLISHED;
use brdf_core::sampling::{Sample, Sampler};
use brdf_core::{AnyBrdf, Family, ModelParameters};
use nalgebra::Vector3;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use rayon::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF};

const INCIDENCES_DEG: [f64; 5] = [0.0, 30.0, 60.0, 80.0, 89.0];
const WIDTHS: [f64; 5] = [0.001, 0.03, 0.3, 1.0, 3.0];

/// The number of draws of one case.
const DRAWS: u32 = 1 << 17;

/// The probability that the whole suite rejects a correct sampler.
const SIGNIFICANCE: f64 = 0.01;

/// The largest distance of a mean from its expectation in standard errors. A correct sampler exceeds
/// it in one of a hundred runs of the 155 cases with other seeds, in agreement with [`SIGNIFICANCE`].
const STANDARD_ERRORS: f64 = 4.0;

/// The least expected count of a bin. Bins with fewer counts are pooled, because their statistic is
/// not distributed as chi-square.
const FEWEST_EXPECTED: f64 = 5.0;

/// The azimuth of all sources, which is not aligned with any bin.
const SOURCE_AZIMUTH: f64 = 0.7;

/// The absolute tolerance of the integral of the density over a bin, a hundredth of a count.
const QUADRATURE_TOLERANCE: f64 = 1e-7;

/// A BRDF at one incidence.
struct Case {
    name: String,
    brdf: AnyBrdf,
    psi: f64,
    /// Whether the lobe is wide enough for bins over the view, which do not follow it.
    wide: bool,
}

impl Case {
    fn source(&self) -> Vector3<f64> {
        direction(self.psi, SOURCE_AZIMUTH)
    }
}

/// The results of the draws of one case.
struct Outcome {
    name: String,
    /// For each histogram the probability of a chi-square at least as large.
    probabilities: Vec<f64>,
    /// The fraction of draws without a direction, its expectation and its standard error.
    none: Mean,
    /// The mean weight, the reflectance, and the standard error.
    weight: Mean,
}

struct Mean {
    value: f64,
    expected: f64,
    standard_error: f64,
}

impl Mean {
    fn is_within_chance(&self) -> bool {
        // Without scatter, the rounding error of the expectation remains.
        let allowed = STANDARD_ERRORS * self.standard_error + 1e-6 * self.expected + 1e-7;
        (self.value - self.expected).abs() <= allowed
    }
}

fn direction(zenith: f64, azimuth: f64) -> Vector3<f64> {
    let (sin, cos) = azimuth.sin_cos();
    Vector3::new(zenith.sin() * cos, zenith.sin() * sin, zenith.cos())
}

fn published() -> impl Iterator<Item = (String, AnyBrdf)> {
    PUBLISHED.iter().map(|row| {
        let at = ModelParameters::three(row.parameters, row.n);
        let name = format!("{} at {} um", row.sample, row.wavelength_um);
        (name, AnyBrdf::new(Family::Paper, &at).unwrap())
    })
}

/// A BRDF whose two parts have the same reflectance at psi, so that each lobe gets half of the draws.
fn balanced(family: Family, k1: f64, psi: f64) -> AnyBrdf {
    let with_kd = |kd| {
        let (k2, n, p) = (0.4, 1.5, 1.7);
        AnyBrdf::new(family, &ModelParameters { k2, kd, k1, n, p }).unwrap()
    };
    let specular = with_kd(0.0).hemispherical_reflectance(psi, 1e-3).unwrap();
    with_kd(specular)
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for psi_deg in INCIDENCES_DEG {
        let psi = psi_deg.to_radians();
        for family in Family::ALL {
            for k1 in WIDTHS {
                cases.push(Case {
                    name: format!("{family:?}, k1 = {k1}, psi = {psi_deg} deg"),
                    brdf: balanced(family, k1, psi),
                    psi,
                    wide: k1 >= 0.3,
                });
            }
        }
        cases.extend(published().map(|(name, brdf)| Case {
            name: format!("{name}, psi = {psi_deg} deg"),
            brdf,
            psi,
            wide: true,
        }));
    }
    cases
}

static OUTCOMES: LazyLock<Vec<Outcome>> = LazyLock::new(|| {
    let cases = cases();
    let numbered = cases.par_iter().enumerate();
    numbered
        .map(|(seed, case)| outcome(case, seed as u64))
        .collect()
});

fn draws(sampler: &Sampler, source: &Vector3<f64>, seed: u64) -> Vec<Option<Sample>> {
    let mut generator = StdRng::seed_from_u64(seed);
    (0..DRAWS)
        .map(|_| sampler.sample(source, generator.random()).unwrap())
        .collect()
}

fn outcome(case: &Case, seed: u64) -> Outcome {
    let (sampler, source) = (Sampler::new(&case.brdf), case.source());
    let draws = draws(&sampler, &source, seed);
    let half = HalfBins::new(case);
    let expected = half.expected(&sampler, &source);
    let none = 1.0 - expected.iter().sum::<f64>();
    let mut probabilities = vec![probability(&draws, &expected, |view| {
        half.index(&source, view)
    })];
    if case.wide {
        let expected = ViewBins.expected(&sampler, &source);
        probabilities.push(probability(&draws, &expected, |view| ViewBins.index(view)));
    }
    Outcome {
        name: case.name.clone(),
        probabilities,
        none: none_mean(&draws, none),
        weight: weight_mean(&draws, case),
    }
}

fn none_mean(draws: &[Option<Sample>], expected: f64) -> Mean {
    let count = f64::from(DRAWS);
    let none = draws.iter().filter(|draw| draw.is_none()).count();
    Mean {
        value: none as f64 / count,
        expected,
        standard_error: (expected.max(0.0) * (1.0 - expected) / count).sqrt(),
    }
}

fn weight_mean(draws: &[Option<Sample>], case: &Case) -> Mean {
    let (value, variance) = mean_and_variance(weights(draws));
    Mean {
        value,
        expected: case.brdf.hemispherical_reflectance(case.psi, 1e-6).unwrap(),
        standard_error: (variance / f64::from(DRAWS)).sqrt(),
    }
}

/// The weights of the draws, with 0 for draws without a direction.
fn weights(draws: &[Option<Sample>]) -> impl ExactSizeIterator<Item = f64> + Clone {
    draws
        .iter()
        .map(|draw| draw.map_or(0.0, |sample| sample.weight))
}

fn mean_and_variance(values: impl ExactSizeIterator<Item = f64> + Clone) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.clone().sum::<f64>() / count;
    let squares = values.map(|value| (value - mean).powi(2)).sum::<f64>();
    (mean, squares / (count - 1.0))
}

/// The probability of a chi-square at least as large as that of the histogram. Draws without a
/// direction form an additional bin.
fn probability(
    draws: &[Option<Sample>],
    expected: &[f64],
    index: impl Fn(&Vector3<f64>) -> usize,
) -> f64 {
    let mut counts = vec![0_u32; expected.len() + 1];
    for draw in draws {
        counts[draw.map_or(expected.len(), |sample| index(&sample.direction.into()))] += 1;
    }
    let none = 1.0 - expected.iter().sum::<f64>();
    let expected = expected.iter().chain([&none]).map(|p| p * f64::from(DRAWS));
    let bins = pooled(expected.zip(counts.into_iter().map(f64::from)).collect());
    let squares = bins.iter().map(|(e, count)| (count - e).powi(2) / e);
    let distribution = ChiSquared::new(bins.len() as f64 - 1.0).unwrap();
    distribution.sf(squares.sum())
}

/// Bins of (expectation, count), of which those with the smallest expectations are pooled in one that is
/// large enough.
fn pooled(mut bins: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    bins.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut pool = (0.0, 0.0);
    while let Some(&(expected, count)) = bins.last() {
        if pool.0 >= FEWEST_EXPECTED && expected >= FEWEST_EXPECTED {
            break;
        }
        pool = (pool.0 + expected, pool.1 + count);
        bins.pop();
    }
    bins.push(pool);
    bins
}

/// Bins over the facet normal that mirrors the source into the view, which follow the lobe. Their
/// coordinates are asinh(tan alpha / min(k1, 1)) and the azimuth relative to the source.
struct HalfBins {
    psi: f64,
    width: f64,
    step: f64,
}

impl HalfBins {
    const TILTS: usize = 16;
    const AZIMUTHS: usize = 8;

    fn new(case: &Case) -> Self {
        let width = case.brdf.parameters().k1.min(1.0);
        // Steeper facets reflect no light above the horizon.
        let steepest = (FRAC_PI_4 + 0.5 * case.psi).tan();
        Self {
            psi: case.psi,
            width,
            step: (steepest / width).asinh() / Self::TILTS as f64,
        }
    }

    fn index(&self, source: &Vector3<f64>, view: &Vector3<f64>) -> usize {
        let half = source + view;
        let tan_alpha = half.x.hypot(half.y) / half.z;
        let tilt = (tan_alpha / self.width).asinh() / self.step;
        let azimuth = half.y.atan2(half.x) - SOURCE_AZIMUTH;
        bin(tilt, Self::TILTS) * Self::AZIMUTHS + azimuth_bin(azimuth, Self::AZIMUTHS)
    }

    /// The integral of the density over each bin.
    fn expected(&self, sampler: &Sampler, source: &Vector3<f64>) -> Vec<f64> {
        let range = |i: usize| [i, i + 1].map(|i| i as f64 * self.step);
        binned(Self::TILTS, Self::AZIMUTHS, |tilt, azimuths| {
            let ring = |x| self.ring(sampler, source, x, azimuths);
            integral(&ring, range(tilt), QUADRATURE_TOLERANCE)
        })
    }

    /// The integral over a range of azimuths in [0, pi], per unit of x = asinh(tan alpha / width).
    fn ring(&self, sampler: &Sampler, source: &Vector3<f64>, x: f64, [from, to]: [f64; 2]) -> f64 {
        let tan_alpha = self.width * x.sinh();
        let alpha = tan_alpha.atan();
        let slope = alpha.sin() * alpha.cos().powi(2) * self.width * x.cosh();
        // The view is on the horizon for 2 cos gamma cos alpha = cos psi.
        let cos_gamma = self.psi.cos() / (2.0 * alpha.cos());
        let cosine = (cos_gamma - self.psi.cos() * alpha.cos()) / (self.psi.sin() * alpha.sin());
        let horizon = cosine.clamp(-1.0, 1.0).acos();
        let density = |azimuth: f64| {
            let normal = direction(alpha, SOURCE_AZIMUTH + azimuth);
            let cos_gamma = source.dot(&normal);
            let view = 2.0 * cos_gamma * normal - source;
            if view.z <= 0.0 {
                return 0.0;
            }
            4.0 * cos_gamma * sampler.pdf(source, view.normalize()).unwrap()
        };
        if horizon <= from {
            return 0.0;
        }
        slope
            * integral(
                &density,
                [from, to.min(horizon)],
                1e-3 * QUADRATURE_TOLERANCE / slope,
            )
    }
}

/// Bins over cos theta and the azimuth of the view relative to the source.
struct ViewBins;

impl ViewBins {
    const ZENITHS: usize = 12;
    const AZIMUTHS: usize = 12;

    #[expect(clippy::unused_self, reason = "the same form as the other bins")]
    fn index(&self, view: &Vector3<f64>) -> usize {
        let azimuth = view.y.atan2(view.x) - SOURCE_AZIMUTH;
        bin(view.z * Self::ZENITHS as f64, Self::ZENITHS) * Self::AZIMUTHS
            + azimuth_bin(azimuth, Self::AZIMUTHS)
    }

    #[expect(clippy::unused_self, reason = "the same form as the other bins")]
    fn expected(&self, sampler: &Sampler, source: &Vector3<f64>) -> Vec<f64> {
        let range = |i: usize| [i, i + 1].map(|i| i as f64 / Self::ZENITHS as f64);
        binned(Self::ZENITHS, Self::AZIMUTHS, |zenith, azimuths| {
            let ring = |cos_theta: f64| {
                let density = |azimuth| {
                    let view = direction(cos_theta.acos(), SOURCE_AZIMUTH + azimuth);
                    sampler.pdf(source, view).unwrap()
                };
                integral(&density, azimuths, QUADRATURE_TOLERANCE)
            };
            integral(&ring, range(zenith), QUADRATURE_TOLERANCE)
        })
    }
}

/// The integrals over a grid of bins. The density is even in the azimuth, so that only the bins in
/// [0, pi] are computed.
fn binned(rows: usize, azimuths: usize, integral: impl Fn(usize, [f64; 2]) -> f64) -> Vec<f64> {
    let mut expected = vec![0.0; rows * azimuths];
    for row in 0..rows {
        for i in 0..azimuths / 2 {
            let range = [i, i + 1].map(|i| i as f64 * TAU / azimuths as f64);
            let value = integral(row, range);
            expected[row * azimuths + i] = value;
            expected[row * azimuths + azimuths - 1 - i] = value;
        }
    }
    expected
}

/// The bin of any azimuth.
fn azimuth_bin(azimuth: f64, bins: usize) -> usize {
    bin(azimuth.rem_euclid(TAU) / TAU * bins as f64, bins)
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "positions of bins are small and not negative"
)]
fn bin(position: f64, bins: usize) -> usize {
    (position as usize).min(bins - 1)
}

/// An integral to an absolute tolerance by the Gauss rule of five points, with bisection until the sum
/// of the halves agrees with the whole.
fn integral(f: &impl Fn(f64) -> f64, [from, to]: [f64; 2], tolerance: f64) -> f64 {
    refined(f, [from, to], gauss(f, [from, to]), tolerance, 0)
}

fn refined(
    f: &impl Fn(f64) -> f64,
    [from, to]: [f64; 2],
    whole: f64,
    tolerance: f64,
    depth: u32,
) -> f64 {
    let middle = 0.5 * (from + to);
    let [left, right] = [[from, middle], [middle, to]];
    let parts = [gauss(f, left), gauss(f, right)];
    let sum = parts[0] + parts[1];
    if (sum - whole).abs() <= tolerance || depth == 30 {
        return sum;
    }
    refined(f, left, parts[0], 0.5 * tolerance, depth + 1)
        + refined(f, right, parts[1], 0.5 * tolerance, depth + 1)
}

fn gauss(f: &impl Fn(f64) -> f64, [from, to]: [f64; 2]) -> f64 {
    const NODES: [(f64, f64); 2] = [
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (0.906_179_845_938_664, 0.236_926_885_056_189_1),
    ];
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let pairs =
        NODES.map(|(node, weight)| weight * (f(middle - half * node) + f(middle + half * node)));
    half * (128.0 / 225.0 * f(middle) + pairs[0] + pairs[1])
}

#[test]
fn directions_are_drawn_with_their_density() {
    let tests = OUTCOMES
        .iter()
        .flat_map(|outcome| {
            outcome
                .probabilities
                .iter()
                .map(move |p| (*p, &outcome.name))
        })
        .collect::<Vec<_>>();
    // Sidak's correction: all tests together reject with the probability SIGNIFICANCE.
    let limit = 1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / tests.len() as f64);
    let smallest = tests.iter().min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
    println!(
        "{} chi-square tests, limit {limit:.2e}, smallest p {:.2e} ({})",
        tests.len(),
        smallest.0,
        smallest.1
    );
    let failed = tests
        .iter()
        .filter(|(p, _)| p.is_nan() || *p < limit)
        .collect::<Vec<_>>();
    assert!(failed.is_empty(), "{failed:#?}");
}

#[test]
fn the_fraction_without_a_direction_is_one_less_the_integral_of_the_density() {
    for Outcome { name, none, .. } in OUTCOMES.iter() {
        let Mean {
            value, expected, ..
        } = none;
        assert!(
            none.is_within_chance(),
            "{name}: {value}, expected {expected}"
        );
    }
}

#[test]
fn the_mean_weight_is_the_reflectance() {
    for Outcome { name, weight, .. } in OUTCOMES.iter() {
        let Mean {
            value, expected, ..
        } = weight;
        assert!(
            weight.is_within_chance(),
            "{name}: {value}, expected {expected}"
        );
    }
}

#[test]
fn a_wrong_density_is_detected() {
    let at = |k1| Case {
        name: String::new(),
        brdf: balanced(Family::Paper, k1, 1.0),
        psi: 1.0,
        wide: true,
    };
    let (right, wrong) = (at(0.3), at(0.33));
    let source = right.source();
    let draws = draws(&Sampler::new(&right.brdf), &source, 1);
    let other = Sampler::new(&wrong.brdf);
    let half = HalfBins::new(&right);
    let by_half = probability(&draws, &half.expected(&other, &source), |view| {
        half.index(&source, view)
    });
    let by_view = probability(&draws, &ViewBins.expected(&other, &source), |view| {
        ViewBins.index(view)
    });
    assert!(by_half < 1e-6 && by_view < 1e-6, "{by_half} {by_view}");
}

/// The variances of the estimate of the reflectance by one draw, with this sampler and with cosine
/// sampling.
fn variances(brdf: &AnyBrdf, psi: f64, seed: u64) -> [f64; 2] {
    let lambertian = ModelParameters {
        k2: 0.0,
        kd: 1.0,
        k1: 1.0,
        n: 1.5,
        p: 1.0,
    };
    let cosine = Sampler::new(&AnyBrdf::new(Family::Paper, &lambertian).unwrap());
    let source = direction(psi, SOURCE_AZIMUTH);
    let by_cosine = draws(&cosine, &source, seed).into_iter().map(|draw| {
        let view = draw.unwrap().direction;
        let geometry = brdf_core::Geometry::from_directions(source, view).unwrap();
        PI * brdf.value(&geometry)
    });
    let ours = draws(&Sampler::new(brdf), &source, seed);
    [
        mean_and_variance(weights(&ours)).1,
        mean_and_variance(by_cosine.collect::<Vec<_>>().into_iter()).1,
    ]
}

#[test]
fn the_variance_is_below_that_of_cosine_sampling() {
    println!("variance of the hemispherical reflectance by one draw, over that of cosine sampling");
    for (name, brdf) in published() {
        let k1 = brdf.parameters().k1;
        let ratios = [30.0_f64, 60.0, 80.0].map(|psi_deg| {
            let [ours, cosine] = variances(&brdf, psi_deg.to_radians(), 7);
            ours / cosine
        });
        let [at_30, at_60, at_80] = ratios;
        println!("{name}, k1 = {k1}: {at_30:.4} at 30, {at_60:.4} at 60, {at_80:.4} at 80 deg");
        let limits = if k1 < 0.2 {
            [0.75, 0.1, 0.02]
        } else {
            [1.1; 3]
        };
        let below = ratios
            .iter()
            .zip(limits)
            .all(|(ratio, limit)| *ratio < limit);
        assert!(below, "{name}: {ratios:?}");
    }
}
