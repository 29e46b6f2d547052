//! Two robots in a lane that is too narrow for both.

use mission::in_process::{InProcessOptions, run};
use recorder::Summary;

/// A lane of this width (m) from x = 0 to 8 m, with bays: their middle and half their width (m). Two
/// robots swap its ends.
fn lane(bays: &[(f64, f64)], width: f64, limits: &str) -> String {
    let mut ends = vec![0.0];
    ends.extend(bays.iter().flat_map(|(at, half)| [at - half, at + half]));
    ends.push(8.0);
    let blocks = ends.chunks(2).map(|pair| (pair[0], pair[1], width));
    let backs = bays.iter().map(|(at, half)| (at - half, at + half, 1.0));
    let obstacles: Vec<String> = blocks
        .chain(backs)
        .map(|(from, to, low)| {
            let center = [f64::midpoint(from, to), f64::midpoint(low, 1.6)];
            let half = [0.5 * (to - from), 0.5 * (1.6 - low)];
            format!(
                "[[world.map.vector.obstacles]]\n\
                 shape.rectangle = {{ center = {center:?}, half_extents = {half:?} }}\n"
            )
        })
        .collect();
    let obstacles = obstacles.concat();
    let robot = |name: &str, from: f64, theta: f64, to: f64| {
        format!(
            "[[robots]]\nname = \"{name}\"\nteam = \"neutral\"\nlimits = {{ {limits} }}\n\
             start = {{ x = {from}, y = {y}, theta = {theta} }}\n\
             goal = {{ circle = {{ center = [{to}, {y}], radius = 0.05 }} }}\n",
            y = 0.5 * width
        )
    };
    format!(
        "[world.map.vector]\nbounds = {{ min = [0.0, 0.0], max = [8.0, 1.6] }}\n{obstacles}\
         [rules]\ntime_limit = 200.0\n{}{}\
         [[processes]]\nkind = \"optimiser\"\n\
         [[processes]]\nkind = \"navigator\"\nrobots = [\"east\", \"west\"]\n",
        robot("east", 0.4, 0.0, 7.6),
        robot("west", 7.6, core::f64::consts::PI, 0.4),
    )
}

fn drive(text: &str) -> Summary {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("lane.toml");
    std::fs::write(&file, text).unwrap();
    let scenario = kinds::load(file.to_str().unwrap(), &[], None)
        .unwrap_or_else(|problems| panic!("{problems}\n{text}"));
    run(&scenario, &InProcessOptions::default())
        .unwrap()
        .summary
}

fn outcomes(summary: &Summary) -> Vec<(&str, u32)> {
    let robots = summary.robots.iter();
    robots.map(|r| (r.outcome.as_str(), r.contacts)).collect()
}

#[test]
fn two_robots_nose_to_nose_swap_ends_wherever_the_bay_is() {
    let inertia = "acceleration = 0.5, angular_acceleration = 6.0";
    // Behind the robot without right of way, between the two, behind the one with it.
    for (bay, width, limits) in [
        ((6.0, 0.4), 0.4, ""),
        ((6.0, 0.4), 0.35, inertia),
        ((4.0, 0.15), 0.4, ""),
        ((3.8, 0.2), 0.3, ""),
        ((2.0, 0.3), 0.3, ""),
    ] {
        let summary = drive(&lane(&[bay], width, limits));
        assert_eq!(
            outcomes(&summary),
            [("goal_reached", 0); 2],
            "{bay:?} {width} {limits}: {:?}",
            summary.robots
        );
    }
}

#[test]
fn robots_that_stand_without_a_way_are_reported() {
    let summary = drive(&lane(&[], 0.4, ""));
    assert_eq!(outcomes(&summary), [("timed_out", 0); 2]);
    for robot in &summary.robots {
        assert_eq!(robot.standstills, 1, "{robot:?}");
        let of_robot = |kind: &str| {
            let mut events = summary.events.iter();
            events.find(|e| e.kind == kind && e.robot.as_ref() == Some(&robot.name))
        };
        let stands = of_robot("stands").unwrap();
        // They meet after 3.5 m at 0.22 m/s.
        assert!((25.0..32.0).contains(&stands.time_s), "{stands:?}");
        assert_eq!(stands.value, 10.0);
    }
}
