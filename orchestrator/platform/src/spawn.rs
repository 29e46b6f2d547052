//! Start of a program without a wait for it.
//!
//! `std::process::Command` waits until the child executes its program. A child that is stopped before would stop its
//! parent as well, without a limit. [`spawn`] returns as soon as the child exists.

use std::ffi::{CString, OsStr, c_char, c_int};
use std::fs::File;
use std::io::{Error, ErrorKind, Read as _, Result};
use std::os::fd::{AsRawFd as _, OwnedFd, RawFd};
use std::os::unix::ffi::OsStrExt as _;

use rustix::pipe::{PipeFlags, pipe_with};
use rustix::process::{
    Pid, PidfdFlags, Signal, WaitOptions, getpid, kill_process, pidfd_open, waitpid,
};

use crate::descriptors;

/// Exit code of a child that could not execute its program.
const NOT_EXECUTED: c_int = 127;

/// Program to be started.
#[derive(Debug)]
pub struct Program<'a> {
    /// Path, or a name that is searched in `PATH`.
    pub file: &'a OsStr,
    /// Arguments; the first one is the name of the process.
    pub arguments: Vec<&'a OsStr>,
    /// Name and value of a variable in addition to the environment of this process.
    pub variable: (&'a str, &'a OsStr),
    /// Working directory; `None`: that of this process.
    pub folder: Option<&'a OsStr>,
}

/// Child that [`spawn`] has started.
#[derive(Debug)]
pub struct Child {
    /// Process id, valid until the child is reaped.
    pub pid: Pid,
    /// Descriptor of the process, readable once it has ended.
    pub pidfd: OwnedFd,
    /// Writing end of its stdin, closed with this value.
    _stdin: OwnedFd,
    /// Receives the number of the error if the program is not executed.
    failure: File,
}

impl Child {
    /// Returns the reason why a child that has ended executed no program. Returns it once.
    pub fn start_error(&mut self) -> Option<Error> {
        let mut code = [0; size_of::<c_int>()];
        // It never blocks. Without an error the pipe is empty.
        self.failure.read_exact(&mut code).ok()?;
        Some(Error::from_raw_os_error(c_int::from_ne_bytes(code)))
    }
}

/// Starts a program with `output` as stdout and stderr and a pipe as stdin, in a process group of its own. It inherits no
/// other descriptor. The system kills it, also when it is stopped, as soon as the thread that started it ends for any
/// reason.
///
/// # Errors
/// The error of the system. [`Child::start_error`] returns that of the program's execution.
#[expect(
    unsafe_code,
    reason = "no other function returns before the program is executed"
)]
pub fn spawn(program: &Program<'_>, output: &OwnedFd) -> Result<Child> {
    let (stdin, child_stdin) = {
        let (reading, writing) = pipe_with(PipeFlags::CLOEXEC)?;
        (writing, reading)
    };
    let (failure, report) = pipe_with(PipeFlags::CLOEXEC | PipeFlags::NONBLOCK)?;
    let image = Image {
        file: c_string(program.file)?,
        arguments: c_strings(program.arguments.iter().copied())?,
        environment: environment(program.variable)?,
        folder: program.folder.map(c_string).transpose()?,
        parent: getpid().as_raw_nonzero().get(),
        streams: [
            child_stdin.as_raw_fd(),
            output.as_raw_fd(),
            output.as_raw_fd(),
        ],
        report: report.as_raw_fd(),
    };
    let (arguments, environment) = (pointers(&image.arguments), pointers(&image.environment));
    // SAFETY: the child only calls `Image::execute`, which meets the conditions after a fork of a program with threads.
    let pid = match unsafe { libc::fork() } {
        // SAFETY: as above; the pointers are those of the image.
        0 => unsafe { image.execute(&arguments, &environment) },
        pid => Pid::from_raw(pid).filter(|_| pid > 0),
    };
    let pid = pid.ok_or_else(Error::last_os_error)?;
    match pidfd_open(pid, PidfdFlags::empty()) {
        Ok(pidfd) => Ok(Child {
            pid,
            pidfd,
            _stdin: stdin,
            failure: File::from(failure),
        }),
        Err(error) => {
            let _ = kill_process(pid, Signal::KILL);
            let _ = waitpid(Some(pid), WaitOptions::empty());
            Err(error.into())
        }
    }
}

/// All that a child needs to execute its program, allocated before the fork.
struct Image {
    file: CString,
    arguments: Vec<CString>,
    environment: Vec<CString>,
    folder: Option<CString>,
    parent: c_int,
    /// Descriptors that become stdin, stdout and stderr.
    streams: [RawFd; 3],
    /// Descriptor to which the number of an error is written.
    report: RawFd,
}

