//! Failures of an earlier run in lock-step, done again: time is held before the tick that a process did
//! not do any more, and it is taken away there.

use std::collections::VecDeque;

use kit::lockstep::Overseer;

/// A process that is to be taken away between two ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Absence {
    /// The first tick that it does not do.
    pub tick: u64,
    /// Index of the process in the run.
    pub process: usize,
}

/// Who is still to be taken away, and what holds time for that.
#[derive(Debug)]
pub(super) struct Absences {
    due: VecDeque<Absence>,
    overseer: Overseer,
    /// A seat that nobody takes: the simulator holds time before the tick that it waits for there.
    /// Those of the processes do not serve, for whoever is in one is let go on.
    seat: usize,
    /// The tick before which time is held next.
    held: Option<u64>,
}

impl Absences {
    /// Prepares to take away these, on a page with a seat `seat` beside those of the processes.
    /// Before time starts.
    pub(super) fn new(mut due: Vec<Absence>, overseer: Overseer, seat: usize) -> Self {
        due.sort_unstable();
        let mut absences = Self {
            due: due.into(),
            overseer,
            seat,
            held: None,
        };
        if !absences.due.is_empty() {
            absences.overseer.seat(seat, true, false);
            absences.overseer.bury(seat);
            absences.hold();
        }
        absences
    }

    /// The next one.
    pub(super) fn next(&self) -> Option<Absence> {
        self.due.front().copied()
    }

    /// The next one has been taken away, and is waited for if it comes back: time may go on to the one
    /// after that.
    pub(super) fn done(&mut self) {
        self.due.pop_front();
        self.hold();
    }

    fn hold(&mut self) {
        let tick = self.next().map(|absence| absence.tick);
        if tick != self.held {
            self.held = tick;
            self.overseer.expect_back(self.seat, tick);
        }
    }
}
