//! The C header of the messages, compiled: its assertions compare sizes and offsets with those of Rust.

use std::path::Path;
use std::process::Command;

use ipc_types::c_header;

/// Compiles a file that includes the header; `None` without this compiler.
fn compile(folder: &Path, compiler: &str, standard: &str, end: &str) -> Option<Result<(), String>> {
    let source = folder.join(format!("main.{end}"));
    let text = "#include \"messages.h\"\nint main(void) { return sizeof(protean_stamp) == 0; }\n";
    std::fs::write(&source, text).unwrap();
    let mut command = Command::new(compiler);
    command.args(["-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only"]);
    let output = match command.arg(standard).arg(&source).output() {
        Ok(output) => output,
        Err(error) => {
            eprintln!("SKIPPED: the C header with {compiler}: {error}");
            return None;
        }
    };
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    Some(output.status.success().then_some(()).ok_or(errors))
}

#[test]
fn c_and_cpp_have_the_layouts_of_rust() {
    let folder = tempfile::tempdir().unwrap();
    let header = folder.path().join("messages.h");
    for (compiler, standard, end) in [("gcc", "-std=c99", "c"), ("g++", "-std=c++17", "cpp")] {
        std::fs::write(&header, c_header::messages()).unwrap();
        let Some(compiled) = compile(folder.path(), compiler, standard, end) else {
            continue;
        };
        compiled.unwrap();
        // The assertions do assert.
        let wrong = c_header::messages().replacen(
            "offsetof(protean_command, omega) == 8",
            "offsetof(protean_command, omega) == 4",
            1,
        );
        std::fs::write(&header, wrong).unwrap();
        let errors = compile(folder.path(), compiler, standard, end)
            .unwrap()
            .unwrap_err();
        assert!(errors.contains("protean_command_at_omega"), "{errors}");
    }
}
