//! Drives a robot through random worlds by `TangentBug`, and counts the goals that it does not reach.
//!
//! `cargo run --release -p protean-avoidance --example random_worlds [worlds] [first]`: 2000 worlds from number
//! 100 000 by default, for sensors with a range of 0.5 m and of 3.5 m.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use drive::{Machine, PATROL};
use planner_view::waypoint::WaypointOutcome::Reached;
use random_world::RandomWorld;

#[allow(dead_code, reason = "the tests use all of it")]
#[path = "../tests/all/drive.rs"]
mod drive;
#[path = "../tests/all/random_world.rs"]
mod random_world;

fn main() {
    let mut arguments = std::env::args().skip(1).map(|a| a.parse::<u64>());
    let mut argument = |default| arguments.next().and_then(Result::ok).unwrap_or(default);
    let (count, first) = (argument(2000), argument(100_000));
    for range in [0.5, 3.5] {
        let machine = Machine { range, ..PATROL };
        let (mut driven, mut reachable, mut unreachable) = (0, 0, 0);
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
            match drive.outcome {
                None => endless.push(number),
                Some(Reached) => {}
                Some(_) if drive.reachable == Some(true) => given_up.push(number),
                Some(_) => {}
            }
        }
        println!(
            "range {range} m: worlds {first} to {}, {driven} drives",
            first + count - 1
        );
        println!(
            "  goals reachable {reachable}, not reachable {unreachable}; longest drive {longest:.0} m"
        );
        println!(
            "  given up though reachable {}: {given_up:?}",
            given_up.len()
        );
        println!("  endless {}: {endless:?}", endless.len());
        println!("  contacts {}: {contacts:?}", contacts.len());
    }
}
