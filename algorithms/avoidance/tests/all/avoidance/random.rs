//! Random worlds: the robot reaches every goal that an exact planner reaches, and reports the others.

use crate::drive::{FAR, Machine, PATROL, SENSORS};
use crate::random_world::RandomWorld;
use planner_view::waypoint::WaypointOutcome::{Reached, Unreachable};

/// Number of worlds for each of [`SENSORS`].
const WORLDS: [u64; 3] = [110, 60, 40];

/// Drives a robot through a world; returns `true` if its goal surely was reachable, `false` if it surely was
/// not, `None` if neither is sure.
fn drive(number: u64, machine: Machine) -> Option<bool> {
    let driven = RandomWorld::new(number, &machine)?.drive(machine);
    let (outcome, run) = (driven.outcome, &driven.run);
    assert!(
        run.least_clearance > 0.0,
        "world {number}: contact {}",
        run.least_clearance
    );
    assert!(
        outcome.is_some(),
        "world {number}: no end at {:?}",
        run.pose
    );
    let expected = driven
        .reachable
        .map(|surely| if surely { Reached } else { Unreachable });
    if expected.is_some() {
        assert_eq!(outcome, expected, "world {number}: at {:?}", run.pose);
    }
    driven.reachable
}

/// Numbers of worlds whose goal surely could not and surely could be reached.
fn drive_all(seeds: core::ops::Range<u64>, machine: Machine) -> [u32; 2] {
    let mut judged = [0; 2];
    for reachable in seeds.filter_map(|seed| drive(seed, machine)) {
        judged[usize::from(reachable)] += 1;
    }
    judged
}

#[test]
fn the_robot_reaches_what_can_be_reached_and_reports_the_rest() {
    for (worlds, machine) in WORLDS.into_iter().zip(SENSORS) {
        let judged = drive_all(0..worlds, machine);
        // Both kinds of worlds occur.
        let [none, some] = judged.map(|count| u64::from(count) * 110 / worlds);
        assert!(none > 10 && some > 50, "{judged:?}");
    }
}

#[test]
fn the_robot_leaves_wedges() {
    // The tip of a wedge looks walled in, and a step outside it either wall may be the followed one.
    for seed in [2510, 2889, 5537, 6409, 7180] {
        assert_eq!(drive(seed, PATROL), Some(true), "world {seed}");
    }
}

#[test]
fn a_robot_whose_speeds_take_time_to_change_does_as_well() {
    let nimble = Machine {
        accelerations: Some((1.0, 8.0)),
        ..PATROL
    };
    let slow = Machine {
        v_max: 0.5,
        ..nimble
    };
    let sluggish = Machine {
        range: 0.7,
        accelerations: Some((0.5, 4.0)),
        ..PATROL
    };
    for (seeds, machine) in [(0..14, nimble), (30..40, slow), (50..58, sluggish)] {
        let judged = drive_all(seeds, machine);
        assert!(judged[1] > 3, "{judged:?}");
    }
}

#[test]
fn a_long_range_sensor_does_not_cause_oscillation_at_a_boundary() {
    for seed in [56, 119, 208] {
        assert_ne!(drive(seed, FAR), Some(false), "{seed}");
    }
}

#[test]
fn reachable_goals_are_not_given_up_and_no_drive_is_endless() {
    // A beam that meets an edge or misses it, by the heading, made the robot choose between two directions on
    // the spot until it counted as stuck.
    for number in [100_087, 100_766] {
        assert_eq!(drive(number, PATROL), Some(true), "{number}");
    }
    // Excursions to passages that only look wide enough from afar closed the loop falsely.
    for number in [100_342, 100_531, 101_139, 101_972] {
        assert_eq!(drive(number, FAR), Some(true), "{number}");
    }
    // The robot circled a walled-in goal along tangents without end.
    assert_eq!(drive(100_100, FAR), Some(false));
}

#[test]
fn a_robot_that_turns_on_the_spot_keeps_its_choice() {
    // Two near-equal tangents, and two directions along a boundary with little room, each seen only from the
    // heading of the other: the robot turned left and right in turn until it counted as stuck.
    assert_eq!(drive(301_393, PATROL), Some(true));
    assert_eq!(drive(301_045, FAR), Some(true));
}
