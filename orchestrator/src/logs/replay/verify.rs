//! Processes of a recorded run, one or several, against what they heard then.
//!
//! Everybody who is not under test says in each tick what the log says; those under test take their
//! turns as in the run: when the world and those they wait for have spoken. What others say of a
//! tick comes after their turn, because in the run nobody could count on hearing it earlier.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use ipc_types::bus::Bus;
use ipc_types::messages::world::WorldHeader;
use ipc_types::topics::{Control, NAMES, Topic as _, WorldMap, WorldShapes, WorldState};
use serde::Serialize;
use zerocopy::FromBytes as _;

use super::super::compare::{Difference, first_difference};
use super::super::error::LogsError;
use super::super::failures::{Left, first_to_leave};
use super::super::filter::nanoseconds;
use super::super::known::{self, ENCAPSULATION};
use super::super::pattern::Topics;
use super::super::ros2::{Cell, field_at};
use super::super::watch::Watch;
use super::cast::{Cast, Processes, within};
use super::deviation::Deviation;
use super::ears::{Ear, Said};
use super::source::{Logged, Source};
use super::stage::{Choir, Clocks, SayError, Stage};
use crate::mission::MissionError;
use crate::mission::children::Executable;
use crate::mission::plan::{Launch, Plan};
use crate::scenario::kinds::{KINDS, Need, Product, find};

/// What is tested, and how.
#[derive(Debug, Clone, Default)]
pub struct VerifyOptions {
    /// Names of the processes under test.
    pub processes: Vec<String>,
    /// Changes to the scenario in the log, as `--set` takes them.
    pub changes: Vec<String>,
    /// Up to and with this simulated time [s].
    pub end_s: Option<f64>,
    /// Whether in this process.
    pub in_process: bool,
    /// Whether programs that are not ours may be started.
    pub allow_external: bool,
    /// Whether what the processes say on stderr is kept back.
    pub quiet: bool,
}

/// How a topic compares.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct TopicVerdict {
    /// Messages in the log.
    pub recorded: u64,
    /// Messages now.
    pub now: u64,
    /// Messages that are the same, clocks apart.
    pub equal: u64,
    /// The first difference; absent if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first: Option<Difference>,
    /// By how much fields differ.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub fields: BTreeMap<String, Deviation>,
}

/// How the processes compare with themselves in the log.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Verified {
    /// The scenario.
    pub scenario: String,
    /// The processes under test.
    pub processes: Vec<String>,
    /// Those that were started too, because what they answer is in no log.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub helpers: Vec<String>,
    /// The version that recorded the log, if it is another.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recorded_by: Option<String>,
    /// What was changed.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<String>,
    /// Ticks that were done.
    pub ticks: u64,
    /// Whether every message is the same.
    pub identical: bool,
    /// Whether the log holds all that was asked for.
    pub whole: bool,
    /// The first of them that failed in the run of the log: only what it said before is compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left: Option<Left>,
    /// The topics on which they spoke, then or now.
    pub topics: BTreeMap<String, TopicVerdict>,
    /// Real time from the first tick to the last [s].
    pub wall_time_s: f64,
    /// What was wrong with the file.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<String>,
}

impl Verified {
    /// The earliest difference, and its topic.
    pub fn first(&self) -> Option<(&String, &Difference)> {
        let topics = self.topics.iter();
        topics
            .filter_map(|(topic, verdict)| Some((topic, verdict.first.as_ref()?)))
            .min_by_key(|(_, first)| first.tick)
    }
}

