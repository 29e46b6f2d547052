//! Memory of the orchestrator between missions.

/// Lets threads share arenas, from which the C library takes memory: as many as this machine can do
/// things at once, where it would make eight times as many. Over many missions each arena comes to hold
/// pages that are only partly used, which cannot be given back. Call before there are threads. Does nothing
/// where the C library is another.
#[cfg_attr(
    target_env = "gnu",
    expect(
        unsafe_code,
        reason = "a call of the C library that has no other wrapper"
    )
)]
pub fn share_arenas() {
    #[cfg(target_env = "gnu")]
    {
        let processors = std::thread::available_parallelism().map_or(2, usize::from);
        let arenas = libc::c_int::try_from(processors.max(2)).unwrap_or(libc::c_int::MAX);
        // SAFETY: takes no pointers and sets a number that is read when an arena is to be made. A refusal
        // changes nothing.
        unsafe {
            libc::mallopt(libc::M_ARENA_MAX, arenas);
        }
    }
}

/// Most that a thread may keep of what it has freed last [bytes]: what the C library begins with.
#[cfg(target_env = "gnu")]
const KEPT: libc::c_int = 128 << 10;

/// Has what is freed at the end of an arena given back at once, as it is at first: the C library keeps
/// more, up to 64 megabytes, once larger pieces have been freed, and [`give_back`] does not reach it in
/// the arenas of other threads. Does nothing where the C library is another.
#[cfg_attr(
    target_env = "gnu",
    expect(
        unsafe_code,
        reason = "a call of the C library that has no other wrapper"
    )
)]
pub fn keep_little() {
    #[cfg(target_env = "gnu")]
    // SAFETY: takes no pointers, may be called at any time from any thread, and sets a number. A refusal
    // changes nothing.
    unsafe {
        libc::mallopt(libc::M_TRIM_THRESHOLD, KEPT);
    }
}

/// Gives back to the system what this process has freed.
///
/// Every mission is recorded by a thread of its own, and the C library keeps what a thread frees in
/// one of many arenas, whichever the thread was given: after many missions each of them keeps as
/// much as the largest mission needed. Does nothing where the C library is another.
#[cfg_attr(
    target_env = "gnu",
    expect(
        unsafe_code,
        reason = "a call of the C library that has no other wrapper"
    )
)]
pub fn give_back() {
    #[cfg(target_env = "gnu")]
    // SAFETY: takes no pointers, may be called at any time from any thread, and touches only memory
    // that is free.
    unsafe {
        libc::malloc_trim(0);
    }
}

#[cfg(all(test, target_env = "gnu"))]
mod tests {
    use std::sync::{Mutex, PoisonError};

    use super::*;
    use crate::census;

    /// Held while what this process holds is measured: each test here takes much.
    static ALONE: Mutex<()> = Mutex::new(());

    const PIECE: usize = 64 * 1024;
    const PIECES: usize = 512;

    fn held() -> u64 {
        census::member(std::process::id() as i32)
            .unwrap()
            .memory_bytes
    }

    #[test]
    fn threads_keep_little_of_what_they_have_freed_last() {
        let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
        // Raises what is kept, unless that has been fixed.
        drop(std::hint::black_box(vec![1_u8; 30 << 20]));
        keep_little();
        let before = held();
        let fill_and_empty = || {
            let pieces: Vec<Vec<u8>> = (0..PIECES).map(|_| vec![1; PIECE]).collect();
            drop(std::hint::black_box(pieces));
        };
        std::thread::spawn(fill_and_empty).join().unwrap();
        let after = held();
        // Others test beside this one and may take some meanwhile.
        assert!(
            after.saturating_sub(before) < (PIECE * PIECES / 2) as u64,
            "{before} {after}"
        );
    }

    #[test]
    fn what_threads_have_freed_is_given_back() {
        let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
        let fill = || {
            // Below what the C library maps piece by piece; the last piece, which is kept, has all
            // others below it, so that nothing is given back without being asked.
            let mut pieces: Vec<Vec<u8>> = (0..PIECES).map(|_| vec![1; PIECE]).collect();
            pieces.pop()
        };
        let kept = std::thread::spawn(fill).join().unwrap();
        let before = held();
        give_back();
        let after = held();
        // Others test beside this one and may take some meanwhile.
        assert!(
            before.saturating_sub(after) > (PIECE * PIECES / 2) as u64,
            "{before} {after}"
        );
        drop(kept);
    }
}
