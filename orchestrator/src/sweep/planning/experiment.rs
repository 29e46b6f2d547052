//! From the file of an experiment of plans to checked cells.

use std::collections::BTreeSet;
use std::path::Path;

use serde::Deserialize;
use serde::de::IgnoredAny;

use super::task::{Draft, Task};
use crate::scenario::files::read_text;
use crate::scenario::text::{Code, Diagnostic, Diagnostics, FieldPath, Node};
use crate::sweep::assignments::{self, Assignment};
use crate::sweep::build::describe;
use crate::sweep::cell::Value;
use crate::sweep::experiment::{Case, Column, LoadOptions, MAX_FILE};
use crate::sweep::grid::{self, Written};
use crate::sweep::manifest::{Kind, Manifest, ManifestCell};
use crate::sweep::parameters::{self, Parameter};
use crate::sweep::parts::{check_name, read_run, read_seeds};
use crate::sweep::reader::Reader;
use crate::sweep::seeds::Seeds;
use crate::sweep::spec::{CaseSpec, MAX_CELLS, MAX_MISSIONS, RunSpec};

/// The top level of the file.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct TopLevel {
    #[serde(rename = "kind")]
    _kind: Kind,
    #[serde(rename = "name")]
    _name: Option<String>,
    title: Option<String>,
    description: Option<String>,
    // Read piece by piece, each with its own path.
    #[serde(rename = "task")]
    _task: Option<IgnoredAny>,
    #[serde(rename = "seeds")]
    _seeds: Option<IgnoredAny>,
    #[serde(rename = "cases")]
    _cases: Option<IgnoredAny>,
    #[serde(rename = "parameters")]
    _parameters: Option<IgnoredAny>,
    #[serde(rename = "grid")]
    _grid: Option<IgnoredAny>,
    #[serde(rename = "run")]
    _run: Option<IgnoredAny>,
}

/// A combination of case and parameters: one task, carried out with every seed.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanCell {
    /// Name of the case.
    pub case: String,
    /// Values of the parameters, in the order of the columns.
    pub values: Vec<Value>,
    /// What its missions do.
    pub task: Task,
    /// What makes it of an empty task, in order.
    pub overrides: Vec<String>,
    /// Fingerprint of the task.
    pub blake3: String,
}

/// An experiment of plans with everything checked.
#[derive(Debug, Clone)]
pub struct PlanExperiment {
    /// Short name: of the directory of its results.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// Some lines for people.
    pub description: String,
    /// The file as it was read.
    pub text: String,
    /// The cases, in the order of the file.
    pub cases: Vec<Case>,
    /// The parameters, in the order of the file.
    pub parameters: Vec<Column>,
    /// Every combination: case by case, the last parameter fastest.
    pub cells: Vec<PlanCell>,
    /// The seeds, the same for every cell.
    pub seeds: Seeds,
    /// How the missions are carried out.
    pub run: RunSpec,
}

/// Whether a file is an experiment of plans. What cannot be read is not; who reads it says why.
pub fn is_planning(path: &Path) -> bool {
    let text = read_text(path, MAX_FILE).ok();
    let reader = text.and_then(|text| Reader::new("", &text).ok());
    let kind = reader.and_then(|r| r.root.get("kind")?.as_str().map(str::to_owned));
    kind.as_deref() == Some("planning")
}

impl PlanExperiment {
    /// Reads an experiment and checks every task that comes of it.
    ///
    /// # Errors
    /// Everything that is wrong, each with file, line, field, value and what was expected.
    pub fn load(path: &Path, options: &LoadOptions) -> Result<Self, Diagnostics> {
        let text = read_text(path, MAX_FILE).map_err(|refused| {
            Diagnostic::new(Code::File, refused.message)
                .value(path.display())
                .expected(format!("the path of an experiment: {}", refused.expected))
        })?;
        let stem = path.file_stem().and_then(|s| s.to_str());
        let mut reader = Reader::new(&path.display().to_string(), &text)?;
        match Self::read(&mut reader, stem.unwrap_or("experiment"), options) {
            Some(experiment) if reader.problems.is_empty() => Ok(Self { text, ..experiment }),
            _ => {
                let unexplained =
                    || Diagnostic::new(Code::Requirement, "the experiment is incomplete");
                reader.problems.push_if_empty(unexplained);
                Err(reader.problems.sorted())
            }
        }
    }

    fn read(reader: &mut Reader, stem: &str, options: &LoadOptions) -> Option<Self> {
        let root = reader.root.clone();
        let top: Option<TopLevel> = reader.read(&root, &FieldPath::default());
        let name = root.get("name").and_then(Node::as_str).unwrap_or(stem);
        check_name(reader, &FieldPath::key("name"), name);
        let parameters = parameters::read(reader);
        let combinations = grid::read(reader, &parameters);
        let seeds = read_seeds(reader, options);
        let run = read_run(reader);
        let shared = match root.get("task") {
            Some(node) => assignments::read(reader, &FieldPath::key("task"), node),
            None => Vec::new(),
        };
        let cases = read_cases(reader);
        let (top, combinations, seeds, run) = (top?, combinations?, seeds?, run?);
        let cases = cases?;
        if !reader.problems.is_empty() {
            return None;
        }
        let count = cases.len().saturating_mul(combinations.len());
        if count > MAX_CELLS || count.saturating_mul(seeds.len()) > MAX_MISSIONS {
            let message = format!("{count} cells times {} seeds are too many", seeds.len());
            let expected = format!("at most {MAX_CELLS} cells and {MAX_MISSIONS} missions");
            reader.refuse(&FieldPath::key("seeds"), Code::Limit, &message, &expected);
            return None;
        }
        let cells = cells(
            reader,
            (&shared, &cases),
            (&parameters, &combinations),
            &options.set,
        );
        let column = |p: Parameter| Column {
            name: p.name,
            title: p.title,
        };
        Some(Self {
            name: name.to_owned(),
            title: top.title.unwrap_or_else(|| name.to_owned()),
            description: top.description.unwrap_or_default().trim().to_owned(),
            text: String::new(),
            cases: cases.into_iter().map(|(case, _)| case).collect(),
            parameters: parameters.into_iter().map(column).collect(),
            cells,
            seeds,
            run,
        })
    }

