//! A source file: its heading, constants and functions.

use std::f64::consts::PI;

use brdf_core::{AnyBrdf, Family, Sampler};

use super::dialect::{Dialect, comment, print};
use super::formula::{evaluation, sampling};
use super::name::{NameError, check_name};
use crate::export::material::Fitted;

/// A fit that is written as source code.
pub(in crate::export) struct Source<'a> {
    /// The prefix of all names.
    pub(super) name: &'a str,
    /// The BRDF and its origin.
    fitted: &'a Fitted,
    /// The specular weights of the sampler at cos psi = (i/16)^2, i = 0 ... 16.
    specular_weights: Vec<f64>,
}

/// The parts of a file that differ from language to language, with NAME for the prefix of all
/// names. A line VALUES stands for the table of specular weights.
pub(super) struct Parts {
    /// The functions for the user, as a comment.
    pub(super) conventions: &'static str,
    /// The code before the constants.
    pub(super) opening: &'static str,
    /// The constants `OUTSIDE`, the value outside the domain, and `BELOW_ONE`, the largest number
    /// below 1, and the table of specular weights.
    pub(super) constants: &'static str,
    /// The function `specular_weight`, which interpolates in the table.
    pub(super) specular_weight: &'static str,
    /// The code after the functions.
    pub(super) closing: &'static str,
}

/// The comment above the function `specular_weight`.
const SPECULAR_WEIGHT: &str = "\
w_s, the probability of the specular lobe, interpolated between its values at cos psi = (i/16)^2. It
affects the variance of an estimate, not its mean.";

impl<'a> Source<'a> {
    /// A fit with the prefix of all names.
    ///
    /// # Errors
    ///
    /// The prefix does not pass [`check_name`].
    pub(in crate::export) fn new(name: &'a str, fitted: &'a Fitted) -> Result<Self, NameError> {
        check_name(name)?;
        let sampler = Sampler::new(&fitted.brdf);
        Ok(Self {
            name,
            fitted,
            specular_weights: sampler.specular_weights().to_vec(),
        })
    }

    /// The whole file in a language.
    pub(super) fn text<D: Dialect>(&self, dialect: &D, parts: &Parts) -> String {
        let mut text = comment::<D>(&self.heading());
        text += &comment::<D>(&self.filled(parts.conventions));
        text += &self.filled(parts.opening);
        text += &self.constants_and_functions(dialect, parts);
        text + &self.filled(parts.closing)
    }

    fn constants_and_functions<D: Dialect>(&self, dialect: &D, parts: &Parts) -> String {
        let mut text = constants(dialect, &self.fitted.brdf);
        text += &self.filled(parts.constants);
        text += &print(dialect, &evaluation(self.fitted.brdf.family()));
        text += D::BEFORE_FUNCTION;
        text += &comment::<D>(SPECULAR_WEIGHT);
        text += &self.filled(parts.specular_weight);
        text + &print(dialect, &sampling())
    }

    /// A part with the prefix and the table filled in.
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

    /// The table of specular weights, five entries a line.
    fn values(&self, indent: &str) -> String {
        let lines = self.specular_weights.chunks(5).map(|line| {
            let numbers: Vec<_> = line.iter().map(|weight| format!("{weight:?}")).collect();
            indent.to_owned() + &numbers.join(", ")
        });
        lines.collect::<Vec<_>>().join(",\n") + "\n"
    }

    /// The origin of the BRDF and the formula of the model.
    fn heading(&self) -> String {
        let terms = match self.fitted.brdf.family() {
            Family::Paper => "the model of the paper",
            Family::Smith => "the paper's facets with the shadowing of Smith",
            Family::Power => "the paper's facets with a free exponent",
            Family::Ggx => "GGX with the shadowing of Smith in the form of the paper",
            Family::Beckmann => "the facets of Beckmann in the form of the paper",
        };
        let wavelength = self.fitted.wavelength_suffix();
        let Fitted {
            file,
            e_percent,
            psi_max_deg,
            ..
        } = self.fitted;
        // The name of a file may contain any character; {:?} escapes line breaks.
        format!(
            "The BRDF of {file:?}{wavelength}, {terms}:\n\
             fitted with E = {e_percent:.4} % to incidences up to {psi_max_deg} deg.\n\n\
             {MODEL}"
        )
    }
}

/// The formula of the model, in the heading.
const MODEL: &str = "\
f_r = (k2/pi) f(alpha)/f(0) R0(gamma) G/(cos psi cos theta) + kD/pi     [1/sr]

Eq. (4) of Li Tie, Yan Wei, Wu Zhensen, Acta Optica Sinica 22(7), 769 (2002). psi is the incidence
angle, theta the view angle, alpha the tilt of the facet that mirrors one into the other, gamma the
incidence angle on it; all angles are in radians. Directions are unit vectors away from the surface,
z along its normal.
";

/// The definitions of the parameters and of pi.
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
        "Refractive index n = {:?}, minus 1 to keep its precision.",
        at.n
    );
    add(&index, "N_MINUS_1", at.n - 1.0);
    if brdf.family() == Family::Power {
        add("Exponent of the facet distribution.", "P", at.p);
    }
    text += &dialect.constant("PI", PI);
    text
}
