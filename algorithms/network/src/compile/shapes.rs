//! Operators on shapes.

use super::{Compiler, Value};
use crate::error::NetworkError;
use crate::node::Node;
use crate::step::{Operation, Unary};
use crate::{MAX_RANK, tensor};

impl Compiler {
    pub(super) fn flatten(&mut self, node: Node<'_>) -> Result<usize, NetworkError> {
        node.check_attributes(&["axis"])?;
        let operand = self.operand(node, 0)?;
        let shape = self.shape(operand);
        let axis = node.axis(1, shape.len(), shape.len())?;
        let (outer, inner) = shape.split_at(axis);
        let shape = vec![outer.iter().product(), inner.iter().product()];
        self.mapped(node, Unary::Identity, operand, shape)
    }

    pub(super) fn reshape(&mut self, node: Node<'_>) -> Result<usize, NetworkError> {
        node.check_attributes(&["allowzero"])?;
        let operand = self.operand(node, 0)?;
        let target = node.input(1).and_then(|name| self.names.get(name));
        let Some(Value::Integers(target)) = target else {
            return Err(node.refused("its shape is computed", "a constant shape"));
        };
        if target.len() > MAX_RANK {
            let found = format!("its shape has {} dimensions", target.len());
            return Err(node.refused(found, format!("at most {MAX_RANK}")));
        }
        let old = self.shape(operand);
        let keeps_zero = node.integer("allowzero", 0) != 0;
        let count: usize = old.iter().product();
        let refused = || {
            let found = format!("it makes {target:?} of {old:?}");
            node.refused(found, "shapes with the same number of values")
        };
        let mut shape = Vec::new();
        let mut open = None;
        for (axis, &dim) in target.iter().enumerate() {
            shape.push(match dim {
                -1 if open.is_none() => {
                    open = Some(axis);
                    1
                }
                0 if !keeps_zero => old.get(axis).copied().ok_or_else(refused)?,
                dim => usize::try_from(dim).map_err(|_| refused())?,
            });
        }
        let known = tensor::size(&shape).ok_or_else(refused)?;
        if let Some(dim) = open.and_then(|axis| shape.get_mut(axis)) {
            *dim = count.checked_div(known).ok_or_else(refused)?;
        }
        if tensor::size(&shape) != Some(count) {
            return Err(refused());
        }
        self.mapped(node, Unary::Identity, operand, shape)
    }

    pub(super) fn concat(&mut self, node: Node<'_>) -> Result<usize, NetworkError> {
        node.check_attributes(&["axis"])?;
        let inputs = 0..node.0.input.len();
        let operands: Vec<usize> = inputs
            .map(|i| self.operand(node, i))
            .collect::<Result<_, _>>()?;
        let shapes: Vec<&[usize]> = operands.iter().map(|&place| self.shape(place)).collect();
        let first = shapes.first().copied().unwrap_or_default();
        let Some(last) = first.len().checked_sub(1) else {
            return Err(node.refused("its inputs have no dimensions", "tensors of one or more"));
        };
        if node.attribute("axis").is_none() {
            return Err(node.refused("it has no `axis`", "`axis`"));
        }
        let axis = node.axis(0, first.len(), last)?;
        let mut shape = first.to_vec();
        let mut joined = 0_usize;
        let mut lengths = Vec::new();
        for own in &shapes {
            let mut rest = own.to_vec();
            match (rest.get_mut(axis), shape.get(axis)) {
                (Some(dim), Some(&other)) => *dim = other,
                _ => rest.clear(),
            }
            if rest != shape {
                let found = format!("its inputs have the shapes {first:?} and {own:?}");
                return Err(node.refused(found, "shapes that differ in `axis` alone"));
            }
            joined = joined.saturating_add(own.get(axis).copied().unwrap_or(0));
            lengths.push(own.get(axis..).unwrap_or_default().iter().product());
        }
        if let Some(dim) = shape.get_mut(axis) {
            *dim = joined;
        }
        let work = tensor::size(&shape).unwrap_or(usize::MAX);
        self.step(node, Operation::Concat { lengths }, operands, shape, work)
    }
}