impl Image {
    /// Executes the program in the child.
    ///
    /// # Safety
    /// Must be called after a fork only, with the pointers to this image's strings. Between fork and exec it makes
    /// system calls only. They are safe after a fork of a program with threads: they take no lock and allocate no
    /// memory.
    #[expect(unsafe_code, reason = "system calls between fork and exec")]
    unsafe fn execute(&self, arguments: &[*const c_char], environment: &[*const c_char]) -> ! {
        // SAFETY: see above. All pointers refer to values of this function or to arrays that end with a null pointer.
        unsafe {
            // First, so that the child does not outlive its parent from here on, even if it is stopped.
            if libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGKILL) == 0
                && libc::getppid() == self.parent
                && libc::setpgid(0, 0) == 0
                && (0..)
                    .zip(self.streams)
                    .all(|(to, from)| libc::dup2(from, to) == to)
                && (self.folder.as_ref()).is_none_or(|folder| libc::chdir(folder.as_ptr()) == 0)
            {
                descriptors::close_on_exec();
                // Rust programs ignore it; others expect the default.
                libc::signal(libc::SIGPIPE, libc::SIG_DFL);
                libc::execvpe(self.file.as_ptr(), arguments.as_ptr(), environment.as_ptr());
            }
            let code = *libc::__errno_location();
            libc::write(self.report, (&raw const code).cast(), size_of::<c_int>());
            libc::_exit(NOT_EXECUTED)
        }
    }
}

fn c_string(text: &OsStr) -> Result<CString> {
    CString::new(text.as_bytes()).map_err(|_| {
        let text = text.to_string_lossy();
        Error::new(ErrorKind::InvalidInput, format!("{text:?} has a zero byte"))
    })
}

fn c_strings<'a>(texts: impl Iterator<Item = &'a OsStr>) -> Result<Vec<CString>> {
    texts.map(c_string).collect()
}

/// Returns the environment of this process with another variable.
fn environment((name, value): (&str, &OsStr)) -> Result<Vec<CString>> {
    let others = std::env::vars_os().filter(|(key, _)| key != name);
    others
        .chain([(name.into(), value.to_owned())])
        .map(|(mut pair, value)| {
            pair.push("=");
            pair.push(value);
            c_string(&pair)
        })
        .collect()
}

/// Returns the pointers to strings, with a null pointer at the end.
fn pointers(strings: &[CString]) -> Vec<*const c_char> {
    let pointers = strings.iter().map(|text| text.as_ptr());
    pointers.chain([std::ptr::null()]).collect()
}

#[cfg(test)]
mod tests {
    use std::os::fd::AsFd as _;

    use rustix::process::{WaitId, WaitIdOptions, waitid};

    use super::*;

    /// Starts a program; returns its output, its exit code and its start error.
    fn run(words: &[&str], folder: Option<&str>) -> (String, Option<i32>, Option<Error>) {
        let (reading, output) = pipe_with(PipeFlags::CLOEXEC).unwrap();
        let program = Program {
            file: OsStr::new(words[0]),
            arguments: words.iter().map(OsStr::new).collect(),
            variable: ("SPAWN_TEST", OsStr::new("a value")),
            folder: folder.map(OsStr::new),
        };
        let mut child = spawn(&program, &output).unwrap();
        drop(output);
        let mut text = String::new();
        File::from(reading).read_to_string(&mut text).unwrap();
        let ended = waitid(WaitId::PidFd(child.pidfd.as_fd()), WaitIdOptions::EXITED);
        let code = ended.unwrap().unwrap().exit_status();
        (text, code, child.start_error())
    }

    #[test]
    fn a_program_is_found_and_gets_its_arguments_variable_folder_and_three_descriptors_only() {
        let file = tempfile::tempfile().unwrap();
        rustix::io::fcntl_setfd(&file, rustix::io::FdFlags::empty()).unwrap();
        let script = "echo \"$1 $SPAWN_TEST $(ps -o pgid= -p $$ | tr -d ' ')\" >&2; pwd; \
                      for fd in /proc/$$/fd/*; do test -e \"$fd\" && echo \"${fd##*/}\" >&2; done; echo $$ >&2; exit 5";
        let (text, code, error) = run(&["sh", "-c", script, "sh", "word"], Some("/usr"));
        let lines: Vec<&str> = text.lines().collect();
        let pid = *lines.last().unwrap();
        assert_eq!(
            lines,
            [&*format!("word a value {pid}"), "/usr", "0", "1", "2", pid]
        );
        assert_eq!(code, Some(5));
        assert!(error.is_none(), "{error:?}");
    }

    #[test]
    fn a_program_that_cannot_be_executed_has_the_reason() {
        for (file, folder, kind) in [
            ("./there-is-no-such-program", None, ErrorKind::NotFound),
            ("there-is-no-such-program", None, ErrorKind::NotFound),
            ("/etc/passwd", None, ErrorKind::PermissionDenied),
            ("sh", Some("/there-is-no-such-folder"), ErrorKind::NotFound),
        ] {
            let (text, code, error) = run(&[file], folder);
            assert_eq!((text.as_str(), code), ("", Some(NOT_EXECUTED)), "{file}");
            assert_eq!(error.map(|error| error.kind()), Some(kind), "{file}");
        }
    }

    #[test]
    fn a_zero_byte_is_refused() {
        let (_, output) = pipe_with(PipeFlags::CLOEXEC).unwrap();
        let program = Program {
            file: OsStr::new("sh\0"),
            arguments: Vec::new(),
            variable: ("SPAWN_TEST", OsStr::new("")),
            folder: None,
        };
        let error = spawn(&program, &output).unwrap_err();
        assert_eq!(error.to_string(), "\"sh\\0\" has a zero byte");
    }
}
