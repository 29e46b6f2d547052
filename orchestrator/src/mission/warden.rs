//! Stands between the orchestrator and a program of the user's, which knows nothing of runs: when the
//! program ends, or the orchestrator is gone, everything that the program has started ends too.
//!
//! A program may start others, leave its process group and its session, and forget its environment.
//! What it cannot do is leave its *warden*: a process of ours that is its parent and, being a "child
//! subreaper", becomes the parent of whoever loses its own. So what is below the warden is all that
//! the program has ever started; the warden kills its children until it has none. (Only children, a
//! generation at a time: the number of a child is not used again before its parent has looked.)
//!
//! The orchestrator signals the program itself, whose number the warden writes to stdout, and the
//! warden ends as its program did: by the same exit code or the same signal. If somebody kills the
//! warden, its program goes with it, and [`super::leftovers`] is left to find the rest.

use std::ffi::OsString;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::os::fd::{AsFd as _, BorrowedFd, OwnedFd};
use std::os::unix::net::UnixStream;
use std::os::unix::process::{CommandExt as _, ExitStatusExt as _};
use std::process::{ChildStdout, Command, ExitCode, ExitStatus, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags};
use rustix::io::retry_on_intr;
use rustix::process::{Pid, PidfdFlags, Signal, WaitId, WaitIdOptions};
use rustix::thread::Timespec;
use signal_hook::consts::SIGCHLD;
use signal_hook::low_level;

use crate::descriptors;

/// What wardens are called by `ps`, before the names of their programs.
pub const TITLE: &str = "protean:warden:";

/// Exit code of a warden whose program could not be started, or that cannot guard it.
const EXIT_NOT_STARTED: u8 = 127;
/// Time for what was killed to be gone. What the system does not end by then (a process of another
/// user, one in the middle of a broken device) is not waited for.
const GONE_WITHIN: Duration = Duration::from_secs(4);
/// How often it is looked whether what was killed is gone: nobody tells of children of children.
const LOOK: Timespec = Timespec {
    tv_sec: 0,
    tv_nsec: 5_000_000,
};
/// Time for a warden to start its program.
const START_WITHIN: Timespec = Timespec {
    tv_sec: 20,
    tv_nsec: 0,
};
/// Signals that are handed on to the program.
const HANDED_ON: [Signal; 6] = [
    Signal::TERM,
    Signal::INT,
    Signal::HUP,
    Signal::QUIT,
    Signal::USR1,
    Signal::USR2,
];

/// The program of a warden, as the orchestrator sees it.
#[derive(Debug)]
pub(super) struct Ward {
    /// Its process id.
    pub(super) pid: u32,
    /// `None` if it ended so soon that it was gone already: its warden then ends as it did.
    pidfd: Option<OwnedFd>,
}

impl Ward {
    /// Sends it a signal; one that has ended hears nothing.
    pub(super) fn signal(&self, signal: Signal) {
        if let Some(pidfd) = &self.pidfd {
            let _ = rustix::process::pidfd_send_signal(pidfd, signal);
        }
    }
}

/// Waits until a warden has started its program.
///
/// # Errors
/// What the system said to the program's start, or that the warden said nothing.
pub(super) fn await_ward(warden: &OwnedFd, stdout: ChildStdout) -> std::io::Result<Ward> {
    let mut ready = [PollFd::new(&stdout, PollFlags::IN)];
    // A signal (Ctrl-C, say) that is taken meanwhile is for others to heed.
    let is_ready = || rustix::event::poll(&mut ready, Some(&START_WITHIN));
    if retry_on_intr(is_ready)? == 0 {
        return Err(std::io::ErrorKind::TimedOut.into());
    }
    let mut line = String::new();
    BufReader::new(stdout.take(64)).read_line(&mut line)?;
    let said = match line.trim().split_once(' ') {
        Some((word, number)) => number.parse().ok().map(|number| (word, number)),
        None => None,
    };
    match said {
        Some(("started", pid)) => {
            let id = Pid::from_raw(pid).ok_or(std::io::ErrorKind::InvalidData)?;
            let pidfd = match rustix::process::pidfd_open(id, PidfdFlags::empty()) {
                Err(rustix::io::Errno::SRCH) => None,
                opened => Some(opened?),
            };
            // As long as the warden is there the number is its program's: it keeps that, dead or alive.
            let mut ended = [PollFd::new(warden, PollFlags::IN)];
            let has_ended = || rustix::event::poll(&mut ended, Some(&Timespec::default()));
            let is_over = retry_on_intr(has_ended)? > 0;
            Ok(Ward {
                pid: pid.unsigned_abs(),
                pidfd: pidfd.filter(|_| !is_over),
            })
        }
        Some(("refused", number)) if number > 0 => Err(std::io::Error::from_raw_os_error(number)),
        _ => Err(std::io::Error::other("its warden ended")),
    }
}

