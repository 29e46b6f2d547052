//! Conversion of a graph to steps.

mod elementwise;
mod matrices;
mod shapes;

use std::collections::BTreeMap;

use crate::error::NetworkError;
use crate::node::{Node, shown};
use crate::proto::{Graph, Model, ValueInfo};
use crate::step::{Binary, Operation, Step, Unary};
use crate::tensor::{self, Elements, FLOAT, Tensor};
use crate::{MAX_NODES, MAX_OPERATIONS, MAX_VALUES, OPSETS};

/// Steps of a network, and the memory of their values.
#[derive(Debug, Clone, PartialEq)]
pub struct CompiledNetwork {
    pub(crate) steps: Vec<Step>,
    /// Constants, the input and the results of steps.
    pub(crate) values: Vec<Vec<f32>>,
    /// Place of the input among the values.
    pub(crate) input: usize,
    /// Place of the output.
    pub(crate) output: usize,
}

/// Returns the steps of a file.
///
/// # Errors
/// [`NetworkError`] names the first unsupported part.
pub fn compile(model: &Model) -> Result<CompiledNetwork, NetworkError> {
    let graph = model.graph.as_ref().ok_or(NetworkError::NoGraph)?;
    let standard = |domain: &str| matches!(domain, "" | "ai.onnx");
    let mut opsets = model.opset_import.iter();
    let version = opsets
        .find(|set| standard(&set.domain))
        .map_or(0, |set| set.version);
    if !OPSETS.contains(&version) {
        return Err(NetworkError::Opset { version });
    }
    limit("nodes", graph.node.len(), MAX_NODES)?;
    let mut compiler = Compiler::default();
    for constant in &graph.initializer {
        let tensor = tensor::read(constant, &constant.name)?;
        compiler.constant(&constant.name, tensor)?;
    }
    let input = compiler.input(graph)?;
    for node in &graph.node {
        compiler.node(Node(node))?;
    }
    let output = compiler.output(graph)?;
    Ok(CompiledNetwork {
        steps: compiler.steps,
        values: compiler.values,
        input,
        output,
    })
}

/// A value of the graph.
#[derive(Debug, Clone)]
enum Value {
    /// A floating-point tensor: its place among the values.
    Floats(usize),
    /// A constant shape.
    Integers(Vec<i64>),
}

#[derive(Debug, Default)]
struct Compiler {
    names: BTreeMap<String, Value>,
    /// Shapes of the values; empty while the value is unknown.
    shapes: Vec<Vec<usize>>,
    values: Vec<Vec<f32>>,
    /// `true` for constants.
    fixed: Vec<bool>,
    steps: Vec<Step>,
    elements: usize,
    operations: usize,
}

impl Compiler {
    fn place(
        &mut self,
        shape: Vec<usize>,
        values: Vec<f32>,
        is_constant: bool,
    ) -> Result<usize, NetworkError> {
        self.elements = self.elements.saturating_add(values.len());
        limit("values", self.elements, MAX_VALUES)?;
        self.shapes.push(shape);
        self.values.push(values);
        self.fixed.push(is_constant);
        Ok(self.values.len() - 1)
    }

    fn name(&mut self, name: &str, value: Value) -> Result<(), NetworkError> {
        match self.names.insert(name.to_owned(), value) {
            None => Ok(()),
            Some(_) => Err(NetworkError::Ports {
                found: format!("two values are called `{}`", shown(name)),
                expected: "a name for each",
            }),
        }
    }

    fn constant(&mut self, name: &str, tensor: Tensor) -> Result<(), NetworkError> {
        let value = match tensor.elements {
            Elements::Floats(values) => Value::Floats(self.place(tensor.shape, values, true)?),
            Elements::Integers(values) => Value::Integers(values),
        };
        self.name(name, value)
    }

    /// Adds the input of the graph.
    fn input(&mut self, graph: &Graph) -> Result<usize, NetworkError> {
        // Old files list constants among the inputs.
        let own: Vec<&ValueInfo> = graph
            .input
            .iter()
            .filter(|input| !self.names.contains_key(&input.name))
            .collect();
        let [input] = own.as_slice() else {
            return Err(NetworkError::Ports {
                found: format!("the network has {} inputs", own.len()),
                expected: "one",
            });
        };
        let refused = |found: String| NetworkError::Ports {
            found: format!("the input `{}` {found}", shown(&input.name)),
            expected: "float numbers of fixed shape; only the first dimension may be open, which is then 1",
        };
        let tensor = input.r#type.as_ref().and_then(|kind| kind.tensor.as_ref());
        let tensor = tensor.filter(|tensor| tensor.elem_type == FLOAT);
        let shape = tensor.and_then(|tensor| tensor.shape.as_ref());
        let Some(shape) = shape else {
            return Err(refused("has another type or no shape".to_owned()));
        };
        let mut dims = Vec::new();
        for (axis, dim) in shape.dim.iter().enumerate() {
            match dim.value.map(usize::try_from) {
                Some(Ok(length)) if length > 0 => dims.push(length),
                None if axis == 0 => dims.push(1),
                _ => return Err(refused(format!("has no length in dimension {axis}"))),
            }
        }
        let Some(count) = tensor::size(&dims) else {
            return Err(refused("is too large".to_owned()));
        };
        let place = self.place(dims, vec![0.0; count], false)?;
        self.name(&input.name, Value::Floats(place))?;
        Ok(place)
    }

