//! Common behaviour of the bus between processes and the bus in memory: every test on both.

use std::sync::Arc;

use ipc_types::bus::{AnyTopic, Arrivals, Bus, BusError, Inbox, RawPublisher, SendError};
use ipc_types::layout::TopicLayout;
use ipc_types::messages::robot::{Command, PlanHeader, PlanPoint};
use ipc_types::messages::world::{MapCell, MapHeader, RobotState};
use ipc_types::stamp::{PlainHeader, Stamp};
use ipc_types::topics::{Commands, Plan, Topic, TopicId, WorldMap, WorldState};

use crate::support::{Echoes, Space, local, options, port, state};

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

#[test]
fn a_topic_that_is_declared_while_the_program_runs_has_bytes_as_messages() {
    let layout = TopicLayout {
        name: "declared/echo".to_owned(),
        message: "float64 range  # [m]\nuint32 robot\nuint32 reserved\n".to_owned(),
        ..TopicLayout::default()
    };
    let topic = layout.register().unwrap();
    assert_eq!(layout.register(), Ok(topic));
    assert_eq!(topic.facts().element.name, "declared/Echo");
    let elements: Vec<u8> = (0..48).collect();
    on_both("declared", false, |bus| {
        let any = AnyTopic::find(topic).unwrap();
        let _service = any.create(bus).unwrap();
        let publisher = RawPublisher::open(bus, topic, port(5, 3)).unwrap();
        let mut repeater = any.repeater(bus, 6).unwrap();
        let subscriber = any.subscriber(bus).unwrap();
        publisher.update_connections().unwrap();
        publisher.send(state(4).stamp, &elements).unwrap();
        publisher.send(state(5).stamp, &[]).unwrap();
        let full = publisher.send(state(6).stamp, &[0; 64]);
        assert!(matches!(full, Err(SendError::Capacity { .. })), "{full:?}");
        let (mut all, mut logged) = (Vec::new(), Vec::new());
        let read_all = |all: &mut Vec<_>, logged: &mut Vec<u8>| {
            let taken = subscriber.drain(9, &mut |message| {
                logged.clear();
                message.encode(logged);
                let stamp = message.stamp;
                all.push((
                    stamp.tick,
                    stamp.sequence,
                    stamp.source,
                    message.elements.to_vec(),
                ));
            });
            assert!(taken.unwrap());
        };
        read_all(&mut all, &mut logged);
        assert_eq!(all, [(4, 0, 5, elements.clone()), (5, 1, 5, Vec::new())]);
        // A log's message is sent again byte for byte, in memory with the next number of its sender; others are refused.
        let mut again = logged.clone();
        assert!(repeater.repeat(&again).unwrap());
        assert!(!repeater.repeat(&again[..again.len() - 1]).unwrap());
        read_all(&mut all, &mut logged);
        if bus.is_local() {
            // After encapsulation, tick and time.
            again[20..28].fill(0);
        }
        assert_eq!((all.len(), &logged), (3, &again));
    });
}

#[test]
fn a_topic_in_words_is_the_same_as_one_of_another_crate() {
    // What a program with the types tells one without them.
    let words = TopicLayout::for_topic(Echoes::id());
    assert_eq!(words.register(), Ok(Echoes::id()));
    let space = Space::new("words");
    space.0.create_root().unwrap();
    let bus = Bus::join(&space.0, options(false), "test").unwrap();
    let _service = bus.create::<Echoes>().unwrap();
    let typed = bus.subscriber::<Echoes>().unwrap();
    let raw = RawPublisher::open(&bus, Echoes::id(), port(2, 2)).unwrap();
    let (mut first, second) = (Command::default(), Command::default());
    first.v = 0.5;
    let bytes = [first, second].map(|command| zerocopy::transmute!(command));
    let bytes: [[u8; size_of::<Command>()]; 2] = bytes;
    raw.send(state(3).stamp, bytes.as_flattened()).unwrap();
    let message = typed.receive().unwrap().expect("one message");
    assert_eq!(message.header().stamp.tick, 3);
    assert!(message.header().stamp.sent_ns > 0);
    assert_eq!(message.elements(), [first, second]);
}

#[test]
fn a_layout_that_is_no_ros_message_is_refused_with_its_field() {
    let refused = |name: &str, message: &str| {
        let layout = TopicLayout {
            name: name.to_owned(),
            message: message.to_owned(),
            ..TopicLayout::default()
        };
        layout.register().unwrap_err().to_string()
    };
    for (message, words) in [
        ("", "expected from 1 to"),
        ("float64", "line \"float64\": expected a type and a name"),
        (
            "float64 x\nfloat64 x",
            "field \"x\": expected a name of its own",
        ),
        ("float32 x\nfloat64 y", "field \"y\": it begins at byte 4"),
        ("float64 x\nuint32 n", "12 bytes: expected a multiple of 8"),
        (
            "float64[] x",
            "field \"x\": type float64[]: expected a fixed number",
        ),
        ("string x", "type \"string\""),
        ("own/A a\nMSG: own/A\nown/A a", "type \"own/A\""),
        ("float64[99999999] x", "expected from 1 to"),
    ] {
        let reason = refused("own/refused", message);
        assert!(reason.contains(words), "{message:?}: {reason}");
    }
    assert!(refused("Own", "float64 x").contains("lower-case"));
    assert!(refused("world/state", "float64 x").contains("Protean's own"));
    assert!(TopicId::from_name("own/refused").is_none());
}

/// A link that delays all messages by two ticks and loses those of tick 5.
#[derive(Debug)]
struct Late;

impl Arrivals for Late {
    fn arrival(&self, _topic: &str, stamp: &Stamp) -> Option<u64> {
        (stamp.tick != 5).then_some(stamp.tick + 2)
    }

    fn is_awaited(&self, _topic: &str) -> bool {
        true
    }
}

#[test]
fn links_hold_for_topics_without_their_types() {
    let layout = TopicLayout {
        name: "declared/late".to_owned(),
        message: "float64 range\n".to_owned(),
        ..TopicLayout::default()
    };
    let topic = layout.register().unwrap();
    on_both("linked", false, |bus| {
        let any = AnyTopic::find(topic).unwrap();
        let _service = any.create(bus).unwrap();
        let publisher = RawPublisher::open(bus, topic, port(1, 1)).unwrap();
        let inbox = Inbox::new(Box::new(Late), 50_000_000);
        let (subscriber, answers) = bus.through(&inbox, || {
            let answers = RawPublisher::open(bus, topic, port(2, 1)).unwrap();
            (any.subscriber(bus).unwrap(), answers)
        });
        let recorder = any.subscriber(bus).unwrap();
        for port in [&publisher, &answers] {
            port.update_connections().unwrap();
        }
        let mut seen = Vec::new();
        for tick in 4..9 {
            publisher.send(state(tick).stamp, &[0; 8]).unwrap();
            assert_eq!(inbox.begin(tick).unwrap(), tick >= 6);
            let taken = subscriber.drain(9, &mut |message| {
                seen.push((tick, message.stamp.tick));
            });
            assert!(taken.unwrap());
        }
        assert_eq!(seen, [(6, 4), (8, 6)]);
        // An answer to an old message belongs to the tick in which it is sent.
        answers.send(state(6).stamp, &[0; 8]).unwrap();
        let mut dates = Vec::new();
        let taken = recorder.drain(20, &mut |message| {
            dates.push((message.stamp.source, message.stamp.tick));
        });
        assert!(taken.unwrap());
        assert_eq!(dates.last(), Some(&(2, 8)), "{dates:?}");
    });
}
