//! An evader of the kind `evader_reach_avoid` drove against the wall of `hello` until the time limit, and
//! one of the kind `evader_potential` never got its axle into a small exit.

use crate::support::Sandbox;

fn outcome(set: &[&str]) -> (String, f64) {
    let sandbox = Sandbox::new();
    let mut call = sandbox.protean(["run", "hello", "--in-process", "--quiet"]);
    for change in set {
        call = call.set(change);
    }
    let robot = &call.json()["robots"][0];
    let time = robot["time_s"].as_f64().unwrap();
    (robot["outcome"].as_str().unwrap().to_owned(), time)
}

#[test]
fn a_reach_avoid_evader_leaves_the_room_without_police() {
    let (outcome, time_s) = outcome(&["processes.evader_potential.kind=\"evader_reach_avoid\""]);
    assert_eq!(outcome, "escaped");
    // The path is 5.2 m long, at 0.22 m/s.
    assert!(time_s < 28.0, "{time_s}");
}

#[test]
fn an_evader_enters_an_exit_nearer_than_its_control_point() {
    let exit = "rules.exits=[{ circle = { center = [3.5, 0.5], radius = 0.1 } }]";
    assert_eq!(outcome(&[exit]).0, "escaped");
}
