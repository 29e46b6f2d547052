//! What commands write to the terminal, and their exit codes.

use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

use config::Diagnostics;
use platform::eprintln;

/// Exit code of a run that failed.
pub const EXIT_FAILED: u8 = 1;
/// Exit code for wrong usage or input.
pub const EXIT_INVALID: u8 = 2;
/// Exit code for a partial result: a run that was interrupted, a log that misses messages.
pub const EXIT_PARTIAL: u8 = 3;

/// Says on stderr why a command is refused; a scenario's problems are texts of their own.
pub(super) fn complain(error: &(dyn std::error::Error + 'static)) {
    if let Some(problems) = error.downcast_ref::<Diagnostics>() {
        eprintln!("{problems}");
    } else {
        eprintln!("error: {error}");
    }
}

/// Whether a result could not be written to stdout.
static RESULT_LOST: AtomicBool = AtomicBool::new(false);

/// Writes a line to stdout, of text that cannot steer a terminal; a reader that went away
/// (`protean list | head`) is no error. Anything else is told, and the program ends with [`EXIT_FAILED`] if it
/// would have ended well.
pub(super) fn print(text: &str) {
    use std::io::{ErrorKind, Write as _};
    let mut out = std::io::stdout().lock();
    let written =
        writeln!(out, "{}", platform::terminal::harmless(text)).and_then(|()| out.flush());
    if let Err(error) = written
        && error.kind() != ErrorKind::BrokenPipe
        && !RESULT_LOST.swap(true, Ordering::Relaxed)
    {
        eprintln!("error: cannot write the result to stdout: {error}");
    }
}

/// Writes a JSON object to stdout.
pub(super) fn print_json(value: &serde_json::Value) {
    print(&value.to_string());
}

/// The exit code of a command that ended with this one.
pub(super) fn exit_code(code: ExitCode) -> ExitCode {
    if RESULT_LOST.load(Ordering::Relaxed) && code == ExitCode::SUCCESS {
        ExitCode::from(EXIT_FAILED)
    } else {
        code
    }
}
