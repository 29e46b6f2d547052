//! Golden files: names and values that users and their programs rely on, pinned in `tests/goldens/`.
//!
//! `PROTEAN_GOLDENS=write cargo test -p end_to_end goldens::` writes the files anew. The commit that
//! changes one says which contract changed and why.

mod digests;
mod names;

use std::path::PathBuf;

/// Path of a golden file.
fn path(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("goldens")
        .join(name)
}

/// Text of a golden file.
fn golden(name: &str) -> String {
    std::fs::read_to_string(path(name)).unwrap()
}

/// Compares a text with the golden file of this name, or writes the file if `PROTEAN_GOLDENS=write`.
#[track_caller]
pub fn compare(name: &str, now: &str) {
    let path = path(name);
    if std::env::var_os("PROTEAN_GOLDENS").is_some_and(|word| word == "write") {
        std::fs::write(&path, now).unwrap();
        return;
    }
    let golden = golden(name);
    let missing = golden
        .lines()
        .filter(|line| !now.lines().any(|l| l == *line));
    let added = now
        .lines()
        .filter(|line| !golden.lines().any(|l| l == *line));
    let difference: Vec<String> = missing
        .map(|line| format!("- {line}"))
        .chain(added.map(|line| format!("+ {line}")))
        .collect();
    assert!(
        golden == now,
        "tests/goldens/{name} differs (- golden, + now; order counts):\n{}",
        difference.join("\n")
    );
}
