//! The conversion of readings to f_r, and the sentences that report conversions and omissions.

use std::f64::consts::{LN_10, PI};
use std::fmt;

/// What a file gives in place of f_r, before its scale.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// The BRDF f_r in 1/sr.
    Brdf,
    /// The cosine-corrected BRDF, f_r cos theta, in 1/sr.
    BrdfCos,
    /// The reflectance factor, pi f_r: the radiance relative to that of a perfect diffuser.
    ReflectanceFactor,
}

/// The scale of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scale {
    /// The value itself.
    One,
    /// The value in percent.
    Percent,
    /// The decadic logarithm of the value.
    Log10,
    /// Ten times the decadic logarithm of the value.
    Decibel,
}

/// The quantity that a file gives in place of f_r.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Quantity {
    pub(super) kind: Kind,
    pub(super) scale: Scale,
}

impl Quantity {
    /// f_r in 1/sr.
    pub(super) const BRDF: Self = Self::of(Kind::Brdf);

    /// A quantity without a scale.
    pub(super) const fn of(kind: Kind) -> Self {
        Self {
            kind,
            scale: Scale::One,
        }
    }

    /// f_r in 1/sr of a reading at the view zenith angle theta in radians.
    pub(super) fn to_brdf(self, reading: f64, theta: f64) -> f64 {
        let value = match self.scale {
            Scale::One => reading,
            Scale::Percent => reading / 100.0,
            Scale::Log10 => 10_f64.powf(reading),
            Scale::Decibel => 10_f64.powf(reading / 10.0),
        };
        match self.kind {
            Kind::Brdf => value,
            Kind::BrdfCos => value / theta.cos(),
            Kind::ReflectanceFactor => value / PI,
        }
    }

    /// The standard deviation of f_r, from that of a reading; for logarithms by the first derivative.
    pub(super) fn deviation(self, sigma: f64, reading: f64, theta: f64) -> f64 {
        match self.scale {
            Scale::One | Scale::Percent => self.to_brdf(sigma, theta),
            Scale::Log10 => self.to_brdf(reading, theta) * LN_10 * sigma,
            Scale::Decibel => self.to_brdf(reading, theta) * LN_10 / 10.0 * sigma,
        }
    }

    /// The sentence that reports the conversion; `None` where there is none.
    pub(super) fn conversion(self) -> Option<String> {
        let scale = match self.scale {
            Scale::One => None,
            Scale::Percent => Some("values in percent are divided by 100"),
            Scale::Log10 => Some("values are decadic logarithms: 10^value is taken"),
            Scale::Decibel => Some("values are in dB: 10^(value/10) is taken"),
        };
        let kind = match self.kind {
            Kind::Brdf => None,
            Kind::BrdfCos => Some("BRDF cos theta is divided by cos theta"),
            Kind::ReflectanceFactor => Some("reflectance factors are divided by pi"),
        };
        let sentences: Vec<&str> = scale.into_iter().chain(kind).collect();
        (!sentences.is_empty()).then(|| sentences.join("; "))
    }
}

/// The quantity in words.
impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.scale {
            Scale::Log10 => "the decadic logarithm of ",
            Scale::Decibel => "ten times the decadic logarithm of ",
            Scale::One | Scale::Percent => "",
        })?;
        f.write_str(match self.kind {
            Kind::Brdf => "f_r",
            Kind::BrdfCos => "f_r cos theta",
            Kind::ReflectanceFactor => "the reflectance factor",
        })?;
        match self.scale {
            Scale::Percent => f.write_str(" in percent"),
            _ => Ok(()),
        }
    }
}

/// The quantity of the values of a file, and the factor by which they are multiplied first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Values {
    pub(super) quantity: Quantity,
    pub(super) factor: f64,
}

impl Values {
    /// f_r in 1/sr of a reading at the view zenith angle theta in radians.
    pub(super) fn to_brdf(self, reading: f64, theta: f64) -> f64 {
        self.quantity.to_brdf(self.factor * reading, theta)
    }

    /// The standard deviation of f_r, from that of a reading.
    pub(super) fn deviation(self, sigma: f64, reading: f64, theta: f64) -> f64 {
        let (sigma, reading) = (self.factor * sigma, self.factor * reading);
        self.quantity.deviation(sigma, reading, theta)
    }

    /// The sentences that report the conversions.
    pub(super) fn conversions(self) -> Vec<String> {
        let factor =
            (self.factor != 1.0).then(|| format!("values are multiplied by {}", self.factor));
        factor
            .into_iter()
            .chain(self.quantity.conversion())
            .collect()
    }
}

/// The sentence that reports how many readings were left out, and which; `None` where none was.
pub(super) fn left_out(count: usize, which: &str) -> Option<String> {
    match count {
        0 => None,
        1 => Some(format!("1 reading {which} is left out")),
        _ => Some(format!("{count} readings {which} are left out")),
    }
}

/// Which readings are left out because a direction is not above the surface.
pub(super) const BEYOND_HORIZON: &str = "at or beyond 90 deg from the normal";

/// Which readings are left out because there is no value.
pub(super) const NOT_TAKEN: &str = "not taken (no value)";

/// How many readings are left out, by the reason.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct LeftOut {
    pub(super) not_taken: usize,
    pub(super) beyond: usize,
}

impl LeftOut {
    /// The sentences that report the numbers.
    pub(super) fn notes(self) -> impl Iterator<Item = String> {
        let not_taken = left_out(self.not_taken, NOT_TAKEN);
        let beyond = left_out(self.beyond, BEYOND_HORIZON);
        not_taken.into_iter().chain(beyond)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scale_of_every_kind_gives_the_same_f_r() {
        let (f, theta) = (0.25, 0.8_f64);
        for (kind, value) in [
            (Kind::Brdf, f),
            (Kind::BrdfCos, f * theta.cos()),
            (Kind::ReflectanceFactor, f * PI),
        ] {
            for (scale, reading) in [
                (Scale::One, value),
                (Scale::Percent, 100.0 * value),
                (Scale::Log10, value.log10()),
                (Scale::Decibel, 10.0 * value.log10()),
            ] {
                let quantity = Quantity { kind, scale };
                let found = quantity.to_brdf(reading, theta);
                assert!((found / f - 1.0).abs() < 1e-14, "{quantity}: {found}");
                // A small deviation of the reading is the difference of two conversions.
                let step = 1e-6;
                let slope = (quantity.to_brdf(reading + step, theta) - found) / step;
                let deviation = quantity.deviation(step, reading, theta) / step;
                assert!((deviation / slope - 1.0).abs() < 1e-4, "{quantity}");
            }
        }
    }
}
