//! Output of commands to the terminal, and their exit codes.

use std::io::Write as _;
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

use mcap_log::{DerivedError, derived};
use mission::MissionError;
use platform::atomic_file::{AtomicFile, Readers};
use platform::terminal::{Colours, is_coloured};
use platform::{eprintln, shell};

/// Exit code of a run that failed.
pub const EXIT_FAILED: u8 = 1;
/// Exit code for wrong usage or input.
pub const EXIT_INVALID: u8 = 2;
/// Exit code for a partial result: an interrupted run, a log with missing messages.
pub const EXIT_PARTIAL: u8 = 3;

/// Returns the exit code of a command whose run ends with this error.
pub fn exit_code_of_mission(error: &MissionError) -> u8 {
    if error.is_refusal() {
        EXIT_INVALID
    } else {
        EXIT_FAILED
    }
}

/// `true` if a result could not be written to stdout.
static RESULT_LOST: AtomicBool = AtomicBool::new(false);

/// Creates an output file that is not made from a log, and its folder.
///
/// # Errors
/// [`DerivedError::Exists`] without `force` if the file exists; [`DerivedError::Create`].
pub fn create(path: &Path, force: bool) -> Result<AtomicFile, DerivedError> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(derived::refused(folder))?;
    }
    derived::create(path, Path::new(""), force, Readers::All)
}

/// Writes the content of such a file.
///
/// # Errors
/// [`DerivedError::Write`].
pub fn write(
    mut file: AtomicFile,
    path: &Path,
    bytes: impl AsRef<[u8]>,
) -> Result<(), DerivedError> {
    file.write_all(bytes.as_ref())
        .and_then(|()| file.commit())
        .map_err(derived::failed(path))
}

/// Returns a command line of this program, which is named as the user named it.
pub fn command_line(words: &[&str]) -> String {
    let program = program();
    shell::line([program.as_str()].into_iter().chain(words.iter().copied()))
}

/// Returns a command line for another folder: a program named by a relative path has its absolute one.
pub fn command_line_elsewhere(words: &[&str]) -> String {
    let program = program();
    let absolute = std::path::absolute(&program)
        .ok()
        .filter(|_| program.contains('/'));
    let program = absolute.map_or(program, |path| path.display().to_string());
    shell::line([program.as_str()].into_iter().chain(words.iter().copied()))
}

fn program() -> String {
    let program = std::env::args().next();
    program.unwrap_or_else(|| "protean".to_owned())
}

/// Writes a line to stdout, with control characters escaped. A closed pipe (`protean list | head`) is not an error.
/// After another error, the exit code [`EXIT_FAILED`] replaces success.
pub fn print(text: &str) {
    print_coloured(text, Colours::default());
}

/// Does the same, with words in these colours if stdout is coloured.
pub fn print_coloured(text: &str, colours: Colours) {
    use std::io::ErrorKind;
    let mut out = std::io::stdout().lock();
    let colours = if is_coloured(&out) {
        colours
    } else {
        Colours::default()
    };
    let written = writeln!(out, "{}", colours.paint(text)).and_then(|()| out.flush());
    if let Err(error) = written
        && error.kind() != ErrorKind::BrokenPipe
        && !RESULT_LOST.swap(true, Ordering::Relaxed)
    {
        eprintln!("error: cannot write the result to stdout: {error}");
    }
}

/// Writes a JSON object to stdout.
pub fn print_json(value: &serde_json::Value) {
    print(&value.to_string());
}

/// Returns the exit code of the program for the exit code of its command.
pub fn exit_code(code: ExitCode) -> ExitCode {
    if RESULT_LOST.load(Ordering::Relaxed) && code == ExitCode::SUCCESS {
        ExitCode::from(EXIT_FAILED)
    } else {
        code
    }
}
