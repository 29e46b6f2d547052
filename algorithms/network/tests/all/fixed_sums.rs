//! The order of sums.

use network::Network;
use proptest::prelude::*;

use crate::models::{model, node, tensor};

proptest! {
    #[test]
    fn sums_are_those_of_a_plain_loop_to_the_bit(
        inner in 1_usize..40,
        columns in 1_usize..40,
        seed in prop::collection::vec(-1e6_f32..1e6, 1680),
    ) {
        let (input, weights) = (&seed[..inner], &seed[40..40 + inner * columns]);
        let constants = [tensor("w", &[inner as u64, columns as u64], weights)];
        let file = model(&[node("MatMul", &["x", "w"], "y")], &constants, inner as u64);
        let mut network = Network::from_onnx(&file).unwrap();
        let got: Vec<u32> = network.evaluate(input).unwrap().iter().map(|y| y.to_bits()).collect();
        let sum = |column: usize| {
            let mut sum = 0.0_f32;
            for k in 0..inner {
                sum += input[k] * weights[k * columns + column];
            }
            sum.to_bits()
        };
        prop_assert_eq!(got, (0..columns).map(sum).collect::<Vec<u32>>());
    }
}

#[test]
fn the_policy_of_the_tests_has_the_same_bits_everywhere() {
    let mut network = Network::from_onnx(crate::models::file("policy")).unwrap();
    let input = [0.1, -0.2, 0.3, -0.4, 0.5, -0.6, 0.7];
    let bits: Vec<u32> = network
        .evaluate(&input)
        .unwrap()
        .iter()
        .map(|y| y.to_bits())
        .collect();
    assert_eq!(bits, [3_193_130_500, 1_060_809_454]);
}
