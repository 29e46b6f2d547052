//! The models of `models/make.py`, and files made here.

use prost::Message;

/// Contents of a model file.
pub fn file(name: &str) -> &'static [u8] {
    match name {
        "policy" => include_bytes!("../models/policy.onnx"),
        "operators" => include_bytes!("../models/operators.onnx"),
        "old" => include_bytes!("../models/old.onnx"),
        _ => panic!("no model {name}"),
    }
}

/// A field of a message on the wire: its number and its bytes.
fn field(number: u32, bytes: &[u8], out: &mut Vec<u8>) {
    prost::encoding::encode_key(number, prost::encoding::WireType::LengthDelimited, out);
    prost::encoding::encode_varint(bytes.len() as u64, out);
    out.extend_from_slice(bytes);
}

fn number(field: u32, value: u64, out: &mut Vec<u8>) {
    prost::encoding::encode_key(field, prost::encoding::WireType::Varint, out);
    prost::encoding::encode_varint(value, out);
}

/// A message of fields with bytes.
pub fn message(fields: &[(u32, Vec<u8>)]) -> Vec<u8> {
    let mut out = Vec::new();
    for (number, bytes) in fields {
        field(*number, bytes, &mut out);
    }
    out
}

/// A constant of floating-point numbers.
pub fn tensor(name: &str, dims: &[u64], values: &[f32]) -> Vec<u8> {
    let mut out = Vec::new();
    for &dim in dims {
        number(1, dim, &mut out);
    }
    number(2, 1, &mut out);
    field(8, name.as_bytes(), &mut out);
    let raw: Vec<u8> = values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    field(9, &raw, &mut out);
    out
}

/// A node.
pub fn node(operator: &str, inputs: &[&str], output: &str) -> Vec<u8> {
    let mut fields: Vec<(u32, Vec<u8>)> =
        inputs.iter().map(|i| (1, i.as_bytes().to_vec())).collect();
    fields.push((2, output.as_bytes().to_vec()));
    fields.push((4, operator.as_bytes().to_vec()));
    message(&fields)
}

/// A file with the input `x` of one row, and the output `y`.
pub fn model(nodes: &[Vec<u8>], constants: &[Vec<u8>], input: u64) -> Vec<u8> {
    let mut dims = Vec::new();
    for length in [1, input] {
        let mut dim = Vec::new();
        number(1, length, &mut dim);
        field(1, &dim, &mut dims);
    }
    let mut kind = Vec::new();
    number(1, 1, &mut kind);
    field(2, &dims, &mut kind);
    let input = message(&[(1, b"x".to_vec()), (2, message(&[(1, kind)]))]);
    let mut graph: Vec<(u32, Vec<u8>)> = nodes.iter().map(|n| (1, n.clone())).collect();
    graph.extend(constants.iter().map(|c| (5, c.clone())));
    graph.push((11, input));
    graph.push((12, message(&[(1, b"y".to_vec())])));
    let mut opset = Vec::new();
    number(2, 17, &mut opset);
    message(&[(8, opset), (7, message(&graph))])
}

#[test]
fn the_files_made_here_are_messages() {
    assert!(<()>::decode(&model(&[], &[], 3)[..]).is_ok());
}
