//! The warden of a program that is not ours: it ends as the program did, and takes along whatever the
//! program has started.

use std::io::{BufRead as _, BufReader, Write as _};
use std::os::unix::process::ExitStatusExt as _;
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};

use rustix::process::Signal;

use crate::support::sandbox::{end_sleeping, signal, sleeping};
use crate::support::{SOON, until};

/// A warden with its program; the sleepers of the program end with the test.
struct Warden {
    child: Child,
    /// As the orchestrator holds it.
    stdin: Option<ChildStdin>,
    time: String,
}

impl Warden {
    /// Starts the script, in which `TIME` is a number that nobody else sleeps for.
    fn start(script: &str) -> Self {
        static STARTED: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);
        let number = STARTED.fetch_add(1, std::sync::atomic::Ordering::SeqCst);
        let time = format!("2000.{}{number:02}", std::process::id());
        let mut child = Command::new(env!("CARGO_BIN_EXE_protean"))
            .args(["warden", "--", "sh", "-c", &script.replace("TIME", &time)])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let stdin = child.stdin.take();
        Self { child, stdin, time }
    }

    /// The program's process id.
    fn program(&mut self) -> u32 {
        let mut line = String::new();
        let stdout = self.child.stdout.take().unwrap();
        BufReader::new(stdout).read_line(&mut line).unwrap();
        line.trim()
            .strip_prefix("started ")
            .unwrap()
            .parse()
            .unwrap()
    }

    fn await_sleepers(&self, count: usize) {
        until("the sleepers", SOON, || {
            (sleeping(&self.time) == count).then_some(())
        });
    }

    fn end(&mut self) -> ExitStatus {
        until("the end of the warden", SOON, || {
            self.child.try_wait().unwrap()
        })
    }
}

impl Drop for Warden {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
        end_sleeping(&self.time);
    }
}

/// Three in sessions of their own, two of them without an environment, one of these an orphan.
const SCATTERED: &str =
    "setsid sleep TIME & setsid env -i sleep TIME & (setsid env -i sleep TIME &);";

#[test]
fn it_ends_as_its_program_did() {
    for (script, code, by) in [
        ("exit 0", Some(0), None),
        ("exit 7", Some(7), None),
        ("exit 255", Some(255), None),
        ("kill -TERM $$", None, Some(15)),
        ("kill -KILL $$", None, Some(9)),
        ("kill -SEGV $$", None, Some(11)),
        ("kill -ABRT $$", None, Some(6)),
        // One without a name.
        ("kill -40 $$", None, Some(40)),
    ] {
        let status = Warden::start(script).end();
        assert_eq!((status.code(), status.signal()), (code, by), "{script}");
    }
}

#[test]
fn what_its_program_has_started_ends_before_it() {
    let mut warden = Warden::start(&format!("{SCATTERED} read line; exit 3"));
    warden.await_sleepers(3);
    let mut stdin = warden.stdin.take().unwrap();
    stdin.write_all(b"go\n").unwrap();
    let status = warden.end();
    assert_eq!(sleeping(&warden.time), 0);
    assert_eq!(status.code(), Some(3));
}

#[test]
fn all_of_it_ends_with_its_orchestrator() {
    // The program does not look at its standard input.
    let mut warden = Warden::start(&format!(
        "{SCATTERED} trap '' TERM; while :; do sleep TIME; done"
    ));
    warden.await_sleepers(4);
    drop(warden.stdin.take());
    let status = warden.end();
    assert_eq!(sleeping(&warden.time), 0);
    assert_eq!(status.signal(), Some(9));
}

#[test]
fn it_hands_signals_on_and_its_program_goes_with_it() {
    let mut warden = Warden::start("trap 'exit 5' USR1; sleep TIME & wait");
    warden.await_sleepers(1);
    signal(warden.child.id(), Signal::USR1);
    assert_eq!(warden.end().code(), Some(5));
    assert_eq!(sleeping(&warden.time), 0);

    let mut warden = Warden::start("exec sleep TIME");
    let program = warden.program();
    warden.await_sleepers(1);
    let name = std::fs::read_to_string(format!("/proc/{program}/comm")).unwrap();
    assert_eq!(name.trim(), "sleep", "the number it tells is its program's");
    signal(program, Signal::STOP);
    signal(warden.child.id(), Signal::KILL);
    warden.end();
    warden.await_sleepers(0);
}

#[test]
fn a_program_that_cannot_be_started_is_told_with_its_reason() {
    let mut warden = Command::new(env!("CARGO_BIN_EXE_protean"))
        .args(["warden", "--", "./there-is-no-such-program", "--help"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    BufReader::new(warden.stdout.take().unwrap())
        .read_line(&mut line)
        .unwrap();
    let status = warden.wait().unwrap();
    assert_eq!((line.trim(), status.code()), ("refused 2", Some(127)));
}
