//! Replay of logs: to subscribers, and to processes under test.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::time::{Duration, Instant};

use ipc_types::bus::{Bus, BusError, RunSpace, Subscriber};
use ipc_types::cdr;
use ipc_types::topics::{NAMES, Topic, TopicVisitor, WorldState, for_each_topic};
use runtime::ProcessConfig;
use serde_json::Value as Json;

use crate::support::call::{Call, Running};
use crate::support::{SOON, Sandbox, until};

/// Messages of our topics from a time on (ns), without those of the replay itself, by topic in the
/// order in which they are.
fn logged(path: &Path, from: u64, to: u64) -> BTreeMap<String, Vec<Vec<u8>>> {
    let bytes = std::fs::read(path).unwrap();
    let mut messages: BTreeMap<String, Vec<Vec<u8>>> = BTreeMap::new();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let topic = &message.channel.topic;
        if NAMES.contains(&topic.as_str())
            && topic != "run/control"
            && (from..=to).contains(&message.log_time)
        {
            let data = message.data.into_owned();
            messages.entry(topic.clone()).or_default().push(data);
        }
    }
    messages
}

/// Received messages in the order of logs: publishers of one topic have no order among them.
fn sorted(mut messages: BTreeMap<String, Vec<Vec<u8>>>) -> BTreeMap<String, Vec<Vec<u8>>> {
    let key = |data: &Vec<u8>| {
        let word = |at: usize| u64::from_le_bytes(data[4 + at..12 + at].try_into().unwrap());
        (word(0), data[4 + 24..4 + 28].to_vec(), word(16))
    };
    for messages in messages.values_mut() {
        messages.sort_by_key(key);
    }
    messages
}

/// Asserts that the same was heard, naming topic and place of the first difference.
#[track_caller]
fn assert_same(heard: &BTreeMap<String, Vec<Vec<u8>>>, expected: &BTreeMap<String, Vec<Vec<u8>>>) {
    let counts = |messages: &BTreeMap<String, Vec<Vec<u8>>>| -> Vec<(String, usize)> {
        let counts = messages
            .iter()
            .map(|(topic, list)| (topic.clone(), list.len()));
        counts.collect()
    };
    assert_eq!(counts(heard), counts(expected));
    for (topic, messages) in expected {
        for (at, (x, y)) in heard[topic].iter().zip(messages).enumerate() {
            assert!(x == y, "{topic}, message {at}");
        }
    }
}

/// A subscriber of one topic, without its type.
trait TopicSubscriber {
    fn receive(&self, heard: &mut BTreeMap<String, Vec<Vec<u8>>>);
}

impl<T: Topic> TopicSubscriber for Subscriber<T> {
    fn receive(&self, heard: &mut BTreeMap<String, Vec<Vec<u8>>>) {
        while let Some(message) = self.receive().unwrap() {
            let mut data = Vec::new();
            cdr::encode::<T>(message.header(), message.elements(), &mut data);
            heard.entry(T::NAME.to_owned()).or_default().push(data);
        }
    }
}

/// Subscribers of all topics of a replay.
struct Listener {
    subscribers: Vec<Box<dyn TopicSubscriber>>,
    _bus: Bus,
}

