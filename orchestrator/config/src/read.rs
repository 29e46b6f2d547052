//! Reader of typed values from nodes, which reports all independent problems.

use serde::de::DeserializeOwned;

use super::deserialize::{NodeReader, ReadError, ReadFault};
use super::diagnostic::{Code, Diagnostic, Diagnostics};
use super::node::{Node, Value};
use super::path::{FieldPath, Step};
use super::source::Sources;
use super::suggest::{list_choices, nearest};

/// Reads a node into a type; stops at the first problem.
///
/// # Errors
/// Place of and reason for the mismatch between node and type.
pub fn read_once<T: DeserializeOwned>(node: &Node) -> Result<T, ReadError> {
    T::deserialize(NodeReader(node))
}

/// Reads a node into a type and reports every independent problem, by removing each invalid value and reading
/// again. `path` is the path of the node.
pub fn read<T: DeserializeOwned>(
    sources: &Sources,
    node: &Node,
    path: &FieldPath,
    problems: &mut Diagnostics,
) -> Option<T> {
    /// Maximum number of problems reported for one node.
    const MAX_TRIES: usize = 16;
    let mut left: Option<Node> = None;
    let mut removed: Vec<FieldPath> = Vec::new();
    // Keys that are missing because of a problem that was already reported, such as a misspelt key.
    let mut explained: Vec<FieldPath> = Vec::new();
    for _ in 0..MAX_TRIES {
        let error = match read_once::<T>(left.as_ref().unwrap_or(node)) {
            Ok(value) => return removed.is_empty().then_some(value),
            Err(error) => error,
        };
        let below = entry_path(&error.path);
        let is_missing = matches!(error.fault, ReadFault::Missing { .. });
        if !(is_missing && explained.contains(&below)) {
            problems.push(describe(sources, &error, path));
        }
        let rest = left.get_or_insert_with(|| node.clone());
        if is_missing || !remove(rest, &below) {
            return None;
        }
        if let ReadFault::UnknownKey { key, known } = &error.fault
            && let Some(near) = nearest(key, known.iter().map(String::as_str))
        {
            let parent = FieldPath(
                below
                    .0
                    .split_last()
                    .map(|p| p.1.to_vec())
                    .unwrap_or_default(),
            );
            explained.push(parent.then(near));
        }
        explained.push(below.clone());
        removed.push(below);
    }
    None
}

/// Returns the path up to its last key: an entry that can be removed without shifting array elements.
fn entry_path(path: &FieldPath) -> FieldPath {
    let end = path
        .0
        .iter()
        .rposition(|s| matches!(s, Step::Key(_)))
        .map_or(0, |i| i + 1);
    FieldPath(path.0.iter().take(end).cloned().collect())
}

fn remove(node: &mut Node, path: &FieldPath) -> bool {
    let Some((Step::Key(last), parents)) = path.0.split_last() else {
        return false;
    };
    let mut node = node;
    for step in parents {
        let next = match (step, &mut node.value) {
            (Step::Key(key), Value::Table(table)) => table.get_mut(key),
            (Step::Index(i) | Step::Named(i, _), Value::Array(list)) => list.get_mut(*i),
            _ => None,
        };
        let Some(next) = next else { return false };
        node = next;
    }
    node.as_table_mut()
        .is_some_and(|t| t.remove(last).is_some())
}

/// Converts a read error to a problem with place, field, value and expectation.
pub fn describe(sources: &Sources, error: &ReadError, base: &FieldPath) -> Diagnostic {
    let field = base.join(&error.path);
    let place = sources.place(error.origin);
    let start = |code, message: String| {
        let problem = Diagnostic::new(code, message)
            .at(place.clone())
            .field(&field);
        match &error.value {
            Some(value) => problem.value(value),
            None => problem,
        }
    };
    match &error.fault {
        ReadFault::UnknownKey { key, known } => suggest(
            start(Code::UnknownKey, format!("unknown key `{key}`")),
            key,
            known,
            "",
        ),
        ReadFault::UnknownChoice { found, known } => suggest(
            start(
                Code::OutOfRange,
                format!("`{found}` is not one of the choices"),
            ),
            found,
            known,
            "",
        ),
        ReadFault::Missing { key } => start(Code::MissingKey, format!("missing key `{key}`")),
        ReadFault::Type { found, expected } => start(
            Code::WrongType,
            format!(
                "wrong type: {}",
                if found.is_empty() {
                    "unreadable"
                } else {
                    found
                }
            ),
        )
        .expected(expected),
        ReadFault::Range { expected } => {
            start(Code::OutOfRange, "value not allowed".to_owned()).expected(expected)
        }
        ReadFault::Other(message) => start(Code::OutOfRange, message.clone()),
    }
}

/// Adds the choices, and suggests the nearest one.
pub fn suggest<S: AsRef<str>>(
    problem: Diagnostic,
    word: &str,
    known: &[S],
    lead: &str,
) -> Diagnostic {
    let problem = problem.expected(format!("{lead}{}", list_choices(known)));
    match nearest(word, known.iter().map(AsRef::as_ref)) {
        Some(near) => problem.help(format!("did you mean `{near}`?")),
        None => problem,
    }
}

