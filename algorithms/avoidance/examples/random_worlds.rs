//! Drives a robot through random worlds by `TangentBug`, and counts the goals that it does not reach.
//!
//! `cargo run --release -p protean-avoidance --example random_worlds [worlds] [first]`: 10 000 worlds from number
//! 100 000 by default, for sensors with a range of 0.5 m and of 3.5 m, and for the default sensor. A drive with
//! a wrong end (given up though the goal is reachable, endless, a contact) ends it with an error.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use drive::SENSORS;
use planner_view::waypoint::WaypointOutcome::{Reached, Stuck};
use random_world::RandomWorld;

#[allow(dead_code, reason = "the tests use all of it")]
#[path = "../tests/all/drive.rs"]
mod drive;
#[path = "../tests/all/random_world.rs"]
mod random_world;

fn main() {
    let mut arguments = std::env::args().skip(1).map(|a| a.parse::<u64>());
    let mut argument = |default| arguments.next().and_then(Result::ok).unwrap_or(default);
    let (count, first) = (argument(10_000), argument(100_000));
    let mut wrong = 0;
    for machine in SENSORS {
        let (mut driven, mut reachable, mut unreachable, mut stuck) = (0, 0, 0, 0);
        let (mut given_up, mut endless, mut contacts) = (Vec::new(), Vec::new(), Vec::new());
        let mut longest: f64 = 0.0;
        for number in first..first + count {
            let Some(world) = RandomWorld::new(number, &machine) else {
                continue;
            };
            let drive = world.drive(machine);
            driven += 1;
            reachable += u32::from(drive.reachable == Some(true));
            unreachable += u32::from(drive.reachable == Some(false));
            longest = longest.max(drive.run.travelled);
            if drive.run.least_clearance <= 0.0 {
                contacts.push(number);
            }
            stuck += u32::from(drive.outcome == Some(Stuck));
            match drive.outcome {
                None => endless.push(number),
                Some(Reached) => {}
                Some(_) if drive.reachable == Some(true) => given_up.push(number),
                Some(_) => {}
            }
        }
        wrong += given_up.len() + endless.len() + contacts.len();
        println!(
            "range {} m, {} beams, noise {} m: worlds {first} to {}, {driven} drives",
            machine.range,
            machine.beams,
            machine.noise,
            first + count - 1
        );
        println!(
            "  goals reachable {reachable}, not reachable {unreachable}; stuck {stuck}; longest drive {longest:.0} m"
        );
        println!(
            "  given up though reachable {}: {given_up:?}",
            given_up.len()
        );
        println!("  endless {}: {endless:?}", endless.len());
        println!("  contacts {}: {contacts:?}", contacts.len());
    }
    assert_eq!(wrong, 0, "drives with a wrong end");
}
