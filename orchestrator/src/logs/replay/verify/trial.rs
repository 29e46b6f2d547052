//! The turns of the processes under test, tick by tick, and what they say in them.

use std::time::Instant;

use ipc_types::bus::Bus;
use ipc_types::messages::world::WorldHeader;
use ipc_types::topics::{Control, NAMES, Topic as _, WorldMap, WorldShapes, WorldState};
use zerocopy::FromBytes as _;

use super::super::super::error::LogsError;
use super::super::super::known::{self, ENCAPSULATION};
use super::super::super::watch::Watch;
use super::super::cast::Cast;
use super::super::ears::{Ear, Said};
use super::super::source::{Logged, Source};
use super::super::stage::{Choir, Clocks, SayError};
use super::tested::Tested;
use super::verdict::Verified;
use crate::mission::MissionError;
use crate::mission::plan::Plan;

/// The messages of one tick.
pub(super) struct Moment {
    pub(super) tick: u64,
    pub(super) time: u64,
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

/// The bus of a test, with a voice for everybody who is not under test.
pub(super) struct Trial<'a> {
    bus: &'a Bus,
    tested: &'a Tested,
    choir: Choir,
    ears: Vec<Ear>,
    period_ns: u64,
}

impl<'a> Trial<'a> {
    /// Opens the ports of everybody who is not under test, and of who listens to those who are.
    pub(super) fn open(
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

    pub(super) fn run(
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
                        (a, b) => verdict.compare(ear, moment, a, b),
                    }
                }
            }
        }
        Ok(())
    }
}