/// Creates a problem at a path of a tree, with the place and value there, if they exist.
pub fn problem_at(
    sources: &Sources,
    root: &Node,
    path: &FieldPath,
    code: Code,
    message: impl Into<String>,
) -> Diagnostic {
    let mut problem = Diagnostic::new(code, message)
        .at(sources.place(root.origin_along(path)))
        .field(path);
    let found = root.follow(path);
    let is_leaf = !matches!(found.value, Value::Table(_));
    if is_leaf && !std::ptr::eq(found, root) {
        problem = problem.value(found.render_short());
    }
    problem
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::super::parse::parse_document;
    use super::super::source::SourceKind;
    use super::*;

    #[derive(Debug, Deserialize, PartialEq)]
    #[serde(deny_unknown_fields)]
    struct Limits {
        v_max: f64,
        #[serde(default)]
        count: u8,
    }

    #[derive(Debug, Deserialize, PartialEq)]
    #[serde(tag = "shape", rename_all = "lowercase", deny_unknown_fields)]
    enum Shape {
        Circle { radius: f64 },
    }

    #[derive(Debug, Deserialize, PartialEq)]
    #[serde(rename_all = "lowercase")]
    enum Mode {
        Block,
        Spin,
    }

    #[derive(Debug, Deserialize, PartialEq)]
    #[serde(deny_unknown_fields)]
    struct Thing {
        limits: Option<Limits>,
        mode: Mode,
        at: [f64; 2],
        #[serde(default)]
        shapes: Vec<Shape>,
    }

    fn attempt(text: &str) -> Result<Thing, String> {
        let mut sources = Sources::default();
        let id = sources.add(SourceKind::File, "t.toml", text);
        let mut problems = Diagnostics::default();
        let node = parse_document(&sources, id, &mut problems).expect("valid TOML");
        let thing = read(&sources, &node, &FieldPath::key("thing"), &mut problems);
        match thing {
            Some(thing) if problems.is_empty() => Ok(thing),
            _ => Err(problems.into_result(()).unwrap_err().to_string()),
        }
    }

    #[test]
    fn integers_are_read_as_floats_and_nested_values_are_read() {
        let text = "mode = 'spin'\nat = [1, 2.5]\nlimits.v_max = 3\n[[shapes]]\nshape = 'circle'\nradius = 1";
        assert_eq!(
            attempt(text).unwrap(),
            Thing {
                limits: Some(Limits {
                    v_max: 3.0,
                    count: 0
                }),
                mode: Mode::Spin,
                at: [1.0, 2.5],
                shapes: vec![Shape::Circle { radius: 1.0 }],
            }
        );
    }

    #[test]
    fn several_problems_are_reported_at_once_each_with_its_line() {
        let text = "mode = 'spun'\nat = [1, 'x']\nextra = 1\n[limits]\nv_mx = 3\ncount = 300\n";
        let all = attempt(text).unwrap_err();
        for want in [
            "`spun` is not one of the choices\n --> t.toml:1:8 (thing.mode)",
            "did you mean `spin`?",
            "wrong type: text\n --> t.toml:2:10 (thing.at[1])",
            "expected: a number",
            "unknown key `extra`\n --> t.toml:3:1 (thing.extra)",
            "unknown key `v_mx`\n --> t.toml:5:1 (thing.limits.v_mx)",
            "did you mean `v_max`?",
            "t.toml:6:9 (thing.limits.count)\n  |\n6 | count = 300\n  |         ^^^\n  = value: 300\n  = expected: a whole number from 0 to 255",
        ] {
            assert!(all.contains(want), "missing {want:?} in:\n{all}");
        }
    }

    #[test]
    fn a_missing_key_is_reported_at_its_table() {
        let all = attempt("mode = 'block'\nat = [1, 2]\n[limits]\ncount = 1\n").unwrap_err();
        assert!(all.contains("missing key `v_max`\n --> t.toml:3:"), "{all}");
        assert!(all.contains("(thing.limits.v_max)"), "{all}");
    }

    #[test]
    fn arrays_of_the_wrong_length_and_numbers_that_are_not_finite_are_refused() {
        let all = attempt("mode = 'block'\nat = [1, 2, 3]").unwrap_err();
        assert!(all.contains("an array of 2 values"), "{all}");
        let all = attempt("mode = 'block'\nat = [1]").unwrap_err();
        assert!(all.contains("an array of 2 values"), "{all}");
        let all = attempt("mode = 'block'\nat = [1, nan]").unwrap_err();
        assert!(all.contains("a finite number"), "{all}");
    }

    #[test]
    fn problems_inside_tagged_tables_are_placed_at_least_at_the_table() {
        let text = "mode = 'block'\nat = [1, 2]\n[[shapes]]\nshape = 'circle'\nradus = 1\n";
        let all = attempt(text).unwrap_err();
        assert!(
            all.contains("unknown key `radus`\n --> t.toml:5:1 (thing.shapes[0].radus)"),
            "{all}"
        );
        let text = "mode = 'block'\nat = [1, 2]\n[[shapes]]\nshape = 'circel'\nradius = 1\n";
        let all = attempt(text).unwrap_err();
        assert!(all.contains("did you mean `circle`?"), "{all}");
    }
}