impl Listener {
    fn join(sandbox: &Sandbox, run: &str) -> Self {
        struct Open<'a>(&'a Bus, Vec<Box<dyn TopicSubscriber>>);
        impl TopicVisitor for Open<'_> {
            type Error = BusError;
            fn visit<T: Topic>(&mut self) -> Result<(), BusError> {
                self.1.push(Box::new(self.0.recorder::<T>()?));
                Ok(())
            }
        }
        let root = sandbox.runtime_dir().join("protean").join(run);
        let config = root.join("process-1.json");
        let config = until("the configuration for those who join", SOON, || {
            ProcessConfig::load(&config).ok()
        });
        let space = RunSpace::new(&root, Sandbox::prefix(run)).unwrap();
        assert_eq!(config.run.space().unwrap(), space);
        let bus = Bus::join(&space, config.run.bus_options(), "listener").unwrap();
        let mut open = Open(&bus, Vec::new());
        for_each_topic(&mut open).unwrap();
        Self {
            subscribers: open.1,
            _bus: bus,
        }
    }

    /// Receives from a looping replay until one whole pass has arrived from every publisher. The first pass
    /// may have begun before the subscribers connected.
    fn listen(
        &self,
        replay: &mut Running<'_>,
        expected: &BTreeMap<String, Vec<Vec<u8>>>,
    ) -> BTreeMap<String, Vec<Vec<u8>>> {
        let mut heard = BTreeMap::new();
        let deadline = Instant::now() + SOON;
        let mut is_asked = false;
        while replay.is_alive() {
            assert!(Instant::now() < deadline, "the replay does not end");
            for subscriber in &self.subscribers {
                subscriber.receive(&mut heard);
            }
            let all = expected.iter().all(|(topic, messages)| {
                messages.iter().map(|data| source(data)).all(|source| {
                    let heard = heard.get(topic).map_or(&[][..], Vec::as_slice);
                    passes(heard, source).len() > 2
                })
            });
            if all && !is_asked {
                is_asked = true;
                replay.signal(rustix::process::Signal::INT);
            }
            std::thread::park_timeout(Duration::from_millis(1));
        }
        heard.remove("run/control");
        for messages in heard.values_mut() {
            let sources: BTreeSet<u32> = messages.iter().map(|data| source(data)).collect();
            let second = |source| passes(messages, source).into_iter().nth(1);
            *messages = sources.into_iter().filter_map(second).flatten().collect();
        }
        heard
    }
}

/// The process that sent a message.
fn source(data: &[u8]) -> u32 {
    u32::from_le_bytes(data[28..32].try_into().unwrap())
}

/// The messages of a process, split where the replay begins again.
fn passes(messages: &[Vec<u8>], of: u32) -> Vec<Vec<Vec<u8>>> {
    let sequence = |data: &[u8]| u64::from_le_bytes(data[20..28].try_into().unwrap());
    let (mut passes, mut last): (Vec<Vec<Vec<u8>>>, _) = (Vec::new(), None);
    for message in messages.iter().filter(|data| source(data) == of) {
        let now = sequence(message);
        if last.is_none_or(|last| now <= last) {
            passes.push(Vec::new());
        }
        passes.last_mut().unwrap().push(message.clone());
        last = Some(now);
    }
    passes
}

#[test]
fn a_subscriber_gets_what_was_recorded_byte_for_byte() {
    let sandbox = Sandbox::new();
    sandbox.record("chase");
    let expected = logged(&sandbox.path().join("run.mcap"), 0, u64::MAX);
    for speed in [&["--pace", "20"][..], &["--as-fast-as-possible"]] {
        let known = sandbox.runs();
        let call = sandbox.protean(["replay", "run.mcap", "--json", "--loop"]);
        let mut replay = speed.iter().fold(call, Call::arg).start();
        let listener = Listener::join(&sandbox, &sandbox.next_run(&known));
        let heard = listener.listen(&mut replay, &expected);
        drop(listener);
        assert_same(&sorted(heard), &expected);
        let outcome = replay.finish();
        assert_eq!(outcome.code, Some(3), "{outcome}");
        assert_eq!(outcome.json()["malformed"], 0, "{outcome}");
    }
    sandbox.assert_nothing_left();
}

#[test]
fn a_part_begins_with_what_lasts() {
    let sandbox = Sandbox::new();
    sandbox.record("chase_exact");
    let (from, to) = (500_000_000, 1_000_000_000);
    let part = [
        "replay",
        "run.mcap",
        "--json",
        "--start",
        "0.5",
        "--end",
        "1",
        "--exclude",
        "robot/plan,process/*",
    ];
    let log = sandbox.path().join("run.mcap");
    let mut expected = logged(&log, from, to);
    expected.retain(|topic, _| topic != "robot/plan" && topic != "process/status");
    // The map and the last state before the start come first.
    let before = logged(&log, 0, from - 1);
    for (topic, messages) in &before {
        if ["world/map", "world/shapes", WorldState::NAME].contains(&topic.as_str()) {
            let last = messages.last().unwrap().clone();
            expected.entry(topic.clone()).or_default().insert(0, last);
        }
    }
    let known = sandbox.runs();
    let mut replay = sandbox.protean(part).arg("--loop").start();
    let listener = Listener::join(&sandbox, &sandbox.next_run(&known));
    let heard = listener.listen(&mut replay, &expected);
    drop(listener);
    assert_same(&sorted(heard), &expected);
    replay.finish();
    let once = sandbox.protean(part).arg("--as-fast-as-possible").run();
    assert_eq!(once.code, Some(0), "{once}");
    let report = once.json();
    let counts = ["ticks", "restored", "times"].map(|key| report[key].as_u64());
    assert_eq!(counts, [Some(11), Some(3), Some(1)], "{report}");
    sandbox.assert_nothing_left();
}

