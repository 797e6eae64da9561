//! Runs the functions of a shader on the processor, in `f32`: as much of naga's intermediate
//! representation as the exported shaders use. What validates may still compute something else.

use std::collections::HashMap;

use naga::{
    Arena, BinaryOperator, Block, Expression, Function, Handle, Literal, LocalVariable,
    MathFunction, Module, ScalarKind, Statement, UnaryOperator,
};

/// A value of a shader.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Value {
    /// A number.
    Float(f32),
    /// A whole number.
    Int(i32),
    /// A truth.
    Bool(bool),
    /// The parts of a vector, an array or a structure.
    Parts(Vec<Value>),
    /// A variable, and which part of it.
    Pointer(usize, Vec<usize>),
    /// What a variable has before it is given something.
    Unset,
}

impl Value {
    /// A vector.
    pub(crate) fn vector(components: [f32; 3]) -> Self {
        Self::Parts(components.map(Self::Float).to_vec())
    }

    /// The number that this is.
    pub(crate) fn float(&self) -> f32 {
        let Self::Float(value) = self else {
            panic!("{self:?} is no number")
        };
        *value
    }

    /// The parts of this.
    pub(crate) fn parts(&self) -> &[Value] {
        let Self::Parts(parts) = self else {
            panic!("{self:?} has no parts")
        };
        parts
    }

    fn index(&self) -> usize {
        let Self::Int(value) = self else {
            panic!("{self:?} is no index")
        };
        usize::try_from(*value).expect("an index that is not negative")
    }

    fn truth(&self) -> bool {
        let Self::Bool(value) = self else {
            panic!("{self:?} is no truth")
        };
        *value
    }

    fn part(&mut self, index: usize) -> &mut Value {
        let Self::Parts(parts) = self else {
            panic!("{self:?} has no parts")
        };
        &mut parts[index]
    }
}

/// The variables of the functions that run.
pub(crate) struct Interpreter<'a> {
    module: &'a Module,
    memory: Vec<Value>,
}

/// One call of a function.
#[derive(Default)]
struct Frame {
    arguments: Vec<Value>,
    /// Where the local variables begin in the memory.
    locals: HashMap<Handle<LocalVariable>, usize>,
    /// The expressions that have been evaluated, by their index.
    values: Vec<Option<Value>>,
}

/// The function has ended, with this value.
struct Returned(Option<Value>);

impl<'a> Interpreter<'a> {
    /// An interpreter of a module that is valid.
    pub(crate) fn new(module: &'a Module) -> Self {
        let memory = Vec::new();
        Self { module, memory }
    }

    /// The value of a function.
    pub(crate) fn call(&mut self, name: &str, arguments: &[Value]) -> Value {
        let functions = &mut self.module.functions.iter();
        let found = functions.find(|(_, function)| function.name.as_deref() == Some(name));
        let (_, function) = found.unwrap_or_else(|| panic!("no function {name}"));
        let value = self.run(function, arguments.to_vec());
        value.expect("a function with a value")
    }

    fn run(&mut self, function: &Function, arguments: Vec<Value>) -> Option<Value> {
        let base = self.memory.len();
        let mut frame = Frame {
            arguments,
            locals: HashMap::new(),
            values: vec![None; function.expressions.len()],
        };
        for (handle, variable) in function.local_variables.iter() {
            let init = variable.init;
            let init = init.map(|init| self.evaluate(&function.expressions, &frame, init));
            frame.locals.insert(handle, self.memory.len());
            self.memory.push(init.unwrap_or(Value::Unset));
        }
        let result = self.block(function, &mut frame, &function.body);
        self.memory.truncate(base);
        result.and_then(|Returned(value)| value)
    }

    fn block(&mut self, function: &Function, frame: &mut Frame, block: &Block) -> Option<Returned> {
        block
            .iter()
            .find_map(|one| self.statement(function, frame, one))
    }

    fn statement(
        &mut self,
        function: &Function,
        frame: &mut Frame,
        statement: &Statement,
    ) -> Option<Returned> {
        let arena = &function.expressions;
        match statement {
            Statement::Emit(range) => {
                for handle in range.clone() {
                    frame.values[handle.index()] = None;
                    frame.values[handle.index()] = Some(self.evaluate(arena, frame, handle));
                }
            }
            Statement::Block(inner) => return self.block(function, frame, inner),
            Statement::If {
                condition,
                accept,
                reject,
            } => {
                let holds = self.evaluate(arena, frame, *condition).truth();
                return self.block(function, frame, if holds { accept } else { reject });
            }
            Statement::Return { value } => {
                let value = value.map(|value| self.evaluate(arena, frame, value));
                return Some(Returned(value));
            }
            Statement::Store { pointer, value } => {
                let value = self.evaluate(arena, frame, *value);
                let pointer = self.evaluate(arena, frame, *pointer);
                *self.variable(&pointer) = value;
            }
            Statement::Call {
                function: called,
                arguments,
                result,
            } => {
                let arguments = arguments.iter();
                let arguments = arguments.map(|a| self.evaluate(arena, frame, *a)).collect();
                let value = self.run(&self.module.functions[*called], arguments);
                if let Some(result) = result {
                    frame.values[result.index()] = value;
                }
            }
            other => panic!("not to be met in these shaders: {other:?}"),
        }
        None
    }

