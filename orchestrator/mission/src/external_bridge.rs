//! Bridge between the tick barrier and external programs, in any language that iceoryx2 supports.
//!
//! One thread per external process waits at the tick barrier in its place and forwards each turn through two
//! events. [`TURN_EVENT`] with the process's index starts a turn; the process answers each with [`DONE_EVENT`] and
//! its index. It sends the first answer without a turn, when its ports are open. The second one answers the turn in
//! which it connects its ports. After that, each tick is one turn. [`END_OF_TURNS`] added to the index marks the end.
//!
//! A program that uses the crate `runtime` waits at the barrier itself and never answers; its thread then waits for the
//! end of the run or of the process.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use ipc_types::bus::{Bus, Listener, Notifier, TopicHolder};
use ipc_types::topics::{DONE_EVENT, END_OF_TURNS, TURN_EVENT};
use runtime::config::{Clock, ProcessConfig};
use runtime::lockstep::{BarrierMember, POLL_INTERVAL, Phase, SlotState, TickBarrier, TickWait};

use super::child_process::Executable;
use super::error::MissionError;
use super::plan::Launch;

/// Time to wait for answers left over from a process that has ended. (Zero would wait without limit.)
const DRAIN: Duration = Duration::from_millis(1);
/// Interval at which a thread without a process checks for a new one.
const SUCCESSOR_POLL_INTERVAL: Duration = Duration::from_millis(5);

/// Threads that wait at the barrier for external processes.
#[derive(Debug)]
pub struct ExternalBridge {
    threads: Vec<JoinHandle<Result<(), MissionError>>>,
    stop: Arc<AtomicBool>,
    /// Slots of the bridge, each with `true` once its thread has detected the end of its process.
    vacant: Vec<(usize, Arc<AtomicBool>)>,
    /// Topics of the two events, which exist as long as the bridge.
    events: Vec<TopicHolder>,
}

impl ExternalBridge {
    /// Assigns a slot to every external process among these. Must be called before they are started.
    ///
    /// # Errors
    /// [`MissionError`] if the events cannot be created.
    pub fn start(
        launches: &[Launch],
        bus: &Bus,
        barrier: &Arc<TickBarrier>,
    ) -> Result<Self, MissionError> {
        let stop = Arc::new(AtomicBool::new(false));
        let external: Vec<&ProcessConfig> = launches
            .iter()
            .filter(|launch| matches!(launch.executable(), Executable::Command { .. }))
            .map(|launch| &launch.config)
            .collect();
        let mut bridge = Self {
            threads: Vec::new(),
            stop,
            vacant: Vec::new(),
            events: Vec::new(),
        };
        if external.is_empty() {
            return Ok(bridge);
        }
        bridge.events = vec![bus.create_event(TURN_EVENT)?, bus.create_event(DONE_EVENT)?];
        let options = *bus.options();
        for config in external {
            let (space, barrier, stop) = (
                config.run.space()?,
                Arc::clone(barrier),
                Arc::clone(&bridge.stop),
            );
            let config = config.clone();
            let vacant = Arc::new(AtomicBool::new(false));
            bridge
                .vacant
                .push((config.index as usize, Arc::clone(&vacant)));
            let (tell, opened) = std::sync::mpsc::channel();
            let thread = std::thread::Builder::new()
                .name(format!("bridge-{}", config.index))
                .spawn(move || {
                    // Ports belong to the thread that opens them.
                    let bus = Bus::join(&space, options, "bridge")?;
                    let member = ExternalMember::open(&config, &bus, barrier, stop, vacant)?;
                    let _ = tell.send(());
                    member.serve()
                })
                .map_err(|source| MissionError::System {
                    what: "cannot start a bridge's thread".into(),
                    source,
                })?;
            bridge.threads.push(thread);
            // The listener must exist before its process can notify.
            let _ = opened.recv();
        }
        Ok(bridge)
    }

    /// Returns `true` if no thread waits for the process of a slot, so that a successor can be started; always
    /// `true` for slots outside the bridge.
    pub fn is_vacant(&self, slot: usize) -> bool {
        let mut members = self.vacant.iter();
        members
            .find(|(member, _)| *member == slot)
            .is_none_or(|(_, vacant)| vacant.load(Ordering::SeqCst))
    }

    /// Ends all threads; the run must have reached [`Phase::Stop`].
    ///
    /// # Errors
    /// The first failure of a thread.
    pub fn finish(self) -> Result<(), MissionError> {
        self.stop.store(true, Ordering::SeqCst);
        let mut first = Ok(());
        for thread in self.threads {
            if let Ok(Err(error)) = thread.join()
                && first.is_ok()
            {
                first = Err(error);
            }
        }
        drop(self.events);
        first
    }
}

