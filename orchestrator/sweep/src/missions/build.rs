//! Building of the scenarios of the cells from cases and parameters.

use config::{Code, Diagnostic, Diagnostics, FieldPath, Place, Step};

use super::mission::Mission;
use crate::assignments::Assignment;
use crate::cases::CaseDraft;
use crate::cell::{Cell, Value, describe};
use crate::grid::LocatedValue;
use crate::options::LoadOptions;
use crate::parameters::{Parameter, ScaleError};
use crate::reader::Reader;
use scenario::{Draft, MapCache, Program, ResolvedScenario, Template, spec};

/// An applied override, and its origin.
struct AppliedOverride {
    place: Vec<Step>,
    by: String,
}

/// Applies overrides and records what they change.
struct Builder<'r> {
    reader: &'r mut Reader,
    /// Problems that have been reported, without the name of their cell.
    reported: Vec<Diagnostic>,
}

impl Builder<'_> {
    /// Applies overrides; reports those that undo earlier ones as contradictions.
    fn apply(
        &mut self,
        draft: &mut Draft<'static>,
        made: &mut Vec<AppliedOverride>,
        assignments: &[Assignment],
        by: &str,
    ) {
        for assignment in assignments {
            let Some(path) = draft.apply(&assignment.label, &assignment.argument) else {
                continue;
            };
            let place: Vec<Step> = path.0.iter().map(by_index).collect();
            if place == [Step::Key("run".into()), Step::Key("seed".into())] {
                self.contradiction(
                    assignment,
                    &path,
                    "sets `run.seed`, which `seeds` varies",
                    by,
                );
            }
            // The same key again, or a table that contains it: the earlier value would be lost.
            if let Some(earlier) = made.iter().find(|m| m.place.starts_with(&place)) {
                let message = format!("sets `{path}`, which {} sets too", earlier.by);
                self.contradiction(assignment, &path, &message, by);
            }
            made.push(AppliedOverride {
                place,
                by: by.to_owned(),
            });
        }
    }

    fn contradiction(&mut self, assignment: &Assignment, path: &FieldPath, what: &str, by: &str) {
        let problem = Diagnostic::new(Code::Duplicate, format!("{by} {what}"))
            .field(format!("{}: {path}", assignment.label))
            .value(&assignment.argument)
            .expected("every key set in one place");
        self.reader.problems.push(problem);
    }

    /// Reports that the factor of a parameter is missing.
    fn unscaled(&mut self, parameter: &str, case: &str, error: ScaleError) {
        let message = format!("`{parameter}` cannot be scaled by `{}`", error.key);
        let problem = Diagnostic::new(Code::Requirement, message)
            .field(format!("{}: parameters.{parameter}.scale", error.label))
            .value(error.found)
            .expected(format!(
                "a number that the scenario of case `{case}` contains, or a number in its place"
            ));
        self.reader.problems.push(problem);
    }

    /// Reports the problems of the scenario of a cell, each for the first cell only. One of a key stands at the key, once
    /// for all values.
    fn report(&mut self, case: &str, cell: &str, applied: &[Assignment], problems: &Diagnostics) {
        for problem in problems.iter() {
            let mut problem = problem.clone();
            let key = problem
                .place
                .as_ref()
                .and_then(|place| key_at(place, applied));
            if key.is_some() {
                problem.place = key.cloned();
                problem.value = None;
            }
            if self.reported.contains(&problem) {
                continue;
            }
            self.reported.push(problem.clone());
            let scope = if key.is_some() { case } else { cell };
            problem.message = format!("{} (in {scope})", problem.message);
            self.reader.problems.push(problem);
        }
    }
}

/// Returns the place in the experiment of the key that a place in an override is about; `None` for a place in its value.
fn key_at<'a>(place: &Place, applied: &'a [Assignment]) -> Option<&'a Place> {
    let is_there = |assignment: &&Assignment| {
        assignment.label == place.file && place.snippet.starts_with(assignment.key())
    };
    let assignment = applied.iter().find(is_there)?;
    let is_in_key = place.is_override && place.column <= assignment.key().chars().count();
    assignment.key_place.as_ref().filter(|_| is_in_key)
}

fn by_index(step: &Step) -> Step {
    match step {
        Step::Named(index, _) => Step::Index(*index),
        step => step.clone(),
    }
}

