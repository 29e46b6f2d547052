//! Open files: their limit, and their inheritance by started processes.

use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};

/// Raises the limit of open files to the hard limit, for this process and its children. A mission has
/// hundreds of files open; the soft limit exists for programs that use `select(2)`, which ends at descriptor
/// 1023.
pub fn raise_limit() {
    let limit = getrlimit(Resource::Nofile);
    let raised = Rlimit {
        current: limit.maximum,
        maximum: limit.maximum,
    };
    // On failure the limit stays, and the file that cannot be opened is reported later.
    let _ = setrlimit(Resource::Nofile, raised);
}

/// Returns the number of files that this process may still open, less some for its own use.
pub fn available() -> u64 {
    const OWN: u64 = 40;
    let limit = getrlimit(Resource::Nofile).current;
    limit.map_or(u64::MAX, |limit| limit.saturating_sub(OWN))
}

/// Marks all descriptors of this process except standard input, output and error to be closed when it executes
/// another program.
///
/// The Rust standard library opens files with close-on-exec; iceoryx2 (0.10) opens the descriptors of
/// services, ports and connections without it. A process started during a mission would inherit the
/// descriptors of that mission and of every other one in this process, also if it is an external program.
/// Linux before 5.11 cannot close all descriptors at once; there they stay open.
#[expect(unsafe_code, reason = "`rustix` lacks the system call")]
pub(crate) fn close_on_exec() {
    let first = libc::STDERR_FILENO.unsigned_abs() + 1;
    // Marked instead of closed: the pipe that reports a failed exec must stay open.
    // By number: C libraries older than Linux 5.11 do not define a name for the flag.
    // SAFETY: takes numbers only, and changes only flags of this process's own descriptors.
    unsafe {
        libc::syscall(
            libc::SYS_close_range,
            first,
            libc::c_uint::MAX,
            libc::CLOSE_RANGE_CLOEXEC,
        );
    }
}
