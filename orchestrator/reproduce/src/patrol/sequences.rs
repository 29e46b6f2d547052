//! Table 1 of the Chebyshev coverage paper: `v(xy)`, computed when the page is built.

use chaotic_maps::{ChebF64, ChebP, Emission};
use metrics::sequence::mean_difference;

/// Rows of the table: name of the values, emission, the paper's results for 2000 and for 10 000
/// values, and the limit for independent coordinates.
pub(super) const TABLE_1: [(&str, Emission, [f64; 2], &str); 2] = [
    ("original", Emission::Raw, [0.8309, 0.8209], "8/π² = 0.8106"),
    (
        "arcsine, arccosine",
        Emission::Arcsine,
        [0.6830, 0.6758],
        "2/3 = 0.6667",
    ),
];
/// The paper's first values.
const FIRST: [f64; 2] = [0.1, 0.2];
pub(super) const LENGTHS: [usize; 2] = [2000, 10_000];
/// A key of the exact map.
const KEY: [u64; 2] = [123_456_789_012_345_678, 987_654_321_098_765_432];

/// Returns the rows of the table.
pub(super) fn rows() -> String {
    let mut text = String::new();
    for (name, emission, published, limit) in TABLE_1 {
        for (n, published) in LENGTHS.into_iter().zip(published) {
            text += &format!(
                "| {name} | {n} | {published:.4} | {} | {} | {limit} |\n",
                number(in_floating_point(emission, n)),
                number(exact(emission, n)),
            );
        }
    }
    text
}

/// Computes with the first values as the first pair, as in the paper.
fn in_floating_point(emission: Emission, n: usize) -> Option<f64> {
    let [x, y] = FIRST;
    let mut map = ChebF64::new(x, y, emission).ok()?;
    let pairs = (0..n).map(|_| {
        let pair = map.point();
        map.step();
        pair
    });
    Some(mean_difference(pairs))
}

fn exact(emission: Emission, n: usize) -> Option<f64> {
    exact_under(KEY, emission, n)
}

/// Computes with the exact map under a key.
pub(super) fn exact_under([tx, ty]: [u64; 2], emission: Emission, n: usize) -> Option<f64> {
    let mut map = ChebP::new(tx, ty, emission).ok()?;
    let pairs = (0..n).map(|_| {
        map.step();
        map.point()
    });
    Some(mean_difference(pairs))
}

fn number(value: Option<f64>) -> String {
    value.map_or_else(|| "–".into(), |v| format!("{v:.4}"))
}
