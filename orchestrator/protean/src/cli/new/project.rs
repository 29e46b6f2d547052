//! A new project: a planner in Rust with its mission, the files of `examples/external_planner`.

use std::path::{Path, PathBuf};

/// The name that the name of the project replaces.
const NAME: &str = "my_planner";
/// The source of the crate in the example.
const SOURCE: &str = r#"path = "../../processes/planner""#;
/// The crate beside the source of this program.
const CRATE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../processes/planner");
/// Maximum length of a name (bytes).
const MAX_NAME_BYTES: usize = 64;

/// Paths and texts of the example.
const FILES: [(&str, &str); 8] = [
    (
        "Cargo.toml",
        include_str!("../../../../../examples/external_planner/Cargo.toml"),
    ),
    (
        "src/main.rs",
        include_str!("../../../../../examples/external_planner/src/main.rs"),
    ),
    (
        "src/nearest_free.rs",
        include_str!("../../../../../examples/external_planner/src/nearest_free.rs"),
    ),
    (
        "tests/mission.rs",
        include_str!("../../../../../examples/external_planner/tests/mission.rs"),
    ),
    (
        "hall.toml",
        include_str!("../../../../../examples/external_planner/hall.toml"),
    ),
    (
        "sweep.toml",
        include_str!("../../../../../examples/external_planner/sweep.toml"),
    ),
    (
        "README.md",
        include_str!("../../../../../examples/external_planner/README.md"),
    ),
    (
        ".gitignore",
        include_str!("../../../../../examples/external_planner/.gitignore"),
    ),
];

/// Returns the name of a project in this folder if Cargo and scenarios accept it.
pub(super) fn name(folder: &Path) -> Option<&str> {
    let name = folder.file_name()?.to_str()?;
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    let fits = name.len() <= MAX_NAME_BYTES && name.starts_with(|c: char| c.is_ascii_alphabetic());
    (fits && name.chars().all(is_word)).then_some(name)
}

/// Returns the files of a project in this folder.
pub(super) fn files(folder: &Path, name: &str) -> Vec<(PathBuf, String)> {
    let source = match std::fs::canonicalize(CRATE)
        .ok()
        .as_deref()
        .map(Path::to_str)
    {
        Some(Some(path)) => format!("path = {path:?}"),
        _ => format!("version = {:?}", env!("CARGO_PKG_VERSION")),
    };
    let text = |text: &str| text.replace(SOURCE, &source).replace(NAME, name);
    FILES
        .map(|(path, example)| (folder.join(path), text(example)))
        .into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_project_is_the_example_with_another_name_and_source() {
        let files = files(Path::new("a/zig_zag"), "zig_zag");
        assert_eq!(files.len(), FILES.len());
        for ((path, text), (example, original)) in files.iter().zip(FILES) {
            assert_eq!(*path, Path::new("a/zig_zag").join(example));
            let differs = |(line, original): &(&str, &str)| line != original;
            for (line, original) in text.lines().zip(original.lines()).filter(differs) {
                let named = original.replace(NAME, "zig_zag");
                assert!(
                    line == named || original.contains(SOURCE),
                    "{example}: {line}"
                );
            }
            assert_eq!(text.lines().count(), original.lines().count());
        }
    }

    #[test]
    fn names_are_those_that_cargo_accepts() {
        assert_eq!(name(Path::new("some/where/zig_zag-2")), Some("zig_zag-2"));
        for refused in ["", "..", "2nd", "a b", "ä", "a.toml", "_a"] {
            assert_eq!(name(Path::new(refused)), None, "{refused}");
        }
    }
}
