//! `[[cases]]`: what is compared.

use std::path::Path;

use config::{Code, FieldPath};

use super::assignments::{self, Assignment};
use super::experiment::{Case, LoadOptions};
use super::parts::check_name;
use super::reader::Reader;
use super::spec::CaseSpec;
use super::subject::Subject;

/// A case as it is read.
pub(super) struct CaseDraft<D> {
    pub case: Case,
    pub target: String,
    pub draft: D,
    pub assignments: Vec<Assignment>,
    pub path: FieldPath,
}

/// Reads the cases; without `[[cases]]` there is one.
pub(super) fn read_cases<S: Subject>(
    reader: &mut Reader,
    folder: &Path,
    options: &LoadOptions,
) -> Option<Vec<CaseDraft<S::Draft>>> {
    let blocks = reader.blocks("cases");
    if reader.root.get("cases").is_none() {
        let (target, draft) = S::open(reader, folder, None, options)?;
        let name = S::case_name(&target);
        return Some(vec![CaseDraft {
            case: Case {
                title: name.clone(),
                name,
            },
            target,
            draft,
            assignments: Vec::new(),
            path: FieldPath::key("scenario"),
        }]);
    }
    if blocks.is_empty() {
        reader.refuse(
            &FieldPath::key("cases"),
            Code::Requirement,
            "no cases",
            "at least one [[cases]] block, or no `cases` at all",
        );
    }
    let mut cases: Vec<CaseDraft<S::Draft>> = Vec::new();
    let mut complete = true;
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
        let Some((target, draft)) = S::open(reader, folder, Some((&path, &node)), options) else {
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
