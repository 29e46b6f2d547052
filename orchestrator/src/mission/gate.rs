//! The recorder's view of the turn page.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use kit::lockstep::Overseer;

use crate::recorder::Gate;

/// Lets the recorder sleep until there is something to record, and hold the simulator back.
#[derive(Debug, Clone)]
pub struct PageGate {
    overseer: Overseer,
    ended: Arc<AtomicBool>,
}

impl PageGate {
    /// A gate over the page; `ended` is set once no process of the run sends any more.
    pub fn new(overseer: Overseer, ended: Arc<AtomicBool>) -> Self {
        Self { overseer, ended }
    }
}

impl Gate for PageGate {
    fn wait(&self, timeout: Duration) {
        if !self.ended() {
            self.overseer.wait_for_records(timeout);
        }
    }

    fn completed_tick(&self) -> Option<u64> {
        self.overseer.completed_tick()
    }

    fn recorded(&self, tick: u64) {
        self.overseer.recorded(tick);
    }

    fn ended(&self) -> bool {
        self.ended.load(Ordering::SeqCst)
    }
}
