//! The program `protean` with one more kind of process.

mod nearest_free;

use std::process::ExitCode;

use protean::kinds;

fn main() -> ExitCode {
    let mut all = kinds::KINDS.to_vec();
    all.push(kinds::planner::<nearest_free::NearestFree>());
    protean::main_with(all)
}
