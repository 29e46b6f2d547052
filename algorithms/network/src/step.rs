//! One step of an evaluation.

use geometry::math;

/// Operation on two operands, element by element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Binary {
    Add,
    Sub,
    Mul,
    Div,
}

/// Function of one operand, element by element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unary {
    Identity,
    Relu,
    Tanh,
    Sigmoid,
    Sin,
    Cos,
    Clip { min: f32, max: f32 },
}

/// Computation of one value from others.
#[derive(Debug, Clone, PartialEq)]
pub enum Operation {
    /// Product of a matrix with rows of length `inner` and one of `inner` rows of length `columns`.
    Product { inner: usize, columns: usize },
    /// Operation on two operands; the indices of their elements for each element of the result, if they differ.
    Binary {
        kind: Binary,
        left: Option<Vec<u32>>,
        right: Option<Vec<u32>>,
    },
    /// Function of one operand.
    Unary(Unary),
    /// Pieces of the operands in turn; the lengths of the pieces.
    Concat { lengths: Vec<usize> },
}

/// One step: an operation, its operands and its result, by their places among the values.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    pub(crate) operation: Operation,
    pub(crate) operands: Vec<usize>,
    pub(crate) result: usize,
}

impl Operation {
    /// Computes the result, whose length is fixed.
    pub(crate) fn compute<'a>(&self, operand: impl Fn(usize) -> &'a [f32], out: &mut [f32]) {
        match self {
            Self::Product { inner, columns } => {
                product(operand(0), operand(1), *inner, *columns, out);
            }
            Self::Binary { kind, left, right } => {
                binary(*kind, (operand(0), left), (operand(1), right), out);
            }
            Self::Unary(function) => {
                for (out, &x) in out.iter_mut().zip(operand(0)) {
                    *out = function.apply(x);
                }
            }
            Self::Concat { lengths } => concat(lengths, operand, out),
        }
    }
}

/// Adds the products of each sum in the order of `inner`. Only independent sums run beside each other, so that vector
/// instructions do not change their order.
fn product(left: &[f32], right: &[f32], inner: usize, columns: usize, out: &mut [f32]) {
    out.fill(0.0);
    if inner == 0 || columns == 0 {
        return;
    }
    let rows = left.chunks_exact(inner);
    for (row, sums) in rows.zip(out.chunks_exact_mut(columns)) {
        for (&factor, weights) in row.iter().zip(right.chunks_exact(columns)) {
            for (sum, &weight) in sums.iter_mut().zip(weights) {
                *sum += factor * weight;
            }
        }
    }
}

type IndexedValues<'a> = (&'a [f32], &'a Option<Vec<u32>>);

fn binary(kind: Binary, left: IndexedValues<'_>, right: IndexedValues<'_>, out: &mut [f32]) {
    let element = |(values, indices): IndexedValues<'_>, i: usize| {
        let i = match indices {
            None => Some(i),
            Some(indices) => indices.get(i).map(|&i| i as usize),
        };
        i.and_then(|i| values.get(i).copied()).unwrap_or(f32::NAN)
    };
    for (i, out) in out.iter_mut().enumerate() {
        let (a, b) = (element(left, i), element(right, i));
        *out = match kind {
            Binary::Add => a + b,
            Binary::Sub => a - b,
            Binary::Mul => a * b,
            Binary::Div => a / b,
        };
    }
}

impl Unary {
    /// The function's value.
    fn apply(self, x: f32) -> f32 {
        match self {
            Self::Relu if x < 0.0 => 0.0,
            Self::Tanh => math::tanh(f64::from(x)) as f32,
            Self::Sigmoid => (1.0 / (1.0 + math::exp(-f64::from(x)))) as f32,
            Self::Sin => math::sin(f64::from(x)) as f32,
            Self::Cos => math::cos(f64::from(x)) as f32,
            Self::Clip { min, .. } if x < min => min,
            Self::Clip { max, .. } if x > max => max,
            Self::Identity | Self::Relu | Self::Clip { .. } => x,
        }
    }
}

fn concat<'a>(lengths: &[usize], operand: impl Fn(usize) -> &'a [f32], out: &mut [f32]) {
    let whole: usize = lengths.iter().sum();
    if whole == 0 {
        return;
    }
    for (turn, out) in out.chunks_exact_mut(whole).enumerate() {
        let mut rest = out;
        for (i, &length) in lengths.iter().enumerate() {
            let (piece, behind) = rest.split_at_mut(length);
            let from = operand(i).get(turn * length..(turn + 1) * length);
            if let Some(from) = from {
                piece.copy_from_slice(from);
            }
            rest = behind;
        }
    }
}
