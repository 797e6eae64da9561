//! Colours and marks of the incidences for print and for screens, which colour-blind readers can
//! distinguish.

/// Up to this number of incidences of a single sample have distinct colours.
pub(super) const FEW_CURVES: usize = FEW.len();

/// The number of families of colours: up to this number of samples have distinct ones.
pub const FAMILIES: usize = 6;

/// The background of the colours.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Ground {
    /// Paper, or a light window.
    #[default]
    Light,
    /// A dark window.
    Dark,
}

/// The shape of a reading's mark, which distinguishes samples and incidences beside the colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MarkShape {
    /// A filled circle.
    Circle,
    /// A filled square.
    Square,
    /// A filled diamond.
    Diamond,
    /// A filled triangle.
    Triangle,
    /// A filled triangle with its apex below.
    Inverted,
    /// A filled cross.
    Cross,
}

/// The marks, one for each family of colours.
const MARKS: [MarkShape; FAMILIES] = [
    MarkShape::Circle,
    MarkShape::Square,
    MarkShape::Diamond,
    MarkShape::Triangle,
    MarkShape::Inverted,
    MarkShape::Cross,
];

/// Red, green and blue.
pub(super) type Rgb = [u8; 3];

type Ramp = [Rgb; 5];

/// Okabe and Ito's colours, which colour-blind readers can distinguish, with grey instead of their
/// yellow, which is hardly visible on white.
const FEW: [Rgb; 8] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [230, 159, 0],
    [86, 180, 233],
    [0, 0, 0],
    [140, 140, 140],
];

/// The same on a dark ground, with a lighter blue and with white instead of black.
const FEW_ON_DARK: [Rgb; 8] = [
    [60, 150, 220],
    [240, 120, 40],
    [0, 175, 130],
    [220, 140, 185],
    [235, 175, 40],
    [120, 205, 250],
    [245, 245, 245],
    [150, 150, 150],
];

/// A ramp from dark to light in equal steps of lightness, for more incidences of a single sample than
/// there are distinct colours.
const MANY: Ramp = [
    [40, 20, 90],
    [55, 90, 140],
    [35, 140, 135],
    [95, 190, 95],
    [215, 215, 45],
];

/// A ramp for each of several samples. The middles of any two differ by 14 or more in CIE L*a*b*, with
/// normal and with colour-blind vision; the ends cannot, so that the marks differ as well.
const RAMPS: [Ramp; FAMILIES] = [
    // Green.
    [
        [5, 50, 0],
        [15, 85, 10],
        [55, 120, 45],
        [90, 155, 75],
        [130, 195, 110],
    ],
    // Violet.
    [
        [80, 0, 120],
        [130, 20, 185],
        [170, 70, 225],
        [210, 120, 255],
        [230, 180, 255],
    ],
    // Amber.
    [
        [95, 60, 0],
        [140, 95, 0],
        [185, 125, 5],
        [235, 160, 0],
        [255, 210, 145],
    ],
    // Red.
    [
        [125, 5, 25],
        [175, 50, 55],
        [220, 90, 90],
        [255, 135, 130],
        [255, 195, 190],
    ],
    // Grey.
    [
        [35, 30, 35],
        [75, 70, 70],
        [115, 110, 115],
        [160, 155, 160],
        [210, 205, 210],
    ],
    // Magenta.
    [
        [110, 0, 90],
        [160, 45, 130],
        [200, 85, 170],
        [245, 125, 210],
        [255, 190, 235],
    ],
];

/// The colour (red, green and blue) of incidence `i` of `count` in ascending order: of a single sample
/// with `family` `None`, or of one of several samples in a family of colours. The families repeat
/// after [`FAMILIES`].
///
/// Up to 8 incidences of a single sample have distinct colours. Further ones, and those of several
/// samples, have colours of a ramp from dark to light, of which each ground uses the visible part.
pub fn colour(family: Option<usize>, i: usize, count: usize, ground: Ground) -> Rgb {
    let few = match ground {
        Ground::Light => &FEW,
        Ground::Dark => &FEW_ON_DARK,
    };
    let ramp = match family {
        None if count <= few.len() => return few[i % few.len()],
        None => &MANY,
        Some(family) => &RAMPS[family % FAMILIES],
    };
    on_ramp(ramp, i as f64 / (count.max(2) - 1) as f64, ground)
}

/// The colour that represents a sample among several: the middle of its family.
pub fn family_colour(family: usize, ground: Ground) -> Rgb {
    on_ramp(&RAMPS[family % FAMILIES], 0.5, ground)
}

/// The colour at a fraction of the visible part of a ramp.
fn on_ramp(ramp: &Ramp, fraction: f64, ground: Ground) -> Rgb {
    let fraction = match ground {
        Ground::Light => 0.8 * fraction,
        Ground::Dark => 0.3 + 0.7 * fraction,
    };
    interpolated(ramp, fraction.min(1.0))
}

/// The mark of the readings of incidence `i`. The marks of a single sample (`family` is `None`) differ
/// from incidence to incidence, those of several samples from sample to sample.
pub fn mark(family: Option<usize>, i: usize) -> MarkShape {
    match family {
        None => MARKS[i % 4],
        Some(family) => MARKS[family % FAMILIES],
    }
}

