//! Files that are damaged, unsupported or made to do harm.

use network::{MAX_FILE, Network, NetworkError};
use proptest::prelude::*;

use crate::models::{file, message, model, node, tensor};

fn refused(file: &[u8]) -> String {
    Network::from_onnx(file).unwrap_err().to_string()
}

#[test]
fn an_unknown_operator_is_named_with_the_known_ones() {
    let text = refused(&model(&[node("LSTM", &["x"], "y")], &[], 3));
    assert_eq!(
        text,
        "node `y` has the operator `LSTM`: expected one of Add, Clip, Concat, Constant, Cos, Div, Flatten, Gemm, \
         Identity, MatMul, Mul, Relu, Reshape, Sigmoid, Sin, Sub, Tanh"
    );
}

#[test]
fn names_in_errors_are_short_and_without_control_characters() {
    let name = format!("\u{1b}[2J{}", "a".repeat(1000));
    let text = refused(&model(&[node(&name, &["x"], "y")], &[], 3));
    assert!(text.len() < 400 && !text.contains('\u{1b}'), "{text}");
}

#[test]
fn a_file_without_graph_is_no_network() {
    assert_eq!(refused(&[]), "not an ONNX file: it has no graph");
    assert!(refused(b"GIF89a").starts_with("not an ONNX file: "));
    let large = vec![0; MAX_FILE + 1];
    assert!(matches!(
        Network::from_onnx(&large),
        Err(NetworkError::TooLarge { .. })
    ));
}

#[test]
fn constants_that_are_not_what_they_say_are_refused() {
    let sum = [node("Add", &["x", "c"], "y")];
    let with =
        |dims: &[u64], values: &[f32]| refused(&model(&sum, &[tensor("c", dims, values)], 3));
    assert_eq!(
        with(&[4], &[1.0; 3]),
        "constant `c`: it has 3 values: expected those of the shape [4]"
    );
    assert_eq!(
        with(&[1 << 40, 1 << 40], &[1.0]),
        "constant `c`: its shape is [1099511627776, 1099511627776]: expected up to 8 dimensions and 2097152 values"
    );
    assert!(with(&[u64::MAX], &[1.0]).contains("its shape is [-1]"));
    assert!(with(&[1], &[f32::NAN]).contains("it contains NaN: expected finite numbers"));
    assert!(
        with(&[2], &[1.0; 2]).contains("shapes [1, 3] and [2]: expected shapes that broadcast")
    );
}

#[test]
fn values_come_from_earlier_nodes() {
    let text = refused(&model(
        &[
            node("Add", &["x", "later"], "y"),
            node("Relu", &["x"], "later"),
        ],
        &[],
        3,
    ));
    assert!(
        text.contains("`later` is computed by no earlier node"),
        "{text}"
    );
    let text = refused(&model(&[node("Relu", &["x"], "x")], &[], 3));
    assert!(text.contains("two values are called `x`"), "{text}");
    let text = refused(&model(&[node("Relu", &["x"], "z")], &[], 3));
    assert!(text.contains("no node computes the output `y`"), "{text}");
    let text = refused(&model(&[node("MatMul", &["x", "x"], "y")], &[], 3));
    assert!(
        text.contains("its input 1 is computed: expected a constant"),
        "{text}"
    );
}

#[test]
fn memory_and_work_are_limited() {
    // Each sum of a column and a row is a matrix of a million values.
    let (column, row) = (
        tensor("c", &[1000, 1], &[1.0; 1000]),
        tensor("r", &[1, 1000], &[1.0; 1000]),
    );
    let sums: Vec<Vec<u8>> = (0..50)
        .map(|i| node("Add", &["c", "r"], &format!("s{i}")))
        .collect();
    let text = refused(&model(&sums, &[column, row], 3));
    assert!(text.contains("values: expected at most 2097152"), "{text}");
    // A product of many rows by the same weights.
    let rows = tensor("a", &[600, 500], &vec![1.0; 300_000]);
    let weights = tensor("w", &[500, 400], &vec![1.0; 200_000]);
    let text = refused(&model(
        &[node("MatMul", &["a", "w"], "y")],
        &[rows, weights],
        3,
    ));
    assert!(
        text.contains("operations per evaluation: expected at most 16777216"),
        "{text}"
    );
    let nodes: Vec<Vec<u8>> = (0..1001)
        .map(|i| node("Relu", &["x"], &format!("n{i}")))
        .collect();
    assert_eq!(
        refused(&model(&nodes, &[], 3)),
        "the network has 1001 nodes: expected at most 1000"
    );
}

#[test]
fn deep_nesting_does_not_exhaust_the_stack() {
    // Graphs in attributes of nodes of graphs.
    let mut graph = Vec::new();
    for _ in 0..2000 {
        graph = message(&[(1, message(&[(5, message(&[(6, graph)]))]))]);
    }
    assert!(Network::from_onnx(&message(&[(7, graph)])).is_err());
}

proptest! {
    #[test]
    fn any_bytes_are_a_network_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let _ = Network::from_onnx(&bytes);
    }

    #[test]
    fn a_damaged_file_is_a_network_or_an_error(
        name in prop::sample::select(vec!["policy", "operators", "old"]),
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let mut bytes = file(name).to_vec();
        for (place, value) in damage {
            let place = place.index(bytes.len());
            bytes[place] = value;
        }
        if let Ok(mut network) = Network::from_onnx(&bytes) {
            let input = vec![0.5; network.input_length()];
            let _ = network.evaluate(&input);
        }
    }
}
