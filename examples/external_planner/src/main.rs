//! A planner for Protean: a run of `hall.toml` starts this program.

mod nearest_free;

use std::process::ExitCode;

fn main() -> ExitCode {
    planner::main::<nearest_free::NearestFree>()
}
