//! New projects: a planner in one language with its mission and a test, the files of a folder of `examples`.

use std::path::{Path, PathBuf};

use platform::shell;

use crate::cli::output;

/// The name that the name of the project replaces.
const NAME: &str = "my_planner";
/// The source of the crate in the example in Rust.
const SOURCE: &str = r#"path = "../../processes/planner""#;
/// The crate beside the source of this program.
const CRATE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../processes/planner");
/// Maximum length of a name (bytes).
const MAX_NAME_BYTES: usize = 64;

/// A kind of project.
#[derive(Debug)]
pub struct Project {
    /// Command that builds the planner in its folder; empty if nothing is to be built.
    build: &'static str,
    /// Paths and texts of the files.
    files: &'static [(&'static str, &'static str)],
}

/// Paths and texts of files of an example.
macro_rules! example {
    ($folder:literal: $($path:literal)+) => {
        &[$(($path, include_str!(concat!("../../../../../examples/", $folder, "/", $path)))),+]
    };
}

/// A planner in Rust.
pub const RUST: Project = Project {
    build: "cargo build --release",
    files: example!("external_planner": "Cargo.toml" "src/main.rs" "src/nearest_free.rs" "tests/mission.rs" "hall.toml"
        "sweep.toml" "README.md" ".gitignore" "tests/hall.toml" ".github/workflows/tests.yml" ".gitlab-ci.yml"
        ".pre-commit-config.yaml"),
};

/// A planner in Python.
pub const PYTHON: Project = Project {
    build: "",
    files: example!("python_planner": "planner.py" "test_planner.py" "hall.toml" "README.md" ".gitignore"
        "tests/hall.toml" ".github/workflows/tests.yml" ".gitlab-ci.yml" ".pre-commit-config.yaml"),
};

/// A planner in C++.
pub const CPP: Project = Project {
    build: "make",
    files: example!("cpp_planner": "planner.cpp" "protean_planner.h" "Makefile" "test.sh" "hall.toml" "README.md"
        ".gitignore" "tests/hall.toml" ".github/workflows/tests.yml" ".gitlab-ci.yml" ".pre-commit-config.yaml"),
};

/// Returns the name of a project in this folder if Cargo and scenarios accept it.
pub fn name(folder: &Path) -> Option<&str> {
    let name = folder.file_name()?.to_str()?;
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    let fits = name.len() <= MAX_NAME_BYTES && name.starts_with(|c: char| c.is_ascii_alphabetic());
    (fits && name.chars().all(is_word)).then_some(name)
}

impl Project {
    /// Returns the files of a project in this folder.
    pub fn files(&self, folder: &Path, name: &str) -> Vec<(PathBuf, String)> {
        let source = match std::fs::canonicalize(CRATE)
            .ok()
            .as_deref()
            .map(Path::to_str)
        {
            Some(Some(path)) => format!("path = {path:?}"),
            _ => format!("version = {:?}", env!("CARGO_PKG_VERSION")),
        };
        let text = |text: &str| text.replace(SOURCE, &source).replace(NAME, name);
        let files = self.files.iter();
        files
            .map(|(path, example)| (folder.join(path), text(example)))
            .collect()
    }

    /// Returns the command line that builds and runs a project in this folder.
    pub fn next(&self, folder: &str) -> String {
        let folder = shell::line(["cd", folder]);
        let build = if self.build.is_empty() {
            String::new()
        } else {
            format!(" && {}", self.build)
        };
        // Without the option, a run asks at the terminal before it starts the planner.
        let run = output::command_line_elsewhere(&["run", "hall.toml", "--allow-external"]);
        format!("{folder}{build} && {run}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_project_is_the_example_with_another_name_and_source() {
        for project in [&RUST, &PYTHON, &CPP] {
            let files = project.files(Path::new("a/zig_zag"), "zig_zag");
            assert_eq!(files.len(), project.files.len());
            for ((path, text), (example, original)) in files.iter().zip(project.files) {
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
    }

    #[test]
    fn the_next_command_builds_what_is_to_be_built() {
        let run = output::command_line_elsewhere(&["run", "hall.toml", "--allow-external"]);
        assert_eq!(CPP.next("a b"), format!("cd 'a b' && make && {run}"));
        assert_eq!(PYTHON.next("a"), format!("cd a && {run}"));
    }

    #[test]
    fn names_are_those_that_cargo_accepts() {
        assert_eq!(name(Path::new("some/where/zig_zag-2")), Some("zig_zag-2"));
        for refused in ["", "..", "2nd", "a b", "ä", "a.toml", "_a"] {
            assert_eq!(name(Path::new(refused)), None, "{refused}");
        }
    }
}
