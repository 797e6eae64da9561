//! How a language prints the functions of the formulas.

use std::fmt::Write as _;

use super::expression::Term;
use super::formula::{Function, Statement};
use super::name::name_in_shaders;
use crate::format::printable;

/// A language. The defaults are those of most shading languages.
pub(super) trait Dialect {
    /// The beginning of a comment that extends to the end of the line.
    const COMMENT: &'static str = "//";
    /// The end of a statement.
    const END: &'static str = ";";
    /// The empty lines before a function.
    const BEFORE_FUNCTION: &'static str = "\n";

    /// The prefix of all names.
    fn prefix(&self) -> &str;

    /// The name of a function or a constant, with the prefix.
    fn named(&self, name: &str) -> String {
        format!("{}_{}", self.prefix(), name_in_shaders(name))
    }

    /// A number, given with a decimal point, that is exact in single precision.
    fn number(&self, digits: &str) -> String {
        digits.to_owned()
    }

    /// A component of a vector.
    fn component(&self, vector: &str, axis: usize) -> String {
        format!("{vector}[{axis}]")
    }

    /// A call of a function of the library; `None` for a function of the formulas.
    fn library_call(&self, function: &str, arguments: &[String]) -> Option<String> {
        same_call(function, arguments).or_else(|| with_operators(function, arguments))
    }

    /// The definition of a constant.
    fn constant(&self, name: &str, value: f64) -> String;

    /// The first line of the definition of a function.
    fn head(&self, function: &Function) -> String;

    /// The statement that marks a parameter as unused, where the language needs one.
    fn unused(&self, _parameter: &str) -> String {
        String::new()
    }

    /// The end of the definition of a function.
    fn tail(&self) -> &'static str {
        "}\n"
    }

    /// The code before the name in the definition of a local number.
    fn local(&self) -> String;

    /// The code before the name in the definition of a local truth value.
    fn condition(&self) -> &'static str;

    /// The lines that return a vector of the given components.
    fn return_vector(&self, components: &[String]) -> Vec<String>;
}

/// A component of a vector by its name: x, y or z.
pub(super) fn named_component(vector: &str, axis: usize) -> String {
    format!("{vector}.{}", ["x", "y", "z"][axis])
}

/// The first line of a definition in a language with types before the names of parameters and
/// function.
pub(super) fn typed_head(name: &str, function: &Function, real: &str, vector: &str) -> String {
    let kind = |is_vector| if is_vector { vector } else { real };
    let parameters = function.parameters.iter();
    let parameters = parameters.map(|p| format!("{} {}", kind(p.is_vector), p.name));
    let parameters = parameters.collect::<Vec<_>>().join(", ");
    format!("{} {name}({parameters}) {{", kind(function.returns_vector))
}

/// `select` and `both` with the operators of C.
pub(super) fn with_operators(function: &str, arguments: &[String]) -> Option<String> {
    match (function, arguments) {
        ("select", [condition, then, otherwise]) => {
            Some(format!("({condition} ? {then} : {otherwise})"))
        }
        ("both", [a, b]) => Some(format!("({a} && {b})")),
        _ => None,
    }
}

/// A call of a function that has the same name in the formulas and in shading languages.
pub(super) fn same_call(function: &str, arguments: &[String]) -> Option<String> {
    let same = ["sqrt", "exp", "log", "sin", "cos", "abs", "min", "max"];
    let call = || format!("{function}({})", arguments.join(", "));
    same.contains(&function).then(call)
}

/// The definitions of functions.
pub(super) fn print<D: Dialect>(dialect: &D, functions: &[Function]) -> String {
    functions.iter().map(|one| function(dialect, one)).collect()
}

/// Lines as comments.
pub(super) fn comment<D: Dialect>(lines: &str) -> String {
    let line = |line: &str| {
        format!("{} {}", D::COMMENT, printable(line))
            .trim_end()
            .to_owned()
            + "\n"
    };
    lines.lines().map(line).collect()
}

fn function<D: Dialect>(dialect: &D, function: &Function) -> String {
    let mut text = D::BEFORE_FUNCTION.to_owned();
    text += &comment::<D>(&function.comment.join("\n"));
    let _ = writeln!(text, "{}", dialect.head(function));
    let statements = function.body.iter().flat_map(|one| statement(dialect, one));
    let body: Vec<_> = statements.map(|line| format!("    {line}\n")).collect();
    let body = body.concat();
    for parameter in &function.parameters {
        if !body.contains(parameter.name) {
            text += &dialect.unused(parameter.name);
        }
    }
    text + &body + dialect.tail()
}

fn statement<D: Dialect>(dialect: &D, statement: &Statement) -> Vec<String> {
    let end = D::END;
    let line = match statement {
        Statement::Comment(words) => format!("{} {words}", D::COMMENT),
        Statement::Let(name, value) => {
            let value = expression(dialect, value);
            format!("{}{name} = {value}{end}", dialect.local())
        }
        Statement::Condition(name, value) => {
            let value = expression(dialect, value);
            format!("{}{name} = {value}{end}", dialect.condition())
        }
        Statement::Return(value) => match value.as_slice() {
            [Term::Call(name, components)] if name == "vec3" => {
                let components: Vec<_> =
                    components.iter().map(|c| expression(dialect, c)).collect();
                return dialect.return_vector(&components);
            }
            _ => format!("return {}{end}", expression(dialect, value)),
        },
    };
    vec![line]
}

fn expression<D: Dialect>(dialect: &D, terms: &[Term]) -> String {
    terms.iter().map(|one| term(dialect, one)).collect()
}

fn term<D: Dialect>(dialect: &D, term: &Term) -> String {
    match term {
        Term::Operator(text) | Term::Local(text) => text.clone(),
        Term::Number(digits) => dialect.number(digits),
        Term::Constant(name) => dialect.named(name),
        Term::Component(vector, axis) => dialect.component(vector, *axis),
        Term::Group(inside) => format!("({})", expression(dialect, inside)),
        Term::Call(name, arguments) => {
            let arguments: Vec<_> = arguments.iter().map(|a| expression(dialect, a)).collect();
            dialect
                .library_call(name, &arguments)
                .unwrap_or_else(|| format!("{}({})", dialect.named(name), arguments.join(", ")))
        }
    }
}
