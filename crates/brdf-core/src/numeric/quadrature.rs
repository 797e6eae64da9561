//! Integration by the Gauss-Kronrod rule: adaptive, or by the Gauss rule alone.

/// The positive nodes of the 15-point Kronrod rule on [-1, 1], each with its weight in that rule and
/// in the 7-point Gauss rule, which uses every second node and has weight 0 at the others (Kronrod
/// 1964).
const NODES: [(f64, f64, f64); 7] = [
    (0.991_455_371_120_812_6, 0.022_935_322_010_529_224, 0.0),
    (
        0.949_107_912_342_758_5,
        0.063_092_092_629_978_55,
        0.129_484_966_168_869_7,
    ),
    (0.864_864_423_359_769_1, 0.104_790_010_322_250_18, 0.0),
    (
        0.741_531_185_599_394_5,
        0.140_653_259_715_525_92,
        0.279_705_391_489_276_64,
    ),
    (0.586_087_235_467_691_1, 0.169_004_726_639_267_9, 0.0),
    (
        0.405_845_151_377_397_2,
        0.190_350_578_064_785_4,
        0.381_830_050_505_118_9,
    ),
    (0.207_784_955_007_898_46, 0.204_432_940_075_298_9, 0.0),
];

/// The weights of the node 0 in the Kronrod rule and in the Gauss rule.
const CENTRE: (f64, f64) = (0.209_482_141_084_727_82, 0.417_959_183_673_469_4);

/// The number of halvings in one integral, after which the estimates are accepted as they are. It is
/// ten times the number that a peak with kinks needs and ends the work on divergent integrals.
const MAX_HALVINGS: u32 = 500;

/// A way to integrate a non-negative function over the panels between ascending `breaks`, and the
/// functions that are integrals themselves.
pub(crate) trait Quadrature {
    /// The integral.
    fn integrate<const N: usize>(&self, f: &impl Fn(f64) -> f64, breaks: [f64; N]) -> f64;

    /// How the values of such a function are integrated.
    fn of_values(&self) -> Self;
}

/// To this relative tolerance, by [`integrate`].
#[derive(Clone, Copy)]
pub(crate) struct Adaptive(pub(crate) f64);

impl Quadrature for Adaptive {
    fn integrate<const N: usize>(&self, f: &impl Fn(f64) -> f64, breaks: [f64; N]) -> f64 {
        integrate(f, breaks, self.0)
    }

    fn of_values(&self) -> Self {
        Self(0.1 * self.0)
    }
}

/// By the Gauss rule of 7 points in each panel, without an estimate of the error.
#[derive(Clone, Copy)]
pub(crate) struct Rough;

impl Quadrature for Rough {
    fn integrate<const N: usize>(&self, f: &impl Fn(f64) -> f64, breaks: [f64; N]) -> f64 {
        let panels = breaks.windows(2).filter(|ends| ends[0] < ends[1]);
        let panel = |ends: &[f64]| {
            let (middle, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
            let gauss = NODES.iter().filter(|(.., weight)| *weight > 0.0);
            let pairs = gauss.map(|&(node, _, weight)| {
                weight * (f(middle - half * node) + f(middle + half * node))
            });
            half * (CENTRE.1 * f(middle) + pairs.sum::<f64>())
        };
        panels.map(panel).sum()
    }

    fn of_values(&self) -> Self {
        *self
    }
}

/// The integral of a non-negative function over the panels between ascending `breaks`.
///
/// A panel is halved until the Gauss and Kronrod estimates differ by less than `tolerance` times
/// the first estimate of the whole integral; the Kronrod estimate, which is returned, is far better
/// than that. A function that is not smooth between the breaks needs more evaluations.
pub(crate) fn integrate<const N: usize>(
    f: &impl Fn(f64) -> f64,
    breaks: [f64; N],
    tolerance: f64,
) -> f64 {
    // There is one panel less than breaks: the last stays empty, as do those between equal breaks.
    let mut panels = [Panel::default(); N];
    for (panel, ends) in panels.iter_mut().zip(breaks.windows(2)) {
        if ends[0] < ends[1] {
            *panel = Panel::new(f, ends[0], ends[1]);
        }
    }
    let allowed = tolerance * panels.iter().map(|panel| panel.estimate).sum::<f64>();
    let mut left = MAX_HALVINGS;
    panels
        .iter()
        .map(|panel| panel.refined(f, allowed, &mut left))
        .sum()
}

/// A part of the range, with its estimate and the difference between the two rules.
#[derive(Clone, Copy, Default)]
struct Panel {
    from: f64,
    to: f64,
    estimate: f64,
    error: f64,
}

impl Panel {
    fn new(f: &impl Fn(f64) -> f64, from: f64, to: f64) -> Self {
        let (estimate, error) = rule(f, from, to);
        Self {
            from,
            to,
            estimate,
            error,
        }
    }

    fn refined(&self, f: &impl Fn(f64) -> f64, allowed: f64, left: &mut u32) -> f64 {
        if self.error <= allowed || *left == 0 {
            return self.estimate;
        }
        *left -= 1;
        let middle = 0.5 * (self.from + self.to);
        let mut half = |from, to| Self::new(f, from, to).refined(f, 0.5 * allowed, left);
        half(self.from, middle) + half(middle, self.to)
    }
}

/// The Kronrod estimate and the magnitude of its difference to the Gauss estimate.
fn rule(f: &impl Fn(f64) -> f64, a: f64, b: f64) -> (f64, f64) {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    let centre = f(middle);
    let mut kronrod = CENTRE.0 * centre;
    let mut gauss = CENTRE.1 * centre;
    for (node, kronrod_weight, gauss_weight) in NODES {
        let pair = f(middle - half * node) + f(middle + half * node);
        kronrod += kronrod_weight * pair;
        gauss += gauss_weight * pair;
    }
    (half * kronrod, half * (kronrod - gauss).abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_is_exact_for_polynomials() {
        // Kronrod's 15 points integrate degree 22 exactly, Gauss's 7 degree 13.
        let (value, _) = rule(&|x: f64| x.powi(22), 0.0, 1.0);
        assert!((value - 1.0 / 23.0).abs() < 1e-15);
        let (value, error) = rule(&|x: f64| x.powi(13), 0.0, 1.0);
        assert!((value - 1.0 / 14.0).abs() < 1e-15);
        assert!(error < 1e-15);
    }

    #[test]
    fn kinks_and_peaks_meet_the_tolerance() {
        let kink = integrate(&|x: f64| (x - 0.3).abs(), [0.0, 1.0], 1e-10);
        assert!((kink - 0.29).abs() < 1e-10);
        let width = 1e-4;
        let peak = integrate(&|x: f64| width / (x * x + width * width), [0.0, 1.0], 1e-10);
        assert!((peak - (1.0 / width).atan()).abs() < 1e-9);
    }
}
