//! Logs that are played again: to whoever listens, and to processes under test.

mod terminal;

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Instant;

use ipc_types::bus::{Bus, BusError, RunSpace, Subscriber};
use ipc_types::cdr;
use ipc_types::topics::{NAMES, Topic, TopicVisitor, WorldState, for_each_topic};
use kit::ProcessConfig;
use serde_json::Value as Json;

use crate::support::call::Call;
use crate::support::{SOON, Sandbox, until};

/// Messages of our topics from a time on [ns], but for what the replay says itself, by topic in the
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

/// What a listener heard, sorted as logs are: publishers of a topic have no order among them.
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

/// Hears one topic of a run.
trait Ear {
    fn hear(&self, heard: &mut BTreeMap<String, Vec<Vec<u8>>>);
}

impl<T: Topic> Ear for Subscriber<T> {
    fn hear(&self, heard: &mut BTreeMap<String, Vec<Vec<u8>>>) {
        while let Some(message) = self.receive().unwrap() {
            let mut data = Vec::new();
            cdr::encode::<T>(message.header(), message.elements(), &mut data);
            heard.entry(T::NAME.to_owned()).or_default().push(data);
        }
    }
}

/// Somebody who has joined the run that a replay is.
struct Listener {
    ears: Vec<Box<dyn Ear>>,
    _bus: Bus,
}

impl Listener {
    fn join(sandbox: &Sandbox, run: &str) -> Self {
        struct Open<'a>(&'a Bus, Vec<Box<dyn Ear>>);
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
            ears: open.1,
            _bus: bus,
        }
    }

    /// Listens until the replay has ended.
    fn listen(&self, replay: &mut Replay) -> BTreeMap<String, Vec<Vec<u8>>> {
        let mut heard = BTreeMap::new();
        let deadline = Instant::now() + SOON;
        loop {
            let ended = replay.0.try_wait().unwrap().is_some();
            for ear in &self.ears {
                ear.hear(&mut heard);
            }
            if ended {
                heard.remove("run/control");
                return heard;
            }
            assert!(Instant::now() < deadline, "the replay does not end");
            std::thread::park_timeout(std::time::Duration::from_millis(1));
        }
    }
}

/// A replay whose keys are pressed through a pipe.
struct Replay(Child);

impl Replay {
    fn start(sandbox: &Sandbox, words: &[&str]) -> Self {
        let child = Command::new(env!("CARGO_BIN_EXE_protean"))
            .args(["replay", "run.mcap", "--json", "--quiet", "--paused"])
            .args(words)
            .current_dir(sandbox.path())
            .env("XDG_RUNTIME_DIR", sandbox.runtime_dir())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        Self(child)
    }

    fn press(&mut self, keys: &str) {
        let stdin = self.0.stdin.as_mut().unwrap();
        stdin.write_all(keys.as_bytes()).unwrap();
    }

    fn report(mut self) -> Json {
        let mut text = String::new();
        let mut stdout = self.0.stdout.take().unwrap();
        std::io::Read::read_to_string(&mut stdout, &mut text).unwrap();
        serde_json::from_str(&text).unwrap()
    }
}