/// Is the warden of a program, until that has ended and everything below it.
pub fn run(words: &[OsString]) -> ExitCode {
    match guard(words) {
        Ok(status) => end_as(status),
        Err(error) => {
            say("refused", error.raw_os_error().unwrap_or(0));
            ExitCode::from(EXIT_NOT_STARTED)
        }
    }
}

/// Tells the orchestrator, if that still listens.
fn say(word: &str, number: i32) {
    let _ = writeln!(std::io::stdout(), "{word} {number}").and_then(|()| std::io::stdout().flush());
}

fn guard(words: &[OsString]) -> std::io::Result<ExitStatus> {
    rustix::process::set_child_subreaper(Some(rustix::process::getpid()))?;
    // A warden that is stopped cannot see that its orchestrator is gone: this wakes it.
    rustix::process::set_parent_process_death_signal(Some(Signal::CONT))?;
    let mut signals = Signals::catch()?;
    let (program, arguments) = words
        .split_first()
        .ok_or(std::io::ErrorKind::InvalidInput)?;
    let mut command = Command::new(program);
    // It inherits standard input, whose end tells it too that the orchestrator is gone, and stderr.
    command
        .args(arguments)
        .stdout(Stdio::null())
        .process_group(0);
    die_with_this_thread(&mut command);
    descriptors::leave_behind(&mut command);
    let mut child = command.spawn()?;
    let pid = Pid::from_child(&child);
    say("started", pid.as_raw_nonzero().get());
    let pidfd = rustix::process::pidfd_open(pid, PidfdFlags::empty());
    if let Ok(pidfd) = &pidfd {
        signals.attend(pid, pidfd);
    }
    end_children(pid);
    pidfd?;
    child.wait()
}

/// The signals that a warden gets.
struct Signals {
    wake: UnixStream,
    came: Vec<(Signal, Arc<AtomicBool>)>,
}

impl Signals {
    fn catch() -> std::io::Result<Self> {
        let (wake, waker) = UnixStream::pair()?;
        wake.set_nonblocking(true)?;
        let mut came = Vec::new();
        for signal in HANDED_ON {
            let flag = Arc::new(AtomicBool::new(false));
            // Before the waker: whoever is woken finds it set.
            signal_hook::flag::register(signal.as_raw(), Arc::clone(&flag))?;
            low_level::pipe::register(signal.as_raw(), waker.try_clone()?)?;
            came.push((signal, flag));
        }
        low_level::pipe::register(SIGCHLD, waker)?;
        Ok(Self { wake, came })
    }

    /// Hands signals on and reaps orphans until the program has ended or the orchestrator is gone.
    fn attend(&mut self, program: Pid, pidfd: &OwnedFd) {
        let stdin = std::io::stdin();
        loop {
            // Woken by whatever it was: everything is looked at. The end of a pipe is always told.
            let gone = is_at_end(stdin.as_fd(), &self.wake);
            let mut sink = [0_u8; 64];
            while matches!(self.wake.read(&mut sink), Ok(read) if read > 0) {}
            for (signal, came) in &self.came {
                if came.swap(false, Ordering::SeqCst) {
                    let _ = rustix::process::pidfd_send_signal(pidfd, *signal);
                }
            }
            let ended = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
            let is_over = rustix::process::waitid(WaitId::PidFd(pidfd.as_fd()), ended)
                .map_or(true, |status| status.is_some());
            if gone || is_over {
                return;
            }
            for (child, state) in children() {
                if state == 'Z' && child != program {
                    reap(child);
                }
            }
        }
    }
}

/// Sleeps until a signal comes or nobody holds the other end of standard input; whether that is so.
fn is_at_end(stdin: BorrowedFd<'_>, wake: &UnixStream) -> bool {
    let mut fds = [
        PollFd::from_borrowed_fd(stdin, PollFlags::empty()),
        PollFd::new(wake, PollFlags::IN),
    ];
    // Interrupted by a signal: the waker has it.
    let _ = rustix::event::poll(&mut fds, None);
    let [stdin, _] = &fds;
    stdin
        .revents()
        .intersects(PollFlags::HUP | PollFlags::ERR | PollFlags::NVAL)
}

/// Kills children until none lives; those of whoever was killed are children then. The program is
/// not reaped: its number must stay its own.
fn end_children(program: Pid) {
    let deadline = Instant::now() + GONE_WITHIN;
    loop {
        let mut children = children();
        children.retain(|&child| child != (program, 'Z'));
        if children.is_empty() || Instant::now() >= deadline {
            return;
        }
        for (child, _) in children {
            let _ = rustix::process::kill_process(child, Signal::KILL);
            if child != program {
                reap(child);
            }
        }
        let _ = rustix::thread::nanosleep(&LOOK);
    }
}

