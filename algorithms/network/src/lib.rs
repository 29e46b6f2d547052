//! Small neural networks from ONNX files, evaluated with the same bits on every machine.
//!
//! General runtimes choose their kernels by the processor, so that sums differ in their last bits. [`Network`] adds in
//! one fixed order, in `f32` and without fused operations; elementary functions are those of [`geometry::math`],
//! computed in `f64` and rounded. It supports the operators of feed-forward policies ([`OPERATORS`]) for one input and
//! one output of fixed size, with weights in the file; all else is an error that names it. The file is untrusted: it
//! cannot cause a panic, and memory and work are limited ([`MAX_FILE`], [`MAX_VALUES`], [`MAX_NODES`],
//! [`MAX_OPERATIONS`]).
//!
//! The modules: `proto` has the messages of a file, `tensor` reads constants, `node` reads attributes, `compile` turns a
//! graph into steps, `step` computes one of them.

mod broadcast;
mod compile;
mod error;
mod network;
mod node;
mod operators;
mod proto;
mod step;
mod tensor;

pub use error::{EvaluationError, NetworkError};
pub use network::Network;
pub use operators::OPERATORS;

/// Maximum size of a file (bytes).
pub const MAX_FILE: usize = 2 << 20;
/// Maximum number of `f32` values in memory: weights and intermediate results.
pub const MAX_VALUES: usize = 1 << 21;
/// Maximum number of nodes of a graph.
pub const MAX_NODES: usize = 1000;
/// Maximum number of multiplications and other elementary operations of an evaluation.
pub const MAX_OPERATIONS: usize = 1 << 24;
/// Maximum number of dimensions of a tensor.
pub const MAX_RANK: usize = 8;
/// First and last version of the ONNX operator set whose operators have the meaning computed here.
pub const OPSETS: core::ops::RangeInclusive<i64> = 7..=26;
