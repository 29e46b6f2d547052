//! The bus in memory: behaviour that the bus between processes does not have.

use std::sync::Arc;

use ipc_types::bus::{BusError, SendError};
use ipc_types::messages::optimiser::{PlanRequest, PlanResponse, TrajectorySample};
use ipc_types::messages::robot::{PlanHeader, PlanPoint};
use ipc_types::messages::world::{MapCell, MapHeader, RobotState, ShapePoint};
use ipc_types::topics::{Commands, OptimiserPlan, Plan, WorldMap, WorldState};
use proptest::prelude::*;

use crate::support::{OtherCommands, local, port, state};

#[test]
fn the_memory_of_messages_is_used_again() {
    let bus = local(false);
    let publisher = bus.publisher::<WorldState>(port(0, 2)).unwrap();
    let subscriber = bus.subscriber::<WorldState>().unwrap();
    let mut places = Vec::new();
    for tick in 0..100 {
        publisher
            .send(state(tick), &[RobotState::default(); 2])
            .unwrap();
        let message = subscriber.receive().unwrap().unwrap();
        places.push(message.elements().as_ptr());
    }
    places.sort_unstable();
    places.dedup();
    // One message is held by the reader, one is kept for late joiners.
    assert!(
        places.len() <= 2,
        "{} places for 100 messages",
        places.len()
    );
}

#[test]
fn a_message_that_is_held_does_not_change_under_its_reader() {
    let bus = local(false);
    let publisher = bus.publisher::<WorldState>(port(0, 1)).unwrap();
    let subscriber = bus.subscriber::<WorldState>().unwrap();
    publisher.send(state(0), &[RobotState::default()]).unwrap();
    let held = subscriber.receive().unwrap().unwrap();
    for tick in 1..4 {
        publisher.send(state(tick), &[]).unwrap();
        subscriber.receive().unwrap().unwrap();
    }
    assert_eq!(held.header().stamp.tick, 0);
    assert_eq!(held.elements().len(), 1);
}

#[test]
fn shared_elements_are_the_senders_own() {
    let bus = local(false);
    let publisher = bus.publisher::<WorldMap>(port(0, 4)).unwrap();
    let subscriber = bus.subscriber::<WorldMap>().unwrap();
    let cells: Arc<[MapCell]> = Arc::from([MapCell::default(); 4]);
    publisher.send_shared(MapHeader::default(), &cells).unwrap();
    let message = subscriber.receive().unwrap().unwrap();
    assert!(Arc::ptr_eq(&cells, &message.shared_elements()));
    assert!(message.shared().is_some_and(|s| Arc::ptr_eq(s, &cells)));
    publisher.send(MapHeader::default(), &cells).unwrap();
    let message = subscriber.receive().unwrap().unwrap();
    assert!(message.shared().is_none());
    let copy = message.shared_elements();
    assert!(!Arc::ptr_eq(&cells, &copy) && copy == cells);
}

#[test]
fn no_clock_is_read() {
    let bus = local(false);
    assert!(bus.is_local() && bus.space().is_none());
    let publisher = bus.publisher::<WorldState>(port(0, 1)).unwrap();
    let subscriber = bus.subscriber::<WorldState>().unwrap();
    publisher.send(state(0), &[]).unwrap();
    let message = subscriber.receive().unwrap().unwrap();
    assert_eq!(message.header().stamp.sent_ns, 0);
}

#[test]
fn a_message_that_is_sent_again_gets_the_next_number_and_no_times() {
    let bus = local(false);
    let publisher = bus.publisher::<WorldState>(port(0, 1)).unwrap();
    let subscriber = bus.subscriber::<WorldState>().unwrap();
    publisher.send(state(0), &[]).unwrap();
    let mut header = state(1);
    (header.stamp.sequence, header.stamp.sent_ns) = (7, 9);
    publisher.repeat(header, &[]).unwrap();
    subscriber.receive().unwrap().unwrap();
    let stamp = subscriber.receive().unwrap().unwrap().header().stamp;
    assert_eq!((stamp.tick, stamp.sequence, stamp.sent_ns), (1, 1, 0));
}

