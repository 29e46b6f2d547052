//! Robots in lanes and doors that are too narrow for two.

use core::f64::consts::PI;

use mission::in_process::{InProcessOptions, run};
use recorder::Summary;

/// Place along x (m), heading (rad) and goal along x (m) of a robot in a lane.
type Trip = (f64, f64, f64);

/// Two robots swap the ends of a lane.
const SWAP: [Trip; 2] = [(0.4, 0.0, 7.6), (7.6, PI, 0.4)];

/// A lane of this width (m) from x = 0 to 8 m, with bays: their middle and half their width (m).
fn lane(bays: &[(f64, f64)], width: f64, limits: &str, trips: &[Trip]) -> String {
    let mut ends = vec![0.0];
    ends.extend(bays.iter().flat_map(|(at, half)| [at - half, at + half]));
    ends.push(8.0);
    let blocks = ends.chunks(2).map(|pair| (pair[0], pair[1], width));
    let backs = bays.iter().map(|(at, half)| (at - half, at + half, 1.0));
    let blocks = blocks.chain(backs);
    let obstacles: Vec<_> = blocks.map(|(from, to, low)| [from, low, to, 1.6]).collect();
    let y = 0.5 * width;
    let trips = trips.iter();
    let trips: Vec<_> = trips
        .map(|&(x, theta, to)| ([x, y], theta, [to, y]))
        .collect();
    mission([8.0, 1.6], &obstacles, limits, &trips)
}

/// A mission of robots among rectangles from (x, y) to (x, y) (m): their starts, headings and goals.
fn mission(
    size: [f64; 2],
    rectangles: &[[f64; 4]],
    limits: &str,
    trips: &[([f64; 2], f64, [f64; 2])],
) -> String {
    let obstacles = rectangles.iter().map(|[x0, y0, x1, y1]| {
        let center = [f64::midpoint(*x0, *x1), f64::midpoint(*y0, *y1)];
        let half = [0.5 * (x1 - x0), 0.5 * (y1 - y0)];
        format!(
            "[[world.map.vector.obstacles]]\n\
             shape.rectangle = {{ center = {center:?}, half_extents = {half:?} }}\n"
        )
    });
    let robots = trips.iter().enumerate().map(|(i, ([x, y], theta, to))| {
        format!(
            "[[robots]]\nname = \"r{i}\"\nteam = \"neutral\"\nlimits = {{ {limits} }}\n\
             start = {{ x = {x}, y = {y}, theta = {theta} }}\n\
             goal = {{ circle = {{ center = {to:?}, radius = 0.05 }} }}\n"
        )
    });
    let names: Vec<String> = (0..trips.len()).map(|i| format!("r{i}")).collect();
    format!(
        "[world.map.vector]\nbounds = {{ min = [0.0, 0.0], max = {size:?} }}\n{}\
         [rules]\ntime_limit = 200.0\n{}\
         [[processes]]\nkind = \"optimiser\"\n\
         [[processes]]\nkind = \"navigator\"\nrobots = {names:?}\n",
        obstacles.collect::<String>(),
        robots.collect::<String>(),
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
        let summary = drive(&lane(&[bay], width, limits, &SWAP));
        assert_eq!(
            outcomes(&summary),
            [("goal_reached", 0); 2],
            "{bay:?} {width} {limits}: {:?}",
            summary.robots
        );
    }
}

#[test]
fn convoys_swap_the_ends_of_a_lane() {
    // The bays hold one convoy of two and a robot of the other one of three.
    let east = [(1.2, 0.0, 7.6), (0.8, 0.0, 7.2), (0.4, 0.0, 6.8)];
    let west = [(7.2, PI, 0.4), (7.6, PI, 0.8)];
    let trips: Vec<Trip> = east.into_iter().chain(west).collect();
    let summary = drive(&lane(&[(3.0, 0.35), (5.0, 0.35)], 0.4, "", &trips));
    assert_eq!(outcomes(&summary), [("goal_reached", 0); 5]);
}

#[test]
fn robots_swap_two_rooms_through_a_door() {
    // A door of 0.34 m.
    let wall = [[2.0, 0.0, 2.1, 1.03], [2.0, 1.37, 2.1, 2.4]];
    let trips = [
        ([1.6, 1.2], 0.0, [3.4, 0.4]),
        ([1.0, 0.5], 0.0, [3.6, 1.9]),
        ([2.5, 1.2], PI, [0.5, 0.4]),
        ([3.0, 1.8], PI, [0.5, 1.9]),
    ];
    let summary = drive(&mission([4.1, 2.4], &wall, "", &trips));
    assert_eq!(outcomes(&summary), [("goal_reached", 0); 4]);
}

#[test]
fn robots_that_stand_without_a_way_are_reported() {
    let summary = drive(&lane(&[], 0.4, "", &SWAP));
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
