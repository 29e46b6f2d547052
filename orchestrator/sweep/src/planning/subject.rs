//! Plans, as the subject of a cell of an experiment.

use core::fmt::Display;
use std::collections::BTreeSet;
use std::path::Path;

use config::{Code, Diagnostic, FieldPath, Node};

use super::row::PlanRow;
use crate::assignments::{self, Assignment};
use crate::cases::CaseDraft;
use crate::cell::{Cell, Value, describe};
use crate::engine::Call;
use crate::experiment::{ExperimentOf, MAX_FILE};
use crate::grid::LocatedValue;
use crate::options::LoadOptions;
use crate::parameters::Parameter;
use crate::reader::Reader;
use crate::subject::{MissionResult, Pinning, Subject};
use crate::task::{Draft, DraftError, Task};
use plan::solve;
use scenario::files::read_text;

/// An experiment of plans.
pub type PlanExperiment = ExperimentOf<Task>;

/// Returns `true` if a file is an experiment of plans. An unreadable file is not one; loading it
/// reports the reason.
pub fn is_planning(path: &Path) -> bool {
    let text = read_text(path, MAX_FILE).ok();
    let reader = text.and_then(|text| Reader::new("", &text).ok());
    let kind = reader.and_then(|r| r.root.get("kind")?.as_str().map(str::to_owned));
    kind.as_deref() == Some("planning")
}

impl Subject for Task {
    type Row = PlanRow;
    type Draft = ();
    type Engine = ();
    const UNIT: &'static str = "plans";
    const FOREIGN_KEYS: &'static [(&'static str, &'static str)] = &[
        ("scenario", "`task`: plans have no scenario"),
        (
            "figures",
            "no figures: `protean reproduce --paper vmc-lp` draws those of the paper",
        ),
    ];

    fn open(
        reader: &mut Reader,
        _: &Path,
        case: Option<(&FieldPath, &Node)>,
        _: &LoadOptions,
    ) -> Option<(String, ())> {
        if let Some((path, _)) = case.filter(|(_, node)| node.get("scenario").is_some()) {
            let path = path.then("scenario");
            let message = "plans have no scenario";
            reader.refuse(&path, Code::Requirement, message, "`set` of the task alone");
        }
        Some(("planning".to_owned(), ()))
    }

    fn case_name(_: &str) -> String {
        "plan".to_owned()
    }

    fn cells(
        reader: &mut Reader,
        cases: &[CaseDraft<()>],
        parameters: &[Parameter],
        combinations: &[Vec<LocatedValue>],
        options: &LoadOptions,
    ) -> Vec<Cell<Self>> {
        cells(reader, cases, (parameters, combinations), &options.set)
    }

    fn carry_out(
        cell: &Cell<Self>,
        seed: u64,
        (): &(),
        call: &Call,
    ) -> Option<MissionResult<PlanRow>> {
        let task = &cell.subject;
        let instance = task.instances.instance(seed.to_string(), seed);
        let answer = solve(&instance, &task.options, 1, &call.interrupted)?;
        Some(MissionResult {
            row: PlanRow::from_answer(&answer, instance.obstacles.len()),
            cpu_ms: answer.cpu_ms,
        })
    }

    fn pinning(_: &Cell<Self>, (): &()) -> Pinning {
        Pinning::Never
    }
}

/// Returns the cells in order; cells with an invalid task are reported and left out.
fn cells(
    reader: &mut Reader,
    cases: &[CaseDraft<()>],
    (parameters, combinations): (&[Parameter], &[Vec<LocatedValue>]),
    on_top: &[String],
) -> Vec<Cell<Task>> {
    let shared = match reader.root.get("task").cloned() {
        Some(node) => assignments::read(reader, &FieldPath::key("task"), &node),
        None => Vec::new(),
    };
    let names: Vec<&str> = parameters.iter().map(|p| p.name.as_str()).collect();
    let mut reported: BTreeSet<String> = BTreeSet::new();
    let mut cells = Vec::new();
    for case in cases {
        for combination in combinations {
            let values: Vec<Value> = combination.iter().map(|w| w.value.clone()).collect();
            let mut all: Vec<Assignment> =
                shared.iter().chain(&case.assignments).cloned().collect();
            for (parameter, written) in parameters.iter().zip(combination) {
                match parameter.assignments(&written.value, &written.node, reader, None) {
                    Ok(found) => all.extend(found),
                    Err(error) => {
                        let message = format!("`{}` is not scaled by a number", parameter.name);
                        let problem = Diagnostic::new(Code::Requirement, message)
                            .field(format!("{}: {}", error.label, error.key))
                            .expected("a number: plans have no scenario with a key to scale by");
                        reader.problems.push(problem);
                    }
                }
            }
            all.extend(on_top.iter().map(|set| Assignment::of_command_line(set)));
            let made = made(&all).map_err(|(label, what)| {
                let cell = describe(&case.case.name, &names, &values);
                (label, what, cell)
            });
            match made {
                Ok(task) => cells.push(Cell {
                    case: case.case.name.clone(),
                    values,
                    target: case.target.clone(),
                    overrides: all.into_iter().map(|a| a.argument).collect(),
                    external: false,
                    blake3: fingerprint(&task),
                    subject: task,
                }),
                // Each problem is reported for the first cell only.
                Err((label, what, cell)) => {
                    if reported.insert(format!("{label}{what}")) {
                        let problem =
                            Diagnostic::new(Code::OutOfRange, format!("{what} (in {cell})"))
                                .field(label)
                                .expected("keys and values of a task: instances and options");
                        reader.problems.push(problem);
                    }
                }
            }
        }
    }
    cells
}

/// Returns the task of these keys.
///
/// # Errors
/// The problem, and its location.
fn made(assignments: &[Assignment]) -> Result<Task, (String, String)> {
    let mut draft = Draft::default();
    for assignment in assignments {
        // A key that does not exist is one problem for all values.
        let at = |error: DraftError| match (&assignment.key_place, error.to_string()) {
            (Some(key), what) if what.starts_with("unknown field") => {
                let label = format!("{}:{}", key.file, key.line);
                (label, format!("`{}`: {what}", assignment.key()))
            }
            (_, what) => {
                let what = format!("`{}`: {what}", assignment.argument);
                (assignment.label.clone(), what)
            }
        };
        draft.apply(&assignment.argument).map_err(&at)?;
        // An unknown key is an error at once; a number may be valid together with later keys.
        draft.task().map_err(&at)?;
    }
    let whole = |error: &dyn Display| ("task".to_owned(), error.to_string());
    let task = draft.task().map_err(|error| whole(&error))?;
    parameters::check(&task).map_err(|error| whole(&error))?;
    Ok(task)
}

fn fingerprint(task: &Task) -> String {
    // A task consists of numbers and names, which can always be serialised.
    let text = serde_json::to_string(task).unwrap_or_default();
    blake3::hash(text.as_bytes()).to_hex().to_string()
}