impl Drop for Replay {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn whoever_listens_hears_what_was_recorded_byte_for_byte() {
    let sandbox = Sandbox::new();
    sandbox.record("chase");
    let known = sandbox.runs();
    let log = sandbox.path().join("run.mcap");
    for speed in [&["--rate", "20"][..], &["--as-fast-as-possible"]] {
        let known = sandbox.runs();
        let mut replay = Replay::start(&sandbox, speed);
        let listener = Listener::join(&sandbox, &sandbox.next_run(&known));
        replay.press(" ");
        let heard = listener.listen(&mut replay);
        drop(listener);
        assert_same(&sorted(heard), &logged(&log, 0, u64::MAX));
        let report = replay.report();
        assert_eq!(
            (&report["times"], &report["malformed"]),
            (&1.into(), &0.into())
        );
    }
    assert_eq!(known.len(), 1);
    sandbox.assert_nothing_left();
}

#[test]
fn a_part_begins_with_what_lasts_and_is_stepped_through_by_keys() {
    let sandbox = Sandbox::new();
    sandbox.record("chase_exact");
    let (from, to) = (500_000_000, 1_000_000_000);
    let known = sandbox.runs();
    let words = [
        "--start",
        "0.5",
        "--end",
        "1",
        "--exclude",
        "robot/plan,process/*",
    ];
    let mut replay = Replay::start(&sandbox, &words);
    let listener = Listener::join(&sandbox, &sandbox.next_run(&known));
    // Two single ticks, then the rest.
    replay.press("s\x1b[C ");
    let heard = listener.listen(&mut replay);
    drop(listener);
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
    assert_same(&sorted(heard), &expected);
    let report = replay.report();
    assert_eq!(
        (&report["ticks"], &report["restored"]),
        (&11.into(), &3.into())
    );
    sandbox.assert_nothing_left();
}

#[test]
fn a_replay_that_is_ended_leaves_nothing() {
    let sandbox = Sandbox::new();
    sandbox.record("chase_exact");
    for (words, signal) in [
        (&["--loop"][..], rustix::process::Signal::INT),
        (&["--rate", "0.01"], rustix::process::Signal::TERM),
    ] {
        let known = sandbox.runs();
        let call = sandbox.protean(["replay", "run.mcap", "--json"]);
        let running = words.iter().fold(call, Call::arg).start();
        let run = sandbox.next_run(&known);
        crate::support::wait_for_tick(&run, 1);
        running.signal(signal);
        let outcome = running.finish();
        assert_eq!(outcome.code, Some(3), "{outcome}");
        assert_eq!(outcome.json()["interrupted"], true, "{outcome}");
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
fn processes_say_again_what_they_said_and_a_change_is_named_where_it_shows() {
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
            assert!(verdict["recorded"].as_u64() > Some(15), "{topic}: {report}");
            assert_eq!(verdict["recorded"], verdict["equal"], "{topic}: {report}");
            assert_eq!(verdict["recorded"], verdict["now"], "{topic}: {report}");
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
        let (first, fields) = (&verdict["first"], verdict["fields"].as_object().unwrap());
        assert!(
            first["tick"].is_u64() && first["messages"].as_u64() > Some(0),
            "{report}"
        );
        assert_ne!(first["logged"], first["again"], "{report}");
        let earliest = fields
            .values()
            .map(|field| field["first_tick"].as_u64().unwrap());
        assert_eq!(earliest.min(), first["tick"].as_u64(), "{report}");
        for field in fields.values() {
            let (max, mean) = (
                field["max"].as_f64().unwrap(),
                field["mean"].as_f64().unwrap(),
            );
            assert!(max >= mean && mean > 0.0, "{report}");
        }
        let same = verdict["equal"].as_u64().unwrap() + first["messages"].as_u64().unwrap();
        assert_eq!(verdict["recorded"], same, "{report}");
    }
    sandbox.assert_nothing_left();
}

#[test]
fn a_patrol_is_tested_against_its_log() {
    let sandbox = Sandbox::new();
    sandbox.record("patrol_square");
    let known = sandbox
        .protean(["replay", "run.mcap", "--test", "nobody"])
        .run();
    known.refused(2, &["error: --test nobody", "no process with this name"]);
    let (_, names) = known.stderr.trim().rsplit_once("it has ").unwrap();
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
    sandbox.file("text.mcap", "hello, everybody");
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
        (&["run.mcap", "--rate", "0"], 2, &["--rate 0", "above 0"]),
        (
            &["run.mcap", "--rate", "NaN"],
            2,
            &["--rate NaN", "above 0"],
        ),
        (&["run.mcap", "--start", "2", "--end", "1"], 2, &["--start"]),
        (
            &["run.mcap", "--topics", "nope"],
            2,
            &["--topics nope", "world/state"],
        ),
        (&["run.mcap", "--paused"], 2, &["--paused", "stdin"]),
        (
            &["run.mcap", "--test", "simulator"],
            2,
            &["simulator", "protean rerun"],
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
    // What is left of a log is played as far as it goes, and said to be a part.
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
