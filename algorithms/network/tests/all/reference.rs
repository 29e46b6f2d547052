//! Comparison with ONNX Runtime.

use network::{EvaluationError, Network};
use serde_json::Value;

use crate::models::file;

fn numbers(value: &Value) -> Vec<f32> {
    let list = value.as_array().unwrap().iter();
    list.map(|number| number.as_f64().unwrap() as f32).collect()
}

#[test]
fn results_are_those_of_onnx_runtime_up_to_rounding() {
    let values: Value = serde_json::from_str(include_str!("../models/values.json")).unwrap();
    for (name, cases) in values.as_object().unwrap() {
        let mut network = Network::from_onnx(file(name)).unwrap();
        let cases = cases.as_array().unwrap();
        assert_eq!(cases.len(), 8);
        for case in cases {
            let input = numbers(&case["input"]);
            let expected = numbers(&case["output"]);
            assert_eq!(network.input_length(), input.len());
            assert_eq!(network.output_length(), expected.len());
            let got = network.evaluate(&input).unwrap();
            for (got, expected) in got.iter().zip(&expected) {
                let off = (got - expected).abs();
                assert!(
                    off <= 2e-6 * expected.abs().max(1.0),
                    "{name}: {got} {expected}"
                );
            }
        }
    }
}

#[test]
fn a_network_has_no_memory() {
    let mut network = Network::from_onnx(file("policy")).unwrap();
    let first = network.evaluate(&[0.5; 7]).unwrap().to_vec();
    network.evaluate(&[-3.0; 7]).unwrap();
    assert_eq!(network.evaluate(&[0.5; 7]).unwrap(), first);
}

#[test]
fn an_input_of_another_length_is_refused() {
    let mut network = Network::from_onnx(file("policy")).unwrap();
    let error = network.evaluate(&[0.0; 6]).unwrap_err();
    assert_eq!(error.to_string(), "the input has 6 numbers: expected 7");
}

#[test]
fn an_output_that_is_not_finite_is_refused() {
    let mut network = Network::from_onnx(file("policy")).unwrap();
    let error = network.evaluate(&[f32::NAN; 7]).unwrap_err();
    assert!(matches!(error, EvaluationError::Output { index: 0, .. }));
}
