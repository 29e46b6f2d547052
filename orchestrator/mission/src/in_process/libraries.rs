//! Libraries of planners and processes that this program loads itself.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use library_planner::{Library, LibraryParams, LibraryPlanner, LibraryProgram};
use planner::{PlannerProcess, TopicProcess};
use scenario::kind::ConfiguredKind;
use scenario::{Program, ResolvedScenario};

use super::super::child_process::OWN_NAME;
use super::super::error::InProcessError;

/// Returns the file of a library.
fn library_of(program: &Program) -> Option<PathBuf> {
    let Program::Command { words, folder, .. } = program else {
        return None;
    };
    let [OWN_NAME, "planner", file] = *words.iter().map(String::as_str).collect::<Vec<_>>() else {
        return None;
    };
    Some(Path::new(folder).join(file))
}

/// Returns `true` if a run in one thread starts external programs, whose state no copy of this process contains.
pub fn has_children(scenario: &ResolvedScenario) -> bool {
    let mut external = scenario.external_commands();
    external.any(|process| library_of(&process.program).is_none())
}

/// Adds the kinds of the processes whose command is a library for this program: `["protean", "planner", LIBRARY]`.
///
/// # Errors
/// [`InProcessError::Library`] names the process and the fault of the file.
pub(super) fn load(
    scenario: &ResolvedScenario,
    programs: &mut BTreeMap<String, ConfiguredKind>,
) -> Result<(), InProcessError> {
    for process in &scenario.processes {
        let Some(file) = library_of(&process.program) else {
            continue;
        };
        let library = Library::load(&file);
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
