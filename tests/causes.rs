//! Errors of the file system in the product: a missing file is "no", every other error has its own cause.
//!
//! `Path::exists` and its like answer "no" for any error, and a dropped error of a read does the same. Such places use
//! `platform::presence`, or match the kind of the error.

use std::path::{Path, PathBuf};

/// Calls that take every error for "no".
const PREDICATES: [&str; 3] = [".exists()", ".is_dir()", ".is_file()"];
/// Ends of receivers that are facts of a file already read, not paths.
const FACTS: [&str; 5] = ["facts", "found", "data", ")?", "kind"];
/// Calls whose errors must not be dropped.
const READS: [&str; 8] = [
    "metadata(",
    "canonicalize(",
    "read_dir(",
    "read_link(",
    "fs::read(",
    "read_to_string(",
    "File::open(",
    "read_text(",
];
/// Ends of an expression that drop an error.
const DROPPED: [&str; 7] = [
    ".ok()",
    ".is_ok()",
    ".is_err()",
    ".is_ok_and(",
    ".unwrap_or_default()",
    ".unwrap_or(",
    ".flatten()",
];

/// Places where any error may count as "no": the file, a part of the line, and the reason.
const ALLOWED: &[(&str, &str, &str)] = &[
    (
        "orchestrator/platform/src/machine.rs",
        "read_to_string(\"/proc/cpuinfo\")",
        "a name for people: `unknown processor`",
    ),
    (
        "orchestrator/latency/src/report.rs",
        "read_to_string(\"/proc/loadavg\")",
        "a remark of the report, empty if unknown",
    ),
    (
        "processes/runtime/src/status.rs",
        "read_to_string(\"/proc/self/statm\")",
        "a figure of heartbeats, documented as 0 if unknown",
    ),
    (
        "orchestrator/protean/src/cli/new.rs",
        "fs::read(&path)",
        "the file is then written, which names the cause",
    ),
    (
        "orchestrator/protean/src/cli/new/project.rs",
        "canonicalize(CRATE)",
        "the published version is always right",
    ),
    (
        "orchestrator/sweep/src/planning/subject.rs",
        "read_text(path, MAX_FILE)",
        "loading the experiment names the cause",
    ),
    (
        "orchestrator/platform/src/atomic_file.rs",
        "read_dir(folder)",
        "what cannot be read may have a process, and stays",
    ),
    (
        "orchestrator/platform/src/file_kind.rs",
        "path.metadata()",
        "a help text; the command that reads the file names the cause",
    ),
    (
        "orchestrator/platform/src/file_kind.rs",
        "File::open(path)",
        "a help text; the command that reads the file names the cause",
    ),
];

/// Returns the product code of a file: without comments and the tests at its end.
fn product(text: &str) -> String {
    let code = text.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
    let lines = code.lines().map(|line| match line.trim_start() {
        comment if comment.starts_with("//") => "",
        _ => line,
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// Returns the rest of an expression that begins with a call: up to the end of its chain.
fn chain(rest: &str) -> &str {
    let mut depth = 0_i32;
    for (at, c) in rest.char_indices() {
        match c {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            ';' | ',' | '?' if depth == 0 => return &rest[..at],
            _ => {}
        }
        if depth < 0 {
            return &rest[..at];
        }
    }
    rest
}

/// Returns the chain without what stands in its brackets.
fn outermost(chain: &str) -> String {
    let mut depth = 0_i32;
    let mut text = String::new();
    for c in chain.chars().filter(|c| !c.is_whitespace()) {
        if matches!(c, ')' | ']' | '}') {
            depth -= 1;
        }
        if depth == 0 {
            text.push(c);
        }
        if matches!(c, '(' | '[' | '{') {
            depth += 1;
        }
    }
    text
}

/// Returns the lines (from 1) of a source that take an error for "no", with their texts.
fn findings(source: &str) -> Vec<(usize, String)> {
    let code = product(source);
    let line_of = |at: usize| code[..at].matches('\n').count() + 1;
    let text_of = |line: usize| {
        code.lines()
            .nth(line - 1)
            .unwrap_or_default()
            .trim()
            .to_owned()
    };
    let mut found = Vec::new();
    for predicate in PREDICATES {
        for (at, _) in code.match_indices(predicate) {
            let before = code[..at].trim_end();
            if !FACTS.iter().any(|facts| before.ends_with(facts)) {
                found.push(line_of(at));
            }
        }
    }
    for read in READS {
        for (at, _) in code.match_indices(read) {
            let rest = outermost(chain(&code[at..]));
            let is_dropped = DROPPED.iter().any(|end| {
                let end = end.trim_end_matches(')');
                rest.contains(end)
            });
            let begin = code[..at].rfind('\n').map_or(0, |end| end + 1);
            let is_ignored =
                code[begin..at].contains("let _ =") || code[begin..at].contains("if let Ok");
            if is_dropped || is_ignored {
                found.push(line_of(at));
            }
        }
    }
    found.sort_unstable();
    found.dedup();
    found
        .into_iter()
        .map(|line| (line, text_of(line)))
        .collect()
}

fn sources(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if path.is_dir() {
            if !["target", "tests", "benches", "examples"].contains(&name.as_str()) {
                sources(&path, into);
            }
        } else if path.extension().is_some_and(|end| end == "rs") && name != "tests.rs" {
            into.push(path);
        }
    }
}

#[test]
fn no_error_of_the_file_system_is_taken_for_no() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("..")
        .canonicalize()
        .unwrap();
    let mut files = Vec::new();
    for folder in [
        "algorithms",
        "ipc_types",
        "orchestrator",
        "processes",
        "python",
        "sim_backend",
    ] {
        sources(&root.join(folder), &mut files);
    }
    files.sort();
    assert!(files.len() > 500, "{} files", files.len());
    let (mut faults, mut used) = (Vec::new(), Vec::new());
    for path in files {
        let name = path
            .strip_prefix(&root)
            .unwrap()
            .to_str()
            .unwrap()
            .to_owned();
        for (line, text) in findings(&std::fs::read_to_string(&path).unwrap()) {
            let mut allowed = ALLOWED.iter();
            match allowed.position(|(file, part, _)| *file == name && text.contains(part)) {
                Some(entry) => used.push(entry),
                None => faults.push(format!("{name}:{line}: {text}")),
            }
        }
    }
    assert!(
        faults.is_empty(),
        "an error counts as \"no\" here (platform::presence tells them apart):\n{}",
        faults.join("\n")
    );
    for (entry, (file, part, _)) in ALLOWED.iter().enumerate() {
        assert!(
            used.contains(&entry),
            "take it off the list: {file}: {part}"
        );
    }
}

#[test]
fn each_form_of_a_dropped_error_is_found() {
    for (code, is_found) in [
        ("if path.exists() {", true),
        ("if !path.metadata()?.is_file() {", false),
        ("let is_open = found.is_dir();", false),
        ("roots.filter(|path| path.is_dir())", true),
        ("fs::read_dir(base)?\n    .flatten()\n    .count()", false),
        ("fs::read_dir(base)\n    .flatten()\n    .count()", true),
        ("let there = path.symlink_metadata().is_ok();", true),
        (
            "let text = fs::read_to_string(a(b)).unwrap_or_default();",
            true,
        ),
        ("let text = fs::read_to_string(a.ok()?)?;", false),
        ("if let Ok(text) = fs::read(path) {", true),
        (
            "let text = fs::read(path).map_err(failed)?; let b = c.ok();",
            false,
        ),
        ("// path.exists()", false),
    ] {
        assert_eq!(!findings(code).is_empty(), is_found, "{code}");
    }
}
