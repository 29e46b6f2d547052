//! Tests of recording from shared memory.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use ipc_types::bus::{Bus, BusOptions, PublisherOptions, RunSpace};
use ipc_types::topics::{
    Belief, Commands, RunSize, Topic, TopicVisitor, WorldState, for_each_topic,
};

use mcap_log::LogOptions;

use super::made_up::{FIRST_ROBOT, PERCEPTION, ROBOTS, SIMULATOR, Sent, recording, run};
use crate::{Recorder, Wakeup};

/// A run space that is removed at the end of the test, also on a panic.
struct Space(RunSpace, tempfile::TempDir);

impl Drop for Space {
    fn drop(&mut self) {
        let _ = self.0.wipe();
    }
}

struct Create<'a>(&'a Bus, Vec<ipc_types::bus::TopicHolder>);

impl TopicVisitor for Create<'_> {
    type Error = ipc_types::bus::BusError;
    fn visit<T: Topic>(&mut self) -> Result<(), Self::Error> {
        self.1.push(self.0.create::<T>()?);
        Ok(())
    }
}

/// The time mode of a run.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Clock {
    LockStep,
    RealTime,
}

/// A wakeup between two threads; 0 means "no tick yet".
struct Turns {
    clock: Clock,
    completed: AtomicU64,
    /// Completed ticks when the recorder began to take messages.
    taken: AtomicU64,
    recorded: AtomicU64,
    ended: AtomicBool,
}

impl Wakeup for Turns {
    fn wait(&self, timeout: Duration) {
        if self.clock == Clock::RealTime {
            // Later ticks may have been sent since.
            let taken = self.taken.load(Ordering::Acquire);
            self.recorded.store(taken, Ordering::Release);
        }
        std::thread::sleep(timeout.min(Duration::from_millis(1)));
    }
    fn completed_tick(&self) -> Option<u64> {
        let completed = self.completed.load(Ordering::Acquire);
        self.taken.store(completed, Ordering::Release);
        completed
            .checked_sub(1)
            .filter(|_| self.clock == Clock::LockStep)
    }
    fn recorded(&self, tick: u64) {
        self.recorded.store(tick + 1, Ordering::Release);
    }
    fn ended(&self) -> bool {
        self.ended.load(Ordering::Acquire)
    }
}

const TICKS: u64 = 60;
const RECORDER_TICKS: u64 = 8;

fn record(clock: Clock, name: &str) -> crate::Summary {
    let directory = tempfile::Builder::new()
        .prefix("pt")
        .tempdir_in("/tmp")
        .unwrap();
    let prefix = format!("ptr_{}_{name}_", std::process::id());
    let root = directory.path().join("r");
    let space = Space(RunSpace::new(root, prefix).unwrap(), directory);
    space.0.create_root().unwrap();
    let bus_options = BusOptions {
        size: RunSize {
            robots: ROBOTS as usize,
            processes: 6,
            events: 1,
        },
        recorder_ticks: RECORDER_TICKS as usize,
        overflow: clock == Clock::RealTime,
    };
    let holder = Bus::join(&space.0, bus_options, "holder").unwrap();
    let mut services = Create(&holder, Vec::new());
    for_each_topic(&mut services).unwrap();
    let turns = Turns {
        clock,
        completed: AtomicU64::new(0),
        taken: AtomicU64::new(0),
        recorded: AtomicU64::new(0),
        ended: AtomicBool::new(false),
    };
    let recording = recording(
        &space.1.path().join("run.mcap"),
        &LogOptions::default(),
        None,
    );
    let (ready, opened) = std::sync::mpsc::channel();
    let (connected, go) = std::sync::mpsc::channel();
    std::thread::scope(|scope| {
        let (space, turns) = (&space.0, &turns);
        let thread = scope.spawn(move || {
            let bus = Bus::join(space, bus_options, "recorder").unwrap();
            let recorder = Recorder::open(&bus, recording).unwrap();
            ready.send(()).unwrap();
            go.recv().unwrap();
            recorder.update_connections().unwrap();
            recorder.run(turns, &mut ()).unwrap()
        });
        opened.recv().unwrap();
        let bus = Bus::join(space, bus_options, "processes").unwrap();
        let publisher = |source, capacity| PublisherOptions::new(source, capacity);
        let states = bus
            .publisher::<WorldState>(publisher(SIMULATOR, 3))
            .unwrap();
        let beliefs = bus.publisher::<Belief>(publisher(PERCEPTION, 40)).unwrap();
        let commands: Vec<_> = (0..ROBOTS)
            .map(|robot| {
                bus.publisher::<Commands>(publisher(FIRST_ROBOT + robot, 1))
                    .unwrap()
            })
            .collect();
        states.update_connections().unwrap();
        beliefs.update_connections().unwrap();
        for publisher in &commands {
            publisher.update_connections().unwrap();
        }
        connected.send(()).unwrap();
        for sent in run(TICKS, 1) {
            let tick = sent.stamp().tick;
            match &sent {
                Sent::State(header, robots) => {
                    // All messages of the previous tick have been sent; wait while the recorder lags too far
                    // behind.
                    turns.completed.store(tick, Ordering::Release);
                    let behind =
                        || tick > turns.recorded.load(Ordering::Acquire) + RECORDER_TICKS / 2;
                    while behind() {
                        std::thread::sleep(Duration::from_micros(100));
                    }
                    states.send(*header, robots).unwrap();
                }
                Sent::Belief(header, particles) => {
                    beliefs.send(*header, particles).unwrap();
                }
                Sent::Command(header, command) => {
                    let robot = command[0].robot as usize;
                    commands[robot].send(*header, command).unwrap();
                }
                _ => {}
            }
        }
        turns.completed.store(TICKS, Ordering::Release);
        turns.ended.store(true, Ordering::Release);
        thread.join().unwrap()
    })
}

fn check(summary: &crate::Summary) {
    assert_eq!(summary.ticks, TICKS - 1);
    for (topic, messages) in [
        (WorldState::NAME, TICKS),
        (Belief::NAME, TICKS),
        (Commands::NAME, TICKS * u64::from(ROBOTS)),
    ] {
        let count = summary.topics[topic];
        assert_eq!(
            (count.messages, count.gaps, count.rejected),
            (messages, 0, 0),
            "{topic}"
        );
    }
}

#[test]
fn no_message_is_lost_and_two_runs_give_the_same_log() {
    let first = record(Clock::LockStep, "a");
    let second = record(Clock::LockStep, "b");
    check(&first);
    check(&second);
    assert_eq!(first.digest, second.digest);
}

#[test]
fn in_real_time_processes_do_not_wait_for_the_log_and_it_is_complete() {
    check(&record(Clock::RealTime, "c"));
}