/// The colour at a fraction of a ramp, from 0 to 1.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "fractions and colours are small positive numbers"
)]
fn interpolated(ramp: &Ramp, fraction: f64) -> Rgb {
    let at = fraction * 4.0;
    let low = (at.floor() as usize).min(3);
    let part = at - low as f64;
    std::array::from_fn(|k| {
        let (a, b) = (f64::from(ramp[low][k]), f64::from(ramp[low + 1][k]));
        (a + (b - a) * part).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    type LinearRgb = [f64; 3];

    /// The transformations of linear light by colour blindness of severity 1, after Machado, Oliveira
    /// and Fernandes (2009).
    const BLINDNESS: [[[f64; 3]; 3]; 3] = [
        [
            [0.1522, 1.0525, -0.2048],
            [0.1145, 0.7862, 0.0992],
            [-0.0038, -0.0481, 1.0519],
        ],
        [
            [0.3673, 0.8606, -0.2279],
            [0.2800, 0.6725, 0.0474],
            [-0.0118, 0.0429, 0.9688],
        ],
        [
            [1.2555, -0.0767, -0.1787],
            [-0.0784, 0.9308, 0.1476],
            [0.0047, 0.6913, 0.3039],
        ],
    ];

    fn linear(colour: Rgb) -> LinearRgb {
        colour.map(|channel| {
            let x = f64::from(channel) / 255.0;
            if x <= 0.04045 {
                x / 12.92
            } else {
                ((x + 0.055) / 1.055).powf(2.4)
            }
        })
    }

    fn apply(matrix: &[[f64; 3]; 3], rgb: LinearRgb) -> LinearRgb {
        matrix.map(|row| {
            row.iter()
                .zip(rgb)
                .map(|(a, b)| a * b)
                .sum::<f64>()
                .clamp(0.0, 1.0)
        })
    }

    /// CIE L*a*b* under D65.
    fn lab(rgb: LinearRgb) -> LinearRgb {
        let xyz = [
            (0.4124 * rgb[0] + 0.3576 * rgb[1] + 0.1805 * rgb[2]) / 0.9505,
            0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2],
            (0.0193 * rgb[0] + 0.1192 * rgb[1] + 0.9505 * rgb[2]) / 1.089,
        ];
        let f = xyz.map(|t| {
            if t > 0.008_856 {
                t.cbrt()
            } else {
                7.787 * t + 16.0 / 116.0
            }
        });
        [
            116.0 * f[1] - 16.0,
            500.0 * (f[0] - f[1]),
            200.0 * (f[1] - f[2]),
        ]
    }

    fn difference(a: LinearRgb, b: LinearRgb) -> f64 {
        let (a, b) = (lab(a), lab(b));
        a.iter()
            .zip(b)
            .map(|(x, y)| (x - y).powi(2))
            .sum::<f64>()
            .sqrt()
    }

    /// The least difference of two colours, with normal and with colour-blind vision.
    fn least_difference(a: Rgb, b: Rgb) -> f64 {
        let (a, b) = (linear(a), linear(b));
        let seen = BLINDNESS
            .iter()
            .map(|m| difference(apply(m, a), apply(m, b)));
        seen.fold(difference(a, b), f64::min)
    }

    fn contrast(colour: Rgb, ground: Rgb) -> f64 {
        let luminance = |c: Rgb| {
            let [r, g, b] = linear(c);
            0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05
        };
        let (a, b) = (luminance(colour), luminance(ground));
        a.max(b) / a.min(b)
    }

    const GROUNDS: [Ground; 2] = [Ground::Light, Ground::Dark];

    /// A single sample, and each of several.
    fn samples() -> impl Iterator<Item = Option<usize>> {
        std::iter::once(None).chain((0..FAMILIES).map(Some))
    }

    #[test]
    fn incidences_are_distinguishable_with_any_colour_vision() {
        for ground in GROUNDS {
            for family in samples() {
                for count in [2, 5] {
                    let all: Vec<Rgb> = (0..count)
                        .map(|i| colour(family, i, count, ground))
                        .collect();
                    for (i, a) in all.iter().enumerate() {
                        for b in &all[..i] {
                            let least = least_difference(*a, *b);
                            assert!(least > 7.0, "{family:?} {ground:?} {a:?} {b:?}: {least}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn samples_are_distinguishable_by_their_colour() {
        for ground in GROUNDS {
            for a in 0..FAMILIES {
                for b in 0..a {
                    let colours = (family_colour(a, ground), family_colour(b, ground));
                    let least = least_difference(colours.0, colours.1);
                    assert!(least > 14.0, "{a} {b} {ground:?}: {least}");
                }
            }
        }
    }

    #[test]
    fn any_two_curves_of_two_samples_are_distinguishable_by_colour_or_mark() {
        for ground in GROUNDS {
            for (a, b) in (0..FAMILIES).flat_map(|a| (0..a).map(move |b| (a, b))) {
                for (i, j) in (0..5).flat_map(|i| (0..5).map(move |j| (i, j))) {
                    let colours = [(a, i), (b, j)].map(|(f, i)| colour(Some(f), i, 5, ground));
                    let least = least_difference(colours[0], colours[1]);
                    let other_mark = mark(Some(a), i) != mark(Some(b), j);
                    assert!(least > 5.0 || other_mark, "{a} {i}, {b} {j}: {least}");
                }
            }
        }
    }

    #[test]
    fn colours_are_visible_on_their_ground() {
        for (ground, [r, g, b]) in [(Ground::Light, [255; 3]), (Ground::Dark, [27; 3])] {
            for family in samples() {
                for count in [5, 8, 20] {
                    for i in 0..count {
                        let colour = colour(family, i, count, ground);
                        let contrast = contrast(colour, [r, g, b]);
                        assert!(
                            contrast > 1.8,
                            "{family:?} {i} of {count} {ground:?}: {contrast}"
                        );
                    }
                }
            }
        }
    }
}
