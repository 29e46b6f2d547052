//! What must hold whatever is done to a run.
//!
//! 1. It ends, in bounded time, with an exit code that says how.
//! 2. A process that fails is named, and what the scenario says of its failure happens.
//! 3. What only passes by leaves the history of a run in lock-step as it was.
//! 4. No process of it survives.
//! 5. No shared memory, socket or file of it remains; after a killed orchestrator not once
//!    `protean clean` has been through.
//! 6. Robots whose planner fails stand still when its last command is too old, in the next tick at the
//!    latest.
//! 7. Its log can be read; a killed orchestrator loses at most the last second.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use kit::config::ticks_within;
use serde_json::Value as Json;

use super::fault::{Fault, FaultKind, Policy};
use super::inject::{Injected, inject};
use super::mission::{self, Baseline, Course, Ended, Mission, SIMULATOR};
use super::{ChaosError, ChaosOptions, Outcome, stops};
use crate::census;
use crate::logs::{self, Watch};

/// Times of an untouched mission that one may take in which something was broken, and what comes on
/// top of that and of the time after which a hang is noticed: processes must come back, on a machine
/// that is busy.
const PATIENCE: (f64, f64) = (5.0, 40.0);

/// Time after which no process of a run may live whose orchestrator is gone: the grace of its
/// processes, and what a busy machine adds.
const GONE_WITHIN: Duration = Duration::from_secs(8);

/// What a log may lack of the time before the orchestrator was killed [s].
const LOST: f64 = 1.0;

/// Lets a mission run, does the fault, and checks every promise.
pub(super) fn put_to_the_test(
    options: &ChaosOptions,
    number: u64,
    fault: &Fault,
    moment: f64,
    baseline: &Baseline,
) -> Result<Outcome, ChaosError> {
    let hang_timeout_s = baseline.hang_timeout_s();
    let mut mission = Mission::start(options, fault.course, fault.policy, hang_timeout_s)?;
    let moment = Duration::from_secs_f64(moment * baseline.lasted_s);
    let injected = inject(&mut mission, fault, moment)?;
    let roots = mission.roots();
    let patience = PATIENCE.0 * baseline.lasted_s + PATIENCE.1 + hang_timeout_s;
    let patience = Duration::from_secs_f64(patience);
    let back_after_s = match &injected {
        Some(done) if comes_back(fault) => wait_for_return(&mut mission, done, patience),
        _ => None,
    };
    let ended = mission.end(patience);
    let over_after_s = injected
        .as_ref()
        .map_or(0.0, |done| done.at.elapsed().as_secs_f64());
    let mut check = Check {
        fault,
        baseline,
        broken: Vec::new(),
    };
    let (mut lost_s, mut stopped_after_s) = (None, None);
    match &injected {
        None => check.untouched(&ended),
        Some(_) if fault.kind.hits_orchestrator() => check.orchestrator(&ended),
        Some(_) => check.process(&ended),
    }
    check.nothing_lives(&roots)?;
    check.nothing_remains(&mission, &roots)?;
    if let Some(done) = &injected {
        lost_s = check.log(&mission, done);
        stopped_after_s = check.robots(options, &mission, done);
    }
    let broken = check.broken;
    if !broken.is_empty() {
        keep(options, number, &mission);
    }
    Ok(Outcome {
        number,
        fault: fault.clone(),
        injected: injected.is_some(),
        broken,
        over_after_s,
        back_after_s,
        stopped_after_s,
        lost_s,
    })
}

/// Whether a process that fails by this is started again.
fn comes_back(fault: &Fault) -> bool {
    fault.is_failure() && fault.policy == Policy::Restart && fault.target != SIMULATOR
}

