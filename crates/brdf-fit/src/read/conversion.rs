//! The conversion of readings to f_r, and the sentences that report conversions and omissions.

use std::f64::consts::PI;

/// The quantity that a file gives in place of f_r.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    /// The BRDF f_r in 1/sr.
    Brdf,
    /// The cosine-corrected BRDF, f_r cos theta, in 1/sr.
    BrdfCos,
    /// The reflectance factor, pi f_r: the radiance relative to that of a perfect diffuser.
    ReflectanceFactor,
}

impl Quantity {
    /// The quantity by its name in comments; `None` for any other text.
    pub(super) fn named(name: &str) -> Option<Self> {
        match name {
            "brdf" => Some(Self::Brdf),
            "brdf_cos" => Some(Self::BrdfCos),
            "reflectance_factor" => Some(Self::ReflectanceFactor),
            _ => None,
        }
    }

    /// f_r in 1/sr of a reading at the view zenith angle theta in radians.
    pub(super) fn to_brdf(self, reading: f64, theta: f64) -> f64 {
        match self {
            Self::Brdf => reading,
            Self::BrdfCos => reading / theta.cos(),
            Self::ReflectanceFactor => reading / PI,
        }
    }

    /// The sentence that reports the conversion; `None` where there is none.
    pub(super) fn conversion(self) -> Option<String> {
        match self {
            Self::Brdf => None,
            Self::BrdfCos => Some("BRDF cos theta is divided by cos theta".to_owned()),
            Self::ReflectanceFactor => Some("reflectance factors are divided by pi".to_owned()),
        }
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
