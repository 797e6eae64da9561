//! The parameters of the models and their domains.

/// The smallest and the largest width k1 of the model's domain, dimensionless.
pub const K1_DOMAIN: (f64, f64) = (1e-8, 1e8);

/// The smallest and the largest refractive index n of the model's domain.
pub const N_DOMAIN: (f64, f64) = (1.0, 1e5);

/// The smallest and the largest exponent p of [`Family::Power`](crate::Family::Power).
///
/// At the largest, the widest distribution, which rises like k1^(2 p) towards grazing tilts, is
/// still within the range of `f64`.
pub const P_DOMAIN: (f64, f64) = (0.1, 16.0);

/// The three parameters of the model, in the paper's order.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "RawParameters"))]
pub struct Parameters {
    /// Specular weight k2 = (pi/4) f(0) R(0) >= 0, dimensionless.
    pub k2: f64,
    /// Diffuse weight kD >= 0, the hemispherical reflectance of the Lambertian part, dimensionless.
    pub kd: f64,
    /// Width k1 of the facet distribution, within [`K1_DOMAIN`], dimensionless; a small k1 is a
    /// narrow lobe.
    pub k1: f64,
}

/// A parameter outside the model's domain.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParameterError {
    /// The specular weight is negative or not finite.
    #[error("specular weight k2 = {0}: expected a finite number >= 0")]
    K2(f64),
    /// The diffuse weight is negative or not finite.
    #[error("diffuse weight kD = {0}: expected a finite number >= 0")]
    Kd(f64),
    /// The width is outside [`K1_DOMAIN`].
    #[error("facet width k1 = {0}: expected a number in [{min:e}, {max:e}]", min = K1_DOMAIN.0, max = K1_DOMAIN.1)]
    K1(f64),
    /// The refractive index is outside [`N_DOMAIN`].
    #[error("refractive index n = {0}: expected a number in [{min}, {max:e}]", min = N_DOMAIN.0, max = N_DOMAIN.1)]
    N(f64),
    /// The exponent is outside [`P_DOMAIN`].
    #[error("exponent p = {0}: expected a number in [{min}, {max}]", min = P_DOMAIN.0, max = P_DOMAIN.1)]
    P(f64),
}

/// The parameters as a file contains them, before they are checked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct RawParameters {
    k2: f64,
    kd: f64,
    k1: f64,
}

#[cfg(feature = "serde")]
impl TryFrom<RawParameters> for Parameters {
    type Error = ParameterError;

    fn try_from(raw: RawParameters) -> Result<Self, ParameterError> {
        Self::new(raw.k2, raw.kd, raw.k1)
    }
}

impl Parameters {
    /// The parameters k2 >= 0, kD >= 0 and k1 in [`K1_DOMAIN`].
    ///
    /// # Errors
    ///
    /// [`ParameterError`] for the first of them that is outside its domain.
    pub fn new(k2: f64, kd: f64, k1: f64) -> Result<Self, ParameterError> {
        let weight = 0.0..=f64::MAX;
        if !weight.contains(&k2) {
            return Err(ParameterError::K2(k2));
        }
        if !weight.contains(&kd) {
            return Err(ParameterError::Kd(kd));
        }
        if !(K1_DOMAIN.0..=K1_DOMAIN.1).contains(&k1) {
            return Err(ParameterError::K1(k1));
        }
        Ok(Self { k2, kd, k1 })
    }
}

/// Checks a refractive index against [`N_DOMAIN`] and returns it.
///
/// # Errors
///
/// [`ParameterError::N`] if n is outside the domain or not a number.
pub fn check_refractive_index(n: f64) -> Result<f64, ParameterError> {
    if (N_DOMAIN.0..=N_DOMAIN.1).contains(&n) {
        Ok(n)
    } else {
        Err(ParameterError::N(n))
    }
}

/// Checks an exponent against [`P_DOMAIN`] and returns it.
pub(crate) fn check_exponent(p: f64) -> Result<f64, ParameterError> {
    if (P_DOMAIN.0..=P_DOMAIN.1).contains(&p) {
        Ok(p)
    } else {
        Err(ParameterError::P(p))
    }
}

/// All parameters that a model of any family has, in the order (k2, kD, k1, n, p).
///
/// They are checked when a model is made of them.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ModelParameters {
    /// Specular weight k2 >= 0, dimensionless.
    pub k2: f64,
    /// Diffuse weight kD >= 0, dimensionless.
    pub kd: f64,
    /// Width k1 of the facet distribution, within [`K1_DOMAIN`].
    pub k1: f64,
    /// Refractive index n of the facets relative to air, within [`N_DOMAIN`].
    pub n: f64,
    /// Exponent p of the facet distribution, within [`P_DOMAIN`]; 1 for families without one.
    pub p: f64,
}

impl ModelParameters {
    /// The paper's three parameters at the refractive index n, with p = 1.
    pub fn three(parameters: Parameters, n: f64) -> Self {
        let Parameters { k2, kd, k1 } = parameters;
        Self {
            k2,
            kd,
            k1,
            n,
            p: 1.0,
        }
    }

    /// The parameters k2, kD and k1.
    pub fn parameters(&self) -> Parameters {
        Parameters {
            k2: self.k2,
            kd: self.kd,
            k1: self.k1,
        }
    }
}
