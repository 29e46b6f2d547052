//! A replay takes keys from its terminal, and gives it back however it ends.

use std::io::Write as _;
use std::os::unix::process::ExitStatusExt as _;
use std::process::{Child, Command, ExitStatus, Stdio};

use rustix::process::{Pid, Signal};
use rustix::termios::LocalModes;

use crate::support::terminal::Terminal;
use crate::support::{SOON, Sandbox, until};

/// A replay in the foreground of a terminal; killed if the test ends first.
struct Replay(Child);

impl Replay {
    /// Starts one that waits for keys.
    fn start(sandbox: &Sandbox, terminal: &Terminal) -> Self {
        let child = Command::new("setsid")
            .arg("--ctty")
            .arg(env!("CARGO_BIN_EXE_protean"))
            .args(["replay", "run.mcap", "--paused", "--quiet"])
            .current_dir(sandbox.path())
            .env("XDG_RUNTIME_DIR", sandbox.runtime_dir())
            .stdin(terminal.inside.try_clone().unwrap())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        Self(child)
    }

    fn signal(&self, signal: Signal) {
        // One that has ended is not reaped yet: the number is still its own.
        rustix::process::kill_process(Pid::from_child(&self.0), signal).unwrap();
    }

    fn end(&mut self) -> ExitStatus {
        until("the end of the replay", SOON, || self.0.try_wait().unwrap())
    }
}

impl Drop for Replay {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn the_terminal_is_given_back_however_a_replay_ends() {
    let sandbox = Sandbox::new();
    sandbox.record("chase_exact");
    let terminal = Terminal::open();
    let before = terminal.modes();
    let started = || {
        let replay = Replay::start(&sandbox, &terminal);
        until("keys as they are pressed", SOON, || {
            let (modes, least, _) = terminal.modes();
            let raw = !modes.intersects(LocalModes::ICANON | LocalModes::ECHO) && least == 0;
            raw.then_some(())
        });
        replay
    };
    // By a key, which is handed over without a line's end.
    let mut replay = started();
    let mut keys = std::fs::File::from(terminal.outside.try_clone().unwrap());
    keys.write_all(b"q").unwrap();
    assert_eq!(replay.end().code(), Some(3), "ended before its end");
    assert_eq!(terminal.modes(), before);
    // By what the terminal makes of Ctrl-C.
    let mut replay = started();
    keys.write_all(b"\x03").unwrap();
    assert_eq!(replay.end().code(), Some(3));
    assert_eq!(terminal.modes(), before);
    for (signals, code, by) in [
        (&[Signal::TERM][..], &[3][..], None),
        // The second one ends it at once, if it comes before the first has.
        (&[Signal::INT, Signal::INT], &[3, 130], None),
        (&[Signal::TERM, Signal::TERM], &[3, 143], None),
        (&[Signal::HUP], &[], Some(Signal::HUP)),
        (&[Signal::QUIT], &[], Some(Signal::QUIT)),
    ] {
        let mut replay = started();
        for &signal in signals {
            replay.signal(signal);
        }
        let status = replay.end();
        assert_eq!(
            status.signal(),
            by.map(Signal::as_raw),
            "{signals:?}: {status}"
        );
        let ended = status.code().is_none_or(|found| code.contains(&found));
        assert!(ended, "{signals:?}: {status}");
        assert_eq!(terminal.modes(), before, "{signals:?}");
    }
}
