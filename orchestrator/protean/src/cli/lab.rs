//! Doors to the Python package `protean_robotics.lab`: this process becomes its interpreter.

use std::ffi::OsString;
use std::io;
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Output, Stdio};

use platform::eprintln;
use platform::presence;

use super::output::EXIT_FAILED;

/// Help of the commands that are such doors.
pub const HELP: &str = "\
The command is part of the Python package: pip install 'protean-robotics[lab]'. It runs with the python3 beside this
program, else with that in PATH.";

/// Test whether an interpreter has the package.
const HAS_PACKAGE: &str =
    "import importlib.util as u, sys; sys.exit(u.find_spec('protean_robotics') is None)";

/// Description of a usable interpreter.
const EXPECTED: &str = "expected a Python with the package: pip install 'protean-robotics[lab]'";

/// The interpreter cannot run a command of the package.
#[derive(Debug, thiserror::Error)]
pub enum LabError {
    #[error(
        "{}: it lacks the package protean_robotics, or is older than 3.11: {EXPECTED}", .0.display()
    )]
    NoPackage(PathBuf),
    #[error("{}: {source}: {EXPECTED}", program.display())]
    Program { program: PathBuf, source: io::Error },
}

impl LabError {
    fn program(source: io::Error) -> Self {
        Self::Program {
            program: interpreter(),
            source,
        }
    }
}

/// Arguments of a command that the package takes as they are.
#[derive(Debug, clap::Args)]
#[command(disable_help_flag = true)]
pub struct LabArgs {
    /// Arguments; --help lists them
    #[arg(
        trailing_var_arg = true,
        allow_hyphen_values = true,
        value_name = "ARGUMENT"
    )]
    arguments: Vec<OsString>,
}

/// Replaces this process by a command of the package; returns only if it cannot.
pub fn execute(command: &str, args: &LabArgs) -> ExitCode {
    let error = match door(command) {
        Ok(mut door) => LabError::program(door.args(&args.arguments).exec()),
        Err(error) => error,
    };
    eprintln!("error: {error}");
    ExitCode::from(EXIT_FAILED)
}

/// Runs a command of the package, which tells its errors itself, and returns its output.
///
/// # Errors
/// The package is missing or cannot be run.
pub fn output(command: &str, arguments: &[OsString]) -> Result<Output, LabError> {
    let mut door = door(command)?;
    let door = door.args(arguments).stderr(Stdio::inherit());
    door.output().map_err(LabError::program)
}

/// Returns the begin of a command of the package.
///
/// # Errors
/// The package is missing.
fn door(command: &str) -> Result<Command, LabError> {
    let program = interpreter();
    // No module of the working directory: -P.
    let has_package = Command::new(&program)
        .args(["-P", "-c", HAS_PACKAGE])
        .stdin(Stdio::null())
        .stderr(Stdio::null())
        .status();
    match has_package {
        Ok(status) if status.success() => {
            let mut door = Command::new(&program);
            door.args(["-P", "-m", "protean_robotics.lab", command]);
            Ok(door)
        }
        Ok(_) => Err(LabError::NoPackage(program)),
        Err(error) => Err(LabError::program(error)),
    }
}

/// Returns the interpreter beside this program, as in a virtual environment, else the name of that in PATH.
fn interpreter() -> PathBuf {
    let name = Path::new("python3");
    let own = std::env::current_exe().ok();
    let beside = own.map(|program| program.with_file_name(name));
    beside
        // One that cannot be looked at is tried: its execution tells the cause.
        .filter(|path| !matches!(presence::entry(path), Ok(None)))
        .unwrap_or_else(|| name.to_owned())
}
