//! Source code of one fitted BRDF: evaluation, sampling and its density, in the languages of
//! renderers and of those who compute. The formulas are written once, in [`formula`]; each language
//! prints them.

mod dialect;
mod expression;
mod formula;
pub(super) mod python;

use std::f64::consts::PI;
use std::fmt::Write as _;

use brdf_core::{Family, Sampler};

use super::Fitted;
use dialect::{Dialect, comment};

/// A language.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Language {
    /// Python with NumPy.
    Python,
}

/// What is written as source code.
pub(super) struct Source<'a> {
    /// The first word of all names.
    name: &'a str,
    /// The BRDF, and where it comes from.
    fitted: &'a Fitted,
}

/// Why names cannot begin so.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "\"{0}\" is no name in source code: expected letters a-z, digits and single underscores between \
     them, the first a letter, not gl or gl_..."
)]
pub struct NameError(String);

/// What the table of the sampler is.
const SPECULAR_WEIGHT: &str = "\
w_s, the part of the views that the facets mirror, between its values at cos psi = (i/16)^2. What it
is changes the variance of an estimate, and nothing else.";

/// Checks that a word is an identifier in all languages, and remains one with an underscore and
/// another word behind it, as all names have. GLSL keeps gl_ and two underscores for itself.
pub(super) fn check_name(name: &str) -> Result<(), NameError> {
    let letter = |c: char| c.is_ascii_alphabetic();
    let word = |part: &str| !part.is_empty() && part.chars().all(|c| c.is_ascii_alphanumeric());
    let first = name.split('_').next();
    if name.starts_with(letter) && name.split('_').all(word) && first != Some("gl") {
        Ok(())
    } else {
        Err(NameError(name.to_owned()))
    }
}

impl<'a> Source<'a> {
    /// A BRDF, and the first word of all names; see [`check_name`].
    pub(super) fn new(name: &'a str, fitted: &'a Fitted) -> Result<Self, NameError> {
        check_name(name)?;
        Ok(Self { name, fitted })
    }

    /// A file.
    pub(super) fn text(&self, language: Language) -> String {
        match language {
            Language::Python => python::numpy(self),
        }
    }

    /// What stands at the head of a file.
    fn heading(&self) -> String {
        let Fitted {
            file,
            wavelength_um,
            brdf,
            e_percent,
            psi_max_deg,
        } = self.fitted;
        let wavelength = wavelength_um.map_or_else(String::new, |um| format!(" at {um} um"));
        let terms = match brdf.family() {
            Family::Paper => "the model of the paper",
            Family::Smith => "the paper's facets with the shadowing of Smith",
            Family::Power => "the paper's facets with a free exponent",
            Family::Ggx => "GGX with the shadowing of Smith in the form of the paper",
            Family::Beckmann => "the facets of Beckmann in the form of the paper",
        };
        // The name of a file may have any character in it.
        format!(
            "The BRDF of {file:?}{wavelength}, {terms}:\n\
             fitted with E = {e_percent:.4} % to incidences up to {psi_max_deg} deg.\n\n\
             {MODEL}"
        )
    }

    /// The table of the sampler, five entries a line.
    fn weights(&self, indent: &str) -> String {
        let weights = Sampler::new(&self.fitted.brdf)
            .specular_weights()
            .map(|w| format!("{w:?}"));
        let lines = weights.chunks(5).map(|line| line.join(", "));
        let lines: Vec<_> = lines.map(|line| format!("{indent}{line}")).collect();
        lines.join(",\n") + "\n"
    }
}

const MODEL: &str = "\
f_r = (k2/pi) f(alpha)/f(0) R0(gamma) G/(cos psi cos theta) + kD/pi     [1/sr]

Eq. (4) of Li Tie, Yan Wei, Wu Zhensen, Acta Optica Sinica 22(7), 769 (2002). psi is the incidence
angle, theta the view angle, alpha the tilt of the facet that mirrors one into the other, gamma the
incidence angle on it; all angles are in radians. Directions are unit vectors away from the surface,
z along its normal.
";

/// The definitions of the parameters, and of pi.
fn constants<D: Dialect>(dialect: &D, source: &Source) -> String {
    let brdf = &source.fitted.brdf;
    let at = brdf.model_parameters();
    let mut text = String::new();
    let mut add = |about: &str, name, value| {
        text += &comment::<D>(about);
        text += &dialect.constant(name, value);
    };
    add("Specular weight.", "K2", at.k2);
    add(
        "Diffuse weight, the reflectance of the Lambertian part.",
        "KD",
        at.kd,
    );
    add("Width of the facet distribution.", "K1", at.k1);
    let mut index = String::new();
    let _ = write!(
        index,
        "Refractive index n = {:?}, less 1: that keeps its digits.",
        at.n
    );
    add(&index, "N_MINUS_1", at.n - 1.0);
    if brdf.family() == Family::Power {
        add("Exponent of the facet distribution.", "P", at.p);
    }
    text += &dialect.constant("PI", PI);
    text
}
