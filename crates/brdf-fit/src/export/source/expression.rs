//! Expressions of the formulas: operators, numbers, names and calls. The documentation of the
//! parent module describes them.

use std::iter::Peekable;
use std::str::Chars;

/// A sequence of terms.
pub(super) type Expression = Vec<Term>;

/// A part of an expression.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Term {
    /// Operators and the spaces around them.
    Operator(String),
    /// A number with a decimal point.
    Number(String),
    /// A parameter or a local quantity.
    Local(String),
    /// A constant, in capitals.
    Constant(String),
    /// A component of a vector: its name and the index of the component, from 0.
    Component(String, usize),
    /// A call of a function with its arguments.
    Call(String, Vec<Expression>),
    /// An expression in parentheses.
    Group(Expression),
}

/// Parses an expression, whose text is part of the program.
pub(super) fn parse(text: &str) -> Expression {
    let mut characters = text.chars().peekable();
    let mut parts = arguments(&mut characters);
    debug_assert!(parts.len() == 1 && characters.next().is_none(), "{text}");
    parts.swap_remove(0)
}

/// Parses expressions separated by commas up to a closing parenthesis or the end: at least one.
fn arguments(characters: &mut Peekable<Chars>) -> Vec<Expression> {
    let mut all = vec![Vec::new()];
    let mut last = Vec::new();
    while let Some(&character) = characters.peek() {
        match character {
            ')' => break,
            ',' => {
                characters.next();
                while characters.next_if_eq(&' ').is_some() {}
                all.push(Vec::new());
            }
            _ => last.push(term(characters)),
        }
        if let Some(expression) = all.last_mut() {
            expression.append(&mut last);
        }
    }
    all
}

fn term(characters: &mut Peekable<Chars>) -> Term {
    match characters.peek() {
        Some('(') => Term::Group(in_parentheses(characters).concat()),
        Some(c) if c.is_ascii_digit() => {
            Term::Number(run(characters, |c| c.is_ascii_digit() || c == '.'))
        }
        Some(c) if c.is_ascii_alphabetic() => named(characters),
        _ => Term::Operator(run(characters, |c| {
            !c.is_alphanumeric() && !"(),".contains(c)
        })),
    }
}

fn named(characters: &mut Peekable<Chars>) -> Term {
    let name = run(characters, |c| c.is_ascii_alphanumeric() || c == '_');
    if characters.peek() == Some(&'(') {
        return Term::Call(name, in_parentheses(characters));
    }
    if characters.next_if_eq(&'.').is_some() {
        let component = run(characters, |c| c.is_ascii_alphabetic());
        let axis = ["x", "y", "z"].iter().position(|axis| *axis == component);
        return Term::Component(name, axis.unwrap_or_default());
    }
    if name.starts_with(|c: char| c.is_ascii_uppercase()) {
        Term::Constant(name)
    } else {
        Term::Local(name)
    }
}

fn in_parentheses(characters: &mut Peekable<Chars>) -> Vec<Expression> {
    characters.next();
    let inside = arguments(characters);
    characters.next();
    inside
}

fn run(characters: &mut Peekable<Chars>, belongs: impl Fn(char) -> bool) -> String {
    let mut text = String::new();
    while let Some(character) = characters.next_if(|&c| belongs(c)) {
        text.push(character);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_of_term_is_recognised() {
        let local = |name: &str| Term::Local(name.to_owned());
        let operator = |text: &str| Term::Operator(text.to_owned());
        assert_eq!(
            parse("-K1 * max(view.z, (x + 2.0) / y)"),
            [
                operator("-"),
                Term::Constant("K1".to_owned()),
                operator(" * "),
                Term::Call(
                    "max".to_owned(),
                    vec![
                        vec![Term::Component("view".to_owned(), 2)],
                        vec![
                            Term::Group(vec![
                                local("x"),
                                operator(" + "),
                                Term::Number("2.0".to_owned())
                            ]),
                            operator(" / "),
                            local("y"),
                        ],
                    ],
                ),
            ]
        );
    }
}
