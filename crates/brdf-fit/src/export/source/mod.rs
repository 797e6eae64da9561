//! Source code of one fitted BRDF: evaluation, sampling and its density, in the languages of
//! renderers and of those who compute. The formulas are written once, in [`formula`]; each language
//! prints them.

mod c;
mod dialect;
mod expression;
mod formula;
mod glsl;
mod osl;
pub(super) mod python;
mod wgsl;

use std::f64::consts::PI;

use brdf_core::{AnyBrdf, Family, Sampler};

use super::Fitted;
use dialect::{Dialect, comment, print};
use formula::{evaluation, sampling};

/// A language.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    /// C99.
    C,
    /// GLSL.
    Glsl,
    /// WGSL.
    Wgsl,
    /// The Open Shading Language.
    Osl,
    /// Python with NumPy.
    Python,
}

/// What is written as source code.
pub(super) struct Source<'a> {
    /// The first word of all names.
    name: &'a str,
    /// The BRDF, and where it comes from.
    fitted: &'a Fitted,
    /// The table of the sampler.
    specular_weights: Vec<f64>,
}

/// Why names cannot begin so.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "\"{0}\" is no name in source code: expected letters a-z, digits and single underscores between \
     them, the first a letter, not gl or gl_..."
)]
pub struct NameError(String);

/// What a language has of its own in a file, with NAME for the first word of all names and a line
/// VALUES for the table of the sampler.
struct Parts {
    /// The functions for the user, as comment.
    conventions: &'static str,
    /// What stands before the constants.
    opening: &'static str,
    /// Constants: `OUTSIDE`, the value outside the domain, and `BELOW_ONE`, the largest number below 1.
    constants: &'static str,
    /// The function `specular_weight`.
    specular_weight: &'static str,
    /// What stands behind the functions.
    closing: &'static str,
}

/// The components of a vector.
const AXES: [&str; 3] = ["x", "y", "z"];

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
        let sampler = Sampler::new(&fitted.brdf);
        Ok(Self {
            name,
            fitted,
            specular_weights: sampler.specular_weights().to_vec(),
        })
    }

    /// A file.
    pub(super) fn text(&self, language: Language) -> String {
        match language {
            Language::C => c::header(self),
            Language::Glsl => glsl::snippet(self),
            Language::Wgsl => wgsl::snippet(self),
            Language::Osl => osl::shader(self),
            Language::Python => python::numpy(self),
        }
    }

    /// A file of a language.
    fn file<D: Dialect>(&self, dialect: &D, parts: &Parts) -> String {
        let mut text = comment::<D>(&self.heading());
        text += &comment::<D>(&self.filled(parts.conventions));
        text += &self.filled(parts.opening);
        text += &self.functions(dialect, parts);
        text + &self.filled(parts.closing)
    }

    /// Constants and functions.
    fn functions<D: Dialect>(&self, dialect: &D, parts: &Parts) -> String {
        let mut text = constants(dialect, &self.fitted.brdf);
        text += &self.filled(parts.constants);
        text += &print(dialect, &evaluation(self.fitted.brdf.family()));
        text += D::BEFORE_FUNCTION;
        text += &comment::<D>(SPECULAR_WEIGHT);
        text += &self.filled(parts.specular_weight);
        text + &print(dialect, &sampling())
    }

    /// A part with the name and the table.
    fn filled(&self, part: &str) -> String {
        let mut text = String::new();
        for line in part.split_inclusive('\n') {
            match line.strip_suffix("VALUES\n") {
                Some(indent) => text += &self.values(indent),
                None => text += &line.replace("NAME", self.name),
            }
        }
        text
    }

    /// The table of the sampler, five entries a line.
    fn values(&self, indent: &str) -> String {
        let lines = self.specular_weights.chunks(5).map(|line| {
            let numbers: Vec<_> = line.iter().map(|weight| format!("{weight:?}")).collect();
            indent.to_owned() + &numbers.join(", ")
        });
        lines.collect::<Vec<_>>().join(",\n") + "\n"
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
}

const MODEL: &str = "\
f_r = (k2/pi) f(alpha)/f(0) R0(gamma) G/(cos psi cos theta) + kD/pi     [1/sr]

Eq. (4) of Li Tie, Yan Wei, Wu Zhensen, Acta Optica Sinica 22(7), 769 (2002). psi is the incidence
angle, theta the view angle, alpha the tilt of the facet that mirrors one into the other, gamma the
incidence angle on it; all angles are in radians. Directions are unit vectors away from the surface,
z along its normal.
";

/// The names that functions for the user have.
fn in_the_open(name: &str) -> &str {
    match name {
        "density" => "pdf",
        _ => name,
    }
}

/// The names that they have in shaders, where directions are what there is.
fn of_shaders(name: &str) -> &str {
    match name {
        "of_directions" => "eval",
        "of_angles" => "eval_angles",
        _ => in_the_open(name),
    }
}

/// The definitions of the parameters, and of pi.
fn constants<D: Dialect>(dialect: &D, brdf: &AnyBrdf) -> String {
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
    let index = format!(
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
