//! One real process, with the test in place of all others: the rig creates the services and the tick barrier
//! as the orchestrator does, and sends what the other processes would.

use std::io::Read as _;
use std::os::fd::OwnedFd;
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Instant;

use ipc_types::bus::{
    Bus, BusError, Publisher, PublisherOptions, RunSpace, Subscriber, TopicHolder,
};
use ipc_types::messages::process::ProcessStatus;
use ipc_types::messages::world::{RobotState, WorldHeader};
use ipc_types::stamp::Stamp;
use ipc_types::topics::{
    OptimiserPlan, Status, Topic, TopicVisitor, WorldMap, WorldShapes, WorldState, for_each_topic,
};
use mission::plan::Plan;
use runtime::declaration::Input;
use runtime::lockstep::{BarrierLeader, BarrierMonitor, Phase, SlotState, TickBarrier, TickEnd};
use rustix::process::{Pid, PidfdFlags, Signal};
use scenario::ResolvedScenario;

use super::call::wait;
use super::{PROTEAN, SOON, until};

/// The bus, the barrier and one process; everything goes when it is dropped.
pub struct Rig {
    pub scenario: ResolvedScenario,
    pub plan: Plan,
    pub monitor: BarrierMonitor,
    pub bus: Bus,
    pub process: Process,
    status: Subscriber<Status>,
    newest: std::cell::Cell<ProcessStatus>,
    slot: usize,
    _services: Vec<TopicHolder>,
    space: Wiped,
    // Dropped last: it contains the root of the run.
    _directory: tempfile::TempDir,
}

/// The shared memory of a run, removed on drop: also if a rig fails half-built.
struct Wiped(RunSpace);

impl Drop for Wiped {
    fn drop(&mut self) {
        if let Err(error) = self.0.wipe() {
            eprintln!("{}: cannot be removed: {error}", self.0.root().display());
        }
    }
}

/// A process of the real program.
pub struct Process {
    child: Child,
    pidfd: OwnedFd,
    /// While it is open, the process has a parent.
    pub stdin: Option<ChildStdin>,
}

struct Create<'a>(&'a Bus, Vec<TopicHolder>);

impl TopicVisitor for Create<'_> {
    type Error = BusError;
    fn visit<T: Topic>(&mut self) -> Result<(), BusError> {
        self.1.push(self.0.create::<T>()?);
        Ok(())
    }
}

impl Rig {
    /// Starts the process with this name of a scenario (`simulator` for the simulator).
    pub fn new(text: &str, name: &str) -> Self {
        static RUNS: AtomicU32 = AtomicU32::new(0);
        let directory = tempfile::Builder::new()
            .prefix("pt")
            .tempdir_in("/tmp")
            .unwrap();
        let file = directory.path().join("scenario.toml");
        std::fs::write(&file, text).unwrap();
        let scenario = match kinds::load(file.to_str().unwrap(), &[], None) {
            Ok(scenario) => scenario,
            Err(problems) => panic!("{problems}"),
        };
        let run = RUNS.fetch_add(1, Ordering::Relaxed);
        let prefix = format!("protean_test_{}_{run}_", std::process::id());
        let wiped = Wiped(RunSpace::new(directory.path().join("r"), prefix).unwrap());
        let space = &wiped.0;
        space.create_root().unwrap();
        let mut plan = Plan::new(&scenario, "warn").unwrap();
        let ticks = plan.run.recorder_ticks as usize;
        plan.place(space, ticks);
        let bus = Bus::join(space, plan.run.bus_options(), "test").unwrap();
        let mut create = Create(&bus, Vec::new());
        for_each_topic(&mut create).unwrap();
        let mut services = create.1;
        if plan.serves_plans() {
            services.extend(bus.create_service::<OptimiserPlan>().unwrap());
        }
        let barrier = TickBarrier::create(space.prefix(), plan.launches.len()).unwrap();
        let monitor = BarrierMonitor::new(Arc::new(barrier));
        let slot = plan
            .launches
            .iter()
            .position(|l| l.config.name == name)
            .unwrap();
        monitor.assign_slot(slot, slot != 0, plan.launches[slot].is_awaited());
        let config = space.root().join("process.json");
        let launch = &plan.launches[slot];
        std::fs::write(&config, serde_json::to_vec(launch).unwrap()).unwrap();
        let process = Process::spawn(
            Command::new(PROTEAN)
                .args(["process", &launch.config.kind, "--config"])
                .arg(&config),
        );
        let status = bus.subscriber().unwrap();
        Self {
            process,
            scenario,
            plan,
            monitor,
            bus,
            status,
            newest: std::cell::Cell::new(ProcessStatus::default()),
            slot,
            _services: services,
            space: wiped,
            _directory: directory,
        }
    }