/// Runs processes of the run in a log against what they heard, and compares what they say.
///
/// # Errors
/// [`LogsError`]: the log cannot be read, the processes cannot be tested against it, or one fails.
pub fn verify(
    log: &Path,
    options: &VerifyOptions,
    watch: &mut Watch,
) -> Result<Verified, LogsError> {
    let mut to = nanoseconds("--end", options.end_s)?.unwrap_or(u64::MAX);
    // What a process says after a restart, it says knowing nothing of before.
    let left = first_to_leave(
        log,
        |name| options.processes.iter().any(|p| p == name),
        watch,
    )?;
    if let Some(left) = &left {
        let period: Option<u64> = Source::open(log, &Topics::default(), 0)?
            .origin()
            .manifest
            .get("tick_period_ns")
            .and_then(|text| text.parse().ok());
        let before = left.tick.saturating_mul(period.unwrap_or(1));
        to = to.min(before.saturating_sub(1));
    }
    let mut source = Source::open(log, &Topics::default(), to)?;
    let so =
        "a process cannot be given the same once more; `protean replay` without --test plays it";
    let scenario = source.origin().scenario(log, &options.changes, so)?;
    let manifest = &source.origin().manifest;
    let mut done = Verified {
        scenario: scenario.name.clone(),
        processes: options.processes.clone(),
        changes: options.changes.clone(),
        recorded_by: manifest
            .get("version")
            .filter(|version| *version != env!("CARGO_PKG_VERSION"))
            .cloned(),
        ..Verified::default()
    };
    if options.in_process {
        let plan = Plan::new(&scenario, Path::new(""), "", "warn").map_err(MissionError::from)?;
        let tested = Tested::new(&plan, &source, options)?;
        let bus = Bus::local(plan.run.bus_options(), None);
        let mut trial = Trial::open(&bus, &plan, &tested, &mut source, watch)?;
        let mut cast = within(&tested.launches, &bus)?;
        trial.run(&mut cast, &mut source, watch, &mut done)?;
        done.helpers = tested.helpers;
    } else {
        let stage = Stage::build(&scenario)?;
        let tested = Tested::new(&stage.plan, &source, options)?;
        let mut trial = Trial::open(&stage.bus, &stage.plan, &tested, &mut source, watch)?;
        let mut cast = Processes::start(
            &stage,
            &tested.launches,
            Duration::from_secs_f64(scenario.run.hang_timeout_s),
            Arc::clone(&watch.interrupted),
            !options.quiet,
        )?;
        if !cast.ready()? {
            return Err(LogsError::Interrupted);
        }
        trial.run(&mut cast, &mut source, watch, &mut done)?;
        done.helpers = tested.helpers;
    }
    done.whole &= left.is_none();
    done.left = left;
    done.faults = source.faults();
    done.identical = done.topics.values().all(|topic| topic.first.is_none());
    Ok(done)
}

/// Who is under test.
struct Tested {
    launches: Vec<Launch>,
    helpers: Vec<String>,
    /// Whose words are compared.
    speakers: BTreeSet<u32>,
    /// Who speaks before the turn: the world, and whom they wait for.
    before: BTreeSet<u32>,
}

impl Tested {
    fn new(plan: &Plan, source: &Source, options: &VerifyOptions) -> Result<Self, LogsError> {
        let refuse = |reason: String| LogsError::Argument(format!("--test {reason}"));
        let manifest = &source.origin().manifest;
        let names = |names: Vec<&str>| names.join(",");
        let mut now = names(
            plan.launches
                .iter()
                .map(|l| l.config.name.as_str())
                .collect(),
        );
        now += ",orchestrator";
        for (key, now) in [
            ("processes", now),
            (
                "robots",
                names(plan.run.robots.iter().map(|r| r.name.as_str()).collect()),
            ),
            ("tick_period_ns", plan.run.tick_period_ns.to_string()),
        ] {
            if let Some(then) = manifest.get(key)
                && *then != now
            {
                return Err(LogsError::Argument(format!(
                    "--set: the {key} of the log are {then}, with the changes they are {now}: what \
                     is in the log is not for them"
                )));
            }
        }
        let mut launches = Vec::new();
        for name in &options.processes {
            let mut known = plan.launches.iter();
            let Some(launch) = known.find(|launch| launch.config.name == *name) else {
                let known: Vec<&str> = plan
                    .launches
                    .iter()
                    .skip(1)
                    .map(|l| &*l.config.name)
                    .collect();
                return Err(refuse(format!(
                    "{name}: the log's scenario has no process with this name; it has {}",
                    known.join(", ")
                )));
            };
            if launch.config.index == 0 {
                return Err(refuse(format!(
                    "{name}: it leads the others; `protean rerun` does the whole run again"
                )));
            }
            if let Executable::Command(words) = &launch.executable
                && !options.allow_external
            {
                return Err(refuse(format!(
                    "{name}: it is a program that is not Protean's own; look at it and add \
                     --allow-external: {}",
                    words.join(" ")
                )));
            }
            launches.push(launch.clone());
        }
        let speakers: BTreeSet<u32> = launches.iter().map(|l| l.config.index).collect();
        let needs_plans = |launch: &Launch| {
            find(KINDS, &launch.config.kind)
                .is_some_and(|kind| (kind.needs)(&launch.config.params).contains(&Need::Plans))
        };
        let mut helpers = Vec::new();
        if launches.iter().any(needs_plans) {
            // Requests and answers are in no log.
            for launch in &plan.launches {
                let serves =
                    find(KINDS, &launch.config.kind).is_some_and(|k| k.makes(Product::Plans));
                if serves && !speakers.contains(&launch.config.index) {
                    helpers.push(launch.config.name.clone());
                    launches.push(launch.clone());
                }
            }
        }
        let mut before: BTreeSet<u32> = launches
            .iter()
            .flat_map(|launch| launch.config.upstream.iter().copied())
            .collect();
        before.extend([0, plan.orchestrator_index()]);
        // In the order of the run, each once.
        launches.sort_by_key(|launch| launch.config.index);
        launches.dedup_by_key(|launch| launch.config.index);
        Ok(Self {
            launches,
            helpers,
            speakers,
            before,
        })
    }

