//! Games per second of runs in one process, against runs with processes; and the cost of a log.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::spread::{Spread, paired_ratio};
use kinds::load;
use mission::in_process::{self, Cache, InProcessOptions};
use rustix::time::{ClockId, clock_gettime};
use scenario::ResolvedScenario;

use super::report::{Figure, Goal};
use super::session::{Session, number};
use super::{Options, Result, say};

const ITEM: &str = "in-process";
/// Goal of games per second and core.
const GOAL: f64 = 200.0;

/// A kind of game.
struct Game {
    name: &'static str,
    scenario: &'static str,
    set: &'static [&'static str],
    /// Games that fill the cache before the measurement, as in a sweep of thousands.
    warm: u64,
    /// Games between two readings of the clock.
    batch: u64,
    /// Number of measured batches.
    batches: usize,
    goal: Option<f64>,
}

const GAMES: [Game; 3] = [
    Game {
        name: "chase_exact",
        scenario: "chase_exact",
        set: &[],
        warm: 24,
        batch: 8,
        batches: 12,
        goal: Some(GOAL),
    },
    Game {
        name: "chase_exact, both sides as in the paper",
        scenario: "chase_exact",
        set: &[
            "processes.pursuer.params.preset=paper",
            "processes.evader_potential.params.preset=paper",
        ],
        warm: 8,
        batch: 8,
        batches: 12,
        goal: Some(GOAL),
    },
    Game {
        name: "chase, with perception",
        scenario: "chase",
        set: &[],
        warm: 2,
        batch: 2,
        batches: 4,
        goal: None,
    },
];

/// Runs games with many seeds in this thread, and some of the same with processes; then a chase
/// with and without its log, alternately.
///
/// # Errors
/// The reason of a failed game.
pub fn measure(options: Options) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for game in &GAMES {
        say(&format!("{}, in this process", game.name));
        let here = here(game, options)?;
        let mut beside = Vec::new();
        for seed in 1..=options.repeats(4, 2) as u64 {
            say(&format!("{}, with processes, seed {seed}", game.name));
            beside.push(with_processes(game, seed)?);
        }
        figures.extend(report(game, &here, &beside));
    }
    figures.extend(log_share(options)?);
    Ok(figures)
}

/// Games in this thread.
#[derive(Default)]
struct Here {
    /// Per batch, games per second of CPU time.
    rates: Vec<f64>,
    /// Per batch, CPU time per tick (µs).
    costs: Vec<f64>,
    /// Per batch, time to resolve a scenario (ms).
    resolving: Vec<f64>,
    /// Per game, its length (ticks).
    ticks: Vec<f64>,
}

fn here(game: &Game, options: Options) -> Result<Here> {
    let how = InProcessOptions {
        cache: Arc::new(Cache::default()),
        ..InProcessOptions::default()
    };
    let mut here = Here::default();
    let mut seed = 0;
    let mut play = |games: u64, here: Option<&mut Here>| -> Result<()> {
        let begun = cpu_time();
        let scenarios = (0..games)
            .map(|_| {
                seed += 1;
                resolve(game, seed)
            })
            .collect::<Result<Vec<_>>>()?;
        let resolved = cpu_time();
        let mut ticks = Vec::new();
        for scenario in &scenarios {
            ticks.push(in_process::run(scenario, &how)?.summary.ticks as f64);
        }
        let took = cpu_time().saturating_sub(resolved).as_secs_f64().max(1e-9);
        if let Some(here) = here {
            let resolving = resolved.saturating_sub(begun).as_secs_f64();
            here.resolving.push(resolving * 1e3 / games as f64);
            here.rates.push(games as f64 / took);
            here.costs
                .push(took * 1e6 / ticks.iter().sum::<f64>().max(1.0));
            here.ticks.extend(ticks);
        }
        Ok(())
    };
    play(game.warm, None)?;
    for _ in 0..options.repeats(game.batches, game.batches.div_ceil(4)) {
        play(game.batch, Some(&mut here))?;
    }
    Ok(here)
}