    /// A port on which the test speaks as the process with this index.
    pub fn publisher<T: Topic>(&self, source: u32, capacity: usize) -> Publisher<T> {
        self.bus
            .publisher(PublisherOptions::new(source, capacity))
            .unwrap()
    }

    pub fn subscriber<T: Topic>(&self) -> Subscriber<T> {
        self.bus.subscriber().unwrap()
    }

    pub fn barrier(&self) -> &TickBarrier {
        self.monitor.barrier()
    }

    /// A mapping of the barrier of one's own.
    pub fn open_page(&self) -> Arc<TickBarrier> {
        Arc::new(TickBarrier::open(self.space.0.prefix()).unwrap())
    }

    /// Waits until the process is this far.
    #[track_caller]
    pub fn wait_for(&mut self, state: SlotState) {
        let deadline = Instant::now() + SOON;
        while self.barrier().state(self.slot) != state {
            if let Some(status) = self.process.child.try_wait().unwrap() {
                panic!("{status}: {}", self.process.words());
            }
            assert!(
                Instant::now() < deadline,
                "{:?}",
                self.barrier().state(self.slot)
            );
            std::thread::park_timeout(std::time::Duration::from_millis(1));
        }
    }

    /// The hand-shake up to the map. All ports of the test must be open.
    #[track_caller]
    pub fn take_off(&mut self) {
        self.wait_for(SlotState::Ready);
        self.monitor.set_phase(Phase::Connect);
        self.wait_for(SlotState::Connected);
        self.status.update_connections().unwrap();
    }

    /// The hand-shake from the map to the first tick.
    #[track_caller]
    pub fn prepare(&mut self) {
        self.monitor.set_phase(Phase::Prepare);
        self.wait_for(SlotState::Prepared);
    }

    /// The newest heartbeat.
    pub fn status(&self) -> ProcessStatus {
        while let Some(message) = self.status.receive().unwrap() {
            self.newest.set(message.elements()[0]);
        }
        self.newest.get()
    }

    /// Waits until the process reports exactly this many rejected messages.
    #[track_caller]
    pub fn rejected(&self, messages: u64) {
        let told = until("the count of rejected messages", SOON, || {
            let told = self.status().rejected;
            (told >= messages).then_some(told)
        });
        assert_eq!(told, messages);
    }

    /// State of the process in its slot.
    pub fn state(&self) -> SlotState {
        self.barrier().state(self.slot)
    }
}

impl Process {
    fn spawn(command: &mut Command) -> Self {
        let mut child = command
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let pid = Pid::from_child(&child);
        let pidfd = rustix::process::pidfd_open(pid, PidfdFlags::empty()).unwrap();
        let stdin = child.stdin.take();
        Self {
            child,
            pidfd,
            stdin,
        }
    }

    pub fn signal(&self, signal: Signal) {
        rustix::process::pidfd_send_signal(&self.pidfd, signal).unwrap();
    }

    pub fn is_alive(&mut self) -> bool {
        self.child.try_wait().unwrap().is_none()
    }

    /// Waits for its end; returns how it ended and what it wrote to stderr.
    #[track_caller]
    pub fn end(&mut self) -> (ExitStatus, String) {
        assert!(wait(&self.pidfd, Instant::now() + SOON), "it does not end");
        let status = self.child.wait().unwrap();
        (status, self.words())
    }

