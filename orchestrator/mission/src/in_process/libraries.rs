//! Libraries of planners and processes that this program loads itself.

use std::collections::BTreeMap;
use std::path::Path;

use library_planner::{Library, LibraryParams, LibraryPlanner, LibraryProgram};
use planner::{PlannerProcess, TopicProcess};
use scenario::kind::ConfiguredKind;
use scenario::{Program, ResolvedScenario};

use super::super::child_process::OWN_NAME;
use super::super::error::InProcessError;

/// Adds the kinds of the processes whose command is a library for this program: `["protean", "planner", LIBRARY]`.
///
/// # Errors
/// [`InProcessError::Library`] names the process and the fault of the file.
pub(super) fn load(
    scenario: &ResolvedScenario,
    programs: &mut BTreeMap<String, ConfiguredKind>,
) -> Result<(), InProcessError> {
    for process in &scenario.processes {
        let Program::Command { words, folder, .. } = &process.program else {
            continue;
        };
        let [OWN_NAME, "planner", file] = *words.iter().map(String::as_str).collect::<Vec<_>>()
        else {
            continue;
        };
        let library = Library::load(&Path::new(folder).join(file));
        let library = library.map_err(|source| InProcessError::Library {
            name: process.name.clone(),
            source: Box::new(source),
        })?;
        let params = LibraryParams::new(&process.program.params(), library);
        let kind = if library.is_process() {
            ConfiguredKind::new::<TopicProcess<LibraryProgram>>(params)
        } else {
            ConfiguredKind::new::<PlannerProcess<LibraryPlanner>>(params)
        };
        programs.insert(process.name.clone(), kind);
    }
    Ok(())
}
