//! The bus between two nodes of one process: delivery, history, isolation, mismatches, limits.

use std::time::Duration;

use ipc_types::bus::{Bus, BusOptions, PublisherOptions, RunSpace};
use ipc_types::messages::robot::Command;
use ipc_types::messages::world::{MapCell, MapHeader, RobotState, WorldHeader};
use ipc_types::stamp::PlainHeader;
use ipc_types::topics::{
    self, Commands, OptimiserPlan, RunSize, Topic, TopicVisitor, WorldMap, WorldState,
};

/// A run space of its own that is wiped when the test ends, also by a panic.
struct Space(
    RunSpace,
    #[expect(dead_code, reason = "removed when dropped")] tempfile::TempDir,
);

impl Space {
    fn new(name: &str) -> Self {
        let directory = tempfile::Builder::new()
            .prefix("pt")
            .tempdir_in("/tmp")
            .unwrap();
        let prefix = format!("pt_{}_{name}_", std::process::id());
        Self(
            RunSpace::new(directory.path().join("r"), prefix).unwrap(),
            directory,
        )
    }
}

impl Drop for Space {
    fn drop(&mut self) {
        let _ = self.0.wipe();
    }
}

fn options(overflow: bool) -> BusOptions {
    BusOptions {
        size: RunSize {
            robots: 2,
            processes: 3,
            events: 1,
        },
        recorder_ticks: 8,
        overflow,
    }
}

#[test]
fn messages_arrive_in_order_with_sequence_numbers_and_clocks() {
    let space = Space::new("order");
    space.0.create_root().unwrap();
    let holder = Bus::join(&space.0, options(false), "holder").unwrap();
    let _service = holder.create::<WorldState>().unwrap();
    let bus = Bus::join(&space.0, options(false), "process").unwrap();
    let publisher = bus
        .publisher::<WorldState>(PublisherOptions::new(7, 2))
        .unwrap();
    let subscriber = bus.subscriber::<WorldState>().unwrap();
    publisher.update_connections().unwrap();
    subscriber.update_connections().unwrap();
    for tick in 0..3 {
        let mut header = WorldHeader::default();
        header.stamp.tick = tick;
        let robots = [RobotState {
            x: tick as f64,
            ..RobotState::default()
        }; 2];
        assert_eq!(publisher.send(header, &robots).unwrap(), 1);
    }
    let mut last_clock = 0;
    for tick in 0..3 {
        let message = subscriber
            .receive()
            .unwrap()
            .expect("a message per sending");
        let stamp = message.header().stamp;
        assert_eq!((stamp.tick, stamp.sequence, stamp.source), (tick, tick, 7));
        assert!(stamp.sent_ns > last_clock);
        last_clock = stamp.sent_ns;
        assert_eq!(message.elements().len(), 2);
        assert_eq!(message.elements()[1].x, tick as f64);
    }
    assert!(subscriber.receive().unwrap().is_none());
}

#[test]
fn late_joiners_get_the_last_map() {
    let space = Space::new("late");
    space.0.create_root().unwrap();
    let bus = Bus::join(&space.0, options(false), "process").unwrap();
    let _service = bus.create::<WorldMap>().unwrap();
    let publisher = bus
        .publisher::<WorldMap>(PublisherOptions::new(0, 4))
        .unwrap();
    for revision in 1..=2 {
        let header = MapHeader {
            revision,
            ..MapHeader::default()
        };
        publisher.send(header, &[MapCell::default(); 4]).unwrap();
    }
    let subscriber = bus.subscriber::<WorldMap>().unwrap();
    publisher.update_connections().unwrap();
    assert_eq!(subscriber.receive().unwrap().unwrap().header().revision, 2);
}