    fn variable(&mut self, pointer: &Value) -> &mut Value {
        let Value::Pointer(address, path) = pointer else {
            panic!("{pointer:?} is no pointer")
        };
        let whole = &mut self.memory[*address];
        path.iter().fold(whole, |value, index| value.part(*index))
    }

    fn evaluate(
        &mut self,
        arena: &Arena<Expression>,
        frame: &Frame,
        handle: Handle<Expression>,
    ) -> Value {
        if let Some(Some(value)) = frame.values.get(handle.index()) {
            return value.clone();
        }
        let mut at = |handle: &Handle<Expression>| self.evaluate(arena, frame, *handle);
        match &arena[handle] {
            Expression::Literal(literal) => literal_value(*literal),
            Expression::Constant(constant) => {
                let module = self.module;
                let init = module.constants[*constant].init;
                self.evaluate(&module.global_expressions, &Frame::default(), init)
            }
            Expression::Compose { components, .. } => {
                Value::Parts(components.iter().map(at).collect())
            }
            Expression::Access { base, index } => {
                let index = at(index).index();
                part(at(base), index)
            }
            Expression::AccessIndex { base, index } => part(at(base), *index as usize),
            Expression::FunctionArgument(index) => frame.arguments[*index as usize].clone(),
            Expression::LocalVariable(variable) => {
                Value::Pointer(frame.locals[variable], Vec::new())
            }
            Expression::Load { pointer } => {
                let pointer = at(pointer);
                self.variable(&pointer).clone()
            }
            Expression::Unary { op, expr } => unary(*op, &at(expr)),
            Expression::Binary { op, left, right } => binary(*op, &at(left), &at(right)),
            Expression::Select {
                condition,
                accept,
                reject,
            } => {
                let holds = at(condition).truth();
                at(if holds { accept } else { reject })
            }
            Expression::Math { fun, arg, arg1, .. } => {
                let second = arg1.as_ref().map(&mut at);
                Value::Float(math(
                    *fun,
                    at(arg).float(),
                    second.as_ref().map(Value::float),
                ))
            }
            Expression::As { expr, kind, .. } => converted(&at(expr), *kind),
            other => panic!("not to be met in these shaders: {other:?}"),
        }
    }
}

fn part(base: Value, index: usize) -> Value {
    match base {
        Value::Pointer(address, mut path) => {
            path.push(index);
            Value::Pointer(address, path)
        }
        mut base => base.part(index).clone(),
    }
}

fn literal_value(literal: Literal) -> Value {
    match literal {
        Literal::F32(value) => Value::Float(value),
        Literal::I32(value) => Value::Int(value),
        Literal::Bool(value) => Value::Bool(value),
        other => panic!("not to be met in these shaders: {other:?}"),
    }
}

fn unary(op: UnaryOperator, value: &Value) -> Value {
    match (op, value) {
        (UnaryOperator::Negate, Value::Float(x)) => Value::Float(-x),
        (UnaryOperator::LogicalNot, Value::Bool(x)) => Value::Bool(!x),
        _ => panic!("not to be met in these shaders: {op:?} {value:?}"),
    }
}

fn binary(op: BinaryOperator, left: &Value, right: &Value) -> Value {
    use BinaryOperator as Op;
    match (op, left, right) {
        (Op::Add, Value::Float(a), Value::Float(b)) => Value::Float(a + b),
        (Op::Subtract, Value::Float(a), Value::Float(b)) => Value::Float(a - b),
        (Op::Multiply, Value::Float(a), Value::Float(b)) => Value::Float(a * b),
        (Op::Divide, Value::Float(a), Value::Float(b)) => Value::Float(a / b),
        (Op::Equal, Value::Float(a), Value::Float(b)) => Value::Bool(a == b),
        (Op::Less, Value::Float(a), Value::Float(b)) => Value::Bool(a < b),
        (Op::Greater, Value::Float(a), Value::Float(b)) => Value::Bool(a > b),
        (Op::GreaterEqual, Value::Float(a), Value::Float(b)) => Value::Bool(a >= b),
        (Op::Add, Value::Int(a), Value::Int(b)) => Value::Int(a + b),
        (Op::LogicalAnd, Value::Bool(a), Value::Bool(b)) => Value::Bool(*a && *b),
        _ => panic!("not to be met in these shaders: {left:?} {op:?} {right:?}"),
    }
}

fn math(function: MathFunction, x: f32, y: Option<f32>) -> f32 {
    match (function, y) {
        (MathFunction::Abs, None) => x.abs(),
        (MathFunction::Cos, None) => x.cos(),
        (MathFunction::Sin, None) => x.sin(),
        (MathFunction::Exp, None) => x.exp(),
        (MathFunction::Log, None) => x.ln(),
        (MathFunction::Sqrt, None) => x.sqrt(),
        (MathFunction::Max, Some(y)) => x.max(y),
        (MathFunction::Min, Some(y)) => x.min(y),
        _ => panic!("not to be met in these shaders: {function:?}"),
    }
}

fn converted(value: &Value, kind: ScalarKind) -> Value {
    match (value, kind) {
        #[expect(clippy::cast_possible_truncation, reason = "as the shader does")]
        (Value::Float(x), ScalarKind::Sint) => Value::Int(*x as i32),
        #[expect(clippy::cast_precision_loss, reason = "a small number")]
        (Value::Int(x), ScalarKind::Float) => Value::Float(*x as f32),
        _ => panic!("not to be met in these shaders: {value:?} as {kind:?}"),
    }
}
