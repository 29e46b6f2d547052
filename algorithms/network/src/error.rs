//! Errors of files and of evaluations.

use thiserror::Error;

use crate::operators::OPERATORS;
use crate::{MAX_FILE, OPSETS};

/// Reason why a file is no usable network.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum NetworkError {
    /// The file is too large.
    #[error("the file has {bytes} bytes: expected at most {MAX_FILE}")]
    TooLarge {
        /// Size of the file.
        bytes: usize,
    },
    /// The file is not ONNX.
    #[error("not an ONNX file: {0}")]
    Decode(prost::DecodeError),
    /// The file has no graph.
    #[error("not an ONNX file: it has no graph")]
    NoGraph,
    /// The version of the operator set is unsupported.
    #[error("the ONNX operator set has version {version}: expected one of {} to {}", OPSETS.start(), OPSETS.end())]
    Opset {
        /// The version in the file; 0 if it has none.
        version: i64,
    },
    /// An operator is unsupported.
    #[error("node `{node}` has the operator `{operator}`: expected one of {}", OPERATORS.join(", "))]
    Operator {
        /// Name of the node.
        node: String,
        /// Its operator, with its domain if that is not the standard one.
        operator: String,
    },
    /// A node cannot be computed as it is.
    #[error("node `{node}` ({operator}): {found}: expected {expected}")]
    Node {
        /// Name of the node.
        node: String,
        /// Its operator.
        operator: String,
        /// The part that is unsupported, with its value.
        found: String,
        /// Description of a supported one.
        expected: String,
    },
    /// A constant cannot be used.
    #[error("constant `{name}`: {found}: expected {expected}")]
    Constant {
        /// Name of the constant.
        name: String,
        /// Description of the fault.
        found: String,
        /// Description of a valid constant.
        expected: String,
    },
    /// The inputs or outputs of the graph are unsupported.
    #[error("{found}: expected {expected}")]
    Ports {
        /// Description of the ports.
        found: String,
        /// Description of supported ones.
        expected: &'static str,
    },
    /// A limit is exceeded.
    #[error("the network has {value} {what}: expected at most {max}")]
    Limit {
        /// Limited quantity.
        what: &'static str,
        /// Its number.
        value: usize,
        /// The limit.
        max: usize,
    },
}

/// Reason why an evaluation has no result.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum EvaluationError {
    /// The input has another length.
    #[error("the input has {found} numbers: expected {expected}")]
    InputLength {
        /// Length of the input.
        found: usize,
        /// Length of the network's input.
        expected: usize,
    },
    /// A number of the output is infinite or not a number.
    #[error("number {index} of the output is {value}: expected a finite one")]
    Output {
        /// Its place, from 0.
        index: usize,
        /// Its value.
        value: f32,
    },
}
