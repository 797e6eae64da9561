//! Languages: how each prints the functions of the formulas.

use std::fmt::Write as _;

use super::expression::Term;
use super::formula::{Function, Statement};

/// A language.
pub(super) trait Dialect {
    /// What begins a comment up to the end of the line.
    const COMMENT: &'static str;
    /// What ends a statement.
    const END: &'static str = ";";
    /// The empty lines before a function.
    const BEFORE_FUNCTION: &'static str = "\n";

    /// The name of a function or a constant, with the first word that all names have.
    fn named(&self, name: &str) -> String;

    /// A number that `f32` has too, given with a point.
    fn number(&self, digits: &str) -> String {
        digits.to_owned()
    }

    /// A component of a vector.
    fn component(&self, vector: &str, axis: usize) -> String {
        format!("{vector}[{axis}]")
    }

    /// A call of a function that the language has; nothing if it is one of the formulas.
    fn library_call(&self, function: &str, arguments: &[String]) -> Option<String>;

    /// The definition of a constant.
    fn constant(&self, name: &str, value: f64) -> String;

    /// The first line of a function.
    fn head(&self, function: &Function) -> String;

    /// What is said of a parameter that a function makes no use of.
    fn unused(&self, _parameter: &str) -> String {
        String::new()
    }

    /// What ends a function.
    fn tail(&self) -> &'static str {
        "}\n"
    }

    /// The words before the name of a local number.
    fn local(&self) -> String;

    /// The words before the name of a local truth.
    fn condition(&self) -> &'static str;

    /// The lines that return a vector.
    fn return_vector(&self, components: &[String]) -> Vec<String>;
}

/// The first line of a function in a language that has kinds before names, the result's too.
pub(super) fn typed_head(name: &str, function: &Function, real: &str, vector: &str) -> String {
    let kind = |is_vector| if is_vector { vector } else { real };
    let parameters = function.parameters.iter();
    let parameters = parameters.map(|p| format!("{} {}", kind(p.is_vector), p.name));
    let parameters = parameters.collect::<Vec<_>>().join(", ");
    format!("{} {name}({parameters}) {{", kind(function.returns_vector))
}

/// `select` and `both` by the operators of C.
pub(super) fn with_operators(function: &str, arguments: &[String]) -> Option<String> {
    match (function, arguments) {
        ("select", [condition, then, otherwise]) => {
            Some(format!("({condition} ? {then} : {otherwise})"))
        }
        ("both", [a, b]) => Some(format!("({a} && {b})")),
        _ => None,
    }
}

/// A call of a function that has the same name in the formulas and in the languages of shaders.
pub(super) fn same_call(function: &str, arguments: &[String]) -> Option<String> {
    let same = ["sqrt", "exp", "log", "sin", "cos", "abs", "min", "max"];
    let call = || format!("{function}({})", arguments.join(", "));
    same.contains(&function).then(call)
}

/// The functions.
pub(super) fn print<D: Dialect>(dialect: &D, functions: &[Function]) -> String {
    functions.iter().map(|one| function(dialect, one)).collect()
}

/// Comment lines.
pub(super) fn comment<D: Dialect>(lines: &str) -> String {
    let line = |line: &str| format!("{} {line}", D::COMMENT).trim_end().to_owned() + "\n";
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
            let of_library = dialect.library_call(name, &arguments);
            of_library
                .unwrap_or_else(|| format!("{}({})", dialect.named(name), arguments.join(", ")))
        }
    }
}
