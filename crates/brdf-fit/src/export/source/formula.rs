//! The formulas of a family as functions, parsed from `formula/*.txt`; the documentation of the
//! parent module describes their language.

use brdf_core::Family;

use super::expression::{Expression, parse};

/// A function.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Function {
    /// The lines of the comment above it.
    pub(super) comment: Vec<&'static str>,
    /// Its name, without the prefix of all names.
    pub(super) name: &'static str,
    /// Its parameters.
    pub(super) parameters: Vec<Parameter>,
    /// Whether it returns a vector.
    pub(super) returns_vector: bool,
    /// Its statements.
    pub(super) body: Vec<Statement>,
}

/// A parameter of a function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Parameter {
    /// Its name.
    pub(super) name: &'static str,
    /// Whether it is a vector.
    pub(super) is_vector: bool,
}

/// A line of a function.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Statement {
    /// A comment.
    Comment(&'static str),
    /// The definition of a local real number.
    Let(&'static str, Expression),
    /// The definition of a local truth value.
    Condition(&'static str, Expression),
    /// The result of the function.
    Return(Expression),
}

/// The functions that evaluate a BRDF of a family, each after those that it calls.
pub(super) fn evaluation(family: Family) -> Vec<Function> {
    let facet = match family {
        Family::Paper | Family::Smith => include_str!("formula/ellipsoid.txt"),
        Family::Power => include_str!("formula/power.txt"),
        Family::Ggx => include_str!("formula/ggx.txt"),
        Family::Beckmann => include_str!("formula/beckmann.txt"),
    };
    let shadowing = match family {
        Family::Paper | Family::Power | Family::Beckmann => include_str!("formula/v_groove.txt"),
        Family::Smith | Family::Ggx => include_str!("formula/smith.txt"),
    };
    let elementary = include_str!("formula/elementary.txt");
    let (fresnel, brdf) = (
        include_str!("formula/fresnel.txt"),
        include_str!("formula/brdf.txt"),
    );
    let texts = [elementary, fresnel, shadowing, facet, brdf];
    texts.into_iter().flat_map(functions).collect()
}

/// The functions that sample directions, each after those that it calls, which include the
/// functions of [`evaluation`] and specular_weight(cos_psi), which each language defines itself.
pub(super) fn sampling() -> Vec<Function> {
    functions(include_str!("formula/sampling.txt")).collect()
}

fn functions(text: &'static str) -> impl Iterator<Item = Function> {
    text.split("\n\n").map(function)
}

/// Parses a function. The texts are part of the program: a mistake in one is not an error of the
/// user, and the panic stops every test of its family.
fn function(text: &'static str) -> Function {
    let (comment, code): (Vec<_>, Vec<_>) = text.lines().partition(|line| line.starts_with('#'));
    let head = code.first().copied().unwrap_or_default();
    // Embedded text, which the tests of the sources parse.
    let (name, rest) = head["fn ".len()..]
        .split_once('(')
        .expect("a formula has parameters");
    let (parameters, result) = rest.split_once(')').expect("the parameters end");
    Function {
        comment: comment.into_iter().map(without_mark).collect(),
        name,
        parameters: parameters.split(", ").map(parameter).collect(),
        returns_vector: result == " -> vec3",
        body: code[1..]
            .iter()
            .map(|line| statement(line.trim()))
            .collect(),
    }
}

fn parameter(text: &'static str) -> Parameter {
    let (name, kind) = text.split_once(": ").unwrap_or((text, ""));
    Parameter {
        name,
        is_vector: kind == "vec3",
    }
}

/// Parses a line of a function; as in [`function`], the text is part of the program.
fn statement(line: &'static str) -> Statement {
    if line.starts_with('#') {
        return Statement::Comment(without_mark(line));
    }
    // Embedded text, which the tests of the sources parse.
    let (keyword, rest) = line.split_once(' ').expect("a line is a statement");
    match (keyword, rest.split_once(" = ")) {
        ("let", Some((name, value))) => Statement::Let(name, parse(value)),
        ("condition", Some((name, value))) => Statement::Condition(name, parse(value)),
        _ => Statement::Return(parse(rest)),
    }
}

fn without_mark(line: &'static str) -> &'static str {
    line[1..].strip_prefix(' ').unwrap_or(&line[1..])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::source::expression::Term;

    fn numbers(terms: &[Term]) -> Vec<String> {
        let inside = |term: &Term| match term {
            Term::Number(digits) => vec![digits.clone()],
            Term::Group(inside) => numbers(inside),
            Term::Call(_, arguments) => arguments.iter().flat_map(|a| numbers(a)).collect(),
            _ => Vec::new(),
        };
        terms.iter().flat_map(inside).collect()
    }

    #[test]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the conversion is what is tested"
    )]
    fn every_number_is_exact_in_single_precision() {
        for function in Family::ALL
            .into_iter()
            .flat_map(evaluation)
            .chain(sampling())
        {
            for statement in &function.body {
                let (Statement::Let(_, terms)
                | Statement::Condition(_, terms)
                | Statement::Return(terms)) = statement
                else {
                    continue;
                };
                for digits in numbers(terms) {
                    let number: f64 = digits.parse().unwrap();
                    assert!(
                        digits.contains('.') && f64::from(number as f32) == number,
                        "{digits}"
                    );
                }
            }
        }
    }

    #[test]
    fn functions_are_parsed_from_their_text() {
        let all = sampling();
        let named = |name| all.iter().find(|function| function.name == name).unwrap();
        let (density, draw) = (named("density"), named("draw"));
        assert!(!density.returns_vector && draw.returns_vector);
        assert!(draw.comment[0].starts_with("A view for a source"));
        let numbers = Parameter {
            name: "numbers",
            is_vector: true,
        };
        assert_eq!(draw.parameters[1], numbers);
        assert!(matches!(draw.body.last(), Some(Statement::Return(_))));
    }
}
