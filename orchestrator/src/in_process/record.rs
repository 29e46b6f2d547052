//! What is kept of a run: its summary, and its log if one is wanted.

use ipc_types::bus::Bus;

use super::InProcessOptions;
use crate::mission::plan::Plan;
use crate::mission::{MissionError, MissionOptions, recording};
use crate::recorder::{Observer, Recorder, Summary, Tally};
use crate::scenario::ResolvedScenario;

/// Takes up every message of a run.
pub(super) enum Record {
    /// Into a log.
    Log(Box<Recorder>),
    /// Into the summary alone.
    Tally(Box<Tally>),
}

impl Record {
    /// Creates the log, if one is wanted, and subscribes to every topic.
    pub(super) fn open(
        scenario: &ResolvedScenario,
        plan: &Plan,
        bus: &Bus,
        options: &InProcessOptions,
    ) -> Result<Self, MissionError> {
        if options.out.is_none() {
            let (processes, robots) = (recording::processes(plan), recording::robots(plan));
            let beginnings = options.cache.beginnings();
            let period = plan.run.tick_period_ns;
            let tally = Tally::open(bus, &processes, &robots, period, beginnings)?;
            return Ok(Self::Tally(Box::new(tally)));
        }
        let log = recording::create_log(
            scenario,
            plan,
            &MissionOptions {
                out: options.out.clone(),
                force: options.force,
                ..MissionOptions::default()
            },
            None,
        )?;
        Ok(Self::Log(Box::new(Recorder::open(bus, log)?)))
    }

    /// Takes up every message up to a tick, all of which have been sent.
    pub(super) fn take(
        &mut self,
        tick: u64,
        observer: &mut dyn Observer,
    ) -> Result<(), MissionError> {
        match self {
            Self::Log(recorder) => recorder.take(tick, observer)?,
            Self::Tally(tally) => tally.take(Some(tick), observer)?,
        }
        Ok(())
    }

    /// What the run amounted to.
    pub(super) fn finish(self, observer: &mut dyn Observer) -> Result<Summary, MissionError> {
        Ok(match self {
            Self::Log(recorder) => recorder.finish(observer)?,
            Self::Tally(tally) => tally.finish(),
        })
    }
}
