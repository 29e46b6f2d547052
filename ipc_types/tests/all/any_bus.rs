//! Common behaviour of the bus between processes and the bus in memory: every test on both.

use std::sync::Arc;

use ipc_types::bus::{Bus, BusError, SendError};
use ipc_types::messages::robot::{Command, PlanHeader, PlanPoint};
use ipc_types::messages::world::{MapCell, MapHeader, RobotState};
use ipc_types::stamp::PlainHeader;
use ipc_types::topics::{Commands, Plan, Topic, WorldMap, WorldState};

use crate::support::{Space, local, options, port, state};

/// Tests a behaviour on both buses.
fn on_both(name: &str, overflow: bool, behaviour: impl Fn(&Bus)) {
    behaviour(&local(overflow));
    let space = Space::new(&format!("both_{name}"));
    space.0.create_root().unwrap();
    behaviour(&Bus::join(&space.0, options(overflow), "test").unwrap());
}

#[test]
fn every_subscriber_gets_every_message_in_order_with_its_number_and_source() {
    on_both("order", false, |bus| {
        let _service = bus.create::<WorldState>().unwrap();
        let publisher = bus.publisher::<WorldState>(port(7, 2)).unwrap();
        let subscribers = [(); 3].map(|()| bus.subscriber::<WorldState>().unwrap());
        publisher.update_connections().unwrap();
        for tick in 0..3 {
            let robot = RobotState {
                x: tick as f64,
                ..RobotState::default()
            };
            assert_eq!(publisher.send(state(tick), &[robot; 2]).unwrap(), 3);
        }
        for subscriber in &subscribers {
            for tick in 0..3 {
                let message = subscriber.receive().unwrap().expect("one per sending");
                let stamp = message.header().stamp;
                assert_eq!((stamp.tick, stamp.sequence, stamp.source), (tick, tick, 7));
                assert_eq!(message.elements().len(), 2);
                assert_eq!(message.elements()[1].x, tick as f64);
            }
            assert!(subscriber.receive().unwrap().is_none());
        }
    });
}

#[test]
fn late_joiners_get_the_last_message_of_a_topic_with_history_and_nothing_of_others() {
    on_both("late", false, |bus| {
        let _services = (
            bus.create::<WorldMap>().unwrap(),
            bus.create::<Commands>().unwrap(),
        );
        let maps = bus.publisher::<WorldMap>(port(0, 4)).unwrap();
        let commands = bus.publisher::<Commands>(port(0, 1)).unwrap();
        for revision in 1..=3 {
            let header = MapHeader {
                revision,
                ..MapHeader::default()
            };
            maps.send(header, &[MapCell::default(); 4]).unwrap();
            commands
                .send(PlainHeader::default(), &[Command::default()])
                .unwrap();
        }
        let late_map = bus.subscriber::<WorldMap>().unwrap();
        let late_command = bus.subscriber::<Commands>().unwrap();
        maps.update_connections().unwrap();
        commands.update_connections().unwrap();
        assert_eq!(late_map.receive().unwrap().unwrap().header().revision, 3);
        assert!(late_map.receive().unwrap().is_none());
        assert!(late_command.receive().unwrap().is_none());
    });
}

#[test]
fn a_message_beyond_the_capacity_is_refused_in_the_same_words() {
    let words = std::cell::RefCell::new(Vec::new());
    on_both("capacity", false, |bus| {
        let _service = bus.create::<Plan>().unwrap();
        let publisher = bus.publisher::<Plan>(port(0, 2)).unwrap();
        let subscriber = bus.subscriber::<Plan>().unwrap();
        publisher.update_connections().unwrap();
        let header = PlanHeader::default();
        let point = PlanPoint::default();
        let sent = [
            publisher.send(header, &[point; 3]),
            publisher.send_with(header, 3, |_| point),
            publisher.send_shared(header, &Arc::from([point; 3])),
        ];
        for sent in sent {
            words.borrow_mut().push(sent.unwrap_err().to_string());
        }
        assert!(subscriber.receive().unwrap().is_none());
        // A rejected message leaves no gap in the numbers.
        publisher.send(header, &[point; 2]).unwrap();
        let message = subscriber.receive().unwrap().unwrap();
        assert_eq!(message.header().stamp.sequence, 0);
    });
    let words = words.into_inner();
    assert!(words[0].contains("3 elements") && words[0].contains("capacity of 2"));
    assert!(words.iter().all(|w| *w == words[0]), "{words:?}");
}

#[test]
fn a_full_receiver_fails_the_sender_and_makes_room_by_reading() {
    on_both("full", false, |bus| {
        let _service = bus.create::<Commands>().unwrap();
        let publisher = bus.publisher::<Commands>(port(0, 1)).unwrap();
        let subscriber = bus.subscriber::<Commands>().unwrap();
        publisher.update_connections().unwrap();
        let send = || publisher.send(PlainHeader::default(), &[Command::default()]);
        let error = (0..1000)
            .find_map(|_| send().err())
            .expect("no subscriber reads");
        assert!(matches!(error, SendError::Blocked { .. }), "{error}");
        let words = error.to_string();
        assert!(words.contains("did not take its messages"), "{words}");
        while subscriber.receive().unwrap().is_some() {}
        assert_eq!(send().unwrap(), 1);
    });
}

#[test]
fn with_overflow_the_newest_messages_win() {
    on_both("overflow", true, |bus| {
        let _service = bus.create::<Commands>().unwrap();
        let publisher = bus.publisher::<Commands>(port(0, 1)).unwrap();
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
        assert!(sequences.windows(2).all(|w| w[1] == w[0] + 1));
    });
}

#[test]
fn a_topic_has_the_ports_of_its_quality_of_service_and_they_become_free_again() {
    on_both("port_limit", false, |bus| {
        let _service = bus.create::<WorldState>().unwrap();
        let qos = WorldState::id().qos(&options(false).size);
        let publisher = bus.publisher::<WorldState>(port(0, 2)).unwrap();
        let error = bus.publisher::<WorldState>(port(1, 2)).unwrap_err();
        assert!(matches!(error, BusError::Port { .. }), "{error}");
        drop(publisher);
        bus.publisher::<WorldState>(port(1, 2)).unwrap();
        let taken: Vec<_> = (0..qos.subscribers)
            .map(|_| bus.subscriber::<WorldState>().unwrap())
            .collect();
        let error = bus.subscriber::<WorldState>().unwrap_err();
        assert!(matches!(error, BusError::Port { .. }), "{error}");
        drop(taken);
        bus.subscriber::<WorldState>().unwrap();
    });
}
