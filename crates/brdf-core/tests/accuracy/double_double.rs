//! Numbers of twice the precision of `f64`, about 31 digits: the sum of two `f64`, of which the second is at
//! most half a unit of the last place of the first.
//!
//! The sums and products without error are those of T. J. Dekker, "A floating-point technique for extending
//! the available precision", Numerische Mathematik 18, 224-242 (1971).

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// pi/2 as the sum of numbers that are each the nearest to what is left.
const FRAC_PI_2_PARTS: [f64; 3] = [
    FRAC_PI_2,
    6.123_233_995_736_766e-17,
    -1.497_384_904_859_169_8e-33,
];

#[derive(Debug, Clone, Copy)]
pub(crate) struct DoubleDouble {
    high: f64,
    low: f64,
}

/// a + b as the nearest number and its error.
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

/// a b as the nearest number and its error.
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (split(a), split(b));
    let rest = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
    (product, rest)
}

/// A number as the sum of two of 26 bits each, whose products have no error.
fn split(a: f64) -> (f64, f64) {
    let scaled = 134_217_729.0 * a;
    let high = scaled - (scaled - a);
    (high, a - high)
}

impl DoubleDouble {
    /// The nearest `f64`.
    pub(crate) fn nearest(self) -> f64 {
        self.high
    }

    pub(crate) fn sqrt(self) -> Self {
        if self.high == 0.0 {
            return self;
        }
        let root = self.high.sqrt();
        let rest = self - Self::from(root) * Self::from(root);
        Self::from(root) + Self::from(rest.high / (2.0 * root))
    }

    pub(crate) fn squared(self) -> Self {
        self * self
    }

    pub(crate) fn min(self, other: Self) -> Self {
        if (self - other).high < 0.0 {
            self
        } else {
            other
        }
    }

    pub(crate) fn max(self, other: Self) -> Self {
        if (self - other).high > 0.0 {
            self
        } else {
            other
        }
    }

    /// 1/pi.
    pub(crate) fn frac_1_pi() -> Self {
        let [high, low, _] = FRAC_PI_2_PARTS;
        Self::from(0.5) / (Self::from(high) + Self::from(low))
    }

    /// pi/2 - self, with all digits for a number next to pi/2.
    pub(crate) fn complement(self) -> Self {
        let [high, low, lowest] = FRAC_PI_2_PARTS.map(Self::from);
        // The first difference is exact for an `f64` next to pi/2.
        ((high - self) + low) + lowest
    }

    /// The number less the nearest multiple of pi/2, with all digits, and whether the multiple is odd.
    pub(crate) fn modulo_right_angle(self) -> (Self, bool) {
        let multiple = (self.high / FRAC_PI_2).round();
        let rest = FRAC_PI_2_PARTS.iter().fold(self, |rest, &part| {
            rest - Self::from(multiple) * Self::from(part)
        });
        (rest, multiple % 2.0 != 0.0)
    }

    /// sin self, for a number in [-pi/2, pi/2].
    pub(crate) fn sin(self) -> Self {
        if self.high.abs() <= FRAC_PI_4 {
            return self * self.series(2);
        }
        let sin = self.abs().complement().series(1);
        if self.high > 0.0 { sin } else { -sin }
    }

    /// cos self, for a number in [-pi/2, pi/2].
    pub(crate) fn cos(self) -> Self {
        if self.high.abs() <= FRAC_PI_4 {
            return self.series(1);
        }
        self.abs().complement().sin()
    }

    fn abs(self) -> Self {
        if self.high < 0.0 { -self } else { self }
    }

    /// The sum of (-1)^k self^(2k) / (first (first + 1) ... (first + 2k - 1)) for |self| <= pi/4: the cosine
    /// for first = 1 and sin self / self for first = 2.
    fn series(self, first: u32) -> Self {
        let square = self * self;
        let mut sum = Self::from(1.0);
        for k in (0..17).rev() {
            let divisor = f64::from((first + 2 * k) * (first + 2 * k + 1));
            sum = Self::from(1.0) - square * sum / Self::from(divisor);
        }
        sum
    }
}

impl From<f64> for DoubleDouble {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Add for DoubleDouble {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (high, rest) = two_sum(self.high, other.high);
        let (low, lowest) = two_sum(self.low, other.low);
        let (high, rest) = two_sum(high, rest + low);
        let (high, low) = two_sum(high, rest + lowest);
        Self { high, low }
    }
}

impl Neg for DoubleDouble {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let (high, rest) = two_product(self.high, other.high);
        let (high, low) = two_sum(high, rest + (self.high * other.low + self.low * other.high));
        Self { high, low }
    }
}

impl Div for DoubleDouble {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * Self::from(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::from(second);
        Self::from(first) + Self::from(second) + Self::from(rest.high / other.high)
    }
}

#[test]
fn functions_have_thirty_digits() {
    let number = DoubleDouble::from;
    let agree = |a: DoubleDouble, b: DoubleDouble| ((a - b) / b).nearest().abs() < 1e-30;
    let x = number(0.7) / number(3.0);
    assert!(agree(x.sqrt().squared(), x));
    // The double angle, up to beyond pi/4.
    let [double, four] = [x + x, x + x + x + x];
    assert!(agree(x.sin().squared() + x.cos().squared(), number(1.0)));
    assert!(agree(x.sin() * x.cos() * number(2.0), double.sin()));
    assert!(agree(double.sin() * double.cos() * number(2.0), four.sin()));
    assert!(agree(
        four.sin().squared() + four.cos().squared(),
        number(1.0)
    ));
    // The nearest numbers to pi/2, pi and 8 pi.
    let [_, rest, lowest] = FRAC_PI_2_PARTS;
    let missing = number(rest) + number(lowest);
    assert!(agree(number(FRAC_PI_2).cos(), missing));
    assert!(agree(
        number(PI).modulo_right_angle().0.sin(),
        -missing * number(2.0)
    ));
    assert!(agree(
        number(8.0 * PI).modulo_right_angle().0.sin(),
        -missing * number(16.0)
    ));
}