    fn words(&mut self) -> String {
        let mut text = String::new();
        if let Some(mut stderr) = self.child.stderr.take() {
            let _ = stderr.read_to_string(&mut text);
        }
        text
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The test in the place of the simulator.
pub struct World {
    pub states: Publisher<WorldState>,
    pub maps: Publisher<WorldMap>,
    pub shapes: Publisher<WorldShapes>,
    leader: BarrierLeader,
    /// The robots of the next state.
    pub robots: Vec<RobotState>,
    period_ns: u64,
    cells: usize,
}

impl World {
    /// Its ports; to be opened before [`Rig::take_off`].
    pub fn open(rig: &Rig) -> Self {
        let robots: Vec<RobotState> = rig
            .plan
            .run
            .robots
            .iter()
            .enumerate()
            .map(|(index, robot)| RobotState {
                x: robot.start.x,
                y: robot.start.y,
                theta: robot.start.theta,
                robot: index as u32,
                team: robot.role.code(),
                present: 1,
                ..RobotState::default()
            })
            .collect();
        let cells = rig.plan.run.capacity(Input::MAP.flow).unwrap();
        Self {
            // Room for one robot too many.
            states: rig.publisher(0, robots.len() + 1),
            maps: rig.publisher(0, cells),
            shapes: rig.publisher(0, 4096),
            leader: BarrierLeader::new(rig.open_page(), 0, 1 << 20),
            robots,
            period_ns: rig.plan.run.tick_period_ns,
            cells,
        }
    }

    /// Connects, has `maps` sent, and lets time begin.
    #[track_caller]
    pub fn begin(&self, rig: &mut Rig, maps: impl FnOnce(&Self, &Rig)) {
        self.states.update_connections().unwrap();
        self.maps.update_connections().unwrap();
        self.shapes.update_connections().unwrap();
        maps(self, rig);
        rig.prepare();
        rig.monitor.set_phase(Phase::Run);
    }

    pub fn header(&self, tick: u64) -> WorldHeader {
        WorldHeader {
            stamp: self.stamp(tick),
            tick_period_ns: self.period_ns,
            map_revision: 1,
            phase: WorldHeader::RUNNING,
        }
    }

    pub fn stamp(&self, tick: u64) -> Stamp {
        Stamp {
            tick,
            time_ns: tick * self.period_ns,
            origin_ns: ipc_types::clock::monotonic_ns(),
            ..Stamp::default()
        }
    }

    /// Publishes the map of the scenario, changed by `change` at will, and its pieces.
    pub fn send_map(
        &self,
        rig: &Rig,
        change: impl FnOnce(
            &mut ipc_types::messages::world::MapHeader,
            &mut Vec<ipc_types::messages::world::MapCell>,
        ),
    ) {
        let map = geometry::map::WorldMap::new(&rig.scenario.world.map).unwrap();
        let sigma = rig.scenario.blur_sigma;
        let (mut header, mut cells) =
            simulator::outputs::map_message(&map, sigma, self.stamp(0)).unwrap();
        assert_eq!(cells.len(), self.cells);
        change(&mut header, &mut cells);
        self.maps.send(header, &cells).unwrap();
        let capacity = self.shapes.capacity();
        let (header, points) =
            runtime::shapes::to_message(map.shapes(), header.revision, header.stamp, capacity);
        self.shapes.send(header, &points).unwrap();
    }

    /// Publishes these robots as the state of a tick.
    pub fn send(&self, tick: u64, robots: &[RobotState]) {
        self.states.send(self.header(tick), robots).unwrap();
    }

    /// Posts a tick and waits until all members have done it; `false` if the process ended instead.
    #[track_caller]
    pub fn turn(&self, rig: &Rig, tick: u64) -> bool {
        self.leader.post(tick);
        let deadline = Instant::now() + SOON;
        loop {
            match self.leader.wait(tick) {
                TickEnd::Complete => return true,
                TickEnd::Idle if !rig.state().is_alive() => return false,
                TickEnd::Stop => panic!("the run was stopped"),
                TickEnd::Idle => assert!(Instant::now() < deadline, "no answer to tick {tick}"),
            }
        }
    }

    /// One ordinary tick: the state, and the turn.
    #[track_caller]
    pub fn tick(&self, rig: &Rig, tick: u64) {
        self.send(tick, &self.robots);
        assert!(self.turn(rig, tick), "the process ended in tick {tick}");
    }
}
