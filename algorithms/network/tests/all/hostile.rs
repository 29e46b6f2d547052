//! Files that are damaged, unsupported or made to do harm.

use expect_test::expect;
use network::{MAX_FILE, Network, NetworkError};
use proptest::prelude::*;

use crate::models::{file, message, model, node, tensor};

fn refused(file: &[u8]) -> String {
    Network::from_onnx(file).unwrap_err().to_string()
}

#[test]
fn an_unknown_operator_is_named_with_the_known_ones() {
    let text = refused(&model(&[node("LSTM", &["x"], "y")], &[], 3));
    expect!["node `y` has the operator `LSTM`: expected one of Add, Clip, Concat, Constant, Cos, Div, Flatten, Gemm, Identity, MatMul, Mul, Relu, Reshape, Sigmoid, Sin, Sub, Tanh"].assert_eq(&text);
}

#[test]
fn names_in_errors_are_short_and_without_control_characters() {
    let name = format!("\u{1b}[2J{}", "a".repeat(1000));
    let text = refused(&model(&[node(&name, &["x"], "y")], &[], 3));
    assert!(text.len() < 400 && !text.contains('\u{1b}'), "{text}");
}

#[test]
fn a_file_without_graph_is_no_network() {
    expect![[r#"
        not an ONNX file: it has no graph
        not an ONNX file: failed to decode Protobuf message: invalid wire type value: 7"#]]
    .assert_eq(&[refused(&[]), refused(b"GIF89a")].join("\n"));
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
    let errors = [
        with(&[4], &[1.0; 3]),
        with(&[1 << 40, 1 << 40], &[1.0]),
        with(&[u64::MAX], &[1.0]),
        with(&[1], &[f32::NAN]),
        with(&[2], &[1.0; 2]),
    ];
    expect![[r#"
        constant `c`: it has 3 values: expected those of the shape [4]
        constant `c`: its shape is [1099511627776, 1099511627776]: expected up to 8 dimensions and 2097152 values
        constant `c`: its shape is [-1]: expected up to 8 dimensions and 2097152 values
        constant `c`: it contains NaN: expected finite numbers
        node `y` (Add): its inputs have the shapes [1, 3] and [2]: expected shapes that broadcast"#]].assert_eq(&errors.join("\n"));
}

#[test]
fn values_come_from_earlier_nodes() {
    let errors = [
        vec![
            node("Add", &["x", "later"], "y"),
            node("Relu", &["x"], "later"),
        ],
        vec![node("Relu", &["x"], "x")],
        vec![node("Relu", &["x"], "z")],
        vec![node("MatMul", &["x", "x"], "y")],
    ]
    .map(|nodes| refused(&model(&nodes, &[], 3)));
    expect![[r#"
        node `y` (Add): its input `later` is computed by no earlier node: expected nodes in the order of computation
        two values are called `x`: expected a name for each
        no node computes the output `y`: expected float numbers that a node computes
        node `y` (MatMul): its input 1 is computed: expected a constant"#]].assert_eq(&errors.join("\n"));
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
    let large = refused(&model(&sums, &[column, row], 3));
    // A product of many rows by the same weights.
    let rows = tensor("a", &[600, 500], &vec![1.0; 300_000]);
    let weights = tensor("w", &[500, 400], &vec![1.0; 200_000]);
    let product = [node("MatMul", &["a", "w"], "y")];
    let slow = refused(&model(&product, &[rows, weights], 3));
    let nodes: Vec<Vec<u8>> = (0..1001)
        .map(|i| node("Relu", &["x"], &format!("n{i}")))
        .collect();
    let errors = [large, slow, refused(&model(&nodes, &[], 3))];
    expect![[r#"
        the network has 3002003 values: expected at most 2097152
        the network has 120000000 operations per evaluation: expected at most 16777216
        the network has 1001 nodes: expected at most 1000"#]]
    .assert_eq(&errors.join("\n"));
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
