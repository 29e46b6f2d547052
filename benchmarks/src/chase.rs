//! Real-time factor of the chase with all processes, and CPU time by process.

use std::collections::BTreeMap;
use std::time::Duration;

use crate::spread::Spread;
use runtime::lockstep::Phase;
use serde_json::Value as Json;

use super::probe;
use super::report::{Figure, Goal};
use super::session::{Session, View, number};
use super::{Options, Result, say};

const ITEM: &str = "chase";
/// Ticks per simulated second of the scenario.
const RATE_HZ: f64 = 20.0;
/// Goal of the real-time factor.
const GOAL: f64 = 200.0;
/// Interval between readings of CPU times: short enough for runs of some tenths of a second, long
/// enough to cost little.
const POLL_INTERVAL: Duration = Duration::from_millis(10);
/// Ticks after which maps are built and caches are filled.
const WARM_TICKS: u64 = 20;

/// Hops whose latency is shown, if the run has them.
const HOPS: [&str; 9] = [
    "simulator step",
    "simulator to perception",
    "perception step",
    "perception to pursuer",
    "pursuer step",
    "evader_potential step",
    "pursuer to simulator",
    "evader_potential to simulator",
    "sense to act",
];

/// Runs the chase with several seeds, on all processors and pinned to one in turn.
///
/// # Errors
/// The reason of a failed run.
pub fn measure(options: Options) -> Result<Vec<Figure>> {
    let seeds = options.repeats(5, 2) as u64;
    let mut reports: [Vec<Json>; 2] = [Vec::new(), Vec::new()];
    for seed in 1..=seeds {
        for (pin, reports) in ["none", "one_core"].iter().zip(&mut reports) {
            say(&format!("chase, seed {seed} of {seeds}, pin = {pin}"));
            let session = Session::start("chase", &arguments(seed, pin))?;
            reports.push(session.finish(Duration::from_millis(10), |_| {})?);
        }
    }
    let mut figures = Vec::new();
    for (name, reports) in ["all processors", "one processor"].iter().zip(&reports) {
        let factors = reports.iter().map(|r| number(r, "/real_time_factor"));
        figures.extend(Spread::from_values(factors).map(|factor| {
            Figure::new(
                ITEM,
                format!("real-time factor, {name}"),
                factor,
                "x real time",
            )
            .against("real time at 20 Hz", 1.0)
            .with_goal(Goal::RatioAtLeast(GOAL))
        }));
    }
    for hop in HOPS {
        for part in ["p50", "p99"] {
            let values = reports[0]
                .iter()
                .filter_map(|r| r.pointer("/latency_us")?.get(hop)?.get(part)?.as_f64());
            figures.extend(
                Spread::from_values(values)
                    .map(|value| Figure::new(ITEM, format!("{hop}, {part}"), value, "us")),
            );
        }
    }
    say("chase, CPU time of every process");
    figures.extend(cpu()?);
    Ok(figures)
}

fn arguments(seed: u64, pin: &str) -> [String; 4] {
    [
        "--seed".into(),
        seed.to_string(),
        "--set".into(),
        format!("run.pin={pin}"),
    ]
}

/// CPU times of a run at one moment (ns), by kind of process.
#[derive(Debug, Clone, Default)]
struct Moment {
    tick: u64,
    cpu: BTreeMap<String, u64>,
}

impl Moment {
    fn now(orchestrator: u32, view: &View) -> Self {
        let mut moment = Self {
            tick: view.barrier.ticks_posted(),
            cpu: BTreeMap::new(),
        };
        let mut add = |name: &str, ns: u64| {
            *moment.cpu.entry(name.to_owned()).or_default() += ns;
        };
        let recorder = probe::named_thread_cpu_ns(orchestrator, "recorder");
        add("recorder", recorder);
        add(
            "orchestrator",
            probe::cpu_ns(orchestrator).saturating_sub(recorder),
        );
        for member in &view.members {
            add(&member.kind, probe::cpu_ns(member.pid));
        }
        moment
    }
}

/// Returns CPU time per tick and kind of process, of one run that is sampled while it runs.
fn cpu() -> Result<Vec<Figure>> {
    let session = Session::start("chase", &arguments(1, "none"))?;
    let mut view = None;
    let (mut first, mut warm, mut last) = (None, None, None);
    session.finish(POLL_INTERVAL, |session| {
        if view.is_none() {
            view = View::find(session.pid());
        }
        let Some(view) = &view else { return };
        if view.barrier.phase() == Phase::Stop || view.barrier.is_over() {
            return;
        }
        let moment = Moment::now(session.pid(), view);
        if moment.tick == 0 {
            first = Some(moment);
        } else if moment.tick < WARM_TICKS || warm.is_none() {
            warm = Some(moment);
        } else {
            last = Some(moment);
        }
    })?;
    let mut figures = Vec::new();
    let until = |m: &Moment| m.cpu.values().sum::<u64>() as f64 * 1e-6;
    for (name, moment) in [
        ("CPU before the first tick, all processes", &first),
        ("CPU until caches are warm, all processes", &warm),
    ] {
        figures.extend(
            moment
                .as_ref()
                .map(|m| Figure::once(ITEM, name, until(m), "ms")),
        );
    }
    if let (Some(warm), Some(last)) = (warm, last) {
        figures.extend(per_tick(&warm, &last));
    }
    Ok(figures)
}

/// Returns CPU per tick between two moments, the largest first, and the sum.
fn per_tick(from: &Moment, to: &Moment) -> Vec<Figure> {
    let ticks = to.tick.saturating_sub(from.tick);
    if ticks == 0 {
        return Vec::new();
    }
    let mut shares: Vec<(&str, f64)> = to
        .cpu
        .iter()
        .map(|(name, &ns)| {
            let used = ns.saturating_sub(from.cpu.get(name).copied().unwrap_or(0));
            (name.as_str(), used as f64 * 1e-3 / ticks as f64)
        })
        .collect();
    shares.sort_by(|a, b| b.1.total_cmp(&a.1));
    let total: f64 = shares.iter().map(|(_, us)| us).sum();
    let processors = std::thread::available_parallelism().map_or(1, usize::from) as f64;
    let budget = processors * 1e6 / (RATE_HZ * GOAL);
    let mut figures = vec![
        Figure::once(ITEM, "CPU per tick, all processes", total, "us")
            .with_goal(Goal::AtMost(budget)),
    ];
    figures.extend(shares.iter().map(|(name, us)| {
        Figure::once(ITEM, format!("CPU per tick, {name}"), *us, "us").against("all", total)
    }));
    figures
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cpu_per_tick_is_the_difference_over_the_ticks_between() {
        let moment = |tick, pursuer, simulator| Moment {
            tick,
            cpu: BTreeMap::from([
                ("pursuer".to_owned(), pursuer),
                ("simulator".to_owned(), simulator),
            ]),
        };
        let figures = per_tick(&moment(10, 5_000, 1_000), &moment(20, 305_000, 101_000));
        let values: Vec<_> = figures.iter().map(|f| f.value.median).collect();
        assert_eq!(values, [40.0, 30.0, 10.0]);
        assert!(figures[1].name.ends_with("pursuer"));
        assert_eq!(figures[1].ratio, Some(0.75));
        assert!(per_tick(&moment(10, 0, 0), &moment(10, 1, 1)).is_empty());
    }
}