    /// Whose words of the log are not said: theirs, and those of whoever else was started.
    fn is_silent(&self, source: u32) -> bool {
        let mut launches = self.launches.iter();
        launches.any(|launch| launch.config.index == source)
    }
}

/// The messages of one tick.
struct Moment {
    tick: u64,
    time: u64,
    said: Vec<Logged>,
}

impl Moment {
    /// The state of the world, if it is there.
    fn state(&self) -> Option<WorldHeader> {
        let state = self
            .said
            .iter()
            .find(|m| NAMES.get(m.rank) == Some(&WorldState::NAME))?;
        let (header, _) = WorldHeader::read_from_prefix(state.data.get(ENCAPSULATION..)?).ok()?;
        Some(header)
    }
}

struct Trial<'a> {
    bus: &'a Bus,
    tested: &'a Tested,
    choir: Choir,
    ears: Vec<Ear>,
    period_ns: u64,
}

impl<'a> Trial<'a> {
    /// Opens the ports of everybody who is not under test, and of who listens to those who are.
    fn open(
        bus: &'a Bus,
        plan: &Plan,
        tested: &'a Tested,
        source: &mut Source,
        watch: &mut Watch,
    ) -> Result<Self, LogsError> {
        let mut trial = Self {
            bus,
            tested,
            choir: Choir::new(),
            ears: Ear::all(bus).map_err(MissionError::from)?,
            period_ns: plan.run.tick_period_ns.max(1),
        };
        source.audition(watch, &mut |rank, speaker| {
            trial.open_port(rank, speaker).map(drop)
        })?;
        source.seek(0, watch)?;
        Ok(trial)
    }

    /// Opens the port that a speaker needs; false if it is not played.
    fn open_port(&mut self, rank: usize, speaker: u32) -> Result<bool, LogsError> {
        if self.tested.is_silent(speaker) || NAMES.get(rank) == Some(&Control::NAME) {
            return Ok(false);
        }
        let opened = self.choir.open(self.bus, rank, speaker);
        opened.map_err(MissionError::from)?;
        Ok(true)
    }

    fn say(&mut self, message: &Logged) -> Result<(), LogsError> {
        if !self.open_port(message.rank, message.speaker())? {
            return Ok(());
        }
        match self.choir.say(message, Clocks::Recorded) {
            // What is no message of its topic nobody could take up then.
            Ok(()) | Err(SayError::Decode(_)) => Ok(()),
            Err(SayError::Port(error)) => Err(MissionError::from(error).into()),
            Err(SayError::Send(error)) => Err(MissionError::from(error).into()),
        }
    }

    /// Everything of the next tick.
    fn next(&self, source: &mut Source) -> Result<Option<Moment>, LogsError> {
        let mut said = Vec::new();
        source.tick(&mut said)?;
        Ok(said.first().map(|first| first.time).map(|time| Moment {
            tick: time / self.period_ns,
            time,
            said,
        }))
    }

