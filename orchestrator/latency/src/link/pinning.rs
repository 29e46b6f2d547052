//! Which processors a thread may be on.

use super::LinkError;

/// Pins the calling thread, and what it will start, to its first, second, … allowed processor.
///
/// # Errors
/// [`LinkError`] if the system refuses.
pub fn pin(which: usize) -> Result<(), LinkError> {
    let system = |e: rustix::io::Errno| LinkError::system("cannot pin to a processor")(e.into());
    let mut set = rustix::thread::CpuSet::new();
    set.set(allowed()?.get(which).copied().unwrap_or(which));
    rustix::thread::sched_setaffinity(None, &set).map_err(system)
}

/// The processors that this thread may be on.
///
/// # Errors
/// [`LinkError`] if the system does not tell.
pub fn allowed() -> Result<Vec<usize>, LinkError> {
    let system = |e: rustix::io::Errno| LinkError::system("cannot ask for processors")(e.into());
    let allowed = rustix::thread::sched_getaffinity(None).map_err(system)?;
    let all = 0..rustix::thread::CpuSet::MAX_CPU;
    Ok(all.filter(|&cpu| allowed.is_set(cpu)).collect())
}