/// Returns the cells in order; cells with an invalid scenario are reported and left out.
pub fn build(
    reader: &mut Reader,
    cases: &[CaseDraft<Draft<'static>>],
    parameters: &[Parameter],
    combinations: &[Vec<LocatedValue>],
    options: &LoadOptions,
) -> Vec<Cell<Mission>> {
    let names: Vec<&str> = parameters.iter().map(|p| p.name.as_str()).collect();
    let on_top = options
        .set
        .iter()
        .map(|set| Assignment::of_command_line(set));
    let on_top: Vec<Assignment> = on_top.collect();
    let mut builder = Builder {
        reader,
        reported: Vec::new(),
    };
    let mut map_cache = MapCache::default();
    let mut cells = Vec::new();
    for case in cases {
        for combination in combinations {
            let values: Vec<Value> = combination.iter().map(|w| w.value.clone()).collect();
            let title = describe(&case.case.name, &names, &values);
            let mut made = Vec::new();
            let mut draft = case.draft.clone();
            let mut applied = case.assignments.clone();
            let by = format!("case `{}`", case.case.name);
            builder.apply(&mut draft, &mut made, &case.assignments, &by);
            for (parameter, written) in parameters.iter().zip(combination) {
                let (value, node) = (&written.value, &written.node);
                let found = match parameter.assignments(value, node, builder.reader, Some(&draft)) {
                    Ok(found) => found,
                    Err(error) => {
                        builder.unscaled(&parameter.name, &case.case.name, error);
                        continue;
                    }
                };
                let by = format!("parameter `{}`", parameter.name);
                builder.apply(&mut draft, &mut made, &found, &by);
                applied.extend(found);
            }
            builder.apply(&mut draft, &mut made, &on_top, "--set");
            applied.extend(on_top.iter().cloned());
            let name = format!("case {}", case.case.name);
            let template = match template(draft, &mut map_cache, options) {
                Ok(template) => template,
                Err(problems) => {
                    builder.report(&name, &title, &applied, &problems);
                    continue;
                }
            };
            let scenario = template.scenario();
            for problem in unfit(scenario, case, options) {
                builder.report(&name, &title, &applied, &problem.into());
            }
            cells.push(Cell {
                case: case.case.name.clone(),
                values,
                target: case.target.clone(),
                overrides: applied.into_iter().map(|a| a.argument).collect(),
                external: scenario.uses_external_commands(),
                blake3: fingerprint(scenario.clone()),
                subject: Mission {
                    one_core: scenario.run.pin == spec::Pin::OneCore,
                    template,
                },
            });
        }
    }
    cells
}

/// Returns the template of a scenario; external programs that may run are asked for their declarations.
///
/// # Errors
/// All problems, also that of a program that does not state its declaration.
pub fn template(
    mut draft: Draft<'_>,
    maps: &mut MapCache,
    options: &LoadOptions,
) -> Result<Template, Diagnostics> {
    let template = draft.clone().template(maps)?;
    if !options.allow_external {
        return Ok(template);
    }
    let declared = mission::ask(template.scenario())
        .map_err(|error| Diagnostic::new(Code::Requirement, error.to_string()))?;
    if declared.is_empty() {
        return Ok(template);
    }
    for argument in declared {
        draft.apply("answer of its program", &argument);
    }
    draft.template(maps)
}

/// Finds the parts of a scenario that a sweep does not allow.
fn unfit<D>(
    scenario: &ResolvedScenario,
    case: &CaseDraft<D>,
    options: &LoadOptions,
) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    if scenario.run.mode != spec::Mode::LockStep {
        found.push(
            Diagnostic::new(Code::Requirement, "a sweep runs in lock-step")
                .field("run.mode")
                .value("\"real_time\"")
                .expected("\"lock_step\": real-time results cannot be reproduced"),
        );
    }
    if !options.allow_external {
        for process in scenario.external_commands() {
            let message = format!(
                "the scenario of case `{}` starts an external program",
                case.case.name
            );
            found.push(
                Diagnostic::new(Code::Requirement, message)
                    .field(format!("{}: processes.{}.command", case.path, process.name))
                    .expected("--allow-external, after a review of the program"),
            );
        }
    }
    found
}

/// Hash of everything on which a run of the scenario depends, without its seed.
pub fn fingerprint(mut scenario: ResolvedScenario) -> String {
    let defaults = spec::RunSpec::default();
    scenario.title.clear();
    scenario.description.clear();
    scenario.log = spec::LogSpec::default();
    scenario.run.pin = defaults.pin;
    scenario.run.hang_timeout_s = defaults.hang_timeout_s;
    for process in &mut scenario.processes {
        if let Program::Command { folder, .. } = &mut process.program {
            // Another one on each machine.
            folder.clear();
        }
    }
    blake3::hash(scenario.to_toml().as_bytes())
        .to_hex()
        .to_string()
}
