//! A planner that is not ours: the example in Python takes part in the lock-step by events.

use std::path::Path;

use crate::support::Sandbox;

/// The repository's file with this path.
fn file(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path);
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn a_planner_in_python_drives_its_robot_and_the_history_is_the_same_every_time() {
    let python = match crate::support::python::interpreter() {
        Ok(python) => python,
        Err(reason) => {
            // Past the test harness, which swallows what tests print.
            use std::io::Write as _;
            let note = format!("\nSKIPPED: the planner in Python: {reason}\n");
            std::io::stderr().write_all(note.as_bytes()).unwrap();
            return;
        }
    };
    let sandbox = Sandbox::new();
    let messages = sandbox.protean(["messages", "--python"]).run();
    assert_eq!(messages.code, Some(0), "{messages}");
    sandbox.file("planners/protean_messages.py", messages.stdout.clone());
    let planner = sandbox.file(
        "planners/planner.py",
        file("scenarios/planners/to_the_exit.py"),
    );
    sandbox.file("maps/hello.toml", file("scenarios/maps/hello.toml"));
    let command = format!("command = [{:?}, {:?}]", python.to_str().unwrap(), planner);
    let scenario = file("scenarios/hello_python.toml");
    let theirs = scenario
        .lines()
        .find(|line| line.starts_with("command = "))
        .unwrap();
    sandbox.file("hello_python.toml", scenario.replace(theirs, &command));

    let run = || {
        sandbox
            .protean(["run", "hello_python.toml", "--allow-external"])
            .json()
    };
    let (first, second) = (run(), run());
    assert_eq!(first["robots"][0]["outcome"], "escaped", "{first}");
    assert!(first["robots"][0]["distance_m"].as_f64().unwrap() > 2.5);
    assert_eq!(first["digest"], second["digest"]);
    let ticks = first["ticks"].as_u64().unwrap();
    assert_eq!(first["topics"]["robot/command"]["messages"], ticks);
    sandbox.assert_nothing_left();
}
