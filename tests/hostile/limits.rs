//! Inputs above a limit.

use std::fmt::Write as _;

use super::{GOOD, changed, on_vectors};
use crate::support::Sandbox;

/// Most memory that the program may ask the system for while it refuses something (1024 bytes): a small part
/// of what it is asked for below.
const ENOUGH_KIB: &str = "1500000";

/// Calls `check` and `run` on a scenario, with little memory and little time; both must refuse it with
/// these words.
#[track_caller]
fn refused(sandbox: &Sandbox, text: impl AsRef<[u8]>, words: &[&str]) {
    sandbox.file("greedy.toml", text);
    for command in ["check", "run"] {
        let outcome = sandbox
            .protean([command, "greedy.toml"])
            .with_memory(ENOUGH_KIB)
            .within_seconds("60")
            .run();
        outcome.refused(2, words);
    }
    assert!(sandbox.runs().is_empty(), "nothing is started");
}

#[test]
fn a_scenario_that_asks_for_too_much_is_refused_with_the_limit_named() {
    let sandbox = Sandbox::new();
    let setup = |more: &str| format!("{GOOD}{more}");
    let robots = |count: usize| {
        (0..count).fold(String::new(), |mut text, i| {
            let _ = write!(
                text,
                "[[robots]]\nname = \"r{i}\"\nteam = \"evader\"\nstart = {{ x = 1, y = 1, theta = 0 }}\n"
            );
            text
        })
    };
    let cells = "[world.map.cells]\nwidth = 1000000\nheight = 1000000\nresolution = 0.05\norigin = [0, 0]\n\
                 runs = [1000000000000]";
    let perception = "[[processes]]\nkind = \"perception\"\nteam = \"police\"\nparams.filter.particles = 1000000000\n";
    for (text, words) in [
        (
            changed(
                "robots = [\"robot\"]",
                "robots = [\"robot\"]\n[run]\ndt = 1e-300",
            ),
            &["run.dt", "a number between 0.0001 and 1"][..],
        ),
        (
            changed("time_limit = 1.0", "time_limit = 1e8"),
            &["too many ticks", "2e9 ticks", "at most 1e8 ticks"],
        ),
        (
            changed(
                "theta = 0.0 }",
                "theta = 0.0 }\nscan = { beams = 1000000000 }",
            ),
            &[
                "scan.beams",
                "1000000000",
                "a whole number between 1 and 4096",
            ],
        ),
        (setup(&robots(1000)), &["too many robots", "at most 64"]),
        (setup(perception), &["1000000000", "1000000"]),
        (
            setup("[log]\nviewer_rate_hz = 1e12\n"),
            &["log.viewer_rate_hz", "between 0 and 1000 (Hz)"],
        ),
        (
            on_vectors("resolution = 0.000004"),
            &["resolution", "max_cells = 16000000", "1000000 × 750000"],
        ),
        (
            changed("map = \"builtin:hello\"", cells),
            &["1000000 × 1000000", "cells"],
        ),
        (
            changed(
                "exits = [",
                &format!(
                    "exits = [{}",
                    "{ circle = { center = [3.5, 0.5], radius = 0.2 } }, ".repeat(2000)
                ),
            ),
            &["exits", "a list of 2001", "at most 1024"],
        ),
    ] {
        refused(&sandbox, text, words);
    }
}

#[test]
fn texts_that_would_fill_the_memory_are_refused_before_they_are_parsed() {
    let sandbox = Sandbox::new();
    let much = ["too many tokens in one text", "at most 2200000 tokens"];
    for (text, words) in [
        (format!("a = [{}]", "1,".repeat(1_200_000)), &much[..]),
        ("[[a]]\n".repeat(500_000), &much),
        ("=\n".repeat(2_300_000), &much),
        (
            format!("a = {}", "[".repeat(100_000)),
            &["not valid TOML", "recursion"],
        ),
        (
            format!("a = {}", "{a=".repeat(100_000)),
            &["not valid TOML", "recursion"],
        ),
        (
            format!("a{} = 1", ".a".repeat(100_000)),
            &["key with too many dots", "at most 16"],
        ),
        (
            " ".repeat((64 << 20) + 1),
            &["greedy.toml is too large", "chase"],
        ),
    ] {
        refused(&sandbox, text, words);
    }
}

#[test]
fn maps_that_would_take_too_long_are_refused() {
    let sandbox = Sandbox::new();
    let comb = |corners: usize| {
        let mut text = String::from("{ shape = { polygon = { vertices = [");
        for i in 0..corners - 2 {
            let x = 1.0 + 2.0 * i as f64 / corners as f64;
            let y = if i % 2 == 0 { 2.0 } else { 1.2 };
            let _ = write!(text, "[{x}, {y}], ");
        }
        text.push_str("[3.1, 1.0], [0.9, 1.0]] } } }, ");
        text
    };
    let disc = "{ shape = { circle = { center = [1, 1], radius = 0.1 } } }, ";
    for (obstacles, words) in [
        (
            comb(600),
            &[
                "600 vertices of a polygon that is not convex",
                "at most 512",
            ][..],
        ),
        (
            comb(400).repeat(20),
            &["cubes of the corners", "at most 536870912"],
        ),
        (disc.repeat(65_537), &["65537 obstacles", "at most 65536"]),
    ] {
        let text = on_vectors(&format!("obstacles = [{obstacles}]"));
        refused(&sandbox, text, words);
    }
}

#[test]
fn a_map_image_is_refused_by_its_header_and_read_no_further_than_it_may_be() {
    let sandbox = Sandbox::new();
    let yaml = "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
    sandbox.file("map.yaml", yaml);
    let text = changed("builtin:hello", "map.yaml");
    sandbox.file("map.pgm", "P5 100000 100000 255\n");
    let words = ["100000 × 100000 pixels", "at most 25000000 pixels"];
    refused(&sandbox, &text, &words);
    // Every other pixel is a wall.
    let mut noise = b"P5 2000 2000 255\n".to_vec();
    noise.extend([0, 255].repeat(2_000_000));
    sandbox.file("map.pgm", noise);
    refused(&sandbox, &text, &["runs", "at most 1000000"]);
    // A comment of ten tebibytes; the file takes no room.
    let image = sandbox.file("map.pgm", "P2\n#");
    let file = std::fs::OpenOptions::new().write(true).open(image).unwrap();
    file.set_len(10 << 40).unwrap();
    refused(&sandbox, &text, &["width = the end of the file"]);
}
