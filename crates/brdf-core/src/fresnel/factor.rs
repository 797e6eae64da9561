//! The trait of the forms of the Fresnel factor.

use crate::numeric::{Ratio, Real};

/// A form of the Fresnel factor R0(gamma) = R(gamma)/R(0), dimensionless.
pub trait FresnelFactor: Copy + Send + Sync {
    /// R0(gamma) from cos gamma in (0, 1] and its square.
    fn ratio<R: Real>(&self, cos_gamma: R, cos2_gamma: R) -> Ratio<R>;
}
