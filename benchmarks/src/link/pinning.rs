//! Pinning of threads to processors.

use super::LinkError;

/// Pins the calling thread, and processes that it starts, to its first, second, … allowed
/// processor.
///
/// # Errors
/// [`LinkError`] if the operating system refuses.
pub fn pin(which: usize) -> Result<(), LinkError> {
    let system = |e: rustix::io::Errno| LinkError::system("cannot pin to a processor")(e.into());
    let mut set = rustix::thread::CpuSet::new();
    set.set(allowed()?.get(which).copied().unwrap_or(which));
    rustix::thread::sched_setaffinity(None, &set).map_err(system)
}

/// Returns the processors on which this thread may run.
///
/// # Errors
/// [`LinkError`] if the operating system does not report them.
pub fn allowed() -> Result<Vec<usize>, LinkError> {
    let system =
        |e: rustix::io::Errno| LinkError::system("cannot read the allowed processors")(e.into());
    let allowed = rustix::thread::sched_getaffinity(None).map_err(system)?;
    let all = 0..rustix::thread::CpuSet::MAX_CPU;
    Ok(all.filter(|&cpu| allowed.is_set(cpu)).collect())
}