/// Place of one external process at the barrier.
struct ExternalMember {
    member: BarrierMember,
    barrier: Arc<TickBarrier>,
    index: usize,
    turn: Notifier,
    done: Listener,
    clock: Clock,
    tick_period: f64,
    stop: Arc<AtomicBool>,
    vacant: Arc<AtomicBool>,
}

impl ExternalMember {
    fn open(
        config: &ProcessConfig,
        bus: &Bus,
        barrier: Arc<TickBarrier>,
        stop: Arc<AtomicBool>,
        vacant: Arc<AtomicBool>,
    ) -> Result<Self, MissionError> {
        let index = config.index as usize;
        let upstream = config.upstream.iter().map(|&u| u as usize).collect();
        Ok(Self {
            member: BarrierMember::new(Arc::clone(&barrier), index, upstream),
            barrier,
            index,
            turn: bus.notifier(TURN_EVENT)?,
            done: bus.listener(DONE_EVENT)?,
            clock: config.run.clock,
            tick_period: config.run.tick_period(),
            stop,
            vacant,
        })
    }

    /// Returns `true` if the process of this slot is dead.
    fn is_dead(&self) -> bool {
        self.barrier.state(self.index) == SlotState::Dead
    }

    fn stopping(&self) -> bool {
        self.stop.load(Ordering::SeqCst) || self.barrier.phase() == Phase::Stop
    }

    /// Waits for the process's answer. Returns `false` if the run stops first.
    fn answered(&self) -> Result<bool, MissionError> {
        loop {
            let mut answered = false;
            self.done
                .wait(POLL_INTERVAL, |id| answered |= id == self.index)?;
            if answered {
                return Ok(true);
            }
            if self.stopping() || self.is_dead() {
                return Ok(false);
            }
        }
    }

    fn serve(self) -> Result<(), MissionError> {
        let mut result = self.take_turns();
        while result.is_ok() && self.wait_for_successor()? {
            result = self.take_turns();
        }
        // If the process has ended, the event has no listener.
        let _ = self.turn.notify(self.index + END_OF_TURNS);
        result
    }

    /// Waits for the successor of a process that has ended. Returns `false` if the run stops.
    fn wait_for_successor(&self) -> Result<bool, MissionError> {
        // Answers of the predecessor must not count for turns of the successor.
        self.done.wait(DRAIN, |_| {})?;
        self.vacant.store(true, Ordering::SeqCst);
        loop {
            if self.stopping() {
                return Ok(false);
            }
            if self.barrier.state(self.index) == SlotState::Starting {
                self.vacant.store(false, Ordering::SeqCst);
                return Ok(true);
            }
            // Its first answer stays at the listener.
            std::thread::park_timeout(SUCCESSOR_POLL_INTERVAL);
        }
    }

    fn take_turns(&self) -> Result<(), MissionError> {
        let joins_late = self.member.joins_late();
        if !self.answered()? {
            return Ok(());
        }
        self.member.set_state(SlotState::Ready);
        if !self
            .member
            .wait_for_phase(Phase::Connect, || !self.stopping())
        {
            return Ok(());
        }
        self.turn.notify(self.index)?;
        if !self.answered()? {
            return Ok(());
        }
        let on = || !self.stopping() && !self.is_dead();
        if joins_late && !self.member.join(on) {
            return Ok(());
        }
        self.member.set_state(SlotState::Connected);
        // The process does all its preparation in its first turn.
        if self
            .member
            .wait_for_phase(Phase::Prepare, || !self.stopping())
        {
            self.member.set_state(SlotState::Prepared);
        }
        let mut next = if joins_late {
            self.member.ticks_posted()
        } else {
            0
        };
        loop {
            if self.is_dead() {
                return Ok(());
            }
            let turn = match self.clock {
                Clock::LockStep => self.member.wait_tick(next),
                Clock::RealTime { factor, .. } => {
                    let patience = (self.tick_period / factor.max(1e-3) * 0.5).min(1.0);
                    self.member
                        .wait_newest(next, Duration::from_secs_f64(patience))
                }
            };
            match turn {
                TickWait::Stop => return Ok(()),
                TickWait::Idle if self.stopping() => return Ok(()),
                TickWait::Idle => {}
                TickWait::Tick(tick) => {
                    self.turn.notify(self.index)?;
                    if !self.answered()? {
                        return Ok(());
                    }
                    self.member.done(tick);
                    next = tick + 1;
                }
            }
        }
    }
}