    /// What the results of this experiment belong to.
    pub fn manifest(&self) -> Manifest {
        let cells = self.cells.iter().map(|cell| ManifestCell {
            case: cell.case.clone(),
            values: cell.values.clone(),
            blake3: cell.blake3.clone(),
            scenario: "planning".to_owned(),
            set: cell.overrides.clone(),
            external: false,
        });
        Manifest::new(
            Kind::Planning,
            (&self.name, &self.title),
            self.parameters.iter().map(|p| p.name.clone()).collect(),
            cells.collect(),
            self.seeds.clone(),
        )
    }
}

/// Reads the cases; without `[[cases]]` there is one.
fn read_cases(reader: &mut Reader) -> Option<Vec<(Case, Vec<Assignment>)>> {
    let blocks = reader.blocks("cases");
    if blocks.is_empty() {
        if reader.root.get("cases").is_some() {
            let expected = "at least one [[cases]] block, or no `cases` at all";
            let path = FieldPath::key("cases");
            reader.refuse(&path, Code::Requirement, "no cases", expected);
            return None;
        }
        let name = "plan".to_owned();
        let title = name.clone();
        return Some(vec![(Case { name, title }, Vec::new())]);
    }
    let mut cases: Vec<(Case, Vec<Assignment>)> = Vec::new();
    for (path, node) in blocks {
        let spec = reader.read::<CaseSpec>(&node, &path)?;
        let at = path.then("name");
        check_name(reader, &at, &spec.name);
        if cases.iter().any(|(case, _)| case.name == spec.name) {
            let message = format!("two cases `{}`", spec.name);
            reader.refuse(&at, Code::Duplicate, &message, "different names");
        }
        if node.get("scenario").is_some() {
            let path = path.then("scenario");
            let message = "plans have no scenario";
            reader.refuse(&path, Code::Requirement, message, "`set` of the task alone");
        }
        let set = match node.get("set") {
            Some(set) => assignments::read(reader, &path.then("set"), set),
            None => Vec::new(),
        };
        let title = spec.title.unwrap_or_else(|| spec.name.replace('_', " "));
        let name = spec.name;
        cases.push((Case { name, title }, set));
    }
    Some(cases)
}

/// The cells in their order; those whose task is wrong are left out, and reported.
fn cells(
    reader: &mut Reader,
    (shared, cases): (&[Assignment], &[(Case, Vec<Assignment>)]),
    (parameters, combinations): (&[Parameter], &[Vec<Written>]),
    on_top: &[String],
) -> Vec<PlanCell> {
    let names: Vec<&str> = parameters.iter().map(|p| p.name.as_str()).collect();
    let mut reported: BTreeSet<String> = BTreeSet::new();
    let mut cells = Vec::new();
    for (case, set) in cases {
        for combination in combinations {
            let values: Vec<Value> = combination.iter().map(|w| w.value.clone()).collect();
            let mut all: Vec<Assignment> = shared.iter().chain(set).cloned().collect();
            for (parameter, written) in parameters.iter().zip(combination) {
                match parameter.assignments(&written.value, &written.node, reader, None) {
                    Ok(found) => all.extend(found),
                    Err(error) => {
                        let message = format!("`{}` is not scaled by a number", parameter.name);
                        let problem = Diagnostic::new(Code::Requirement, message)
                            .field(format!("{}: {}", error.label, error.key))
                            .expected("a number: there is no scenario that could hold one");
                        reader.problems.push(problem);
                    }
                }
            }
            all.extend(on_top.iter().map(|argument| Assignment {
                argument: argument.clone(),
                label: "--set".to_owned(),
            }));
            let made = made(&all).map_err(|(label, what)| {
                let cell = describe(&case.name, &names, &values);
                (label, what, cell)
            });
            match made {
                Ok(task) => cells.push(PlanCell {
                    case: case.name.clone(),
                    values,
                    blake3: fingerprint(&task),
                    task,
                    overrides: all.into_iter().map(|a| a.argument).collect(),
                }),
                // Each problem for the first cell only.
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

/// The task that these keys make; what is wrong, and where.
fn made(assignments: &[Assignment]) -> Result<Task, (String, String)> {
    let mut draft = Draft::default();
    for assignment in assignments {
        let at = |what: String| {
            let what = format!("`{}`: {what}", assignment.argument);
            (assignment.label.clone(), what)
        };
        draft.apply(&assignment.argument).map_err(&at)?;
        // A wrong key is wrong at once; a number may fit what is set later.
        draft.task().map_err(&at)?;
    }
    let whole = |what: String| ("task".to_owned(), what);
    let task = draft.task().map_err(whole)?;
    task.validate().map_err(whole)?;
    Ok(task)
}

fn fingerprint(task: &Task) -> String {
    // A task is numbers and names: it can be written.
    let text = serde_json::to_string(task).unwrap_or_default();
    blake3::hash(text.as_bytes()).to_hex().to_string()
}
