//! `benchmarks links`: every transport is measured in every placement.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::process::Command;

use serde_json::Value as Json;

#[test]
fn every_transport_is_measured_in_every_placement() {
    let output = Command::new(env!("CARGO_BIN_EXE_benchmarks"))
        .args(["links", "--quick", "--json"])
        .output()
        .unwrap();
    let json: Json = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["errors"], Json::Array(Vec::new()));
    let figures = json["figures"].as_array().unwrap();
    let several = std::thread::available_parallelism().unwrap().get() > 1;
    let places = ["unpinned", "one core", "two cores"];
    for place in places.iter().take(if several { 3 } else { 2 }) {
        for topic in ["world/state", "perception/belief", "robot/command"] {
            for transport in [
                "raw iceoryx2, busy poll",
                "raw iceoryx2, event wake-up",
                "protean, futex wake-up",
                "Unix domain socket",
                "pipe",
            ] {
                let of = |part: &str| {
                    let end = format!(" B, {place}, {transport}, {part}");
                    let named = |figure: &&Json| {
                        let name = figure["name"].as_str().unwrap();
                        name.starts_with(topic) && name.ends_with(&end)
                    };
                    let figure = figures.iter().find(named);
                    figure.unwrap_or_else(|| panic!("{topic}{end}"))["value"]
                        .as_f64()
                        .unwrap()
                };
                assert!(0.0 < of("p50") && of("p50") <= of("p99"), "{topic}");
            }
        }
    }
}