#[test]
fn a_replay_takes_little_memory_and_leaves_nothing_when_it_is_ended() {
    let sandbox = Sandbox::new();
    sandbox.record("chase_exact");
    for (words, signal) in [
        (&["--loop"][..], rustix::process::Signal::INT),
        (&["--pace", "0.01"], rustix::process::Signal::TERM),
    ] {
        let known = sandbox.runs();
        let call = sandbox.protean(["replay", "run.mcap", "--json"]);
        let running = words.iter().fold(call, Call::arg).start();
        let run = sandbox.next_run(&known);
        crate::support::wait_for_tick(&run, 1);
        let status = std::fs::read_to_string(format!("/proc/{}/status", running.pid())).unwrap();
        let memory = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let memory: u64 = memory
            .unwrap()
            .trim()
            .trim_end_matches(" kB")
            .parse()
            .unwrap();
        running.signal(signal);
        let outcome = running.finish();
        assert_eq!(outcome.code, Some(3), "{outcome}");
        assert_eq!(outcome.json()["interrupted"], true, "{outcome}");
        // Buffers as long as those of a recorder took 390 MB, and more than a machine has with sixty robots.
        assert!(memory < 150_000, "{memory} kB");
        assert!(outcome.stderr.contains(&run), "{outcome}");
    }
    sandbox.assert_nothing_left();
}

/// Tests processes against the log; the exit code and the report.
fn test(sandbox: &Sandbox, processes: &[&str], more: &[&str]) -> (Option<i32>, Json) {
    let mut call = sandbox.protean(["replay", "run.mcap", "--json", "--quiet"]);
    for process in processes {
        call = call.arg("--test").arg(process);
    }
    let outcome = more.iter().fold(call, Call::arg).run();
    assert!(outcome.stdout.starts_with('{'), "{outcome}");
    (outcome.code, outcome.json())
}

#[test]
fn processes_send_the_same_messages_again_and_a_change_is_named_where_it_shows() {
    let sandbox = Sandbox::new();
    sandbox.record("chase");
    for (processes, more) in [
        (&["perception"][..], &[][..]),
        (&["pursuer_police_2"], &[]),
        (&["evader_potential_evader_1"], &["--in-process"]),
        (&["perception", "pursuer_police_1"], &["--end", "1"]),
    ] {
        let (code, report) = test(&sandbox, processes, more);
        assert_eq!(
            (code, &report["identical"]),
            (Some(0), &true.into()),
            "{report}"
        );
        for (topic, verdict) in report["topics"].as_object().unwrap() {
            assert!(verdict["a"].as_u64() > Some(15), "{topic}: {report}");
            assert_eq!(verdict["a"], verdict["equal"], "{topic}: {report}");
            assert_eq!(verdict["a"], verdict["b"], "{topic}: {report}");
        }
    }
    let set = "processes.evader_potential_evader_1.params.threat.gain=0.4";
    for more in [&["--set", set][..], &["--set", set, "--in-process"]] {
        let (code, report) = test(&sandbox, &["evader_potential_evader_1"], more);
        assert_eq!(
            (code, &report["identical"]),
            (Some(1), &false.into()),
            "{report}"
        );
        let verdict = &report["topics"]["robot/command"];
        let fields = verdict["fields"].as_object().unwrap();
        let first = &report["first"]["causes"][0];
        assert_eq!(first["process"], "evader_potential_evader_1", "{report}");
        assert_eq!(first["robot"], "evader_1", "{report}");
        assert_ne!(first["a"], first["b"], "{report}");
        let earliest = fields
            .values()
            .map(|field| field["first_tick"].as_u64().unwrap());
        assert_eq!(earliest.min(), first["tick"].as_u64(), "{report}");
        assert_eq!(first["tick"], verdict["first_tick"], "{report}");
        for field in fields.values() {
            let (max, mean) = (
                field["max"].as_f64().unwrap(),
                field["mean"].as_f64().unwrap(),
            );
            assert!(max >= mean && mean > 0.0, "{report}");
        }
        let same = verdict["equal"].as_u64().unwrap() + verdict["different"].as_u64().unwrap();
        assert_eq!(verdict["a"], same, "{report}");
    }
    sandbox.assert_nothing_left();
}

