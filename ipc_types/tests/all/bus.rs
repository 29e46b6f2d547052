//! The bus between processes, with two nodes in one process: behaviour that the bus in memory does
//! not have.

use std::time::Duration;

use ipc_types::bus::{Bus, PublisherOptions, SendError};
use ipc_types::messages::world::{RobotState, WorldHeader};
use ipc_types::topics::{self, Commands, OptimiserPlan, Topic, TopicVisitor, WorldState};

use crate::support::{OtherCommands, Space, options};

/// A run space, with one process in it.
fn joined(name: &str) -> (Space, Bus) {
    let space = Space::new(name);
    space.0.create_root().unwrap();
    let bus = Bus::join(&space.0, options(false), "process").unwrap();
    (space, bus)
}

#[test]
fn messages_carry_the_clock_of_their_sending() {
    let (_space, bus) = joined("clocks");
    let _service = bus.create::<WorldState>().unwrap();
    let port = PublisherOptions::new(7, 2);
    let publisher = bus.publisher::<WorldState>(port).unwrap();
    let subscriber = bus.subscriber::<WorldState>().unwrap();
    publisher.update_connections().unwrap();
    let mut last = ipc_types::clock::monotonic_ns();
    for _ in 0..3 {
        let robots = [RobotState::default(); 2];
        publisher.send(WorldHeader::default(), &robots).unwrap();
        let message = subscriber.receive().unwrap().expect("one per sending");
        let sent = message.header().stamp.sent_ns;
        assert!(sent > last && sent <= ipc_types::clock::monotonic_ns());
        assert_eq!(message.header().stamp.begun_ns, 0, "no turn has begun");
        assert!((last..=sent).contains(&message.header().stamp.computed_ns));
        last = sent;
    }
    bus.begin_turn();
    publisher.send(WorldHeader::default(), &[]).unwrap();
    let stamp = subscriber.receive().unwrap().unwrap().header().stamp;
    assert!(stamp.begun_ns >= last && stamp.begun_ns <= stamp.computed_ns);
}

/// The clock is read before writing where writing takes time: many elements, or elements that are
/// created one by one.
#[test]
fn the_clock_of_the_content_is_that_of_the_sending_only_where_little_is_copied() {
    let (_space, bus) = joined("content");
    let _service = bus.create::<WorldState>().unwrap();
    let publisher = bus
        .publisher::<WorldState>(PublisherOptions::new(7, 100))
        .unwrap();
    let subscriber = bus.subscriber::<WorldState>().unwrap();
    publisher.update_connections().unwrap();
    let stamp = || subscriber.receive().unwrap().unwrap().header().stamp;
    let robots = [RobotState::default(); 100];
    assert!(size_of_val(&robots[..1]) <= 1024 && size_of_val(&robots) > 1024);
    publisher
        .send(WorldHeader::default(), &robots[..1])
        .unwrap();
    let little = stamp();
    assert_eq!(little.computed_ns, little.sent_ns);
    publisher.send(WorldHeader::default(), &robots).unwrap();
    let much = stamp();
    assert!(much.computed_ns < much.sent_ns, "{much:?}");
    let mut made = 0;
    let make = |_| {
        made = ipc_types::clock::monotonic_ns();
        RobotState::default()
    };
    publisher
        .send_with(WorldHeader::default(), 1, make)
        .unwrap();
    let with = stamp();
    assert!(with.computed_ns <= made && made <= with.sent_ns, "{with:?}");
}

#[test]
fn a_message_sent_in_place_is_the_content_of_the_memory() {
    let (_space, bus) = joined("in_place");
    let _service = bus.create::<WorldState>().unwrap();
    let port = PublisherOptions::new(7, 2);
    let publisher = bus.publisher::<WorldState>(port).unwrap();
    let subscriber = bus.subscriber::<WorldState>().unwrap();
    publisher.update_connections().unwrap();
    let mut places = std::collections::BTreeMap::new();
    for round in 0..64_u32 {
        let mut seen = None;
        publisher
            .send_in_place(WorldHeader::default(), 2, |robots| {
                // Only one robot is written: the other is zeros, or an earlier message.
                robots[0].robot = round;
                seen = Some((robots.as_ptr().addr(), robots[1].robot));
                robots[1].robot = 1000 + round;
            })
            .unwrap();
        let message = subscriber.receive().unwrap().expect("one per sending");
        let robots = message.elements();
        assert_eq!((robots[0].robot, robots[1].robot), (round, 1000 + round));
        let (place, before) = seen.unwrap();
        let expected = places.insert(place, 1000 + round).unwrap_or(0);
        assert_eq!(before, expected, "it was neither copied nor cleared");
    }
    assert!(places.len() < 64, "memory is used again");
    let error = publisher.send_in_place(WorldHeader::default(), 3, |_| {});
    assert!(
        matches!(error, Err(SendError::Capacity { .. })),
        "{error:?}"
    );
}

