//! Products with matrices.

use super::Compiler;
use crate::error::NetworkError;
use crate::node::Node;
use crate::step::{Binary, Operation};

impl Compiler {
    pub(super) fn mat_mul(&mut self, node: Node<'_>) -> Result<usize, NetworkError> {
        node.check_attributes(&[])?;
        let (left, right) = (self.operand(node, 0)?, self.operand(node, 1)?);
        self.fixed(node, 1)?;
        self.product(node, left, right)
    }

    /// Adds the product of the rows of one value with a matrix.
    pub(super) fn product(
        &mut self,
        node: Node<'_>,
        left: usize,
        right: usize,
    ) -> Result<usize, NetworkError> {
        let (a, b) = (self.shape(left), self.shape(right));
        let ((Some((&length, outer)), &[inner, columns]), true) =
            ((a.split_last(), b), a.last() == b.first())
        else {
            let found = format!("it multiplies the shapes {a:?} and {b:?}");
            return Err(node.refused(found, "[…, n] and [n, m]"));
        };
        let mut shape = outer.to_vec();
        shape.push(columns);
        let rows = outer.iter().product::<usize>();
        let work = rows.saturating_mul(length).saturating_mul(columns);
        let operation = Operation::Product { inner, columns };
        self.step(node, operation, vec![left, right], shape, work)
    }

    pub(super) fn gemm(&mut self, node: Node<'_>) -> Result<usize, NetworkError> {
        node.check_attributes(&["alpha", "beta", "transA", "transB"])?;
        if node.integer("transA", 0) != 0 {
            return Err(node.refused("`transA` is set", "0"));
        }
        let left = self.operand(node, 0)?;
        if self.shape(left).len() != 2 {
            let found = format!("its first input has the shape {:?}", self.shape(left));
            return Err(node.refused(found, "two dimensions"));
        }
        let weights = self.fixed(node, 1)?;
        let place = self.operand(node, 1)?;
        let right = if node.integer("transB", 0) == 0 {
            place
        } else {
            let &[rows, columns] = self.shape(place) else {
                return Err(node.refused("its weights are no matrix", "two dimensions"));
            };
            let transposed = (0..columns)
                .flat_map(|column| weights.iter().skip(column).step_by(columns))
                .copied()
                .collect();
            self.place(vec![columns, rows], transposed, true)?
        };
        let mut sum = self.product(node, left, right)?;
        let alpha = node.real("alpha", 1.0)?;
        if alpha != 1.0 {
            let factor = self.place(Vec::new(), vec![alpha], true)?;
            sum = self.elementwise(node, Binary::Mul, sum, factor)?;
        }
        if node.input(2).is_none() {
            return Ok(sum);
        }
        let beta = node.real("beta", 1.0)?;
        let mut bias = self.operand(node, 2)?;
        if beta != 1.0 {
            let scaled = self.fixed(node, 2)?.iter().map(|c| beta * c).collect();
            let shape = self.shape(bias).to_vec();
            bias = self.place(shape, scaled, true)?;
        }
        let expected = self.shape(sum).to_vec();
        let result = self.elementwise(node, Binary::Add, sum, bias)?;
        if self.shape(result) != expected {
            let found = format!("its third input has the shape {:?}", self.shape(bias));
            return Err(node.refused(found, format!("one that broadcasts to {expected:?}")));
        }
        Ok(result)
    }
}