    /// Finds the output of the graph.
    fn output(&self, graph: &Graph) -> Result<usize, NetworkError> {
        let [output] = graph.output.as_slice() else {
            return Err(NetworkError::Ports {
                found: format!("the network has {} outputs", graph.output.len()),
                expected: "one",
            });
        };
        match self.names.get(&output.name) {
            Some(&Value::Floats(place)) => Ok(place),
            _ => Err(NetworkError::Ports {
                found: format!("no node computes the output `{}`", shown(&output.name)),
                expected: "float numbers that a node computes",
            }),
        }
    }

    /// Adds the steps of a node.
    fn node(&mut self, node: Node<'_>) -> Result<(), NetworkError> {
        let operator = node.operator();
        let [output] = node.0.output.as_slice() else {
            let found = format!("it has {} outputs", node.0.output.len());
            return Err(node.refused(found, "one"));
        };
        let place = match operator.as_str() {
            "Constant" => return self.constant_node(node, output),
            "Add" => self.binary(node, Binary::Add)?,
            "Sub" => self.binary(node, Binary::Sub)?,
            "Mul" => self.binary(node, Binary::Mul)?,
            "Div" => self.binary(node, Binary::Div)?,
            "Relu" => self.unary(node, Unary::Relu)?,
            "Tanh" => self.unary(node, Unary::Tanh)?,
            "Sigmoid" => self.unary(node, Unary::Sigmoid)?,
            "Sin" => self.unary(node, Unary::Sin)?,
            "Cos" => self.unary(node, Unary::Cos)?,
            "Identity" => self.unary(node, Unary::Identity)?,
            "Clip" => self.clip(node)?,
            "Flatten" => self.flatten(node)?,
            "Reshape" => self.reshape(node)?,
            "Concat" => self.concat(node)?,
            "MatMul" => self.mat_mul(node)?,
            "Gemm" => self.gemm(node)?,
            _ => {
                return Err(NetworkError::Operator {
                    node: node.name(),
                    operator,
                });
            }
        };
        self.name(output, Value::Floats(place))
    }

    /// The place of an operand of floating-point numbers.
    fn operand(&self, node: Node<'_>, index: usize) -> Result<usize, NetworkError> {
        let name = node.input(index);
        match name.map(|name| (name, self.names.get(name))) {
            Some((_, Some(&Value::Floats(place)))) => Ok(place),
            Some((name, Some(Value::Integers(_)))) => {
                let found = format!("its input `{}` has integers", shown(name));
                Err(node.refused(found, "float numbers"))
            }
            Some((name, None)) => {
                let found = format!("its input `{}` is computed by no earlier node", shown(name));
                Err(node.refused(found, "nodes in the order of computation"))
            }
            None => Err(node.refused(format!("it lacks input {index}"), "this input")),
        }
    }

    fn shape(&self, place: usize) -> &[usize] {
        self.shapes.get(place).map_or(&[], Vec::as_slice)
    }

    /// The numbers of a constant operand.
    fn fixed(&self, node: Node<'_>, index: usize) -> Result<&[f32], NetworkError> {
        let place = self.operand(node, index)?;
        let is_fixed = self.fixed.get(place) == Some(&true);
        let values = self.values.get(place).filter(|_| is_fixed);
        values
            .map(Vec::as_slice)
            .ok_or_else(|| node.refused(format!("its input {index} is computed"), "a constant"))
    }

    /// Adds a step of so many elementary operations; returns the place of its result.
    fn step(
        &mut self,
        node: Node<'_>,
        operation: Operation,
        operands: Vec<usize>,
        shape: Vec<usize>,
        work: usize,
    ) -> Result<usize, NetworkError> {
        self.operations = self.operations.saturating_add(work);
        limit("operations per evaluation", self.operations, MAX_OPERATIONS)?;
        let Some(count) = tensor::size(&shape) else {
            let found = format!("its result has the shape {shape:?}");
            return Err(node.refused(found, format!("at most {MAX_VALUES} values")));
        };
        let result = self.place(shape, vec![0.0; count], false)?;
        self.steps.push(Step {
            operation,
            operands,
            result,
        });
        Ok(result)
    }

    fn constant_node(&mut self, node: Node<'_>, output: &str) -> Result<(), NetworkError> {
        node.check_attributes(&["value", "value_float", "value_floats", "value_ints"])?;
        let floats = |shape, values| Tensor {
            shape,
            elements: Elements::Floats(values),
        };
        let tensor = if let Some(proto) = node.attribute("value").and_then(|a| a.t.as_ref()) {
            tensor::read(proto, output)?
        } else if let Some(value) = node.attribute("value_float").and_then(|a| a.f) {
            floats(Vec::new(), vec![value])
        } else if let Some(attribute) = node.attribute("value_floats") {
            floats(vec![attribute.floats.len()], attribute.floats.clone())
        } else if let Some(attribute) = node.attribute("value_ints") {
            Tensor {
                shape: vec![attribute.ints.len()],
                elements: Elements::Integers(attribute.ints.clone()),
            }
        } else {
            return Err(node.refused("it has no value", "`value`"));
        };
        self.constant(output, tensor)
    }
}

/// Checks a number against its limit.
fn limit(what: &'static str, value: usize, max: usize) -> Result<(), NetworkError> {
    if value > max {
        return Err(NetworkError::Limit { what, value, max });
    }
    Ok(())
}