/// Runs one game with processes. Returns the time before and after its ticks, and per tick (s).
fn with_processes(game: &Game, seed: u64) -> Result<(f64, f64)> {
    let mut arguments = vec!["--seed".to_owned(), seed.to_string()];
    for set in game.set {
        arguments.extend(["--set".to_owned(), (*set).to_owned()]);
    }
    let begun = Instant::now();
    let session = Session::start(game.scenario, &arguments)?;
    let report = session.finish(Duration::from_millis(1), |_| {})?;
    let lasted = number(&report, "/wall_time_s");
    let fixed = (begun.elapsed().as_secs_f64() - lasted).max(0.0);
    Ok((fixed, lasted / number(&report, "/ticks").max(1.0)))
}

fn report(game: &Game, here: &Here, beside: &[(f64, f64)]) -> Vec<Figure> {
    let figure = |what: &str, values: &[f64], unit| {
        Spread::from_values(values.iter().copied())
            .map(|value| Figure::new(ITEM, format!("{}: {what}", game.name), value, unit))
    };
    // Games have different lengths: compare the time of a game of the mean length.
    let mean = here.ticks.iter().sum::<f64>() / here.ticks.len().max(1) as f64;
    let rate = |(fixed, per_tick): &(f64, f64)| 1.0 / (fixed + per_tick * mean).max(1e-9);
    let with_processes = Spread::from_values(beside.iter().map(rate));
    let games = figure("games/s of one core", &here.rates, "games/s").map(|games| {
        let games = match with_processes {
            Some(beside) => games.against("with processes, one game at a time", beside.median),
            None => games,
        };
        match game.goal {
            Some(goal) => games.with_goal(Goal::AtLeast(goal)),
            None => games,
        }
    });
    [
        games,
        figure("CPU per tick", &here.costs, "us"),
        figure("resolving a scenario", &here.resolving, "ms"),
        figure("length of a game", &here.ticks, "ticks"),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Measures CPU time per tick of a chase with and without a log, alternately. The file is in
/// memory, so that no disk counts.
fn log_share(options: Options) -> Result<Vec<Figure>> {
    say("chase, in this process with and without a log");
    let folder = tempfile::tempdir_in("/dev/shm")?;
    let set = options.quick.then(|| "rules.time_limit=10".to_owned());
    let scenario = load("chase", set.as_slice(), None).map_err(|e| e.to_string())?;
    let per_tick = |out: Option<PathBuf>| -> Result<f64> {
        let how = InProcessOptions {
            out,
            force: true,
            ..InProcessOptions::default()
        };
        let begun = cpu_time();
        let ticks = in_process::run(&scenario, &how)?.summary.ticks;
        let took = cpu_time().saturating_sub(begun);
        Ok(took.as_secs_f64() * 1e6 / f64::max(ticks as f64, 1.0))
    };
    // Fills the caches before the measurement.
    per_tick(None)?;
    let (mut with, mut without) = (Vec::new(), Vec::new());
    for _ in 0..options.repeats(6, 2) {
        with.push(per_tick(Some(folder.path().join("run.mcap")))?);
        without.push(per_tick(None)?);
    }
    let spreads = (
        Spread::from_values(with.iter().copied()),
        Spread::from_values(without.iter().copied()),
        paired_ratio(&with, &without),
    );
    let (Some(value), Some(base), Some(ratio)) = spreads else {
        return Ok(Vec::new());
    };
    let figure = Figure::new(ITEM, "chase, CPU per tick with a log", value, "us");
    let figure = figure.against("without a log", base.median);
    Ok(vec![figure.with_ratio(ratio.median)])
}

fn resolve(game: &Game, seed: u64) -> Result<ResolvedScenario> {
    let set: Vec<String> = game.set.iter().map(|&set| set.to_owned()).collect();
    Ok(load(game.scenario, &set, Some(seed)).map_err(|problems| problems.to_string())?)
}

/// CPU time of this thread.
fn cpu_time() -> Duration {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(
        u64::try_from(now.tv_sec).unwrap_or(0),
        u32::try_from(now.tv_nsec).unwrap_or(0),
    )
}