#[test]
fn a_port_that_cannot_connect_is_refused() {
    let (space, bus) = joined("unconnected");
    let _service = bus.create::<WorldState>().unwrap();
    let _publisher = bus
        .publisher::<WorldState>(PublisherOptions::new(7, 2))
        .unwrap();
    let memory = std::fs::read_dir("/dev/shm").unwrap().flatten();
    let memory = memory.map(|entry| entry.path()).find(|path| {
        let name = path.file_name().unwrap().to_string_lossy();
        name.starts_with(space.0.prefix()) && name.ends_with(".data")
    });
    std::fs::remove_file(memory.unwrap()).unwrap();
    let error = bus.subscriber::<WorldState>().err().unwrap().to_string();
    let expected = "cannot create a subscriber of topic world/state: it cannot connect";
    assert!(error.starts_with(expected), "{error}");
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
    let (_space, bus) = joined("all");
    let mut visit = Visit(&bus, Vec::new(), Vec::new());
    topics::for_each_topic(&mut visit).unwrap();
    let mut hashes = visit.1.clone();
    hashes.sort();
    hashes.dedup();
    assert_eq!(hashes.len(), topics::NAMES.len());
}

#[test]
fn a_mismatch_names_both_sides() {
    let (_space, bus) = joined("mismatch");
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
    use ipc_types::messages::optimiser::{PlanRequest, PlanResponse, TrajectorySample};
    use ipc_types::messages::world::ShapePoint;
    let (_space, bus) = joined("request");
    let _service = bus.create_service::<OptimiserPlan>().unwrap();
    let server = bus.server::<OptimiserPlan>(7, 16).unwrap();
    let client = bus.client::<OptimiserPlan>(2, 8).unwrap();
    let request = PlanRequest {
        robot: 3,
        ..PlanRequest::default()
    };
    let pending = client.ask(request, &[ShapePoint::default(); 2]).unwrap();
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
    assert_eq!((active.header().stamp.source, header.stamp.source), (2, 7));
    let too_long = active.answer(answer, &[TrajectorySample::default(); 17]);
    assert!(matches!(too_long, Err(SendError::Capacity { .. })));
    drop(active);
    assert!(!pending.is_open());
    let too_long = client.ask(request, &[ShapePoint::default(); 9]);
    assert!(matches!(too_long, Err(SendError::Capacity { .. })));
}

#[test]
fn a_listener_wakes_by_an_event_or_a_file_whichever_comes_first() {
    use rustix::event::{EventfdFlags, eventfd};
    use std::os::fd::AsFd as _;

    let (_space, bus) = joined("either");
    let _service = bus.create_event("run/wake").unwrap();
    let listener = bus.listener("run/wake").unwrap();
    let notifier = bus.notifier("run/wake").unwrap();
    let file = eventfd(0, EventfdFlags::NONBLOCK).unwrap();
    let long = std::time::Duration::from_secs(60);
    let wait = |timeout| {
        let mut ids = Vec::new();
        listener
            .wait_or(file.as_fd(), timeout, |id| ids.push(id))
            .unwrap();
        ids
    };
    notifier.notify(3).unwrap();
    assert_eq!(wait(long), [3]);
    rustix::io::write(&file, &1u64.to_ne_bytes()).unwrap();
    assert!(wait(long).is_empty());
    let mut read = [0; 8];
    rustix::io::read(&file, &mut read).unwrap();
    assert!(wait(std::time::Duration::from_millis(1)).is_empty());
}

#[test]
fn a_listener_that_is_stopped_and_continued_has_only_waited() {
    use std::process::Command;
    use std::sync::atomic::{AtomicBool, Ordering};

    let (_space, bus) = joined("stopped");
    let _service = bus.create_event("run/wake").unwrap();
    let listener = bus.listener("run/wake").unwrap();
    let waited = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            // The test interrupts itself repeatedly until it is stopped during a wait.
            while !waited.load(Ordering::SeqCst) {
                let words = ["-c", "kill -STOP $PPID; kill -CONT $PPID"];
                assert!(Command::new("sh").args(words).status().unwrap().success());
            }
        });
        let woken = listener.wait(Duration::from_secs(60), |_| {});
        waited.store(true, Ordering::SeqCst);
        woken.unwrap();
    });
}

#[test]
fn events_wake_with_their_ids_coalesced() {
    let (_space, bus) = joined("event");
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
    let (space, bus) = joined("wipe");
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

#[test]
fn a_run_keeps_its_root_while_memory_of_it_cannot_be_removed() {
    let (space, bus) = joined("kept");
    drop(bus);
    let odd = std::path::Path::new("/dev/shm").join(format!("{}odd", space.0.prefix()));
    std::fs::create_dir(&odd).unwrap();
    assert!(space.0.wipe().is_err());
    assert!(space.0.root().exists());
    std::fs::remove_dir(&odd).unwrap();
    space.0.wipe().unwrap();
    assert!(!space.0.root().exists());
}
