//! C99: a header.

use super::dialect::{Dialect, with_operators};
use super::file::{Parts, Source};
use super::formula::Function;
use super::name::name_in_c;

/// A header of inline functions.
pub(super) fn header(source: &Source) -> String {
    let dialect = C { name: source.name };
    source.text(&dialect, &PARTS)
}

const PARTS: Parts = Parts {
    conventions: "
NAME_eval(psi, theta, phi)                    f_r in 1/sr, angles in radians; NaN outside the domain
NAME_eval_directions(source, view)            f_r in 1/sr, unit vectors; 0 below the surface
NAME_pdf(source, view)                        density of the views that are sampled, in 1/sr
NAME_sample(source, numbers, view, density)   view and its density from three numbers of [0, 1);
                                              returns f_r cos theta / density, 0 below the surface

C99. Numbers are double, or float where BRDF_SINGLE is defined: the relative error of f_r is then at
most 1e-5 for k1 of at least 0.01 and angles up to 85 deg.",
    opening: "
#ifndef NAME_INCLUDED
#define NAME_INCLUDED

#include <math.h>

#ifndef BRDF_MATH
#ifdef BRDF_SINGLE
#define BRDF_MATH(function) function##f
#else
#define BRDF_MATH(function) function
#endif
#endif

#ifdef BRDF_SINGLE
typedef float NAME_real;
#else
typedef double NAME_real;
#endif

",
    constants: "\
static const NAME_real NAME_OUTSIDE = NAN;
#ifdef BRDF_SINGLE
static const NAME_real NAME_BELOW_ONE = 0.99999994f;
#else
static const NAME_real NAME_BELOW_ONE = 0.9999999999999999;
#endif
static const NAME_real NAME_SPECULAR_WEIGHTS[17] = {
    VALUES
};
",
    specular_weight: "\
static inline NAME_real NAME_specular_weight(NAME_real cos_psi) {
    const NAME_real position = 16.0f * BRDF_MATH(sqrt)(cos_psi);
    const int below = position > 0.0f ? (position < 15.0f ? (int)position : 15) : 0;
    const NAME_real beyond = position - (NAME_real)below;
    const NAME_real left = NAME_SPECULAR_WEIGHTS[below];
    return left + beyond * (NAME_SPECULAR_WEIGHTS[below + 1] - left);
}
",
    closing: "
static inline NAME_real NAME_sample(
    const NAME_real source[3], const NAME_real numbers[3], NAME_real view[3], NAME_real *density) {
    NAME_draw(source, numbers, view);
    *density = NAME_pdf(source, view);
    return NAME_weight(source, view);
}

#endif
",
};

/// The language, with the prefix of all names.
struct C<'a> {
    name: &'a str,
}

impl Dialect for C<'_> {
    fn prefix(&self) -> &str {
        self.name
    }

    fn named(&self, name: &str) -> String {
        format!("{}_{}", self.name, name_in_c(name))
    }

    /// A literal of the type `float`: it is the same number as a `double`, and does not turn the
    /// expression around it into one.
    fn number(&self, digits: &str) -> String {
        format!("{digits}f")
    }

    fn library_call(&self, function: &str, arguments: &[String]) -> Option<String> {
        let function = match function {
            "abs" => "fabs",
            "max" => "fmax",
            "min" => "fmin",
            "sqrt" | "exp" | "log" | "sin" | "cos" => function,
            _ => return with_operators(function, arguments),
        };
        Some(format!("BRDF_MATH({function})({})", arguments.join(", ")))
    }

    fn constant(&self, name: &str, value: f64) -> String {
        let (prefix, name) = (self.name, self.named(name));
        format!("static const {prefix}_real {name} = {value:?};\n")
    }

    fn head(&self, function: &Function) -> String {
        let real = format!("{}_real", self.name);
        let parameters = function.parameters.iter().map(|p| {
            if p.is_vector {
                format!("const {real} {}[3]", p.name)
            } else {
                format!("{real} {}", p.name)
            }
        });
        let mut parameters: Vec<_> = parameters.collect();
        let mut result = real.as_str();
        if function.returns_vector {
            parameters.push(format!("{real} result[3]"));
            result = "void";
        }
        let (name, parameters) = (self.named(function.name), parameters.join(", "));
        format!("static inline {result} {name}({parameters}) {{")
    }

    fn unused(&self, parameter: &str) -> String {
        format!("    (void){parameter};\n")
    }

    fn local(&self) -> String {
        format!("const {}_real ", self.name)
    }

    fn condition(&self) -> &'static str {
        "const int "
    }

    fn return_vector(&self, components: &[String]) -> Vec<String> {
        let all = components.iter().enumerate();
        all.map(|(axis, value)| format!("result[{axis}] = {value};"))
            .collect()
    }
}
