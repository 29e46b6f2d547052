//! The Python package: its wheel is built, installed in a virtual environment and tested there.
//!
//! Tests run in the order of their names, two at once: these take minutes, and leave a core idle if they come last.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

use crate::support::{PROTEAN, Sandbox, python, skipped};

/// The interpreter of the environment with the wheel, or why there is none.
pub static PYTHON: LazyLock<Result<PathBuf, String>> = LazyLock::new(|| {
    let python = python::prepare(python::PACKAGES)?;
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let wheels = tempfile::tempdir().unwrap();
    // As `tools/wheel`, but with the profile of the tests and the program under test.
    let scripts = root.join("target/protean-robotics.data/scripts");
    std::fs::create_dir_all(&scripts).unwrap();
    let program = scripts.join("protean");
    done(Command::new("strip").arg(PROTEAN).arg("-o").arg(program));
    let folder = Path::new(PROTEAN).parent().unwrap();
    let profile = match folder.file_name().unwrap().to_str().unwrap() {
        "debug" => "dev",
        name => name,
    };
    let maturin = python.with_file_name("maturin");
    done(
        Command::new(maturin)
            .args(["build", "--locked", "--profile", profile])
            .args(["--compatibility", "linux", "--out"])
            .arg(wheels.path())
            .current_dir(root.join("python"))
            .env("CARGO_TARGET_DIR", folder.parent().unwrap()),
    );
    let wheel = std::fs::read_dir(wheels.path()).unwrap().next().unwrap();
    done(
        Command::new("python3")
            .args(["-m", "pip", "--python"])
            .arg(&python)
            .args(["install", "--quiet", "--no-deps", "--force-reinstall"])
            .arg(wheel.unwrap().path()),
    );
    Ok(python)
});

/// Runs a command that succeeds.
fn done(command: &mut Command) -> Output {
    let output = command.output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(
        output.status.success(),
        "{command:?}\n{}{}",
        text(&output.stdout),
        text(&output.stderr)
    );
    output
}

/// Runs a module of Python in the environment, in a folder of its own; without one it is skipped with a note.
fn module(arguments: &[&str]) {
    let python = match &*PYTHON {
        Ok(python) => python,
        Err(reason) => {
            skipped(&format!("python3 -m {}", arguments.join(" ")), reason);
            return;
        }
    };
    let sandbox = Sandbox::new();
    let path = std::env::var("PATH").unwrap_or_default();
    let scripts = python.parent().unwrap().display();
    done(
        Command::new(python)
            .arg("-m")
            .args(arguments)
            .current_dir(sandbox.path())
            .env("PATH", format!("{scripts}:{path}"))
            .env("XDG_RUNTIME_DIR", sandbox.runtime_dir())
            // Workers that tests kill leave scratch directories.
            .env("TMPDIR", sandbox.path())
            .env("PYTHONDONTWRITEBYTECODE", "1"),
    );
}

/// Longer than 10 s: it builds a wheel, and the tests start many processes.
#[test]
fn the_tests_of_the_python_package_pass_with_its_wheel() {
    let tests = concat!(env!("CARGO_MANIFEST_DIR"), "/../python/tests");
    let options = ["-q", "-p", "no:cacheprovider", "--import-mode=importlib"];
    module(&[&["pytest"], &options[..], &[tests]].concat());
}

#[test]
fn the_types_of_the_python_package_are_complete() {
    let known = concat!(env!("CARGO_MANIFEST_DIR"), "/../python/tests/stubtest.txt");
    let stubtest = [
        "mypy.stubtest",
        "--ignore-disjoint-bases",
        "--allowlist",
        known,
    ];
    module(&[&stubtest[..], &["protean_robotics"]].concat());
    module(&[
        "pyright",
        "--verifytypes",
        "protean_robotics",
        "--ignoreexternal",
    ]);
}
