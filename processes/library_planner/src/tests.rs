//! Libraries in C and C++, compiled and called.

mod calls;
mod files;
pub(crate) mod header;
mod topics;
mod world;

use std::path::{Path, PathBuf};
use std::process::Command;

/// A folder with the header.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("protean_planner.h"), header::planner()).unwrap();
    folder
}

/// Builds a library from a source in C (`.c`) or C++ (`.cpp`); `None`, with a note, without a compiler.
fn build(folder: &Path, name: &str, source: &str) -> Option<PathBuf> {
    let (compiler, standard) = match name.rsplit_once('.') {
        Some((_, "c")) => ("gcc", "-std=c99"),
        _ => ("g++", "-std=c++17"),
    };
    let (file, library) = (folder.join(name), folder.join(format!("{name}.so")));
    std::fs::write(&file, source).unwrap();
    let mut command = Command::new(compiler);
    command.args([
        standard,
        "-Wall",
        "-Wextra",
        "-Wpedantic",
        "-Werror",
        "-fPIC",
        "-shared",
        "-o",
    ]);
    let output = match command.arg(&library).arg(&file).arg("-lm").output() {
        Ok(output) => output,
        Err(error) => {
            eprintln!("SKIPPED: a planner in {name} with {compiler}: {error}");
            return None;
        }
    };
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    Some(library)
}