#[test]
fn runs_do_not_see_each_other() {
    let (a, b) = (Space::new("a"), Space::new("b"));
    a.0.create_root().unwrap();
    b.0.create_root().unwrap();
    let bus_a = Bus::join(&a.0, options(false), "a").unwrap();
    let _service = bus_a.create::<Commands>().unwrap();
    let bus_b = Bus::join(&b.0, options(false), "b").unwrap();
    let error = bus_b.subscriber::<Commands>().unwrap_err().to_string();
    assert!(
        error.contains("robot/command") && error.contains("no such service"),
        "{error}"
    );
    assert!(
        error.contains(b.0.prefix()),
        "names the run that was searched: {error}"
    );
}

#[test]
fn oversized_messages_are_refused_before_anything_is_sent() {
    let space = Space::new("size");
    space.0.create_root().unwrap();
    let bus = Bus::join(&space.0, options(false), "process").unwrap();
    let _service = bus.create::<Commands>().unwrap();
    let publisher = bus
        .publisher::<Commands>(PublisherOptions::new(0, 1))
        .unwrap();
    let error = publisher
        .send(PlainHeader::default(), &[Command::default(); 2])
        .unwrap_err()
        .to_string();
    assert!(
        error.contains('2') && error.contains("capacity of 1"),
        "{error}"
    );
}

#[test]
fn a_full_receiver_blocks_the_sender_no_longer_than_its_patience() {
    let space = Space::new("full");
    space.0.create_root().unwrap();
    let bus = Bus::join(&space.0, options(false), "process").unwrap();
    let _service = bus.create::<Commands>().unwrap();
    let patience = Duration::from_millis(30);
    let publisher = bus
        .publisher::<Commands>(PublisherOptions {
            patience,
            ..PublisherOptions::new(0, 1)
        })
        .unwrap();
    let _subscriber = bus.subscriber::<Commands>().unwrap();
    publisher.update_connections().unwrap();
    let error = (0..1000)
        .find_map(|_| {
            publisher
                .send(PlainHeader::default(), &[Command::default()])
                .err()
        })
        .expect("nobody takes the messages");
    assert!(
        error.to_string().contains("did not take its messages"),
        "{error}"
    );
}

#[test]
fn with_overflow_the_newest_messages_win() {
    let space = Space::new("overflow");
    space.0.create_root().unwrap();
    let bus = Bus::join(&space.0, options(true), "process").unwrap();
    let _service = bus.create::<Commands>().unwrap();
    let publisher = bus
        .publisher::<Commands>(PublisherOptions::new(0, 1))
        .unwrap();
    let subscriber = bus.subscriber::<Commands>().unwrap();
    publisher.update_connections().unwrap();
    for _ in 0..1000 {
        publisher
            .send(PlainHeader::default(), &[Command::default()])
            .unwrap();
    }
    let mut sequences = Vec::new();
    while let Some(message) = subscriber.receive().unwrap() {
        sequences.push(message.header().stamp.sequence);
    }
    assert_eq!(sequences.last(), Some(&999));
    assert!(
        sequences.windows(2).all(|w| w[1] == w[0] + 1),
        "{sequences:?}"
    );
}

#[test]
fn every_topic_can_be_created_and_opened_and_its_schema_is_its_own() {
    struct Visit<'a>(&'a Bus, Vec<String>, Vec<Box<dyn core::any::Any>>);
    impl TopicVisitor for Visit<'_> {
        type Error = ipc_types::bus::BusError;
        fn visit<T: Topic>(&mut self) -> Result<(), Self::Error> {
            self.2.push(Box::new(self.0.create::<T>()?));
            self.2.push(Box::new(
                self.0.publisher::<T>(PublisherOptions::new(0, 4))?,
            ));
            self.2.push(Box::new(self.0.subscriber::<T>()?));
            self.2.push(Box::new(self.0.recorder::<T>()?));
            self.1.push(ipc_types::schema::hash::<T>());
            Ok(())
        }
    }
    let space = Space::new("all");
    space.0.create_root().unwrap();
    let bus = Bus::join(&space.0, options(false), "process").unwrap();
    let mut visit = Visit(&bus, Vec::new(), Vec::new());
    topics::for_each_topic(&mut visit).unwrap();
    let mut hashes = visit.1.clone();
    hashes.sort();
    hashes.dedup();
    assert_eq!(hashes.len(), topics::NAMES.len());
}

