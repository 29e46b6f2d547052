//! System calls that fail once, or never return, in any process of a command (`system_calls/inject.c`).

#[path = "system_calls/held.rs"]
mod held;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use rustix::io::Errno;

use crate::support::call::Call;
use crate::support::skipped;

/// A call that fails.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Injection {
    /// Names of the calls that count.
    pub(crate) calls: &'static str,
    /// Number of the call among those of all processes, from 1; 0 for none.
    pub(crate) number: u64,
    /// Error; `None`: the call never returns.
    pub(crate) error: Option<Errno>,
}

/// The program that injects; `None`, and a note on stderr, where it cannot be built or used.
fn injector() -> Option<&'static Path> {
    static PROGRAM: OnceLock<Result<PathBuf, String>> = OnceLock::new();
    let program = PROGRAM.get_or_init(|| {
        let source = concat!(env!("CARGO_MANIFEST_DIR"), "/system_calls/inject.c");
        let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join("inject");
        let run = |command: &mut Command| match command.output() {
            Ok(output) if output.status.success() => Ok(()),
            Ok(output) => Err(String::from_utf8_lossy(&output.stderr).into_owned()),
            Err(error) => Err(format!("{command:?}: {error}")),
        };
        run(Command::new("cc").arg("-o").arg(&program).arg(source))?;
        let none = ["/dev/null", "flock", "0", "0", "true"];
        run(Command::new(&program).args(none))?;
        Ok(program)
    });
    match program {
        Ok(program) => Some(program),
        Err(why) => {
            skipped("system calls that fail", why);
            None
        }
    }
}

/// Returns a command with a call that fails. The file `report` of its sandbox receives the name of the process whose
/// call failed, and the number of calls.
pub(crate) fn injected<'a>(call: Call<'a>, injector: &Path, at: Injection) -> Call<'a> {
    let number = at.number.to_string();
    let error = at.error.map_or(0, Errno::raw_os_error).to_string();
    let words = ["report", at.calls, &number, &error];
    call.through(injector.to_str().unwrap(), &words)
}
