//! The baseline: a minimal program on iceoryx2 and a futex page without the runtime. No checks, no
//! stamps, no heartbeat, no phases, no supervision.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crate::link::{LINE, SharedWords, raw_node, sleep_while, store_and_wake, wake};
use iceoryx2::port::publisher::Publisher;
use iceoryx2::port::subscriber::Subscriber;
use iceoryx2::prelude::{Node, ZeroCopySend, ipc};
use ipc_types::bus::RunSpace;
use ipc_types::messages::robot::Command;
use ipc_types::messages::world::{RobotState, WorldHeader};
use ipc_types::stamp::PlainHeader;
use serde::{Deserialize, Serialize};

use crate::{Failure, Result};

/// Number of planners of the exchange.
pub const PLANNERS: usize = 8;

const STATE_WORDS: usize = (size_of::<WorldHeader>() + PLANNERS * size_of::<RobotState>()) / 8;
const COMMAND_WORDS: usize = (size_of::<PlainHeader>() + size_of::<Command>()) / 8;

/// A message of the same size as `world/state` with its header for eight robots.
#[derive(Debug, Clone, Copy, ZeroCopySend)]
#[repr(C)]
struct RawState {
    /// The tick, and padding.
    words: [u64; STATE_WORDS],
}

/// A message of the same size as `robot/command` with its header.
#[derive(Debug, Clone, Copy, ZeroCopySend)]
#[repr(C)]
struct RawCommand {
    /// The tick, the planner, and padding.
    words: [u64; COMMAND_WORDS],
}

/// Index of the word for posted ticks.
const TICK: usize = 0;
/// Index of the word for answers.
const ARRIVED: usize = LINE;
/// Index of the word for the number of answers at which the barrier leader is woken.
const TARGET: usize = 2 * LINE;
/// Index of the word for planners that have opened their ports.
const READY: usize = 3 * LINE;
/// Index of the word for the stage. 1: the ports of all exist; 2: end.
const STAGE: usize = 4 * LINE;

/// Error text for a message that did not arrive.
const LOST: &str = "raw iceoryx2: a message is missing";
/// Maximum sleep between checks for the end.
const POLL_INTERVAL: Duration = Duration::from_millis(100);

/// Configuration of a raw process.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RawConfig {
    /// Root directory.
    pub root: PathBuf,
    /// Prefix in shared memory.
    pub prefix: String,
    /// Index of the planner.
    pub index: u32,
}

/// Converts an error of iceoryx2 into a failure.
fn raw<E: core::fmt::Debug>(what: &'static str) -> impl FnOnce(E) -> Failure {
    move |reason| format!("iceoryx2: cannot {what}: {reason:?}").into()
}

type Service<T> =
    iceoryx2::service::port_factory::publish_subscribe::PortFactory<ipc::Service, T, ()>;

/// Opens the service of the states; the first process creates it.
fn states(node: &Node<ipc::Service>) -> Result<Service<RawState>> {
    node.service_builder(&name("raw/state")?)
        .publish_subscribe::<RawState>()
        .max_publishers(1)
        .max_subscribers(PLANNERS)
        .subscriber_max_buffer_size(2)
        .enable_safe_overflow(false)
        .open_or_create()
        .map_err(raw("open the states"))
}

/// Opens the service of the commands; the first process creates it.
fn commands(node: &Node<ipc::Service>) -> Result<Service<RawCommand>> {
    node.service_builder(&name("raw/command")?)
        .publish_subscribe::<RawCommand>()
        .max_publishers(PLANNERS)
        .max_subscribers(1)
        .subscriber_max_buffer_size(2)
        .enable_safe_overflow(false)
        .open_or_create()
        .map_err(raw("open the commands"))
}

/// Returns the name of a service.
fn name(text: &str) -> Result<iceoryx2::prelude::ServiceName> {
    text.try_into().map_err(raw("name a service"))
}