#[test]
fn a_patrol_is_tested_against_its_log() {
    let sandbox = Sandbox::new();
    sandbox.record("patrol_square");
    let known = sandbox
        .protean(["replay", "run.mcap", "--test", "unknown"])
        .run();
    known.refused(2, &["error: --test unknown", "no process with this name"]);
    let (_, names) = known.stderr.trim().rsplit_once("one of ").unwrap();
    let names: Vec<&str> = names.split(", ").collect();
    let (code, report) = test(&sandbox, &names, &[]);
    assert_eq!(code, Some(0), "{report}");
    assert!(
        report["topics"]["robot/command"]["equal"].as_u64() > Some(20),
        "{report}"
    );
    sandbox.assert_nothing_left();
}

#[test]
fn what_cannot_be_played_or_tested_is_refused() {
    let sandbox = Sandbox::new();
    sandbox.file("empty.mcap", "");
    sandbox.file("text.mcap", "hello, world");
    sandbox.record("chase_exact");
    let whole = std::fs::read(sandbox.path().join("run.mcap")).unwrap();
    sandbox.file("cut.mcap", &whole[..whole.len() / 2]);
    for (words, code, expected) in [
        (&["nope.mcap"][..], 2, &["nope.mcap", "No such file"][..]),
        (&["empty.mcap"], 2, &["empty.mcap", "it is empty"]),
        (
            &["text.mcap", "--test", "x"],
            2,
            &["text.mcap", "not an MCAP file"],
        ),
        (&["run.mcap", "--pace", "0"], 2, &["--pace 0", "above 0"]),
        (
            &["run.mcap", "--pace", "NaN"],
            2,
            &["--pace NaN", "above 0"],
        ),
        (&["run.mcap", "--start", "2", "--end", "1"], 2, &["--start"]),
        (
            &["run.mcap", "--topics", "nope"],
            2,
            &["--topics nope", "world/state"],
        ),
        (
            &["run.mcap", "--test", "simulator"],
            2,
            &["simulator", "protean verify"],
        ),
        (
            &["run.mcap", "--test", "pursuer_police_1", "--set", "nope=1"],
            2,
            &["--set", "nope"],
        ),
        (
            &[
                "run.mcap",
                "--test",
                "pursuer_police_1",
                "--set",
                "run.dt=0.1",
            ],
            2,
            &["--set", "tick_period_ns"],
        ),
        (&["run.mcap", "--set", "a=1"], 2, &["--test"]),
    ] {
        let call = sandbox.protean(["replay"]);
        let outcome = words.iter().fold(call, Call::arg).run();
        outcome.refused(code, expected);
    }
    // A truncated log is played to its end and reported as incomplete.
    let outcome = sandbox
        .protean(["replay", "cut.mcap", "--as-fast-as-possible"])
        .run();
    assert_eq!(outcome.code, Some(3), "{outcome}");
    assert!(outcome.stderr.contains("no index"), "{outcome}");
    assert!(outcome.stderr.contains("ends in the middle"), "{outcome}");
    sandbox.record_in_real_time("rt.mcap");
    let outcome = sandbox
        .protean(["replay", "rt.mcap", "--test", "pursuer_police_1"])
        .run();
    outcome.refused(2, &["rt.mcap", "recorded in real time"]);
    let outcome = sandbox
        .protean(["replay", "rt.mcap", "--as-fast-as-possible", "--quiet"])
        .run();
    assert_eq!(outcome.code, Some(0), "{outcome}");
    sandbox.assert_nothing_left();
}
