//! A log that is nowhere on a disk.

use std::io::Write as _;
use std::os::fd::AsRawFd as _;
use std::path::{Path, PathBuf};

use orchestrator::logs::Watch;
use rustix::fs::{MemfdFlags, memfd_create};

/// Calls `read` with the path of a file that holds these bytes.
pub fn with_log(bytes: &[u8], read: impl FnOnce(&Path)) {
    let fd = memfd_create("log", MemfdFlags::CLOEXEC).expect("a file in memory");
    let mut file = std::fs::File::from(fd);
    file.write_all(bytes).expect("room");
    let path = PathBuf::from(format!("/proc/self/fd/{}", file.as_raw_fd()));
    read(&path);
}

/// Nobody looks on.
pub fn watch() -> Watch {
    Watch::new(std::sync::Arc::default(), true)
}