fn reap(child: Pid) {
    let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG;
    let _ = rustix::process::waitid(WaitId::Pid(child), options);
}

/// The children of this process and their states, `'Z'` if they have ended.
fn children() -> Vec<(Pid, char)> {
    let this = rustix::process::getpid().as_raw_nonzero().get();
    let processes = procfs::process::all_processes().into_iter().flatten();
    processes
        // Whatever cannot be read has ended, and was not ours to reap.
        .filter_map(|process| process.ok()?.stat().ok())
        .filter(|stat| stat.ppid == this)
        .filter_map(|stat| Some((Pid::from_raw(stat.pid)?, stat.state)))
        .collect()
}

/// Ends as the program did.
fn end_as(status: ExitStatus) -> ExitCode {
    if let Some(signal) = status.signal() {
        // Whether the program has left an image of its memory is its own business; ours would be of
        // no use.
        let none = rustix::process::Rlimit {
            current: Some(0),
            maximum: Some(0),
        };
        let _ = rustix::process::setrlimit(rustix::process::Resource::Core, none);
        if low_level::signal_name(signal).is_some() {
            let _ = low_level::emulate_default_handler(signal);
        }
        // One without a name (or that ends nobody by default) is not caught here either.
        let _ = low_level::raise(signal);
        return ExitCode::from(128_u8.saturating_add(u8::try_from(signal).unwrap_or(127)));
    }
    status
        .code()
        .and_then(|code| u8::try_from(code).ok())
        .map_or(ExitCode::FAILURE, ExitCode::from)
}

/// Has a program that knows nothing of us killed when the thread that starts it ends, however that
/// goes, and also if the program is stopped.
#[expect(unsafe_code, reason = "the child must be told between fork and exec")]
fn die_with_this_thread(command: &mut Command) {
    let parent = rustix::process::getpid();
    let ask = move || {
        rustix::process::set_parent_process_death_signal(Some(Signal::KILL))?;
        // Gone before it was asked for.
        if rustix::process::getppid() == Some(parent) {
            Ok(())
        } else {
            Err(std::io::Error::from(std::io::ErrorKind::BrokenPipe))
        }
    };
    // SAFETY: between fork and exec only two system calls are made, which are safe after a fork of
    // a program with threads: no lock is taken and no memory allocated (an error without a text
    // needs none).
    unsafe {
        command.pre_exec(ask);
    }
}

#[cfg(test)]
mod tests {
    use signal_hook::consts::SIGWINCH;

    use super::*;

    #[test]
    fn a_program_that_has_long_ended_was_started_all_the_same() {
        let mut program = Command::new("true").spawn().unwrap();
        let pid = program.id();
        program.wait().unwrap();
        // A warden that has ended too, once it is looked at.
        let mut warden = Command::new("echo")
            .args(["started", &pid.to_string()])
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let pidfd = rustix::process::pidfd_open(Pid::from_child(&warden), PidfdFlags::empty());
        let stdout = warden.stdout.take().unwrap();
        warden.wait().unwrap();
        let ward = await_ward(&pidfd.unwrap(), stdout).unwrap();
        assert_eq!(ward.pid, pid);
        assert!(ward.pidfd.is_none());
        // Whoever has its number now hears nothing.
        ward.signal(Signal::KILL);
    }

    #[test]
    #[expect(
        unsafe_code,
        reason = "a signal for this thread and no other of the tests'"
    )]
    fn a_signal_that_comes_meanwhile_is_no_refusal() {
        let came = Arc::new(AtomicBool::new(false));
        signal_hook::flag::register(SIGWINCH, Arc::clone(&came)).unwrap();
        let mut warden = Command::new("sh")
            .args(["-c", "read line && echo started $$"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let pidfd = rustix::process::pidfd_open(Pid::from_child(&warden), PidfdFlags::empty());
        let stdout = warden.stdout.take().unwrap();
        let stat = format!("/proc/self/task/{}/stat", rustix::thread::gettid());
        // SAFETY: takes nothing and says which thread this is.
        let waiting = unsafe { libc::pthread_self() };
        let mut stdin = warden.stdin.take().unwrap();
        let teller = std::thread::spawn(move || {
            let sleeps = || std::fs::read_to_string(&stat).unwrap().contains(") S ");
            while !sleeps() {
                std::thread::yield_now();
            }
            // SAFETY: the thread waits for what is written below, and for this one to end.
            assert_eq!(unsafe { libc::pthread_kill(waiting, SIGWINCH) }, 0);
            while !came.load(Ordering::SeqCst) {
                std::thread::yield_now();
            }
            stdin.write_all(b"go\n").unwrap();
        });
        let ward = await_ward(&pidfd.unwrap(), stdout);
        teller.join().unwrap();
        assert_eq!(ward.unwrap().pid, warden.id());
        warden.wait().unwrap();
    }
}
