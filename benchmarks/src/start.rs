//! Start time of a run, its memory and the size of its log.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use crate::spread::Spread;
use runtime::lockstep::Phase;

use super::probe;
use super::report::{Figure, Goal};
use super::session::{Session, View, number};
use super::{Options, Result, say};

const ITEM: &str = "start";
/// Goal of the real time to the first tick (s).
const GOAL_S: f64 = 0.5;
/// Interval between checks of a starting run.
const POLL_INTERVAL: Duration = Duration::from_micros(500);
/// Tick at which memory is read: maps and caches are complete by then.
const MEMORY_TICK: u64 = 100;

/// Moments of a start, observed from outside (s after the start of the run's executable).
#[derive(Debug, Clone, Copy, Default)]
struct Parts {
    /// All processes have been started and the tick barrier exists.
    launched: f64,
    /// Every process has opened its ports.
    ready: f64,
    /// Every port is connected: the map is sent.
    connected: f64,
    /// Every process has processed the map: time starts.
    running: f64,
    /// The simulator has posted the first state.
    first_tick: f64,
    /// Every process has answered the first tick.
    answered: f64,
}

/// Starts the chase several times, then measures its memory and log once.
///
/// # Errors
/// The reason of a failed run.
pub fn measure(options: Options) -> Result<Vec<Figure>> {
    let repeats = options.repeats(7, 3);
    let mut parts = Vec::new();
    let mut startup_times = Vec::new();
    for repeat in 1..=repeats {
        say(&format!("start of the chase, {repeat} of {repeats}"));
        let (seen, own) = start_once()?;
        parts.push(seen);
        startup_times.push(own);
    }
    let mut figures = Vec::new();
    let spread = |part: fn(&Parts) -> f64| Spread::from_values(parts.iter().map(part));
    let (mut before, mut before_name) = (0.0, "start");
    for (name, part) in [
        ("processes launched", (|p| p.launched) as fn(&Parts) -> f64),
        ("all ports open", |p| p.ready),
        ("all ports connected", |p| p.connected),
        ("all maps built", |p| p.running),
        ("first tick posted", |p| p.first_tick),
        ("first tick answered by all", |p| p.answered),
    ] {
        let Some(value) = spread(part) else { continue };
        let mut figure = Figure::new(ITEM, name, value, "s").against(before_name, before);
        figure.ratio = None;
        if name == "first tick posted" {
            figure = figure.with_goal(Goal::AtMost(GOAL_S));
        }
        (before, before_name) = (value.median, name);
        figures.push(figure);
    }
    figures.extend(
        Spread::from_values(startup_times)
            .map(|value| Figure::new(ITEM, "first tick, as the run reports it", value, "s")),
    );
    say("memory and log of the chase");
    figures.extend(memory_and_log()?);
    Ok(figures)
}

/// Starts a short chase and records the moments of its start.
fn start_once() -> Result<(Parts, f64)> {
    let arguments = ["--set", "rules.time_limit=0.5"].map(String::from);
    let session = Session::start("chase", &arguments)?;
    let mut parts = Parts::default();
    let mut view = None;
    let report = session.finish(POLL_INTERVAL, |session| {
        let now = session.age().as_secs_f64();
        if view.is_none() {
            view = View::find(session.pid());
            parts.launched = now;
        }
        let Some(View { barrier, .. }) = &view else {
            return;
        };
        let take = |part: &mut f64, reached: bool| {
            if reached && *part == 0.0 {
                *part = now;
            }
        };
        take(&mut parts.ready, barrier.phase() >= Phase::Connect);
        take(&mut parts.connected, barrier.phase() >= Phase::Prepare);
        take(&mut parts.running, barrier.phase() >= Phase::Run);
        take(&mut parts.first_tick, barrier.ticks_posted() >= 1);
        take(&mut parts.answered, barrier.ticks_posted() >= 2);
    })?;
    if view.is_none() {
        return Err("the run ended before its processes were found".into());
    }
    Ok((parts, number(&report, "/start_up_s")))
}

/// Measures the memory of every process in the middle of a chase, and the size of the log.
fn memory_and_log() -> Result<Vec<Figure>> {
    let session = Session::start("chase", &[])?;
    let mut view = None;
    let mut seen: BTreeMap<String, Vec<probe::Memory>> = BTreeMap::new();
    let begun = Instant::now();
    let report = session.finish(Duration::from_millis(2), |session| {
        if view.is_none() {
            view = View::find(session.pid());
        }
        let Some(view) = &view else { return };
        if !seen.is_empty() || view.barrier.ticks_posted() < MEMORY_TICK {
            return;
        }
        for member in &view.members {
            seen.entry(member.kind.clone())
                .or_default()
                .extend(probe::memory(member.pid));
        }
        seen.entry("orchestrator".into())
            .or_default()
            .extend(probe::memory(session.pid()));
    })?;
    let wall = begun.elapsed().as_secs_f64();
    let mut figures = Vec::new();
    let mut total = 0.0;
    for (kind, memories) in &seen {
        let mib = |bytes: u64| bytes as f64 / 1_048_576.0;
        total += memories.iter().map(|m| mib(m.pss)).sum::<f64>();
        let name = |what: &str| format!("{what} of {kind} ({} of them)", memories.len());
        figures.extend(
            Spread::from_values(memories.iter().map(|m| mib(m.pss)))
                .map(|value| Figure::new(ITEM, name("PSS"), value, "MiB")),
        );
        figures.extend(
            Spread::from_values(memories.iter().map(|m| mib(m.rss)))
                .map(|value| Figure::new(ITEM, name("RSS"), value, "MiB")),
        );
    }
    if total > 0.0 {
        figures.push(Figure::once(ITEM, "PSS of the whole run", total, "MiB"));
    }
    let simulated = number(&report, "/sim_time_s");
    if simulated > 0.0 {
        let bytes = number(&report, "/log_bytes") / simulated;
        figures.push(Figure::once(
            ITEM,
            "log per simulated second",
            bytes / 1024.0,
            "KiB/s",
        ));
    }
    figures.push(Figure::once(ITEM, "whole command", wall, "s"));
    Ok(figures)
}
