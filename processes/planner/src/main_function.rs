//! Main function of a program that is a process of a planner.

use std::path::Path;
use std::process::ExitCode;

use runtime::config::CONFIG_VARIABLE;

use crate::planner::Planner;
use crate::process::PlannerProcess;

/// Exit code of a program that no run has started.
const EXIT_WITHOUT_RUN: u8 = 2;

/// Main function of a program that is a process of this planner. A scenario names the program with `command`; a run
/// starts it with the path of its configuration in the environment.
pub fn main<P: Planner>() -> ExitCode {
    let Some(config) = std::env::var_os(CONFIG_VARIABLE) else {
        eprintln!(
            "{}: {}\nA run of protean starts this program, a planner: name it in a scenario, command = [\"…\"] in \
             [[processes]].",
            P::NAME,
            P::SUMMARY
        );
        return ExitCode::from(EXIT_WITHOUT_RUN);
    };
    runtime::run::<PlannerProcess<P>>(Path::new(&config))
}
