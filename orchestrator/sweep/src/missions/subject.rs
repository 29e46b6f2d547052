//! Missions of robots, as the subject of a cell of an experiment.

use std::path::Path;

use config::{Code, FieldPath, Node, list_choices, nearest};

use super::build::build;
use super::mission::Mission;
use crate::cases::CaseDraft;
use crate::cell::Cell;
use crate::engine::{Call, Engine};
use crate::grid::LocatedValue;
use crate::options::LoadOptions;
use crate::parameters::Parameter;
use crate::reader::Reader;
use crate::row::Row;
use crate::subject::{MissionResult, Pinning, Subject};
use scenario::files::{Base, ScenarioFile};
use scenario::{Draft, Loader, builtin};

/// The prefix of a built-in scenario.
const BUILTIN: &str = "builtin:";

impl Subject for Mission {
    type Row = Row;
    type Draft = Draft<'static>;
    type Engine = dyn Engine;
    const UNIT: &'static str = "missions";
    const FOREIGN_KEYS: &'static [(&'static str, &'static str)] =
        &[("task", "`kind = \"planning\"` with it")];

    fn open(
        reader: &mut Reader,
        folder: &Path,
        case: Option<(&FieldPath, &Node)>,
        options: &LoadOptions,
    ) -> Option<(String, Self::Draft)> {
        let own = case.and_then(|(path, node)| {
            let scenario = node.get("scenario")?.clone();
            Some((path.then("scenario"), Some(scenario)))
        });
        let (path, node) = own.unwrap_or_else(|| {
            let shared = reader.root.get("scenario").cloned();
            (FieldPath::key("scenario"), shared)
        });
        open(reader, folder, &path, node.as_ref(), options)
    }

    fn case_name(target: &str) -> String {
        let stem = Path::new(target).file_stem().and_then(|s| s.to_str());
        stem.unwrap_or("scenario").to_owned()
    }

    fn cells(
        reader: &mut Reader,
        cases: &[CaseDraft<Self::Draft>],
        parameters: &[Parameter],
        combinations: &[Vec<LocatedValue>],
        options: &LoadOptions,
    ) -> Vec<Cell<Self>> {
        build(reader, cases, parameters, combinations, options)
    }

    fn carry_out(
        cell: &Cell<Self>,
        seed: u64,
        engine: &Self::Engine,
        call: &Call,
    ) -> Option<MissionResult<Row>> {
        let row = match cell.scenario(seed) {
            Ok(scenario) => match engine.execute(&scenario, call) {
                Ok(report) if report.interrupted => return None,
                Ok(report) => Row::from_report(&report),
                Err(error) => Row::failed(error.to_string()),
            },
            Err(problems) => Row::failed(problems.to_string()),
        };
        Some(MissionResult { row, cpu_ms: None })
    }

    fn pinning(cell: &Cell<Self>, engine: &Self::Engine) -> Pinning {
        match (engine.needs_pinning(), cell.subject.one_core) {
            (false, _) => Pinning::Never,
            (true, false) => Pinning::IfCrowded,
            (true, true) => Pinning::Always,
        }
    }
}

/// Opens a scenario; returns the target as `protean run` takes it, and the text.
fn open(
    reader: &mut Reader,
    folder: &Path,
    path: &FieldPath,
    node: Option<&Node>,
    options: &LoadOptions,
) -> Option<(String, Draft<'static>)> {
    const EXPECTED: &str =
        "the path of a scenario beside the experiment, or a built-in one such as \"builtin:chase\"";
    let Some(node) = node else {
        reader.refuse(path, Code::MissingKey, "missing key `scenario`", EXPECTED);
        return None;
    };
    let Some(text) = node.as_str() else {
        reader.wrong_type(path, node, EXPECTED);
        return None;
    };
    let target = if let Some(name) = text.strip_prefix(BUILTIN) {
        let names = builtin::SCENARIOS.map(|s| s.name);
        if !names.contains(&name) {
            let mut problem = reader
                .problem(
                    path,
                    Code::UnknownName,
                    format!("there is no built-in scenario `{name}`"),
                )
                .expected(list_choices(&names));
            if let Some(near) = nearest(name, names) {
                problem = problem.help(format!("did you mean `{BUILTIN}{near}`?"));
            }
            reader.problems.push(problem);
            return None;
        }
        name.to_owned()
    } else {
        let base = Base::Folder {
            folder: folder.to_owned(),
            allow_outside: options.allow_outside,
        };
        match base.find(text) {
            // With a slash: `protean run` prefers built-in scenarios for bare names.
            Ok(ScenarioFile::Disk(_)) => folder.join(text).display().to_string(),
            Ok(ScenarioFile::Text(_)) => text.to_owned(),
            Err(refused) => {
                let mut problem = reader
                    .problem(path, Code::File, refused.message)
                    .expected(format!("{}: {EXPECTED}", refused.expected));
                if builtin::scenario(text).is_some() {
                    problem = problem.help(format!("did you mean `{BUILTIN}{text}`?"));
                }
                reader.problems.push(problem);
                return None;
            }
        }
    };
    match Loader::new(options.kinds)
        .allow_outside(options.allow_outside)
        .draft(&target)
    {
        Ok(draft) => Some((target, draft)),
        Err(problems) => {
            problems
                .iter()
                .for_each(|p| reader.problems.push(p.clone()));
            None
        }
    }
}
