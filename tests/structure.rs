//! The structure of the source tree: floors of crates, modules without cycles, sizes, errors that are types.
//!
//! A failure names file, line and rule. Dependencies of tests are free: they may use any crate, and other
//! programs' libraries as independent readers.

mod checks;
mod graph;
mod made_up;
mod manifests;
mod sources;

use std::path::Path;

use checks::Rules;

/// The rules of this repository.
const RULES: Rules = Rules {
    floors: &[
        &["transport"],
        // Messages, and crates without robots.
        &[
            "config",
            "ipc_types",
            "metrics",
            "parameters",
            "platform",
            "tables",
            "trajectory_check",
        ],
        &["chaotic_maps", "geometry"],
        &[
            "curves",
            "free_motion",
            "network",
            "patrol_chain",
            "robot",
            "ros_messages",
        ],
        &["planner_view"],
        &[
            "draw",
            "mcap_log",
            "runtime",
            "scenario_files",
            "sim_backend",
            "statistics",
            "tracking",
            "trajectory_problem",
        ],
        &["control", "navigation", "optimal_control", "passing"],
        &["avoidance", "trajectory"],
        &["pursuit_evasion"],
        &[
            "coverage",
            "observation",
            "patrol",
            "patrol_graph",
            "planner",
        ],
        // One crate per kind of process, or per family of kinds; none depends on another one.
        &["processes/*"],
        &["recorder", "scenario"],
        &["diff"],
        // Readers of logs: no kinds of processes, no missions.
        &["log_tools", "report"],
        &["viewer"],
        &["kinds", "mission", "plan"],
        &["environment", "replay"],
        &["latency", "published", "sweep"],
        &["branch", "mission_tests"],
        &["protean", "python_algorithms"],
        // `testing` is for tests only.
        &["_core", "benchmarks", "end_to_end", "testing"],
    ],
    only: &[
        // `ros2_bridge` gives that of `ros2-client` the features of the program.
        (&["clap"], &["protean", "benchmarks", "ros2_bridge"]),
        (&["iceoryx2"], &["transport", "benchmarks"]),
        (&["libc"], &["platform"]),
        (&["libloading"], &["library_planner"]),
        (&["mcap"], &["mcap_log"]),
        (&["parquet"], &["tables"]),
        (&["prost"], &["network"]),
        (&["ros2-client", "rustdds"], &["ros2_bridge"]),
        (&["tungstenite"], &["viewer"]),
        (&["processes/*"], &["kinds"]),
        (
            &["evader_rrt_star"],
            &["kinds", "published", "python_algorithms"],
        ),
        // No kind of scenarios: a command.
        (&["library_planner"], &["mission", "protean"]),
        // Routes without a run.
        (
            &["coverage_planners", "patrol_planners"],
            &["kinds", "plan"],
        ),
        // Worlds that are stepped, described or drawn: no algorithm and no planner needs one.
        (
            &["sim_backend"],
            &[
                "simulator",
                "mission",
                "environment",
                "plan",
                "report",
                "scenario",
                "benchmarks",
            ],
        ),
        // It leads the loop that the kinds follow.
        (&["simulator"], &["mission", "protean"]),
    ],
    max_file_lines: 500,
    max_crate_lines: 6000,
    known: KNOWN,
};

/// Faults that are still there, each with its file. What is mended goes from the list.
const KNOWN: &[(&str, &str)] = &[];

#[test]
fn the_tree_keeps_its_structure() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let faults = checks::check(&root, &RULES);
    let lines: Vec<String> = faults.iter().map(ToString::to_string).collect();
    assert!(faults.is_empty(), "\n{}\n", lines.join("\n"));
}
