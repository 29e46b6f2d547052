//! The recorder's view of the turn page.

use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use kit::config::Clock;
use kit::lockstep::Overseer;

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
    pace: Option<Pace>,
}

impl PageGate {
    /// A gate over the page; `ended` is set once no process of the run sends any more. With a pace
    /// ticks count as complete no earlier than they are due.
    pub fn new(
        overseer: Overseer,
        clock: Clock,
        ended: Arc<AtomicBool>,
        calls: Arc<Calls>,
        pace: Option<Pace>,
    ) -> Self {
        Self {
            overseer,
            clock,
            ended,
            calls,
            pace,
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
        match &self.pace {
            // Most of the time the simulator waits for the recorder: that must not wake it.
            Some(pace) => std::thread::sleep(timeout.min(pace.until_due())),
            None => self.overseer.wait_for_records(timeout),
        }
    }

    fn completed_tick(&self) -> Option<u64> {
        if self.clock != Clock::LockStep {
            return None;
        }
        let completed = self.overseer.completed_tick()?;
        match &self.pace {
            Some(pace) => pace.due(completed),
            None => Some(completed),
        }
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

/// How fast the ticks of a run in lock-step may come.
///
/// The simulator may not be far ahead of the recorder, so that holding back the recorder holds back
/// the world: what it does does not depend on when.
#[derive(Debug, Clone)]
pub struct Pace {
    /// Real time between two ticks.
    period: Duration,
    /// The first tick that is not due yet, and when it will be.
    next: Cell<Option<(u64, Instant)>>,
}

impl Pace {
    /// `factor` simulated seconds per second, at ticks of this length [simulated s].
    pub fn new(factor: f64, tick_period: f64) -> Self {
        let seconds = tick_period / factor;
        Self {
            // A factor beyond all measure is no pace at all.
            period: Duration::try_from_secs_f64(seconds).unwrap_or_default(),
            next: Cell::new(None),
        }
    }

    /// The last of the completed ticks that is due; the first is due at once.
    fn due(&self, completed: u64) -> Option<u64> {
        let now = Instant::now();
        let (mut tick, mut at) = self.next.get().unwrap_or((0, now));
        while tick <= completed && at <= now {
            tick += 1;
            at += self.period;
        }
        if tick <= completed {
            self.next.set(Some((tick, at)));
        } else {
            // The world is late: the schedule shifts, so that it does not race to catch up.
            self.next.set(Some((tick, at.max(now))));
        }
        tick.checked_sub(1)
    }

    /// Time until the next tick is due.
    fn until_due(&self) -> Duration {
        let next = self.next.get();
        next.map_or(Duration::MAX, |(_, at)| {
            at.saturating_duration_since(Instant::now())
        })
        .max(Duration::from_millis(1))
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

    #[test]
    fn ticks_are_due_one_after_the_other_and_never_before_they_are_complete() {
        let slow = Pace::new(1e-3, 1.0);
        assert_eq!(slow.due(5), Some(0));
        assert_eq!(slow.due(5), Some(0), "the next in a quarter of an hour");
        assert!(slow.until_due() > Duration::from_secs(900));
        let fast = Pace::new(f64::INFINITY, 1.0);
        assert_eq!(fast.due(0), Some(0));
        assert_eq!(fast.due(7), Some(7));
    }
}
