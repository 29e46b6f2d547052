//! `[[cases]]`: the methods that are compared.

use config::{Code, FieldPath, Node};

use super::assignments::{self, Assignment};
use super::parts::check_name;
use super::reader::Reader;
use super::spec::CaseSpec;

/// A case: a method that is compared with the others.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Case {
    /// Name in the results.
    pub name: String,
    /// Title.
    pub title: String,
}

/// A case during reading.
pub struct CaseDraft<D> {
    pub case: Case,
    pub target: String,
    pub draft: D,
    pub assignments: Vec<Assignment>,
    pub path: FieldPath,
}

/// Reads the cases; without `[[cases]]` there is one.
///
/// `open` opens the target of a case, given its block, and returns target and draft. `name_of`
/// returns the name of the case of this target in an experiment without `[[cases]]`.
pub fn read_cases<D>(
    reader: &mut Reader,
    open: impl Fn(&mut Reader, Option<(&FieldPath, &Node)>) -> Option<(String, D)>,
    name_of: impl FnOnce(&str) -> String,
) -> Option<Vec<CaseDraft<D>>> {
    let blocks = reader.blocks("cases");
    if reader.root.get("cases").is_none() {
        let (target, draft) = open(reader, None)?;
        let name = name_of(&target);
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
    let mut cases: Vec<CaseDraft<D>> = Vec::new();
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
        let Some((target, draft)) = open(reader, Some((&path, &node))) else {
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
