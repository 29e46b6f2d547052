//! Who drives the world from tick to tick: everybody's answers, or the clock.

use std::sync::atomic::Ordering;
use std::time::Instant;

use ipc_types::clock;
use kit::lockstep::{Conductor, TurnEnd};
use kit::{ProcessError, Setup};

use super::Simulator;

impl Simulator {
    /// Ticks that come when everybody has done the last one.
    pub(super) fn lock_step(
        &mut self,
        conductor: &Conductor,
        setup: &mut Setup,
    ) -> Result<(), ProcessError> {
        loop {
            let start = Instant::now();
            let over = self.publish()?;
            if over {
                conductor.complete(self.tick);
                return Ok(());
            }
            conductor.post(self.tick);
            loop {
                if setup.stop.load(Ordering::Relaxed) {
                    return Ok(());
                }
                match conductor.wait(self.tick) {
                    TurnEnd::Complete => break,
                    TurnEnd::Idle => {
                        if setup.heartbeat.is_due() {
                            setup.heartbeat.beat(self.tick, 3, None)?;
                        }
                    }
                    TurnEnd::Stop => return Ok(()),
                }
            }
            setup.bus.begin_turn();
            self.take_commands()?;
            setup
                .heartbeat
                .stepped(clock::elapsed_ns(start), 0, self.refused_commands);
            if setup.heartbeat.is_due() {
                setup.heartbeat.beat(self.tick, 3, None)?;
            }
            if !conductor.complete(self.tick) {
                return Ok(());
            }
            self.advance(0);
        }
    }

    /// Ticks that come by the clock.
    pub(super) fn real_time(
        &mut self,
        conductor: &Conductor,
        setup: &mut Setup,
        factor: f64,
        deadline_ns: u64,
    ) -> Result<(), ProcessError> {
        let period = self.tick_period.div_f64(factor.max(1e-3));
        let max_age = kit::config::ticks_within(deadline_ns, self.tick_period);
        let mut due = Instant::now();
        let mut overruns = 0;
        loop {
            conductor.admit(|| self.connect_ports())?;
            let start = Instant::now();
            let over = self.publish()?;
            conductor.post_without_waiting(self.tick);
            if over {
                conductor.complete_without_waiting(self.tick);
                return Ok(());
            }
            due += period;
            let left = due.saturating_duration_since(Instant::now());
            if left.is_zero() {
                // Late: the schedule shifts, so that the world does not race to catch up.
                overruns += 1;
                due = Instant::now();
            }
            if !conductor.sleep(left) || setup.stop.load(Ordering::Relaxed) {
                return Ok(());
            }
            setup.bus.begin_turn();
            self.take_commands()?;
            setup
                .heartbeat
                .stepped(clock::elapsed_ns(start), overruns, self.refused_commands);
            if setup.heartbeat.is_due() {
                setup.heartbeat.beat(self.tick, 3, None)?;
            }
            conductor.complete_without_waiting(self.tick);
            self.advance(max_age);
        }
    }
}
