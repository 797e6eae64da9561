//! Colours and marks of the incidences, for print and for screens, which colour-blind readers tell
//! apart.

/// Up to so many incidences of the first sample have colours of their own.
pub(super) const FEW_CURVES: usize = FEW.len();

/// So many samples have colours of their own.
pub const FAMILIES: usize = 6;

/// What colours are seen on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ground {
    /// Paper, or a light window.
    Light,
    /// A dark window.
    Dark,
}

/// The shape of a reading's mark: a second feature beside the colour.
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
}

type Colour = [u8; 3];

/// Okabe and Ito's colours, which colour-blind readers tell apart; grey instead of their yellow,
/// which is hardly seen on white.
const FEW: [Colour; 8] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [230, 159, 0],
    [86, 180, 233],
    [0, 0, 0],
    [140, 140, 140],
];

/// The same on a dark ground: blue is lighter there, and white stands for black.
const FEW_ON_DARK: [Colour; 8] = [
    [60, 150, 220],
    [240, 120, 40],
    [0, 175, 130],
    [220, 140, 185],
    [235, 175, 40],
    [120, 205, 250],
    [245, 245, 245],
    [150, 150, 150],
];

/// Ramps from dark to light, a family each, their lightness in equal steps; the first is for more
/// incidences of the first sample than there are single colours.
const RAMPS: [[Colour; 5]; FAMILIES] = [
    [
        [40, 20, 90],
        [55, 90, 140],
        [35, 140, 135],
        [95, 190, 95],
        [215, 215, 45],
    ],
    [
        [75, 15, 10],
        [140, 45, 10],
        [205, 85, 15],
        [240, 140, 55],
        [250, 195, 130],
    ],
    [
        [10, 35, 70],
        [20, 75, 135],
        [45, 120, 190],
        [100, 165, 220],
        [160, 205, 240],
    ],
    [
        [55, 5, 70],
        [110, 25, 120],
        [165, 60, 160],
        [210, 115, 195],
        [235, 175, 225],
    ],
    [
        [30, 30, 30],
        [80, 80, 80],
        [125, 125, 125],
        [165, 165, 165],
        [205, 205, 205],
    ],
    [
        [5, 50, 25],
        [15, 95, 50],
        [45, 140, 80],
        [100, 180, 120],
        [165, 215, 170],
    ],
];

/// The colour of incidence `i` of `count`, ascending, of a sample with this family of colours; after
/// [`FAMILIES`] samples they begin again.
///
/// Up to 8 incidences of the first sample have colours of their own, others a ramp from dark to
/// light, of which each ground shows the part that is seen on it.
pub fn colour(family: usize, i: usize, count: usize, ground: Ground) -> Colour {
    let few = match ground {
        Ground::Light => &FEW,
        Ground::Dark => &FEW_ON_DARK,
    };
    let family = family % FAMILIES;
    if family == 0 && count <= few.len() {
        return few[i % few.len()];
    }
    let part = i as f64 / (count.max(2) - 1) as f64;
    let place = match ground {
        Ground::Light => 0.8 * part,
        Ground::Dark => 0.3 + 0.7 * part,
    };
    between(&RAMPS[family], place.min(1.0))
}

/// The mark of the readings of incidence `i` of a sample.
pub fn mark(family: usize, i: usize) -> MarkShape {
    const MARKS: [MarkShape; 4] = [
        MarkShape::Circle,
        MarkShape::Square,
        MarkShape::Diamond,
        MarkShape::Triangle,
    ];
    // Those of the first sample differ among themselves, the others from sample to sample.
    let place = if family == 0 { i } else { family };
    MARKS[place % MARKS.len()]
}

/// The colour at a place of a ramp, from 0 to 1.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "places and colours are small positive numbers"
)]
fn between(ramp: &[Colour; 5], place: f64) -> Colour {
    let at = place * 4.0;
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

    type Rgb = [f64; 3];

    /// Machado, Oliveira and Fernandes (2009), severity 1: what is left of linear light.
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

    fn linear(colour: Colour) -> Rgb {
        colour.map(|channel| {
            let x = f64::from(channel) / 255.0;
            if x <= 0.04045 {
                x / 12.92
            } else {
                ((x + 0.055) / 1.055).powf(2.4)
            }
        })
    }

    fn apply(matrix: &[[f64; 3]; 3], rgb: Rgb) -> Rgb {
        matrix.map(|row| {
            row.iter()
                .zip(rgb)
                .map(|(a, b)| a * b)
                .sum::<f64>()
                .clamp(0.0, 1.0)
        })
    }

    /// CIE L*a*b* under D65.
    fn lab(rgb: Rgb) -> Rgb {
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

    fn difference(a: Rgb, b: Rgb) -> f64 {
        let (a, b) = (lab(a), lab(b));
        a.iter()
            .zip(b)
            .map(|(x, y)| (x - y).powi(2))
            .sum::<f64>()
            .sqrt()
    }

    /// The least difference of two colours, as anybody sees them.
    fn least_difference(a: Colour, b: Colour) -> f64 {
        let (a, b) = (linear(a), linear(b));
        let seen = BLINDNESS
            .iter()
            .map(|m| difference(apply(m, a), apply(m, b)));
        seen.fold(difference(a, b), f64::min)
    }

    fn contrast(colour: Colour, ground: Colour) -> f64 {
        let luminance = |c: Colour| {
            let [r, g, b] = linear(c);
            0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05
        };
        let (a, b) = (luminance(colour), luminance(ground));
        a.max(b) / a.min(b)
    }

    #[test]
    fn incidences_are_told_apart_by_every_eye() {
        for ground in [Ground::Light, Ground::Dark] {
            for family in 0..FAMILIES {
                for count in [2, 5] {
                    let all: Vec<Colour> = (0..count)
                        .map(|i| colour(family, i, count, ground))
                        .collect();
                    for (i, a) in all.iter().enumerate() {
                        for b in &all[..i] {
                            let least = least_difference(*a, *b);
                            assert!(least > 7.0, "{family} {ground:?} {a:?} {b:?}: {least}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn samples_are_told_apart_by_colour_or_mark() {
        for ground in [Ground::Light, Ground::Dark] {
            for a in 1..FAMILIES {
                for b in 1..a {
                    let colours = (colour(a, 2, 5, ground), colour(b, 2, 5, ground));
                    let least = least_difference(colours.0, colours.1);
                    let other_mark = mark(a, 2) != mark(b, 2);
                    assert!(least > 5.0 || other_mark, "{a} {b} {ground:?}: {least}");
                }
            }
        }
    }

    #[test]
    fn colours_are_seen_on_their_ground() {
        for (ground, [r, g, b]) in [(Ground::Light, [255; 3]), (Ground::Dark, [27; 3])] {
            for family in 0..FAMILIES {
                for count in [5, 8, 20] {
                    for i in 0..count {
                        let colour = colour(family, i, count, ground);
                        let contrast = contrast(colour, [r, g, b]);
                        assert!(
                            contrast > 1.8,
                            "{family} {i} of {count} {ground:?}: {contrast}"
                        );
                    }
                }
            }
        }
    }
}