/// Runs a raw planner to its end.
pub fn planner(config: &Path) -> ExitCode {
    match planner_with(config) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn planner_with(config: &Path) -> Result<()> {
    let config: RawConfig = serde_json::from_slice(&std::fs::read(config)?)?;
    let stop = Arc::new(AtomicBool::new(false));
    runtime::guard::watch_parent(Arc::clone(&stop))?;
    let node = raw_node(&RunSpace::new(&config.root, &config.prefix)?)?;
    let (states, commands) = (states(&node)?, commands(&node)?);
    let state_in = states
        .subscriber_builder()
        .create()
        .map_err(raw("subscribe"))?;
    let command_out = commands
        .publisher_builder()
        .create()
        .map_err(raw("publish"))?;
    let page = SharedWords::open(&config.prefix)?;
    page.word(READY).fetch_add(1, Ordering::SeqCst);
    let stage = page.word(STAGE);
    while stage.load(Ordering::SeqCst) == 0 && !stop.load(Ordering::Relaxed) {
        sleep_while(stage, 0, POLL_INTERVAL);
    }
    connect(&state_in, &command_out)?;
    page.word(READY).fetch_add(1, Ordering::SeqCst);

    let (tick, arrived, target) = (page.word(TICK), page.word(ARRIVED), page.word(TARGET));
    let mut done = 0_u32;
    while stage.load(Ordering::Relaxed) == 1 && !stop.load(Ordering::Relaxed) {
        let posted = tick.load(Ordering::SeqCst);
        if posted == done {
            sleep_while(tick, posted, POLL_INTERVAL);
            continue;
        }
        let state = state_in.receive().map_err(raw("receive"))?.ok_or(LOST)?;
        let mut command = RawCommand {
            words: [0; COMMAND_WORDS],
        };
        command.words[0] = state.words[0];
        command.words[1] = u64::from(config.index);
        let sample = command_out.loan_uninit().map_err(raw("loan a command"))?;
        sample
            .write_payload(command)
            .send()
            .map_err(raw("send a command"))?;
        drop(state);
        done = done.wrapping_add(1);
        let count = arrived.fetch_add(1, Ordering::SeqCst).wrapping_add(1);
        if count == target.load(Ordering::SeqCst) {
            wake(arrived);
        }
    }
    Ok(())
}

fn connect(
    state_in: &Subscriber<ipc::Service, RawState, ()>,
    command_out: &Publisher<ipc::Service, RawCommand, ()>,
) -> Result<()> {
    use iceoryx2::port::update_connections::UpdateConnections as _;
    state_in.update_connections().map_err(raw("connect"))?;
    command_out.update_connections().map_err(raw("connect"))
}

/// The raw barrier leader: publishes states, posts ticks, waits, receives commands.
#[derive(Debug)]
pub struct RawLeader {
    page: SharedWords,
    state_out: Publisher<ipc::Service, RawState, ()>,
    commands_in: Subscriber<ipc::Service, RawCommand, ()>,
    // This must live as long as its ports.
    _node: Node<ipc::Service>,
    tick: u32,
}

impl RawLeader {
    /// Creates page, services and ports; then the planners may start.
    pub fn create(space: &RunSpace) -> Result<Self> {
        let node = raw_node(space)?;
        let page = SharedWords::create(space.prefix())?;
        let state_out = states(&node)?
            .publisher_builder()
            .create()
            .map_err(raw("publish"))?;
        let commands_in = commands(&node)?
            .subscriber_builder()
            .create()
            .map_err(raw("subscribe"))?;
        Ok(Self {
            page,
            state_out,
            commands_in,
            _node: node,
            tick: 0,
        })
    }

    /// Returns the number of start steps that planners have reported: each reports open ports, then
    /// connected ports.
    pub fn ready_count(&self) -> usize {
        self.page.word(READY).load(Ordering::SeqCst) as usize
    }

    /// Lets the planners connect their ports, and connects those of the leader.
    pub fn connect(&self) -> Result<()> {
        use iceoryx2::port::update_connections::UpdateConnections as _;
        store_and_wake(self.page.word(STAGE), 1);
        self.state_out
            .update_connections()
            .map_err(raw("connect"))?;
        self.commands_in
            .update_connections()
            .map_err(raw("connect"))
    }

    /// Executes one tick; calls `idle` at intervals while waiting.
    pub fn tick(&mut self, mut idle: impl FnMut() -> Result<()>) -> Result<()> {
        let mut state = RawState {
            words: [0; STATE_WORDS],
        };
        state.words[0] = u64::from(self.tick);
        let sample = self.state_out.loan_uninit().map_err(raw("loan a state"))?;
        sample
            .write_payload(state)
            .send()
            .map_err(raw("send a state"))?;
        let arrived = self.page.word(ARRIVED);
        let target = (self.tick + 1).wrapping_mul(PLANNERS as u32);
        self.page.word(TARGET).store(target, Ordering::SeqCst);
        self.tick += 1;
        store_and_wake(self.page.word(TICK), self.tick);
        loop {
            let seen = arrived.load(Ordering::SeqCst);
            if seen == target {
                break;
            }
            sleep_while(arrived, seen, POLL_INTERVAL);
            if arrived.load(Ordering::SeqCst) == seen {
                idle()?;
            }
        }
        for _ in 0..PLANNERS {
            let command = self
                .commands_in
                .receive()
                .map_err(raw("receive"))?
                .ok_or(LOST)?;
            if command.words[0] != u64::from(self.tick - 1) {
                return Err(LOST.into());
            }
        }
        Ok(())
    }

    /// Ends the planners.
    pub fn stop(&self) {
        store_and_wake(self.page.word(STAGE), 2);
        wake(self.page.word(TICK));
    }
}
