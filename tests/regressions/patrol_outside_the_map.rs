//! A patrol with a small danger zone planned 13 of 30 waypoints outside the map, and one with a zone
//! beside its contour was not protected at all; no command mentioned it.

use crate::support::Sandbox;
use plan::routes::patrol::Patrol;
use serde_json::Value as Json;

fn zone(center: [f64; 2]) -> String {
    format!(
        "processes.patrol.params.mission.danger_zones=[{{ circle = {{ center = {center:?}, radius = 2 }} }}]"
    )
}

fn warnings(remarks: &Json) -> Vec<&str> {
    let remarks = remarks.as_array().unwrap().iter();
    let warnings = remarks.filter(|remark| remark["severity"] == "warning");
    warnings.map(|w| w["message"].as_str().unwrap()).collect()
}

#[test]
fn a_patrol_with_a_danger_zone_stays_inside_the_map() {
    let sandbox = Sandbox::new();
    let scenario = kinds::load("patrol_octagon", &[zone([5.0, 0.0])], None).unwrap();
    let plan = Patrol::from_scenario(&scenario, None, None).unwrap();
    let plan = plan.plan_json(1).unwrap();
    assert_eq!(plan["alpha_choice"], "room");
    for waypoint in plan["waypoints"].as_array().unwrap() {
        for axis in ["x", "y"] {
            let at = waypoint[axis].as_f64().unwrap();
            assert!((-1.781..=16.781).contains(&at), "{waypoint}");
        }
    }
    // The robot chooses the same width.
    let run = sandbox
        .protean(["run", "patrol_octagon", "--in-process"])
        .set(&zone([5.0, 0.0]))
        .set("rules.time_limit=130")
        .json();
    assert!(warnings(&run["remarks"]).is_empty());
    let note = run["remarks"][0]["message"].as_str().unwrap();
    let alpha = plan["alpha"].as_f64().unwrap();
    assert!(note.contains(&format!("{alpha:.3} m")), "{note} {alpha}");
    let waypoints = &run["robots"][0]["waypoints"];
    assert_eq!(waypoints["timed_out"], 0, "{waypoints}");
}

#[test]
fn waypoints_outside_the_map_are_reported_by_every_command() {
    let sandbox = Sandbox::new();
    let wide = "processes.patrol.params.mission.alpha=6";
    for mode in [&["--in-process"][..], &[]] {
        let words = ["run", "patrol_octagon", "--out", "run.mcap", "--force"];
        let run = sandbox
            .protean(words.iter().chain(mode).copied())
            .set(wide)
            .set("rules.time_limit=1")
            .json();
        assert_eq!(warnings(&run["remarks"]).len(), 1);
        let logged = sandbox.protean(["cat", "run.mcap", "--topics", "process/log"]);
        let logged = logged.run();
        assert!(logged.stdout.contains("the robot does not fit"), "{logged}");
    }
    let told = sandbox.protean(["check", "patrol_octagon"]).set(wide).run();
    assert!(told.stdout.contains("the robot does not fit"), "{told}");
}

#[test]
fn a_danger_zone_beside_the_contour_is_reported() {
    let sandbox = Sandbox::new();
    let check = sandbox
        .protean(["check", "patrol_octagon"])
        .set(&zone([7.5, 7.5]))
        .json();
    let found = warnings(&check["remarks"]);
    assert!(found[0].contains("`danger_zones[0]`"), "{found:?}");
    assert!(found[1].contains("unprotected"), "{found:?}");
}

#[test]
fn a_corner_of_the_contour_in_an_unknown_obstacle_is_refused() {
    let sandbox = Sandbox::new();
    let post = "{ name = \"post\", shape = { circle = { center = [0.0, 5.0], radius = 0.4 } } }";
    sandbox
        .protean(["check", "patrol_octagon"])
        .set(&format!("world.map.vector.obstacles=[{post}]"))
        .run()
        .refused(2, &["contour[1]"]);
}
