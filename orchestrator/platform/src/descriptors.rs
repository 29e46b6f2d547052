//! Open files: as many as the system permits, and none of them inherited by the processes that are started.

use std::os::unix::process::CommandExt as _;
use std::process::Command;

use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};

/// Allows this program, and those that it starts, as many open files as the system permits: a mission
/// has hundreds open, and the limit that is met first is there for programs that cannot count beyond 1023.
pub fn raise_limit() {
    let limit = getrlimit(Resource::Nofile);
    let raised = Rlimit {
        current: limit.maximum,
        maximum: limit.maximum,
    };
    // Refused, it stays as it was, and the file that cannot be opened is named.
    let _ = setrlimit(Resource::Nofile, raised);
}

/// Has a program started with nothing open but its standard input, output and error, whatever is open
/// here.
///
/// Rust's library opens everything so that it ends with `exec`; iceoryx2 (0.10) opens what describes
/// services, ports and connections so that it does not. Whoever was started in the midst of a mission,
/// or of several at once, would have inherited what its orchestrator had open of all of them, and a
/// program that is not ours would have, too. Linux before 5.11 cannot close all at once: there it stays
/// as it was.
#[expect(unsafe_code, reason = "the child must do it between fork and exec")]
pub fn leave_behind(command: &mut Command) {
    let first = libc::STDERR_FILENO.unsigned_abs() + 1;
    let mark = move || {
        // Not closed but marked: the pipe through which a failed exec is told has to last until then.
        // By its number: C libraries older than Linux 5.11 have no name for it.
        // SAFETY: takes numbers only, and changes nothing but flags of this process's own descriptors.
        unsafe {
            libc::syscall(
                libc::SYS_close_range,
                first,
                libc::c_uint::MAX,
                libc::CLOSE_RANGE_CLOEXEC,
            );
        }
        Ok(())
    };
    // SAFETY: between fork and exec one system call is made, which is safe after a fork of a program
    // with threads: no lock is taken and no memory allocated.
    unsafe {
        command.pre_exec(mark);
    }
}

#[cfg(test)]
mod tests {
    use std::os::fd::AsRawFd as _;

    use super::*;

    #[test]
    fn nothing_but_the_standard_ones_goes_on() {
        let file = tempfile::tempfile().unwrap();
        rustix::io::fcntl_setfd(&file, rustix::io::FdFlags::empty()).unwrap();
        let listing = |command: &mut Command| {
            let output = command.output().unwrap();
            assert!(output.status.success());
            String::from_utf8(output.stdout).unwrap()
        };
        let list = || {
            let mut command = Command::new("sh");
            // Not the one of the listed folder, which is closed by then.
            let script =
                r#"for fd in /proc/$$/fd/*; do test -e "$fd" && echo "${fd##*/}"; done; true"#;
            command.args(["-c", script]);
            command
        };
        let number = file.as_raw_fd().to_string();
        let inherited = listing(&mut list());
        assert!(inherited.lines().any(|fd| fd == number), "{inherited}");
        let mut command = list();
        leave_behind(&mut command);
        assert_eq!(listing(&mut command), "0\n1\n2\n");
        // A program that is not there is still told.
        let mut command = Command::new("./there-is-no-such-program");
        leave_behind(&mut command);
        let error = command.spawn().unwrap_err();
        assert_eq!(error.kind(), std::io::ErrorKind::NotFound);
    }
}
