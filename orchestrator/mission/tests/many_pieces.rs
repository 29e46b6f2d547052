//! The first tick accepts what `check` accepts: every kind of process on maps with up to as many pieces as documented.
//!
//! It takes more than 10 s in the dev profile: the largest maps have 131 072 pieces.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fmt::Write as _;
use std::path::Path;

use mission::in_process::{InProcessOptions, run};
use runtime::shapes;
use scenario::files::Base;
use scenario::{Loader, ResolvedScenario};

/// Kinds of a scenario that are tested together.
struct Group {
    /// Kinds of the two evaders. The policy was learned with four pursuers and two evaders.
    evaders: [&'static str; 2],
    /// Kinds of further robots.
    others: &'static [&'static str],
    /// Binary logarithm of the largest number of pieces that `check` accepts.
    accepted: u32,
    /// Binary logarithm of the largest number of pieces that is run.
    tested: u32,
}

const GROUPS: [Group; 5] = [
    Group {
        evaders: ["evader_braitenberg", "evader_potential"],
        others: &[],
        accepted: u32::MAX,
        tested: 16,
    },
    Group {
        evaders: ["evader_reach_avoid", "evader_rrt_star"],
        others: &[],
        accepted: u32::MAX,
        // RRT* prepares a map of 65 536 pieces for 20 s in the dev profile.
        tested: 13,
    },
    Group {
        evaders: ["policy", "policy"],
        others: &[],
        accepted: 16,
        tested: 13,
    },
    Group {
        evaders: ["evader_potential", "evader_potential"],
        others: &["navigator", "patrol_awg", "patrol_fto", "patrol_graph"],
        accepted: 16,
        tested: 16,
    },
    Group {
        evaders: ["evader_potential", "evader_potential"],
        others: &[
            "coverage_chebyshev",
            "coverage_keyed",
            "coverage_boustrophedon",
            "coverage_random_bounce",
            "coverage_uniform",
        ],
        // Single cells become no larger rectangles.
        accepted: 10,
        tested: 10,
    },
];

/// Kinds that every scenario has.
const COMMON: [&str; 6] = [
    "perception",
    "pursuer",
    "referee",
    "observer",
    "attacker",
    "optimiser",
];

const PATROL: &str = "mission = { contour = [[1.0, 1.0], [1.0, 7.0], [5.0, 7.0]], t_max = 200.0 }";

/// A map with an open area of 6 m × 8 m and single occupied cells beside it, and the robots in the open.
fn text(group: &Group, pieces: usize) -> String {
    let columns = pieces.isqrt().max(1);
    let rows = pieces.div_ceil(columns);
    let (width, height) = (60 + 2 * columns + 1, (2 * rows + 1).max(80));
    let mut runs = Vec::new();
    let mut free = 0;
    for cell in 0..width * height {
        let (col, row) = (cell % width, cell / width);
        let is_place = col >= 60 && col % 2 == 1 && row % 2 == 1;
        if is_place && runs.len() < 2 * pieces {
            runs.extend([free, 1]);
            free = 0;
        } else {
            free += 1;
        }
    }
    runs.push(free);
    assert_eq!(runs.len(), 2 * pieces + 1);
    let mut text = format!(
        "[world]\nmap.cells = {{ width = {width}, height = {height}, resolution = 0.1, \
         origin = [0.0, 0.0], runs = {runs:?} }}\n\
         exits = [{{ circle = {{ center = [0.5, 7.5], radius = 0.3 }} }}]\n\
         [rules]\ncapture = {{ radius = 0.3 }}\ntime_limit = 60.0\n\
         [[processes]]\nkind = \"perception\"\n\
         [[processes]]\nkind = \"pursuer\"\nteam = \"police\"\n\
         [[processes]]\nkind = \"referee\"\n\
         [[processes]]\nkind = \"observer\"\n\
         [[processes]]\nkind = \"attacker\"\nparams = {{ places = [[1.0, 7.0]], sight = 5.0 }}\n\
         [[processes]]\nkind = \"optimiser\"\n"
    );
    let mut robot = |name: String, team: &str, place: usize| {
        let (x, y) = (
            1.0 + 0.9 * (place % 5) as f64,
            1.0 + 0.9 * (place / 5) as f64,
        );
        writeln!(
            text,
            "[[robots]]\nname = \"{name}\"\nteam = \"{team}\"\nscan = {{}}\n\
             start = {{ x = {x}, y = {y}, theta = 0.0 }}"
        )
        .unwrap();
        if team == "neutral" {
            text += "goal.circle = { center = [5.0, 7.0], radius = 0.3 }\n";
        }
    };
    for i in 0..4 {
        robot(format!("cop_{i}"), "police", i);
    }
    let kinds = group.evaders.iter().zip(["evader"; 2]);
    let others = group.others.iter().zip(["neutral"; 5]);
    let driven: Vec<_> = kinds.chain(others).enumerate().collect();
    for &(i, (_, team)) in &driven {
        robot(format!("robot_{i}"), team, 10 + i);
    }
    for (i, (kind, _)) in driven {
        let params = match *kind {
            "policy" => "model = \"to_the_exit.onnx\"",
            "patrol_awg" | "patrol_fto" => PATROL,
            "patrol_graph" => "graph = { nodes = [[1.0, 1.0], [1.0, 7.0]], edges = [[0, 1]] }",
            _ => "",
        };
        writeln!(
            text,
            "[[processes]]\nname = \"process_{i}\"\nkind = \"{kind}\"\nrobots = [\"robot_{i}\"]\n\
             params = {{ {params} }}"
        )
        .unwrap();
    }
    text
}

