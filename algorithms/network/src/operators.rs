//! The supported operators.

/// The supported operators of ONNX's standard domain, by their names there.
///
/// `Gemm` without `transA` and `MatMul` have constant weights as second input; `Reshape` and `Clip` have a constant shape
/// and constant bounds. `Add`, `Sub`, `Mul` and `Div` broadcast.
pub const OPERATORS: [&str; 17] = [
    "Add", "Clip", "Concat", "Constant", "Cos", "Div", "Flatten", "Gemm", "Identity", "MatMul",
    "Mul", "Relu", "Reshape", "Sigmoid", "Sin", "Sub", "Tanh",
];