#[test]
fn a_mismatch_names_both_sides() {
    /// The same service name with another element: what a process of another build would open.
    #[derive(Debug)]
    struct OtherCommands;
    impl Topic for OtherCommands {
        const NAME: &'static str = Commands::NAME;
        const SHAPE: topics::Shape = topics::Shape::One;
        const ELEMENTS: &'static str = "command";
        const SIMULATED: bool = true;
        type Header = PlainHeader;
        type Element = RobotState;
        fn qos(size: &RunSize) -> topics::Qos {
            Commands::qos(size)
        }
    }
    let space = Space::new("mismatch");
    space.0.create_root().unwrap();
    let bus = Bus::join(&space.0, options(false), "process").unwrap();
    let _service = bus.create::<Commands>().unwrap();
    let error = bus.subscriber::<OtherCommands>().unwrap_err().to_string();
    for part in [
        "robot/command",
        "protean/RobotState",
        "protean/Command",
        "schema",
    ] {
        assert!(error.contains(part), "{part} missing in: {error}");
    }
}

#[test]
fn requests_are_answered_and_ended() {
    use ipc_types::messages::optimiser::{
        PlanRequest, PlanResponse, RequestObstacle, TrajectorySample,
    };
    let space = Space::new("request");
    space.0.create_root().unwrap();
    let bus = Bus::join(&space.0, options(false), "process").unwrap();
    let _service = bus.create_service::<OptimiserPlan>().unwrap();
    let server = bus.server::<OptimiserPlan>(16).unwrap();
    let client = bus.client::<OptimiserPlan>(8).unwrap();
    let request = PlanRequest {
        robot: 3,
        ..PlanRequest::default()
    };
    let pending = client
        .ask(request, &[RequestObstacle::default(); 2])
        .unwrap();
    assert!(pending.poll().unwrap().is_none());
    let active = server.receive().unwrap().expect("the request");
    assert!(active.is_wanted());
    assert_eq!((active.header().robot, active.elements().len()), (3, 2));
    let answer = PlanResponse {
        final_time: 1.5,
        ..PlanResponse::default()
    };
    active
        .answer(answer, &[TrajectorySample::default(); 5])
        .unwrap();
    let (header, samples) = pending.poll().unwrap().expect("the answer");
    assert_eq!((header.final_time, samples.len()), (1.5, 5));
    drop(active);
    assert!(!pending.is_open());
}

#[test]
fn events_wake_with_their_ids_coalesced() {
    let space = Space::new("event");
    space.0.create_root().unwrap();
    let bus = Bus::join(&space.0, options(false), "process").unwrap();
    let _service = bus.create_event("run/wake").unwrap();
    let listener = bus.listener("run/wake").unwrap();
    let notifier = bus.notifier("run/wake").unwrap();
    for id in [3, 3, 5] {
        assert_eq!(notifier.notify(id).unwrap(), 1);
    }
    let mut ids = Vec::new();
    listener
        .wait(Duration::from_secs(5), |id| ids.push(id))
        .unwrap();
    ids.sort_unstable();
    assert_eq!(ids, [3, 5]);
}

#[test]
fn a_wiped_space_leaves_nothing() {
    let space = Space::new("wipe");
    space.0.create_root().unwrap();
    let bus = Bus::join(&space.0, options(false), "process").unwrap();
    let service = bus.create::<WorldState>().unwrap();
    let publisher = bus
        .publisher::<WorldState>(PublisherOptions::new(0, 2))
        .unwrap();
    drop((publisher, service, bus));
    space.0.wipe().unwrap();
    assert!(!space.0.root().exists());
    let left: Vec<_> = std::fs::read_dir("/dev/shm")
        .unwrap()
        .flatten()
        .map(|e| e.file_name().to_string_lossy().into_owned())
        .filter(|name| name.starts_with(space.0.prefix()))
        .collect();
    assert!(left.is_empty(), "{left:?}");
}
