//! System calls that fail once, or never return, in any process of a command: the guarantees hold.
//!
//! `system_calls/inject.c` observes the calls. CI injects into a sample of them; the ignored tests into all, or as many
//! as ten minutes allow (`docs/how-to/faults.md`).

mod held;
mod killed;
mod locks;

use std::cell::Cell;
use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use runtime::lockstep::TickBarrier;
use rustix::io::Errno;
use rustix::process::Signal;

use crate::support::call::{Call, Outcome, PATIENCE};
use crate::support::{SOON, Sandbox, skipped, until, wait_for_tick};

/// Calls that fail.
const CALLS: &str = "openat,flock,write,rename,renameat,renameat2,ftruncate,mmap";
/// Calls of `clean` that fail: also those with which it looks and removes.
const CALLS_OF_CLEAN: &str = "openat,flock,write,mmap,getdents64,statx,unlink,unlinkat,rmdir";
const ERRORS: [Errno; 5] = [
    Errno::MFILE,
    Errno::NOSPC,
    Errno::IO,
    Errno::ACCESS,
    Errno::NOLCK,
];
/// Number of calls of a command that fail in CI, each in an execution of its own.
const SAMPLE: u64 = 16;
/// Maximum duration of an execution: the timeouts of a run end it earlier.
const HANG: Duration = Duration::from_secs(120);

/// A call that fails.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Injection {
    /// Names of the calls that count.
    pub(crate) calls: &'static str,
    /// Number of the call among those of all processes, from 1; 0 for none.
    pub(crate) number: u64,
    /// Its fate.
    pub(crate) fate: Fate,
}

/// The fate of a call.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Fate {
    /// It fails.
    Error(Errno),
    /// It never returns.
    Hang,
    /// The command is killed before it.
    Kill,
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
    let error = match at.fate {
        Fate::Error(error) => error.raw_os_error(),
        Fate::Hang => 0,
        Fate::Kill => -1,
    };
    let error = error.to_string();
    let words = ["report", at.calls, &number, &error];
    call.through(injector.to_str().unwrap(), &words)
}

