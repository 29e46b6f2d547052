//! A whole mission with the planner, run by `protean` from `PATH` or by the program that the variable `PROTEAN` names.

use std::process::Command;

#[test]
fn the_robot_reaches_its_goal() {
    let protean = std::env::var("PROTEAN").unwrap_or_else(|_| "protean".to_owned());
    let program = env!("CARGO_BIN_EXE_my_planner");
    let log = concat!(env!("CARGO_TARGET_TMPDIR"), "/mission.mcap");
    let output = Command::new(&protean)
        .args(["run", "hall.toml", "--allow-external", "--json"])
        .args(["--out", log, "--force", "--set"])
        .arg(format!("processes.my_planner.command=[{program:?}]"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap_or_else(|error| panic!("{protean}: {error}; set PROTEAN to the path of protean"));
    let summary = String::from_utf8_lossy(&output.stdout);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    assert!(summary.contains("\"goal_reached\""), "{summary}");
}
