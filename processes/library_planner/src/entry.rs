//! The process of a library.

use std::path::Path;
use std::process::ExitCode;

use planner::{PlannerProcess, TopicProcess};
use runtime::config::{CONFIG_VARIABLE, DECLARE_VARIABLE};
use serde_json::Value as Json;

use crate::library::Library;
use crate::params::LibraryParams;
use crate::process::LibraryPlanner;
use crate::topic_process::LibraryProgram;

/// Exit code of a library that no run has started.
const EXIT_WITHOUT_RUN: u8 = 2;

/// Main function of a process whose planner is in a library: `command = ["protean", "planner", "LIBRARY"]`.
///
/// A process prints its declaration if it is asked. Without a run it checks the library and says how to use it, with exit code 2.
pub fn run(path: &Path) -> ExitCode {
    let library = match Library::load(path) {
        Ok(library) => library,
        Err(error) => {
            eprintln!("error: {error}");
            return ExitCode::FAILURE;
        }
    };
    if std::env::var_os(DECLARE_VARIABLE).is_some() && library.is_process() {
        // The library was checked.
        let declared = library.declaration().unwrap_or_default();
        println!("{}", serde_json::json!(declared));
        return ExitCode::SUCCESS;
    }
    let Some(config) = std::env::var_os(CONFIG_VARIABLE) else {
        let what = if library.is_process() {
            "process"
        } else {
            "planner"
        };
        eprintln!(
            "{path}: a {what} that reads {}\nA run of protean starts it: name it in a scenario, command = [\"protean\", \
             \"planner\", \"{path}\"] in [[processes]].",
            library.inputs(),
            path = path.display()
        );
        return ExitCode::from(EXIT_WITHOUT_RUN);
    };
    runtime::run_with(Path::new(&config), Vec::new(), |config, values: &Json| {
        let params = LibraryParams::new(values, library);
        if library.is_process() {
            return runtime::follow::<TopicProcess<LibraryProgram>>(config, &params);
        }
        runtime::follow::<PlannerProcess<LibraryPlanner>>(config, &params)
    })
}