/// The result of `check`.
fn check(group: &Group, pieces: usize) -> Result<ResolvedScenario, String> {
    let base = Base::Folder {
        folder: Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/policy"),
        allow_outside: false,
    };
    Loader::new(kinds::KINDS)
        .load_text("many.toml", &text(group, pieces), &base, &[], None)
        .map_err(|e| e.to_string())
}

#[test]
fn what_check_accepts_the_first_tick_accepts() {
    let mut tested: Vec<&str> = COMMON.to_vec();
    for group in &GROUPS {
        tested.extend(group.evaders.iter().chain(group.others));
        for exponent in [0, 5, 10, 13, 16, 17] {
            let pieces = 1 << exponent;
            if exponent > group.accepted {
                let error = check(group, pieces).expect_err("the map has too many pieces");
                let has_limit = ["at most", "more than"]
                    .iter()
                    .any(|words| error.contains(words));
                assert!(has_limit, "{error}");
            } else if exponent <= group.tested {
                let scenario = check(group, pieces).unwrap();
                let options = InProcessOptions {
                    last_tick: Some(2),
                    ..InProcessOptions::default()
                };
                let report = run(&scenario, &options);
                assert!(
                    report.is_ok(),
                    "{:?}, {pieces} pieces: {report:?}",
                    group.others
                );
            }
        }
    }
    // Nodes of ROS 2 steer its robots; it converts cells alone.
    tested.push("ros2_bridge");
    for kind in kinds::KINDS {
        assert!(
            tested.contains(&kind.name),
            "no scenario has the kind {}",
            kind.name
        );
    }
}

#[test]
fn obstacles_that_appear_count_among_the_pieces() {
    // Just as many as fit, as long as nothing appears.
    let pieces = shapes::MAX_POINTS / 4;
    let appear = "[[events]]\ntime_s = 1.0\naction = \"appear\"\nobstacle = \"box\"\n\
                  shape = { circle = { center = [3.0, 7.0], radius = 0.1 } }\n";
    let text = text(&GROUPS[3], pieces) + appear;
    let error = Loader::new(kinds::KINDS)
        .load_text("many.toml", &text, &Base::Nothing, &[], None)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("the map has too many pieces for process"),
        "{error}"
    );
    assert!(
        error.contains("65536 pieces, with all events 262145 corners"),
        "{error}"
    );
    assert!(
        error.contains("at most 262144 corners: 65536 rectangles"),
        "{error}"
    );
}
