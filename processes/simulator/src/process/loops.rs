//! Loops that advance the world: in lock-step, when all processes have done the tick, and in real
//! time.

use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use ipc_types::clock;
use runtime::lockstep::{BarrierLeader, Pacing, TickEnd};
use runtime::{ProcessError, Setup};

use super::Simulator;

/// Times at which ticks are due in real time, one period apart.
struct Schedule {
    period: Duration,
    due: Instant,
}

impl Schedule {
    /// Returns a schedule whose first tick is due now; `factor` is in simulated s per s.
    fn new(tick_period: Duration, factor: f64) -> Self {
        Self {
            period: tick_period.div_f64(factor.max(1e-3)),
            due: Instant::now(),
        }
    }

    /// Returns the time until the next tick is due. Zero if it is late: then the schedule shifts,
    /// so that the world does not race to catch up.
    fn until_next(&mut self) -> Duration {
        self.due += self.period;
        let now = Instant::now();
        let left = self.due.saturating_duration_since(now);
        self.due = self.due.max(now);
        left
    }
}

impl Simulator {
    /// Runs ticks that begin when all processes have done the last one, and not before they are due at
    /// the pace of the orchestrator.
    pub(super) fn lock_step(
        &mut self,
        leader: &BarrierLeader,
        setup: &mut Setup,
    ) -> Result<(), ProcessError> {
        let mut pacing = Pacing::new(self.tick_period);
        loop {
            let start = Instant::now();
            let over = self.publish()?;
            if over {
                leader.complete(self.tick);
                return Ok(());
            }
            leader.post(self.tick);
            loop {
                if setup.stop.load(Ordering::Relaxed) {
                    return Ok(());
                }
                match leader.wait(self.tick) {
                    TickEnd::Complete => break,
                    TickEnd::Idle => {
                        if setup.heartbeat.is_due() {
                            setup.heartbeat.send_if_due(self.tick, 3, None)?;
                        }
                    }
                    TickEnd::Stop => return Ok(()),
                }
            }
            setup.bus.begin_turn();
            self.take_commands()?;
            setup
                .heartbeat
                .stepped(clock::elapsed_ns(start), 0, self.refused_commands);
            if setup.heartbeat.is_due() {
                setup.heartbeat.send_if_due(self.tick, 3, None)?;
            }
            if !leader.complete(self.tick) {
                return Ok(());
            }
            self.advance(0);
            let running = || !setup.stop.load(Ordering::Relaxed);
            if !leader.wait_until_due(&mut pacing, running) {
                return Ok(());
            }
        }
    }

    /// Runs ticks in real time.
    pub(super) fn real_time(
        &mut self,
        leader: &BarrierLeader,
        setup: &mut Setup,
        factor: f64,
        deadline_ns: u64,
    ) -> Result<(), ProcessError> {
        let mut schedule = Schedule::new(self.tick_period, factor);
        let max_age = runtime::config::ticks_within(deadline_ns, self.tick_period);
        let mut overruns = 0;
        loop {
            leader.admit(|| self.connect_ports())?;
            let start = Instant::now();
            let over = self.publish()?;
            leader.post_without_waiting(self.tick);
            if over {
                leader.complete_without_waiting(self.tick);
                return Ok(());
            }
            let left = schedule.until_next();
            overruns += u64::from(left.is_zero());
            if !leader.sleep(left) || setup.stop.load(Ordering::Relaxed) {
                return Ok(());
            }
            setup.bus.begin_turn();
            self.take_commands()?;
            setup
                .heartbeat
                .stepped(clock::elapsed_ns(start), overruns, self.refused_commands);
            if setup.heartbeat.is_due() {
                setup.heartbeat.send_if_due(self.tick, 3, None)?;
            }
            leader.complete_without_waiting(self.tick);
            self.advance(max_age);
        }
    }
}
