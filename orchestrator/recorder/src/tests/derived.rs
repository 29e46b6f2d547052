//! Tests of derived channels: their messages follow their sources in the log.

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::robot::Command;
use ipc_types::topics::{Commands, Topic as _, TopicId};
use mcap_log::LogOptions;

use super::made_up::{PERIOD_NS, ROBOTS, recording, run};
use super::round_trip::read;
use crate::{DerivedChannel, DerivedMessages, DerivedTopics};

const TOPIC: &str = "/count";
const TICKS: u64 = 3;

/// Counts the commands of a tick; the last message of a run is empty.
#[derive(Default)]
struct Count {
    channels: Vec<DerivedChannel>,
    ready: DerivedMessages,
    time_ns: u64,
    commands: u8,
}

impl Count {
    fn new() -> Self {
        let channel = DerivedChannel {
            topic: TOPIC.to_owned(),
            schema_name: "test/msg/Count".to_owned(),
            schema: "uint8 count\n".to_owned(),
            latched: false,
        };
        Self {
            channels: vec![channel],
            ..Self::default()
        }
    }
}

impl Consumer for Count {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::Commands]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, (): &mut ()) {
        self.time_ns = message.time_ns;
        self.commands += 1;
    }

    fn end_of_tick(&mut self, (): &mut ()) {
        let count = core::mem::take(&mut self.commands);
        if count > 0 {
            self.ready.push(0, self.time_ns, |bytes| bytes.push(count));
        }
    }
}

impl DerivedTopics for Count {
    fn channels(&self) -> &[DerivedChannel] {
        &self.channels
    }

    fn ready(&mut self) -> &mut DerivedMessages {
        &mut self.ready
    }

    fn finish(&mut self) {
        self.ready.push(0, self.time_ns, |_| ());
    }
}

#[test]
fn derived_messages_follow_their_tick_are_numbered_and_counted() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let mut recording = recording(&path, &LogOptions::default(), Some(Box::new(Count::new())));
    for mut sent in run(TICKS, 1) {
        // A rejected command is in the log, but has no derived message.
        if let super::made_up::Sent::Command(_, commands) = &mut sent
            && commands[0].robot == 0
        {
            commands[0] = Command {
                v: f64::NAN,
                ..commands[0]
            };
        }
        sent.push(&mut recording);
    }
    let summary = recording.finish(&mut ()).unwrap();
    let read = read(&path);
    let derived: Vec<_> = read.iter().filter(|m| m.0 == TOPIC).collect();
    let accepted = u8::try_from(ROBOTS - 1).unwrap();
    let expected = (0..TICKS).map(|tick| (tick, vec![accepted]));
    let expected = expected.chain([(TICKS - 1, Vec::new())]);
    for (number, (message, (tick, bytes))) in derived.iter().zip(expected).enumerate() {
        assert_eq!(
            (message.1 as usize, message.2, &message.4),
            (number, tick * PERIOD_NS, &bytes)
        );
    }
    assert_eq!(derived.len() as u64, TICKS + 1);
    let count = summary.topics[TOPIC];
    assert_eq!((count.messages, count.bytes), (TICKS + 1, TICKS));
    assert_eq!(summary.topics[Commands::NAME].rejected, TICKS);
    let place = |topic: &str, time_ns: u64| {
        read.iter()
            .rposition(|m| m.0 == topic && m.2 == time_ns)
            .unwrap()
    };
    for tick in 0..TICKS {
        let time_ns = tick * PERIOD_NS;
        assert!(place(TOPIC, time_ns) > place(Commands::NAME, time_ns));
    }
}
