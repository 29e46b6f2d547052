//! Operators on single elements.

use super::Compiler;
use crate::error::NetworkError;
use crate::node::Node;
use crate::step::{Binary, Operation, Unary};
use crate::{broadcast, tensor};

impl Compiler {
    pub(super) fn unary(&mut self, node: Node<'_>, function: Unary) -> Result<usize, NetworkError> {
        node.check_attributes(&[])?;
        let operand = self.operand(node, 0)?;
        let shape = self.shape(operand).to_vec();
        self.mapped(node, function, operand, shape)
    }

    /// Adds a function of one operand with a result of this shape.
    pub(super) fn mapped(
        &mut self,
        node: Node<'_>,
        function: Unary,
        operand: usize,
        shape: Vec<usize>,
    ) -> Result<usize, NetworkError> {
        let work = self.values.get(operand).map_or(0, Vec::len);
        self.step(node, Operation::Unary(function), vec![operand], shape, work)
    }

    pub(super) fn clip(&mut self, node: Node<'_>) -> Result<usize, NetworkError> {
        node.check_attributes(&["min", "max"])?;
        let bound = |index: usize, name: &str, open: f32| match node.input(index) {
            None => node.real(name, open),
            Some(_) => match self.fixed(node, index)? {
                [bound] => Ok(*bound),
                other => {
                    let found = format!("`{name}` has {} numbers", other.len());
                    Err(node.refused(found, "one"))
                }
            },
        };
        let (min, max) = (
            bound(1, "min", f32::NEG_INFINITY)?,
            bound(2, "max", f32::INFINITY)?,
        );
        if min > max {
            let found = format!("`min` is {min} and `max` is {max}");
            return Err(node.refused(found, "`min` up to `max`"));
        }
        let operand = self.operand(node, 0)?;
        let shape = self.shape(operand).to_vec();
        self.mapped(node, Unary::Clip { min, max }, operand, shape)
    }

    pub(super) fn binary(&mut self, node: Node<'_>, kind: Binary) -> Result<usize, NetworkError> {
        node.check_attributes(&[])?;
        let (left, right) = (self.operand(node, 0)?, self.operand(node, 1)?);
        self.elementwise(node, kind, left, right)
    }

    pub(super) fn elementwise(
        &mut self,
        node: Node<'_>,
        kind: Binary,
        left: usize,
        right: usize,
    ) -> Result<usize, NetworkError> {
        let (a, b) = (self.shape(left), self.shape(right));
        let shape = broadcast::shape(a, b);
        let Some((shape, count)) = shape.and_then(|shape| {
            let count = tensor::size(&shape)?;
            Some((shape, count))
        }) else {
            let found = format!("its inputs have the shapes {a:?} and {b:?}");
            return Err(node.refused(found, "shapes that broadcast"));
        };
        // The lists of indices count as values.
        let indices = (broadcast::indices(a, &shape), broadcast::indices(b, &shape));
        let listed = [&indices.0, &indices.1].into_iter().flatten().map(Vec::len);
        self.elements = self.elements.saturating_add(listed.sum());
        let operation = Operation::Binary {
            kind,
            left: indices.0,
            right: indices.1,
        };
        self.step(node, operation, vec![left, right], shape, count)
    }
}
