//! `[[cases]]`: what is compared.

use std::path::Path;

use super::assignments::{self, Assignment};
use super::experiment::{Case, LoadOptions};
use super::parts::check_name;
use super::reader::Reader;
use super::spec::CaseSpec;
use crate::scenario::files::{Base, Found};
use crate::scenario::text::{Code, FieldPath, Node, list_choices, nearest};
use crate::scenario::{Draft, Loader, builtin};

/// What marks a built-in scenario.
const BUILTIN: &str = "builtin:";

/// A case as it is read.
pub(super) struct CaseDraft {
    pub case: Case,
    pub target: String,
    pub draft: Draft<'static>,
    pub assignments: Vec<Assignment>,
    pub path: FieldPath,
}

/// Reads the cases with their scenarios; without `[[cases]]` there is one, named by its scenario.
pub(super) fn read_cases(
    reader: &mut Reader,
    folder: &Path,
    options: &LoadOptions,
) -> Option<Vec<CaseDraft>> {
    let shared = reader.root.get("scenario").cloned();
    let blocks = reader.blocks("cases");
    let none_given = reader.root.get("cases").is_none();
    if !none_given && blocks.is_empty() {
        reader.refuse(
            &FieldPath::key("cases"),
            Code::Requirement,
            "no cases",
            "at least one [[cases]] block, or no `cases` at all",
        );
    }
    let mut cases: Vec<CaseDraft> = Vec::new();
    let mut complete = true;
    if none_given {
        let path = FieldPath::key("scenario");
        let (target, draft) = open(reader, folder, &path, shared.as_ref(), options)?;
        let name = stem_of(&target).to_owned();
        cases.push(CaseDraft {
            case: Case {
                title: name.clone(),
                name,
            },
            target,
            draft,
            assignments: Vec::new(),
            path,
        });
    }
    for (path, node) in blocks {
        let Some(spec) = reader.read::<CaseSpec>(&node, &path) else {
            complete = false;
            continue;
        };
        check_name(reader, &path.then("name"), &spec.name);
        if cases.iter().any(|c| c.case.name == spec.name) {
            let message = format!("two cases `{}`", spec.name);
            reader.refuse(
                &path.then("name"),
                Code::Duplicate,
                &message,
                "different names",
            );
        }
        let assignments = match node.get("set") {
            Some(set) => assignments::read(reader, &path.then("set"), set),
            None => Vec::new(),
        };
        let (at, scenario) = match node.get("scenario") {
            Some(own) => (path.then("scenario"), Some(own.clone())),
            None => (FieldPath::key("scenario"), shared.clone()),
        };
        let Some((target, draft)) = open(reader, folder, &at, scenario.as_ref(), options) else {
            complete = false;
            continue;
        };
        cases.push(CaseDraft {
            case: Case {
                title: spec.title.unwrap_or_else(|| spec.name.replace('_', " ")),
                name: spec.name,
            },
            target,
            draft,
            assignments,
            path,
        });
    }
    complete.then_some(cases)
}

fn stem_of(target: &str) -> &str {
    let stem = Path::new(target).file_stem().and_then(|s| s.to_str());
    stem.unwrap_or("scenario")
}

/// Opens a scenario; the result is what `protean run` would take, and its text.
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
                    format!("no scenario `{name}` is built in"),
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
            // With a slash: `protean run` takes a bare name for a built-in scenario first.
            Ok(Found::Disk(_)) => folder.join(text).display().to_string(),
            Ok(Found::Text(_)) => text.to_owned(),
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
    match Loader::default()
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
