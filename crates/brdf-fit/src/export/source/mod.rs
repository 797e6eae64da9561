//! Source code of one fitted BRDF: evaluation, sampling and the density of the samples, in the
//! languages of renderers and of numerical computing.
//!
//! The formulas are written once, in the files `formula/*.txt` and in a small language: `formula`
//! parses the functions, `expression` their expressions. Each language implements the trait of
//! `dialect`, which prints them; `file` puts the parts of a source file together.
//!
//! # The language of the formulas
//!
//! ```text
//! file       = function { blank line, function }
//! function   = { comment } head { statement }
//! head       = "fn " name "(" parameter { ", " parameter } ")" [ " -> vec3" ]
//! parameter  = name [ ": vec3" ]
//! statement  = indent ( comment
//!                     | "let " name " = " expression
//!                     | "condition " name " = " expression
//!                     | "return " expression )
//! comment    = "#" text
//! expression = { operator | number | name | component | call | group }
//! component  = name "." ( "x" | "y" | "z" )
//! call       = name group
//! group      = "(" expression { ", " expression } ")"
//! ```
//!
//! - A quantity is a real number, a `vec3` of three real numbers, or a truth value. `let` defines a
//!   real number, `condition` a truth value. A function returns a real number, or with `-> vec3`
//!   the vector `vec3(x, y, z)`, which occurs in its `return` statement only.
//! - Operators are copied with the spaces around them; therefore only those occur that have the
//!   same meaning and precedence in all languages: `+ - * / < > >= ==`.
//! - A number has a decimal point and is exactly representable in single precision: it is the same
//!   number in every language, whatever its type.
//! - A name in capitals is a constant of the file: the parameters `K2`, `KD`, `K1`, `N_MINUS_1`
//!   and, for the family with an exponent, `P`; `PI`; `OUTSIDE`, the value outside the domain;
//!   `BELOW_ONE`, the largest number below 1.
//! - Functions of the library are `sqrt`, `exp`, `log`, `sin`, `cos`, `abs`, `min`, `max`,
//!   `select(condition, then, otherwise)` and `both(a, b)`, the logical and. Both alternatives of
//!   `select` may be evaluated.
//! - A function is defined before it is called. Each language defines `specular_weight(cos_psi)`
//!   itself, as it interpolates in a table.

mod c;
mod dialect;
mod expression;
mod file;
mod formula;
mod glsl;
mod language;
mod name;
mod osl;
mod python;
mod wgsl;

pub(super) use file::Source;
pub use language::Language;
pub use name::NameError;
pub(super) use name::check_name;
pub(super) use python::dr_jit_functions;

/// The source file in a language.
pub(super) fn text(source: &Source, language: Language) -> String {
    match language {
        Language::C => c::header(source),
        Language::Glsl => glsl::snippet(source),
        Language::Wgsl => wgsl::snippet(source),
        Language::Osl => osl::shader(source),
        Language::Python => python::numpy_module(source),
    }
}
