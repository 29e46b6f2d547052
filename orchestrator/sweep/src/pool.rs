//! Numbered missions in several threads, ended by Ctrl-C or a limit of real time.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::error::SweepError;

/// Interval between checks for interruptions and time-outs.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Number of missions at once, and what ends them.
pub struct Pool<'a> {
    /// Number of threads, > 0.
    pub jobs: usize,
    /// Real time after which a mission is ended.
    pub timeout: Duration,
    /// Set by the caller (Ctrl-C): running missions are ended, and no other is started.
    pub interrupted: &'a AtomicBool,
}

/// A mission of a thread.
pub struct Turn<'a> {
    /// Number of the mission.
    pub mission: usize,
    /// Set to end the mission in order.
    pub end: Arc<AtomicBool>,
    stop: &'a AtomicBool,
}

impl Turn<'_> {
    /// Returns `true` if all missions are to end, not because of the limit of this one.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::SeqCst)
    }
}

/// Start and end flag of the current mission of a thread.
type Current = Mutex<Option<(Instant, Arc<AtomicBool>)>>;

impl Pool<'_> {
    /// Carries out missions 0 to `count` - 1 by `work`; passes their results to `keep`, in this thread, as they end. Each
    /// thread calls `begin` with its number first.
    ///
    /// # Errors
    /// [`SweepError::Resource`] if a thread cannot be started; the first error of `keep`, which ends the missions.
    pub fn run<T: Send>(
        &self,
        count: usize,
        begin: impl Fn(usize) + Sync,
        work: impl Fn(&Turn<'_>) -> T + Sync,
        mut keep: impl FnMut(T) -> Result<(), SweepError>,
    ) -> Result<(), SweepError> {
        let (next, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
        let jobs = self.jobs.clamp(1, count.max(1));
        let current: Vec<Current> = (0..jobs).map(|_| Mutex::new(None)).collect();
        let (tell, done) = mpsc::channel::<T>();
        std::thread::scope(|scope| {
            for (thread, current) in current.iter().enumerate() {
                let (next, stop, begin, work) = (&next, &stop, &begin, &work);
                let tell = tell.clone();
                let missions = move || {
                    begin(thread);
                    loop {
                        let turn = Turn {
                            mission: next.fetch_add(1, Ordering::SeqCst),
                            end: Arc::default(),
                            stop,
                        };
                        set(current, Some((Instant::now(), Arc::clone(&turn.end))));
                        if turn.mission >= count || turn.is_stopped() {
                            return;
                        }
                        let told = tell.send(work(&turn));
                        set(current, None);
                        if told.is_err() {
                            return;
                        }
                    }
                };
                let builder = std::thread::Builder::new().name(format!("mission-{thread}"));
                if let Err(source) = builder.spawn_scoped(scope, missions) {
                    stop.store(true, Ordering::SeqCst);
                    return Err(SweepError::Resource {
                        what: format!("cannot start thread {thread}: {source}"),
                        help: "; choose fewer --jobs",
                    });
                }
            }
            drop(tell);
            let kept = loop {
                match done.recv_timeout(POLL_INTERVAL).map(&mut keep) {
                    Ok(Ok(())) | Err(RecvTimeoutError::Timeout) => {}
                    Ok(Err(error)) => break Err(error),
                    Err(RecvTimeoutError::Disconnected) => return Ok(()),
                }
                if self.interrupted.load(Ordering::SeqCst) {
                    stop.store(true, Ordering::SeqCst);
                }
                self.end(&current, stop.load(Ordering::SeqCst));
            };
            stop.store(true, Ordering::SeqCst);
            self.end(&current, true);
            kept
        })
    }

    /// Ends all missions, or those that have taken too long.
    fn end(&self, current: &[Current], all: bool) {
        for slot in current {
            let slot = slot.lock().unwrap_or_else(PoisonError::into_inner);
            if let Some((since, end)) = slot.as_ref()
                && (all || since.elapsed() > self.timeout)
            {
                end.store(true, Ordering::SeqCst);
            }
        }
    }
}

fn set(current: &Current, mission: Option<(Instant, Arc<AtomicBool>)>) {
    *current.lock().unwrap_or_else(PoisonError::into_inner) = mission;
}
