//! System calls that fail once, or never return, in any process of a command: the guarantees hold.
//!
//! `system_calls/inject.c` observes the calls. CI injects into a sample of them; the ignored tests into every one
//! (`docs/how-to/faults.md`).

#[path = "system_calls/held.rs"]
mod held;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use runtime::lockstep::TickBarrier;
use rustix::io::Errno;
use rustix::process::Signal;

use crate::support::call::{Call, Outcome, PATIENCE};
use crate::support::{SOON, Sandbox, skipped, until, wait_for_tick};

/// Calls that fail.
const CALLS: &str = "openat,flock,write,rename,renameat,renameat2,ftruncate,mmap";
const ERRORS: [Errno; 4] = [Errno::MFILE, Errno::NOSPC, Errno::IO, Errno::ACCESS];
/// Number of calls of a command that fail in CI, each in an execution of its own.
const SAMPLE: u64 = 24;

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

/// Lets calls of a command fail, one per execution: `attempt` executes it with an injection and asserts the guarantees.
fn inject(
    name: &str,
    sample: Option<u64>,
    attempt: impl Fn(&Sandbox, &dyn Fn(Call<'_>) -> Outcome),
) {
    let Some(injector) = injector() else { return };
    let execute = |number: u64| {
        let error = ERRORS[(number % 4) as usize];
        let sandbox = Sandbox::new();
        let at = Injection {
            calls: CALLS,
            number,
            error: Some(error),
        };
        let call = |call: Call<'_>| injected(call, injector, at).run();
        let held = catch_unwind(AssertUnwindSafe(|| attempt(&sandbox, &call)));
        let report = std::fs::read_to_string(sandbox.path().join("report")).unwrap_or_default();
        let calls = report.lines().last().and_then(|line| line.parse().ok());
        let broken = held
            .is_err()
            .then(|| format!("call {number}, {error}: {report}"));
        (calls.unwrap_or(0), broken)
    };
    let (total, broken) = execute(0);
    assert!(total > 0 && broken.is_none(), "{broken:?}");
    let count = sample.unwrap_or(total).min(total);
    let numbers = (0..count).map(|k| 1 + k * total / count);
    let broken: Vec<String> = numbers.filter_map(|number| execute(number).1).collect();
    skipped(name, &format!("no: {count} of {total} calls failed"));
    assert!(
        broken.is_empty(),
        "{} of {count}:\n{}",
        broken.len(),
        broken.join("\n")
    );
}

/// Returns `true` if the loader or the Rust runtime ended before the program began.
fn fails_to_begin(outcome: &Outcome) -> bool {
    let is_loader = matches!(outcome.code, Some(127 | 139));
    is_loader || outcome.stderr.contains("alternative stack")
}

/// Asserts that a failure has a message, and that nothing remains.
#[track_caller]
fn assert_explained(sandbox: &Sandbox, outcome: &Outcome) {
    let is_error = matches!(outcome.code, Some(1 | 2)) && outcome.stderr.contains("error: ");
    // The summary of a sweep names the missions that failed, `recover` the missing part.
    let is_part = outcome.code == Some(3);
    assert!(is_error || is_part || fails_to_begin(outcome), "{outcome}");
    assert_eq!(sandbox.processes(), []);
    assert_eq!(sandbox.runtime_files(), [] as [PathBuf; 0]);
    assert_eq!(sandbox.shared_memory(), [] as [PathBuf; 0]);
}

fn hello(sandbox: &Sandbox) -> Call<'_> {
    let words = ["run", "hello", "--json", "--quiet", "--out", "run.mcap"];
    sandbox
        .protean(words)
        .set("rules.time_limit=1")
        .set(PATIENCE)
}

fn run() {
    static DIGEST: OnceLock<String> = OnceLock::new();
    let digest = DIGEST.get_or_init(|| hello(&Sandbox::new()).run().json()["digest"].to_string());
    inject("a run", None, |sandbox, call| {
        let outcome = call(hello(sandbox));
        if outcome.code == Some(0) {
            assert_eq!(outcome.json()["digest"].to_string(), *digest);
            sandbox.assert_nothing_left();
        } else {
            assert_explained(sandbox, &outcome);
        }
        if sandbox.path().join("run.mcap").exists() {
            let info = sandbox.protean(["info", "run.mcap"]).run();
            assert_eq!(info.code, Some(0), "{outcome}\n{info}");
        }
    });
}

#[test]
#[ignore = "a run can wait without limit for a segment of size 0: docs/how-to/faults.md"]
fn a_run_in_which_any_system_call_fails_keeps_the_guarantees() {
    run();
}

/// A run that goes on beside the calls, and the remains of another.
fn clean(sample: Option<u64>) {
    let living = Sandbox::new();
    let words = ["run", "chase", "--set", "run.dt=0.0005", "--quiet", "--set"];
    let call = living
        .protean(words)
        .arg(PATIENCE)
        .arg("--out")
        .arg("run.mcap");
    let mut running = call.start();
    let run = living.next_run(&std::collections::BTreeSet::new());
    wait_for_tick(&run, 2);
    let page = TickBarrier::open(&Sandbox::prefix(&run)).unwrap();
    let processes = living.processes();
    let remains = living.runtime_dir().join("protean/rABANDON");
    inject("clean", sample, |sandbox, call| {
        std::fs::create_dir_all(&remains).unwrap();
        std::fs::write(remains.join("lock"), "").unwrap();
        let before = page.ticks_posted();
        let clean =
            |sandbox| Sandbox::protean(sandbox, ["clean"]).runtime_dir(&living.runtime_dir());
        let outcome = call(clean(sandbox));
        let has_panicked = outcome.stderr.contains("panicked");
        assert!(!has_panicked || fails_to_begin(&outcome), "{outcome}");
        assert_eq!(
            living
                .processes()
                .iter()
                .filter(|p| processes.contains(p))
                .count(),
            processes.len()
        );
        until("another tick", SOON, || {
            (page.ticks_posted() > before).then_some(())
        });
        let again = clean(sandbox).run();
        assert_eq!(again.code, Some(0), "{again}");
        assert!(!remains.exists(), "{outcome}\n{again}");
    });
    assert!(running.is_alive());
    running.signal(Signal::INT);
    assert_eq!(running.finish().code, Some(3));
    living.assert_nothing_left();
}

#[test]
fn a_clean_in_which_a_system_call_fails_spares_living_runs() {
    clean(Some(SAMPLE));
}

#[test]
#[ignore = "minutes: docs/how-to/faults.md"]
fn a_clean_in_which_any_system_call_fails_spares_living_runs() {
    clean(None);
}

fn recover(sample: Option<u64>) {
    let source = Sandbox::new();
    source.record("chase_exact");
    let log = std::fs::read(source.path().join("run.mcap")).unwrap();
    let cut = &log[..log.len() * 2 / 3];
    source.file("cut.mcap", cut);
    let words = ["recover", "cut.mcap", "--out", "ok.mcap"];
    assert_eq!(source.protean(words).run().code, Some(3));
    let recovered = std::fs::read(source.path().join("ok.mcap")).unwrap();
    inject("recover", sample, |sandbox, call| {
        let files = [sandbox.file("cut.mcap", cut), sandbox.file("report", "")];
        let outcome = call(sandbox.protean(words));
        let out = sandbox.path().join("ok.mcap");
        assert_eq!(std::fs::read(&files[0]).unwrap(), cut);
        if out.exists() {
            assert_eq!(outcome.code, Some(3), "{outcome}");
            assert!(std::fs::read(&out).unwrap() == recovered, "{outcome}");
        } else {
            assert_explained(sandbox, &outcome);
            assert_eq!(sandbox.files(), files, "{outcome}");
        }
    });
}

#[test]
fn a_recover_in_which_a_system_call_fails_writes_all_or_nothing() {
    recover(Some(SAMPLE));
}

#[test]
#[ignore = "minutes: docs/how-to/faults.md"]
fn a_recover_in_which_any_system_call_fails_writes_all_or_nothing() {
    recover(None);
}

fn resume() {
    const EXPERIMENT: &str = "scenario = \"builtin:hello\"\nseeds = { first = 1, count = 4 }\n\
                              [parameters.limit]\nset = \"rules.time_limit\"\n[grid]\nlimit = [0.5]\n";
    let whole = Sandbox::new();
    whole.file("small.toml", EXPERIMENT);
    let words = [
        "sweep",
        "small.toml",
        "--out",
        "out",
        "--jobs",
        "1",
        "--quiet",
    ];
    assert_eq!(whole.protean(words).run().code, Some(0));
    let table = std::fs::read(whole.path().join("out/results.csv")).unwrap();
    inject("a sweep that is resumed", None, |sandbox, call| {
        sandbox.file("small.toml", EXPERIMENT);
        assert_eq!(
            sandbox.protean(words).args(["--seeds", "1..2"]).run().code,
            Some(0)
        );
        let outcome = call(sandbox.protean(words));
        if outcome.code != Some(0) {
            assert_explained(sandbox, &outcome);
        }
        let resumed = sandbox.protean(words).arg("--retry-failed").run();
        assert_eq!(resumed.code, Some(0), "{outcome}\n{resumed}");
        let found = std::fs::read(sandbox.path().join("out/results.csv")).unwrap();
        assert!(found == table, "{outcome}\n{resumed}");
        sandbox.assert_nothing_left();
    });
}

#[test]
#[ignore = "a run can wait without limit for a segment of size 0: docs/how-to/faults.md"]
fn a_sweep_in_which_any_system_call_fails_is_resumed_to_the_same_table() {
    resume();
}
