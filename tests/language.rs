//! The language of the source tree: the words of `docs/glossary.md`, the first words of doc comments and the form of error
//! texts.

mod glossary;
mod words;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use glossary::Glossary;

/// Paths without findings by definition, each with its reason.
const EXEMPT: &[&str] = &[
    // It lists the words.
    "docs/glossary.md",
    // What was: old names stand in it.
    "CHANGELOG.md",
    // Names of interfaces, and words that a test of this list needs.
    "tests/goldens/",
    "tests/language",
    // Inputs of fuzzing.
    "fuzz/corpus/",
];

/// First words of a doc comment that ask a question instead of describing the item.
const QUESTIONS: &[&str] = &[
    "What", "How", "Whether", "Who", "Whose", "Where", "When", "Which", "Why",
];

/// The name of the rule for first words.
const HEADS: &str = "(question at the head of a doc comment)";

/// Parts of error texts of another form than that of CONTRIBUTING.md.
const FORMS: &[&str] = &[
    "but must be",
    "; expected ",
    "}, expected ",
    "cannot read {",
    "cannot write {",
    "cannot create {",
];

/// The name of the rule for error texts.
const GRAMMAR: &str = "(form of an error text, see CONTRIBUTING.md)";

/// Places of findings by rule.
type Findings = BTreeMap<String, Vec<String>>;

#[test]
fn the_tree_keeps_to_the_glossary() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let glossary = read(&root.join("docs/glossary.md"));
    let findings = search(&root, &Glossary::parse(&glossary).unwrap());

    let mut faults = String::new();
    for (rule, places) in &findings {
        let _ = writeln!(faults, "{rule}: {}", places.join(" "));
    }
    assert!(
        faults.is_empty(),
        "words that docs/glossary.md replaces, or texts of another form:\n{faults}"
    );
}

#[test]
fn a_finding_names_file_line_and_rule() {
    let folder = tempfile::tempdir().unwrap();
    let source = "//! What it is.\n//!\n//! How.\n\n/// Whether `nobody` asks.\nstruct Hub;\n// A Hub.\nfn is_by_hand() {}\n\
                  const MOST_SEATS: u32 = 1;\nlet seat = EyesParams { seat };\n\
                  #[error(\"{x}; expected 1\")]\n#[error(\"{x}: expected 1\")]\n";
    std::fs::write(folder.path().join("a.rs"), source).unwrap();
    std::fs::write(folder.path().join("a.toml"), "seat = 1 # a seat\n").unwrap();
    let table = "| Term | Meaning | Not | Source |\n|---|---|---|---|\n\
                 | a | b | `nobody*`, `Hub`, `by hand`, `MOST_`, `seat`, `seats`, `eyes` | c |\n\n\
                 | Word | In | Reason |\n|---|---|---|\n| `EyesParams` | `a.rs` | d |\n";
    let glossary = Glossary::parse(table).unwrap();
    let found: Vec<(String, String)> = search(folder.path(), &glossary)
        .into_iter()
        .map(|(rule, places)| (rule, places.join(" ")))
        .collect();
    let expected = [
        (HEADS, "a.rs:1 a.rs:5"),
        (GRAMMAR, "a.rs:11"),
        ("MOST_", "a.rs:9"),
        ("Hub", "a.rs:6"),
        ("by hand", "a.rs:8"),
        ("nobody*", "a.rs:5"),
        ("seat", "a.rs:10 a.rs:10 a.toml:1"),
        ("seats", "a.rs:9"),
    ];
    let mut expected = expected.map(|(rule, places)| (rule.to_owned(), places.to_owned()));
    expected.sort();
    assert_eq!(found, expected);
}

/// The findings in all files of a folder.
fn search(root: &Path, glossary: &Glossary) -> Findings {
    let mut findings = Findings::new();
    for path in files(root) {
        let name = path.strip_prefix(root).unwrap().display().to_string();
        if EXEMPT.iter().any(|exempt| name.starts_with(exempt)) {
            continue;
        }
        let kind = path.extension().and_then(|e| e.to_str()).unwrap_or("");
        let content = read(&path);
        let rules = glossary.rules_for(&content);
        let mut in_doc = false;
        for (index, line) in content.lines().enumerate() {
            let place = format!("{name}:{}", index + 1);
            let text = match kind {
                "toml" => line.split_once('#').map_or("", |(_, comment)| comment),
                _ => line,
            };
            for rule in glossary.find(&rules, &name, text) {
                findings
                    .entry(rule.to_owned())
                    .or_default()
                    .push(place.clone());
            }
            let doc = (kind == "rs").then(|| doc_text(line)).flatten();
            if let Some(text) = doc
                && !in_doc
                && QUESTIONS.iter().any(|question| begins_with(text, question))
            {
                findings.entry(HEADS.to_owned()).or_default().push(place);
            }
            if matches!(kind, "rs" | "py") && FORMS.iter().any(|form| line.contains(form)) {
                let places = findings.entry(GRAMMAR.to_owned()).or_default();
                places.push(format!("{name}:{}", index + 1));
            }
            in_doc = doc.is_some();
        }
    }
    findings
}

/// The text of a line of a doc comment.
fn doc_text(line: &str) -> Option<&str> {
    let line = line.trim_start();
    line.strip_prefix("///")
        .or_else(|| line.strip_prefix("//!"))
        .map(str::trim_start)
}

fn begins_with(text: &str, word: &str) -> bool {
    text.strip_prefix(word)
        .is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
}

/// Sources and documents, sorted; no build products and no hidden files.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    entries.sort();
    let mut files = Vec::new();
    for path in entries {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if name.starts_with('.') || name == "target" || name == "node_modules" {
            continue;
        }
        if path.is_dir() {
            files.extend(self::files(&path));
        } else if matches!(
            path.extension().and_then(|e| e.to_str()),
            Some("rs" | "md" | "toml" | "py" | "js")
        ) {
            files.push(path);
        }
    }
    files
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}