#[test]
fn features_of_processes_are_refused_by_name() {
    let bus = local(false);
    for (error, name) in [
        (
            bus.server::<OptimiserPlan>(0, 1).unwrap_err(),
            "optimiser/plan",
        ),
        (bus.create_event("run/turn").unwrap_err(), "run/turn"),
        (bus.notifier("run/turn").unwrap_err(), "run/turn"),
        (bus.listener("run/done").unwrap_err(), "run/done"),
    ] {
        assert!(
            matches!(error, BusError::NeedsProcesses { .. }) && error.to_string().contains(name),
            "{error}"
        );
    }
}

#[test]
fn requests_are_answered_at_once_while_a_server_exists() {
    let bus = local(false);
    let _service = bus.create_service::<OptimiserPlan>().unwrap();
    // The client may exist before the server.
    let client = bus.client::<OptimiserPlan>(3, 8).unwrap();
    let request = PlanRequest {
        robot: 5,
        ..PlanRequest::default()
    };
    let ask = |points: usize| client.ask(request, &vec![ShapePoint::default(); points]);
    let pending = ask(0).unwrap();
    assert!(!pending.is_open() && pending.poll().unwrap().is_none());
    let answer = |request: &PlanRequest, points: &[ShapePoint]| {
        assert_eq!(request.stamp.source, 3);
        let header = PlanResponse {
            robot: request.robot,
            final_time: request.stamp.sequence as f64,
            ..PlanResponse::default()
        };
        (header, vec![TrajectorySample::default(); points.len()])
    };
    let attendant = bus.attend::<OptimiserPlan>(answer).unwrap();
    let second = bus.attend::<OptimiserPlan>(answer).unwrap_err();
    assert!(second.to_string().contains("taken"), "{second}");
    let (first, second) = (ask(2).unwrap(), ask(4).unwrap());
    assert!(first.is_open());
    for (pending, sequence, samples) in [(second, 2.0, 4), (first, 1.0, 2)] {
        let (header, elements) = pending.poll().unwrap().expect("the answer");
        let found = (header.robot, header.final_time, elements.len());
        assert_eq!(found, (5, sequence, samples));
        assert_eq!(header.stamp.sent_ns, 0);
        assert!(!pending.is_open() && pending.poll().unwrap().is_none());
    }
    assert!(matches!(ask(9), Err(SendError::Capacity { .. })));
    drop(attendant);
    assert!(ask(1).unwrap().poll().unwrap().is_none());
    bus.attend::<OptimiserPlan>(answer).unwrap();
}

#[test]
fn another_type_under_the_same_name_is_a_mismatch() {
    let bus = local(false);
    let _service = bus.create::<Commands>().unwrap();
    let error = bus.subscriber::<OtherCommands>().unwrap_err().to_string();
    assert!(error.contains("robot/command"), "{error}");
}

proptest! {
    /// Against a model: for any order of sending and reading, every reader gets each publisher's
    /// messages whole, in order and without gaps.
    #[test]
    fn no_message_is_lost_doubled_or_changed(
        steps in prop::collection::vec((0_usize..4, 0_usize..3), 1..200),
    ) {
        let bus = local(false);
        let publishers = [1, 2].map(|source| bus.publisher::<Plan>(port(source, 8)).unwrap());
        let readers = [(); 2].map(|()| bus.recorder::<Plan>().unwrap());
        let mut sent = [0_u64; 2];
        let mut read = [[0_u64; 2]; 2];
        for (who, size) in steps {
            if let (Some(publisher), Some(sent)) = (publishers.get(who), sent.get_mut(who)) {
                let point = PlanPoint { x: *sent as f64, ..PlanPoint::default() };
                match publisher.send_with(PlanHeader::default(), size, |_| point) {
                    Ok(readers) => {
                        prop_assert_eq!(readers, 2);
                        *sent += 1;
                    }
                    Err(error) => {
                        let is_blocked = matches!(error, SendError::Blocked { .. });
                        prop_assert!(is_blocked, "{}", error);
                    }
                }
            } else if let (Some(reader), Some(read)) = (readers.get(who - 2), read.get_mut(who - 2))
                && let Some(message) = reader.receive().unwrap()
            {
                let stamp = message.header().stamp;
                let expected = &mut read[stamp.source as usize - 1];
                prop_assert_eq!(stamp.sequence, *expected);
                prop_assert!(message.elements().iter().all(|p| p.x == *expected as f64));
                *expected += 1;
            }
        }
        for (reader, read) in readers.iter().zip(&mut read) {
            while let Some(message) = reader.receive().unwrap() {
                read[message.header().stamp.source as usize - 1] += 1;
            }
            prop_assert_eq!(*read, sent);
        }
    }
}
