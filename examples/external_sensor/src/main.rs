//! Protean with three kinds of processes of its own: a sensor that measures bearings alone, a tracker that finds
//! positions from them within the tick, and a planner that drives to these positions.

mod chaser;
mod messages;
mod sensor;
mod tracker;

use std::process::ExitCode;

use protean::kinds::{KINDS, Kind, planner};

fn main() -> ExitCode {
    let own = [
        Kind::from_type::<sensor::BearingSensor>(),
        Kind::from_type::<tracker::BearingTracker>(),
        planner::<chaser::Chaser>(),
    ];
    protean::main_with([KINDS, &own].concat())
}
