//! Commands that are killed at a system call: `clean`, or the next command at the latest, removes what is left.

use std::path::Path;

use super::{Fate, Injection, injected, injector};
use crate::support::call::Call;
use crate::support::{SOON, Sandbox, until};

/// Calls at which a command is killed in a sample of their executions.
const SAMPLED: &str = "openat,write,mmap";
/// Number of these executions.
const SAMPLE: u64 = 2;
/// Calls at which it is killed in all of their first executions: those that name and remove files.
const NAMING: &str = "linkat,rename,renameat,renameat2,unlink,unlinkat,rmdir";
/// Number of these executions.
const NAMINGS: u64 = 3;

const EXPERIMENT: &str = "scenario = \"builtin:hello\"\nseeds = { first = 1, count = 2 }\n";

/// Commands that write files. The second time their results exist.
const COMMANDS: [&str; 6] = [
    "verify run.mcap",
    "export run.mcap --out out --force",
    "report run.mcap --out out.html --force",
    "recover run.mcap --out out.mcap --force",
    "sweep small.toml --in-process --jobs 1 --set rules.time_limit=0.2 --out out",
    "latency run.mcap --json",
];

fn call<'a>(sandbox: &'a Sandbox, words: &'a str) -> Call<'a> {
    // Relative to the working directory, which is the sandbox.
    let call = sandbox.protean(words.split(' '));
    call.through("env", &["TMPDIR=tmp"])
}

fn is_empty(folder: &Path) -> bool {
    std::fs::read_dir(folder).unwrap().next().is_none()
}

#[test]
fn what_a_killed_command_leaves_is_removed() {
    let Some(injector) = injector() else { return };
    let source = Sandbox::new();
    source.record("hello");
    let log = std::fs::read(source.path().join("run.mcap")).unwrap();
    let mut broken = Vec::new();
    for words in COMMANDS {
        let mut kill = |calls: &'static str, number: u64| -> u64 {
            let sandbox = Sandbox::new();
            sandbox.file("run.mcap", &log);
            sandbox.file("small.toml", EXPERIMENT);
            sandbox.file("report", "");
            std::fs::create_dir(sandbox.path().join("tmp")).unwrap();
            let undisturbed = call(&sandbox, words).run();
            assert_eq!(undisturbed.code, Some(0), "{undisturbed}");
            let expected = sandbox.files();
            let fate = Fate::Kill;
            let at = Injection {
                calls,
                number,
                fate,
            };
            let killed = injected(call(&sandbox, words), injector, at).run();
            until("the end of the processes", SOON, || {
                sandbox.processes().is_empty().then_some(())
            });
            let report = std::fs::read_to_string(sandbox.path().join("report")).unwrap();
            let total = report.lines().last().and_then(|line| line.parse().ok());
            if number > 0 {
                assert_eq!(killed.code, Some(137), "{words}: {report} {killed}");
            }
            let cleaned = call(&sandbox, "clean").run();
            assert_eq!(cleaned.code, Some(0), "{words}: {cleaned}");
            let is_clean = is_empty(&sandbox.path().join("tmp"));
            sandbox.assert_empty();
            let again = call(&sandbox, words).run();
            let files = sandbox.files();
            if !is_clean || again.code != Some(0) || files != expected {
                broken.push(format!("{words}: {calls} {number}: {files:?}\n{again}"));
            }
            total.unwrap_or(0)
        };
        for (calls, count) in [(SAMPLED, SAMPLE), (NAMING, NAMINGS)] {
            let total = kill(calls, 0);
            let count = count.min(total);
            for k in 0..count {
                kill(calls, 1 + k * total / count);
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}