/// Time until another process with the victim's name is there; `None` if the mission ends before.
fn wait_for_return(mission: &mut Mission, done: &Injected, patience: Duration) -> Option<f64> {
    while done.at.elapsed() < patience && !mission.is_over() {
        let members = census::children(mission.pid()).unwrap_or_default();
        let back = |m: &census::Member| {
            (&m.name, &m.config) == (&done.victim.name, &done.victim.config)
                && m.pid != done.victim.pid
        };
        if members.iter().any(back) {
            return Some(done.at.elapsed().as_secs_f64());
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    None
}

/// Keeps log and words of a mission that broke a promise.
fn keep(options: &ChaosOptions, number: u64, mission: &Mission) {
    let Some(folder) = &options.keep else { return };
    let _ = std::fs::create_dir_all(folder);
    for name in [mission::LOG, "stderr", "stdout"] {
        let to = folder.join(format!("fault-{number}-{name}"));
        let _ = std::fs::copy(mission.path().join(name), to);
    }
}

struct Check<'a> {
    fault: &'a Fault,
    baseline: &'a Baseline,
    broken: Vec<String>,
}

impl Check<'_> {
    fn broke(&mut self, what: impl Into<String>) {
        self.broken.push(what.into());
    }

    /// The exit code, or that there is none.
    fn code(&mut self, ended: &Ended) -> Option<i32> {
        let Some(status) = ended.status else {
            self.broke("the run did not end");
            return None;
        };
        if status.code().is_none() {
            let words = crate::mission::report::exit_words(status);
            self.broke(format!("the orchestrator {words}"));
        }
        status.code()
    }

    /// A mission that was over before anything could be done to it.
    fn untouched(&mut self, ended: &Ended) {
        match self.code(ended) {
            Some(0) => self.same_history(ended),
            Some(3) if self.fault.course == Course::RealTime => {}
            Some(code) => self.broke(format!("exit code {code} of a run left alone")),
            None => {}
        }
    }

    fn same_history(&mut self, ended: &Ended) {
        let summary = ended.summary.as_ref();
        let digest = summary.and_then(|s| s.get("digest")).and_then(Json::as_str);
        if let Some(expected) = &self.baseline.digest
            && digest != Some(expected)
        {
            let found = digest.unwrap_or("none");
            self.broke(format!("digest {found}, but {expected} if left alone"));
        }
    }

    /// After a fault of a process.
    fn process(&mut self, ended: &Ended) {
        let Some(code) = self.code(ended) else { return };
        let (fault, target) = (self.fault, self.fault.target.as_str());
        let by_the_clock = fault.course == Course::RealTime;
        // A process that fails when the game is over is nobody's loss.
        let unharmed = code == 0 && !self.tells_of_failure(ended);
        if unharmed && !by_the_clock {
            return self.same_history(ended);
        }
        match code {
            0 | 3 if unharmed || (by_the_clock && fault.passes()) => {}
            0 | 3 if comes_back(fault) => {}
            1 if !fault.passes() => {
                // Names may be long: every word of them is there.
                if !ended.stderr.contains(target) {
                    let words = ended.stderr.trim();
                    self.broke(format!("{target} is not named: {words}"));
                }
                // Before time starts, whoever fails ends the run.
                let so_early = [
                    "before it was ready",
                    "was not ready within",
                    "cannot be started",
                ];
                let early = so_early.iter().any(|words| ended.stderr.contains(words));
                if comes_back(fault) && !early {
                    let words = ended.stderr.trim();
                    self.broke(format!("the run ended instead of going on: {words}"));
                }
            }
            code => {
                let words = ended.stderr.trim();
                self.broke(format!("exit code {code}: {words}"));
            }
        }
    }

    /// Whether the summary says that a process failed.
    fn tells_of_failure(&self, ended: &Ended) -> bool {
        let processes = ended.summary.as_ref().and_then(|s| s.get("processes"));
        processes
            .and_then(Json::as_array)
            .is_some_and(|all| all.iter().any(|p| p["name"] == self.fault.target.as_str()))
    }

    /// After a fault of the orchestrator.
    fn orchestrator(&mut self, ended: &Ended) {
        let Some(status) = ended.status else {
            self.broke("the run did not end");
            return;
        };
        let by_the_clock = self.fault.course == Course::RealTime;
        match (self.fault.kind, status.code()) {
            // Killed, as intended; asked to end before it could listen; ended in order.
            (FaultKind::KillOrchestrator, None)
            | (FaultKind::TerminateOrchestrator, None | Some(0 | 3)) => {}
            (_, Some(0)) => self.same_history(ended),
            // By the clock, messages may be lost while nobody listens.
            (FaultKind::PauseOrchestrator, Some(3)) if by_the_clock => {}
            _ => {
                let how = crate::mission::report::exit_words(status);
                let words = ended.stderr.trim();
                self.broke(format!("the orchestrator {how}: {words}"));
            }
        }
    }

    fn nothing_lives(&mut self, roots: &[PathBuf]) -> Result<(), ChaosError> {
        let deadline = Instant::now() + GONE_WITHIN;
        loop {
            let mut living = Vec::new();
            for root in roots {
                living.extend(census::members_of(root)?);
            }
            if living.is_empty() {
                return Ok(());
            }
            // Whoever was stopped cannot end by itself: `clean` sees to it.
            let stopped_orphans =
                self.fault.kind == FaultKind::KillOrchestrator && living.iter().all(|m| m.stopped);
            if stopped_orphans {
                return Ok(());
            }
            if Instant::now() >= deadline {
                for member in living {
                    self.broke(format!("{} still lives ({})", member.name, member.pid));
                }
                return Ok(());
            }
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    fn nothing_remains(&mut self, mission: &Mission, roots: &[PathBuf]) -> Result<(), ChaosError> {
        if self.fault.kind.hits_orchestrator() {
            mission.clean()?;
        }
        for what in mission.left_in_runtime_dir() {
            self.broke(format!("{what} remains"));
        }
        for root in roots {
            let segments = census::segments_of(root)?;
            if let Some(first) = segments.first() {
                let count = segments.len();
                self.broke(format!(
                    "{count} x shared memory remains, as /dev/shm/{first}"
                ));
            }
        }
        Ok(())
    }

    /// The log; what it lacks of the time before the orchestrator was killed [s].
    fn log(&mut self, mission: &Mission, done: &Injected) -> Option<f64> {
        let log = mission.log();
        let killed = self.fault.kind == FaultKind::KillOrchestrator;
        if !log.exists() {
            if killed {
                // Nothing had happened yet, or this is a loss.
                self.lost(done, 0);
            }
            return None;
        }
        let readable = if killed {
            let whole = mission.path().join("recovered.mcap");
            match logs::recover(&log, &whole, true, &mut watch()) {
                Ok(_) => whole,
                Err(error) => {
                    self.broke(format!("the log cannot be recovered: {error}"));
                    return None;
                }
            }
        } else {
            log
        };
        self.is_whole(&readable);
        if !killed {
            return None;
        }
        match logs::newest_state(&readable, &mut watch()) {
            Ok(newest) => Some(self.lost(done, newest.map_or(0, |tick| tick + 1))),
            Err(error) => {
                self.broke(format!("the recovered log cannot be read: {error}"));
                None
            }
        }
    }

    /// How old the oldest tick was that is missing in a log of so many [s]. (A world that says
    /// nothing loses nothing: the time since the last message says less.)
    fn lost(&mut self, done: &Injected, kept: u64) -> f64 {
        let lost_s = done.posts.age_beyond(kept, done.at_ns);
        if lost_s > LOST {
            self.broke(format!("the log lacks the last {lost_s:.3} s"));
        }
        lost_s
    }

    /// The robots of a planner that failed; simulated time until they stood [s].
    fn robots(
        &mut self,
        options: &ChaosOptions,
        mission: &Mission,
        done: &Injected,
    ) -> Option<f64> {
        let (scenario, fault) = (&options.scenario, self.fault);
        let robots = stops::driven_by(scenario, &fault.target);
        let log = mission.log();
        if !fault.is_failure() || robots.is_empty() || !log.exists() {
            return None;
        }
        // Ticks that a command is good for after its own.
        let good_for = match fault.course {
            Course::LockStep => 0,
            Course::RealTime => ticks_within(
                (scenario.run.command_deadline_s * 1e9) as u64,
                Duration::from_secs_f64(scenario.run.dt),
            ),
        };
        let stopped = match stops::Robots::read(&log, &robots, &mut watch()) {
            Ok(seen) => seen.stopped(done.at_ns, good_for),
            Err(error) => {
                self.broke(format!("the log cannot be read: {error}"));
                None
            }
        }?;
        if stopped.ticks > good_for + 1 {
            let ticks = stopped.ticks;
            self.broke(format!(
                "a robot drove on for {ticks} ticks or more without a command, which is good for {good_for}"
            ));
        }
        Some(stopped.after_s)
    }

    fn is_whole(&mut self, log: &Path) {
        match logs::LogInfo::read(log, &mut watch()) {
            Ok(info) if info.condition.is_whole() => {}
            Ok(info) => {
                let faults = info.condition.lines().join("; ");
                self.broke(format!("the log is not whole: {faults}"));
            }
            Err(error) => self.broke(format!("the log cannot be read: {error}")),
        }
    }
}

fn watch() -> Watch {
    Watch::new(std::sync::Arc::default(), true)
}