    fn run(
        &mut self,
        cast: &mut dyn Cast,
        source: &mut Source,
        watch: &Watch,
        done: &mut Verified,
    ) -> Result<(), LogsError> {
        let go_on = |go_on: bool| go_on.then_some(()).ok_or(LogsError::Interrupted);
        self.choir.greet().map_err(MissionError::from)?;
        go_on(cast.connect()?)?;
        self.choir.greet().map_err(MissionError::from)?;
        for ear in &self.ears {
            ear.connect().map_err(MissionError::from)?;
        }
        let mut moment = self.next(source)?;
        // Everybody builds what it needs of the map before time starts.
        if let Some(first) = &mut moment {
            for name in [WorldMap::NAME, WorldShapes::NAME] {
                let mut said = first.said.iter();
                if let Some(at) = said.position(|m| NAMES.get(m.rank) == Some(&name)) {
                    let message = first.said.remove(at);
                    self.say(&message)?;
                }
            }
        }
        go_on(cast.prepare()?)?;
        let start = Instant::now();
        let mut over = false;
        while let Some(now) = moment {
            if watch.interrupted.load(std::sync::atomic::Ordering::Relaxed) {
                return Err(LogsError::Interrupted);
            }
            let state = now.state().filter(|state| state.stamp.tick == done.ticks);
            let Some(state) = state.filter(|_| now.tick == done.ticks) else {
                return Err(LogsError::NotRepeatable {
                    path: source.path().to_owned(),
                    reason: format!(
                        "the state of the world at tick {} is not in it: a log that was cut or \
                         damaged cannot be a test's",
                        done.ticks
                    ),
                });
            };
            over = state.phase == WorldHeader::OVER;
            moment = self.next(source)?;
            for message in &now.said {
                let speaker = message.speaker();
                if self.tested.before.contains(&speaker) {
                    self.say(message)?;
                }
            }
            if !over {
                go_on(cast.turn(now.tick)?)?;
            }
            done.ticks += 1;
            // The last tick of a log that was cut may lack something.
            self.judge(&now, moment.is_none() && !over, done)?;
            for message in &now.said {
                let speaker = message.speaker();
                if !self.tested.before.contains(&speaker) {
                    self.say(message)?;
                }
            }
        }
        done.whole = over || source.has_index();
        done.wall_time_s = start.elapsed().as_secs_f64();
        Ok(())
    }

    /// Compares what was said in a tick with what is said in the log.
    fn judge(&self, moment: &Moment, may_lack: bool, done: &mut Verified) -> Result<(), LogsError> {
        for ear in &self.ears {
            let heard = ear
                .hear(&self.tested.speakers)
                .map_err(MissionError::from)?;
            let recorded: Vec<Said> = moment
                .said
                .iter()
                .filter(|message| message.rank == ear.rank)
                .filter_map(|message| {
                    let stamp = known::stamp(&message.data)?;
                    let data = message.data.clone();
                    let tested = self.tested.speakers.contains(&stamp.source);
                    tested.then_some(Said { stamp, data })
                })
                .collect();
            if heard.is_empty() && recorded.is_empty() {
                continue;
            }
            let verdict = done.topics.entry(ear.topic.to_owned()).or_default();
            verdict.recorded += recorded.len() as u64;
            verdict.now += heard.len() as u64;
            for &speaker in &self.tested.speakers {
                let of = |said: &&Said| said.stamp.source == speaker;
                let mut then = recorded.iter().filter(of);
                let mut now = heard.iter().filter(of);
                loop {
                    match (then.next(), now.next()) {
                        (None, None) => break,
                        (None, Some(_)) if may_lack => {}
                        (a, b) => compare(ear, moment, a, b, verdict),
                    }
                }
            }
        }
        Ok(())
    }
}

fn compare(
    ear: &Ear,
    moment: &Moment,
    then: Option<&Said>,
    now: Option<&Said>,
    verdict: &mut TopicVerdict,
) {
    let mut field = String::new();
    let sequence = |said: Option<&Said>| {
        said.map_or_else(String::new, |said| {
            format!("message {}", said.stamp.sequence)
        })
    };
    let (mut logged, mut again) = (sequence(then), sequence(now));
    if let (Some(a), Some(b)) = (then, now) {
        let Some(at) = first_difference(&a.data, &b.data) else {
            verdict.equal += 1;
            return;
        };
        ear.numbers
            .compare(moment.tick, &a.data, &b.data, &mut verdict.fields);
        let value = |data: &[u8]| -> Option<(String, Cell)> {
            field_at(&ear.schema.as_ref()?.fields, data, at)
                .ok()
                .flatten()
        };
        let (x, y) = (value(&a.data), value(&b.data));
        let name = x.as_ref().or(y.as_ref()).map(|(name, _)| name.clone());
        field = name.unwrap_or_else(|| format!("byte {at}"));
        let text = |value: Option<(String, Cell)>| {
            value.map(|(_, cell)| cell.to_string()).unwrap_or_default()
        };
        (logged, again) = (text(x), text(y));
    }
    match &mut verdict.first {
        Some(first) => first.messages += 1,
        none => {
            let stamp = then.or(now).map(|said| said.stamp).unwrap_or_default();
            *none = Some(Difference {
                tick: moment.tick,
                time_s: super::super::seconds(moment.time),
                source: stamp.source,
                field,
                logged,
                again,
                messages: 1,
            });
        }
    }
}
