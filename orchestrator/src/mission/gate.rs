//! The recorder's view of the turn page.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use runtime::config::Clock;
use runtime::lockstep::Overseer;

use crate::recorder::Gate;

/// Asks the recorder to take what has been sent, out of its turn: it sleeps for many ticks, and what a
/// process has sent that is dead goes with the rest of it as soon as that is cleaned up, unless the
/// recorder has met the process while it lived.
#[derive(Debug, Default)]
pub struct Calls {
    asked: AtomicU64,
    answered: AtomicU64,
    /// Whether the recorder is at work.
    open: AtomicBool,
}

impl Calls {
    /// How long the recorder is waited for, which may be writing to a slow disk.
    const PATIENCE: Duration = Duration::from_secs(5);
    /// Time between two looks for its answer.
    const LOOK: Duration = Duration::from_micros(200);

    /// Returns when the recorder has taken everything that had been sent before the call, or when it
    /// does not do so yet, or any more.
    pub fn call(&self) {
        let call = self.asked.fetch_add(1, Ordering::SeqCst) + 1;
        let deadline = Instant::now() + Self::PATIENCE;
        while self.answered.load(Ordering::SeqCst) < call && self.open.load(Ordering::SeqCst) {
            if Instant::now() >= deadline {
                tracing::warn!("the recorder does not answer: last words of a process may be lost");
                return;
            }
            std::thread::park_timeout(Self::LOOK);
        }
    }

    /// The recorder begins, or ends, to take what is sent.
    pub fn open(&self, open: bool) {
        self.open.store(open, Ordering::SeqCst);
    }
}

/// Lets the recorder sleep until there is something to record, and hold the simulator back.
#[derive(Debug, Clone)]
pub struct PageGate {
    overseer: Overseer,
    clock: Clock,
    ended: Arc<AtomicBool>,
    calls: Arc<Calls>,
}

impl PageGate {
    /// A gate over the page; `ended` is set once no process of the run sends any more.
    pub fn new(
        overseer: Overseer,
        clock: Clock,
        ended: Arc<AtomicBool>,
        calls: Arc<Calls>,
    ) -> Self {
        Self {
            overseer,
            clock,
            ended,
            calls,
        }
    }
}

impl Gate for PageGate {
    fn wait(&self, timeout: Duration) {
        if self.ended() {
            return;
        }
        if self.clock != Clock::LockStep
            && let Some(tick) = self.overseer.completed_tick()
        {
            // In real time nothing waits for the log: the recorder is woken for what it has not
            // taken, not for what is not written.
            self.overseer.recorded(tick);
        }
        self.overseer.wait_for_records(timeout);
    }

    fn completed_tick(&self) -> Option<u64> {
        if self.clock != Clock::LockStep {
            return None;
        }
        self.overseer.completed_tick()
    }

    fn recorded(&self, tick: u64) {
        self.overseer.recorded(tick);
    }

    fn calls(&self) -> u64 {
        self.calls.asked.load(Ordering::SeqCst)
    }

    fn answer(&self, calls: u64) {
        self.calls.answered.store(calls, Ordering::SeqCst);
    }

    fn ended(&self) -> bool {
        self.ended.load(Ordering::SeqCst)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whoever_calls_waits_for_a_look_that_began_after_the_call() {
        let calls = Calls::default();
        calls.call();
        calls.open(true);
        let (seen, called) = (AtomicU64::new(0), AtomicBool::new(false));
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while calls.open.load(Ordering::SeqCst) {
                    let asked = calls.asked.load(Ordering::SeqCst);
                    // The look.
                    if called.load(Ordering::SeqCst) {
                        seen.fetch_add(1, Ordering::SeqCst);
                    }
                    calls.answered.store(asked, Ordering::SeqCst);
                }
            });
            called.store(true, Ordering::SeqCst);
            calls.call();
            assert!(seen.load(Ordering::SeqCst) > 0, "answered without a look");
            calls.open(false);
        });
        // Nobody is waited for who has gone.
        calls.call();
    }
}