/// Lets at most `count` calls of a command fail, one per execution: `attempt` executes it with an injection and asserts
/// the guarantees. Executions that wait for a segment of shared memory without a size are counted apart: iceoryx2 0.10
/// lets a process wait for it without limit (`docs/reference/guarantees.md`).
fn inject(
    (name, calls): (&str, &'static str),
    count: u64,
    attempt: impl Fn(&Sandbox, &dyn Fn(Call<'_>) -> Outcome),
) {
    let Some(injector) = injector() else { return };
    let (mut held, mut broken) = (0, Vec::new());
    let mut execute = |number: u64, error: Errno| {
        let sandbox = Sandbox::new();
        let at = Injection {
            calls,
            number,
            fate: Fate::Error(error),
        };
        let hangs = Cell::new(false);
        let call = |call: Call<'_>| {
            let mut running = injected(call, injector, at).start();
            let deadline = Instant::now() + HANG;
            while running.is_alive() {
                if Instant::now() > deadline {
                    // Before its processes are killed: another run may remove the segment then.
                    hangs.set(has_empty_segment(&sandbox));
                    panic!("no end within {HANG:?}");
                }
                std::thread::park_timeout(Duration::from_millis(1));
            }
            running.finish()
        };
        let kept = catch_unwind(AssertUnwindSafe(|| attempt(&sandbox, &call))).is_ok();
        let report = std::fs::read_to_string(sandbox.path().join("report")).unwrap_or_default();
        let is_cleaned = || {
            let clean = sandbox.protean(["clean"]).run();
            clean.code == Some(0) && sandbox.shared_memory().is_empty()
        };
        if !kept && hangs.get() && is_cleaned() {
            held += 1;
        } else if !kept {
            broken.push(format!("call {number}, {error}: {report}"));
        }
        report.lines().last().and_then(|line| line.parse().ok())
    };
    let total: u64 = execute(0, Errno::IO).expect("the number of calls");
    let count = count.min(total);
    for k in 0..count {
        execute(
            1 + k * total / count,
            ERRORS[(k % ERRORS.len() as u64) as usize],
        );
    }
    let violations = broken.len();
    eprintln!("{name}: {count} of {total} calls, {violations} violations, {held} held");
    assert!(broken.is_empty(), "{name}:\n{}", broken.join("\n"));
    assert!(held <= 1 + count / 50, "{name}: {held} of {count} held");
}

/// Returns `true` if processes wait for a segment of size 0.
fn has_empty_segment(sandbox: &Sandbox) -> bool {
    let is_empty = |path: &PathBuf| {
        !path.to_string_lossy().ends_with("_lock")
            && path.metadata().is_ok_and(|facts| facts.len() == 0)
    };
    sandbox.shared_memory().iter().any(is_empty)
}

/// Returns `true` if the loader or the Rust runtime ended the program: before it began, or because a new thread has no
/// memory for its signal stack.
fn is_aborted(outcome: &Outcome) -> bool {
    let is_loader = matches!(outcome.code, Some(127 | 139));
    is_loader || outcome.stderr.contains("alternative stack")
}

/// Asserts that a failure has a message, and that nothing remains.
#[track_caller]
fn assert_explained(sandbox: &Sandbox, outcome: &Outcome) {
    let is_error = matches!(outcome.code, Some(1 | 2)) && outcome.stderr.contains("error: ");
    // The summary of a sweep names the missions that failed, `recover` the missing part.
    let is_result = matches!(outcome.code, Some(0 | 3));
    assert!(is_error || is_result || is_aborted(outcome), "{outcome}");
    // As after `kill -9`; or a directory that the program warns of.
    if is_aborted(outcome) || outcome.stderr.contains("cannot be removed") {
        until("the end of the processes", SOON, || {
            sandbox.processes().is_empty().then_some(())
        });
        let cleaned = sandbox.protean(["clean"]).run();
        assert_eq!(cleaned.code, Some(0), "{outcome}\n{cleaned}");
    }
    sandbox.assert_empty();
}

fn run(count: u64) {
    let words = "run hello --json --quiet --out run.mcap --set rules.time_limit=1";
    let whole = Sandbox::new().protean(words.split(' ')).run().json();
    inject(("run", CALLS), count, |sandbox, call| {
        let outcome = call(sandbox.protean(words.split(' ')));
        assert_explained(sandbox, &outcome);
        if outcome.code == Some(0) {
            assert_eq!(outcome.json()["digest"], whole["digest"]);
        }
        if sandbox.path().join("run.mcap").exists() && !is_aborted(&outcome) {
            let info = sandbox.protean(["info", "run.mcap"]).run();
            let is_cut = outcome.stderr.contains("it stays readable");
            assert_eq!(info.code, Some(if is_cut { 3 } else { 0 }), "{outcome}");
        }
    });
}

/// A run that goes on beside the calls, and the remains of another.
fn clean(count: u64) {
    let living = Sandbox::new();
    // So slow that it does not end by itself, however long the calls take, and leaves the processors to them.
    let words = "run chase --quiet --out run.mcap --pace 1 --set rules.time_limit=40000 \
                 --set teams.evader.limits.v_max=0.01 --set teams.police.limits.v_max=0.01";
    let mut running = living
        .protean(words.split_whitespace())
        .set(PATIENCE)
        .start();
    let run = living.next_run(&BTreeSet::new());
    wait_for_tick(&run, 2);
    let page = TickBarrier::open(&Sandbox::prefix(&run)).unwrap();
    let processes = living.processes();
    let id = std::process::id();
    let remains = living.runtime_dir().join(format!("protean/rA{id}"));
    // Of this run, and of one whose directory is gone.
    let memory = [
        format!("/dev/shm/protean_rA{id}_turn"),
        format!("/dev/shm/protean_rB{id}_turn"),
        format!("/dev/shm/protean_rB{id}_lock"),
    ]
    .map(PathBuf::from);
    inject(("clean", CALLS_OF_CLEAN), count, |sandbox, call| {
        std::fs::create_dir_all(&remains).unwrap();
        std::fs::write(remains.join("lock"), "").unwrap();
        for path in &memory {
            std::fs::write(path, "").unwrap();
        }
        let is_anything_left = || remains.exists() || memory.iter().any(|path| path.exists());
        let before = page.ticks_posted();
        let clean =
            |sandbox| Sandbox::protean(sandbox, ["clean"]).runtime_dir(&living.runtime_dir());
        let outcome = call(clean(sandbox));
        let has_panicked = outcome.stderr.contains("panicked");
        assert!(!has_panicked || is_aborted(&outcome), "{outcome}");
        assert!(outcome.code != Some(0) || !is_anything_left(), "{outcome}");
        let alive = living.processes();
        assert!(processes.iter().all(|process| alive.contains(process)));
        until("another tick", SOON, || {
            (page.ticks_posted() > before).then_some(())
        });
        let again = clean(sandbox).run();
        assert_eq!(again.code, Some(0), "{again}");
        assert!(!is_anything_left(), "{outcome}\n{again}");
    });
    assert!(running.is_alive());
    running.signal(Signal::INT);
    assert_eq!(running.finish().code, Some(3));
    living.assert_nothing_left();
}

fn recover(count: u64) {
    let source = Sandbox::new();
    source.record("chase_exact");
    let log = std::fs::read(source.path().join("run.mcap")).unwrap();
    let cut = &log[..log.len() * 2 / 3];
    source.file("cut.mcap", cut);
    let words = ["recover", "cut.mcap", "--out", "ok.mcap"];
    assert_eq!(source.protean(words).run().code, Some(3));
    let recovered = std::fs::read(source.path().join("ok.mcap")).unwrap();
    inject(("recover", CALLS), count, |sandbox, call| {
        let files = [sandbox.file("cut.mcap", cut), sandbox.file("report", "")];
        let outcome = call(sandbox.protean(words));
        let out = sandbox.path().join("ok.mcap");
        assert_eq!(std::fs::read(&files[0]).unwrap(), cut);
        assert_explained(sandbox, &outcome);
        if out.exists() {
            assert_eq!(outcome.code, Some(3), "{outcome}");
            assert!(std::fs::read(&out).unwrap() == recovered, "{outcome}");
        } else {
            assert_eq!(sandbox.files(), files, "{outcome}");
        }
    });
}

fn resume(count: u64) {
    const EXPERIMENT: &str = "scenario = \"builtin:hello\"\nseeds = { first = 1, count = 2 }\n\
                              [parameters.limit]\nset = \"rules.time_limit\"\n[grid]\nlimit = [0.5]\n";
    let whole = Sandbox::new();
    whole.file("small.toml", EXPERIMENT);
    assert_eq!(whole.sweep_in_order().run().code, Some(0));
    let table = std::fs::read(whole.path().join("out/results.csv")).unwrap();
    inject(("resume", CALLS), count, |sandbox, call| {
        sandbox.file("small.toml", EXPERIMENT);
        let first = sandbox.sweep_in_order().args(["--seeds", "1"]).run();
        assert_eq!(first.code, Some(0), "{first}");
        let outcome = call(sandbox.sweep_in_order());
        assert_explained(sandbox, &outcome);
        let resumed = sandbox.sweep_in_order().arg("--retry-failed").run();
        assert_eq!(resumed.code, Some(0), "{outcome}\n{resumed}");
        let found = std::fs::read(sandbox.path().join("out/results.csv")).unwrap();
        assert!(found == table, "{outcome}\n{resumed}");
        sandbox.assert_empty();
    });
}

#[test]
fn a_run_in_which_a_system_call_fails_keeps_the_guarantees() {
    run(SAMPLE);
}

#[test]
fn a_clean_in_which_a_system_call_fails_spares_living_runs() {
    clean(SAMPLE);
}

#[test]
fn a_recover_in_which_a_system_call_fails_writes_all_or_nothing() {
    recover(SAMPLE);
}

#[test]
fn a_sweep_in_which_a_system_call_fails_is_resumed_to_the_same_table() {
    resume(SAMPLE);
}

#[test]
#[ignore = "ten minutes: docs/how-to/faults.md"]
fn every_call_of_a_run_may_fail() {
    run(u64::MAX);
}

#[test]
#[ignore = "ten minutes: docs/how-to/faults.md"]
fn every_call_of_other_commands_may_fail() {
    clean(u64::MAX);
    recover(u64::MAX);
    resume(200);
}
