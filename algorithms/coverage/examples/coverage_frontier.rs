//! Coverage against predictability: the table of `docs/results/coverage.md`.
//!
//! `cargo run -p coverage --example coverage_frontier -- [keys] [guesses] [watched]`
//!
//! Drives every planner over the empty 10 m × 10 m workplace with a disc of radius 0.1 m, under
//! `keys` different keys (30). Observers guess every next sub-goal of the first 800 m. The observer
//! that knows the method and its state, but not the key, guesses from `guesses` (24) next sub-goals
//! under keys of its own, for the first `watched` (8) of the keys.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::process::ExitCode;

use chaotic_maps::{ChebP, Emission, KeyedStream, Source};
use coverage::boustrophedon::Boustrophedon;
use coverage::decomposition::Decomposition;
use coverage::goal::GoalSource;
use coverage::keyed::{KeyedCoverage, KeyedParams};
use coverage::random_bounce::RandomBounce;
use coverage::uniform::UniformGoals;
use coverage::workplace::Workplace;
use geometry::shape::Aabb;
use metrics::coverage::{CellGrid, SweptCells};
use metrics::quantile::quantile;
use nalgebra::{Point2, Vector2};

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Lengths of path at which coverage is measured (m).
const MARKS: [f64; 4] = [250.0, 500.0, 800.0, 1000.0];
/// Length of path for the observers (m).
const WATCHED: f64 = 800.0;
/// Number of sub-goals observed before the observers without the method begin to guess.
const HISTORY: usize = 20;
/// Maximum length of a path (m).
const LIMIT: f64 = 4000.0;
/// Distance (m) below which a guess is a hit.
const HIT: f64 = 0.5;

/// A planner and, if it is used for guesses, the method as an observer knows it.
enum Planner {
    Keyed(KeyedParams),
    Uniform,
    Bounce,
    Chebyshev(Emission),
    Boustrophedon,
}

/// Result of a run under one key.
#[derive(Default)]
struct Run {
    at_marks: [f64; 4],
    /// Length at which 0.95 was covered (m); NaN if never.
    to_95: f64,
    goals: usize,
    /// Errors of the observers (m): the method, neighbours in the plane, neighbours per
    /// coordinate, constant velocity.
    errors: [Vec<f64>; 4],
    hits: usize,
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let mut number = |default: usize| arguments.next().map_or(Ok(default), |text| text.parse());
    let (keys, guesses, watched) = (number(30)?, number(24)?, number(8)?);
    let keyed = |choices: f64| {
        let params = KeyedParams {
            choices,
            ..KeyedParams::default()
        };
        (format!("keyed, {choices} orders"), Planner::Keyed(params))
    };
    let mut planners = vec![
        ("i.i.d. uniform".to_owned(), Planner::Uniform),
        ("boustrophedon".to_owned(), Planner::Boustrophedon),
        ("random bounce".to_owned(), Planner::Bounce),
        (
            "Chebyshev raw".to_owned(),
            Planner::Chebyshev(Emission::Raw),
        ),
        (
            "Chebyshev arcsine".to_owned(),
            Planner::Chebyshev(Emission::Arcsine),
        ),
    ];
    planners.extend([1.0, 1.4, 1.6, 2.0, 3.0].map(keyed));
    println!(
        "| planner | 250 m | 500 m | 800 m | 1000 m | to 0.95 [m] | goals | method | lower quartile \
         | hits | neighbour | per coordinate | velocity |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    let mut reference = None;
    for (name, planner) in planners {
        let runs = all_keys(
            &planner,
            keys,
            |key| if key < watched { guesses } else { 0 },
        )?;
        let row = Row::new(&runs);
        let reference = reference.get_or_insert_with(|| row.clone());
        row.print(&name, reference);
    }
    Ok(())
}

/// Runs all keys, on as many threads as there are processors.
fn all_keys(
    planner: &Planner,
    keys: usize,
    guesses: impl Fn(usize) -> usize + Sync,
) -> Result<Vec<Run>, Failure> {
    let keys = match planner {
        Planner::Boustrophedon => 1,
        _ => keys,
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let parts: Vec<Result<Vec<(usize, Run)>, Failure>> = std::thread::scope(|scope| {
        let guesses = &guesses;
        let work = move |thread: usize| {
            let mine = (thread..keys).step_by(threads);
            mine.map(|key| Ok((key, one_key(planner, key as u64, guesses(key))?)))
                .collect()
        };
        let handles: Vec<_> = (0..threads)
            .map(|thread| scope.spawn(move || work(thread)))
            .collect();
        let join = |handle: std::thread::ScopedJoinHandle<'_, _>| handle.join();
        handles
            .into_iter()
            .map(|handle| join(handle).unwrap_or_else(|_| Err("a thread has panicked".into())))
            .collect()
    });
    let mut runs = Vec::new();
    for part in parts {
        runs.extend(part?);
    }
    runs.sort_by_key(|&(key, _)| key);
    Ok(runs.into_iter().map(|(_, run)| run).collect())
}

/// Keys of the planners (`of` = 0) and of the observers' guesses.
fn key(of: u64, number: u64, guess: u64) -> [u8; 32] {
    let mut key = [0; 32];
    for (part, value) in key.chunks_exact_mut(8).zip([of, number, guess, 5]) {
        part.copy_from_slice(&value.to_le_bytes());
    }
    key
}

/// Returns the next sub-goal after a point, and those that an observer with the method considers
/// possible.
type Next = Box<dyn FnMut(Point2<f64>) -> (Option<Point2<f64>>, Vec<Point2<f64>>)>;

fn one_key(planner: &Planner, number: u64, guesses: usize) -> Result<Run, Failure> {
    let bounds = Aabb {
        min: Point2::origin(),
        max: Point2::new(10.0, 10.0),
    };
    let workplace = Workplace::new(bounds, 0.1, &[], 0.01)?;
    let parts = Decomposition::new(&workplace)?;
    let mut swept = SweptCells::new(CellGrid::new(&workplace.domain()?, 0.1)?, 0.1);
    let secret = key(0, number, 0);
    let home = match planner {
        Planner::Boustrophedon => Point2::new(0.1, 0.1),
        _ => {
            UniformGoals::new(&workplace, &parts, bounds.center(), key(2, number, 0))
                .next_goal(bounds.center())
                .ok_or("no start")?
                .waypoint
                .point
        }
    };
    let mut next: Next;
    let mut steps = 0_u64;
    let point = |goal: coverage::goal::Goal| goal.waypoint.point;
    // The candidates are drawn from the state before the planner moves on.
    macro_rules! guessing {
        ($planner:expr) => {{
            let mut planner = $planner;
            let mut length = 0.0;
            Box::new(move |from: Point2<f64>| {
                steps += 1;
                let watched = length < WATCHED;
                let guesses = if watched { guesses as u64 } else { 0 };
                let under = |guess| {
                    let mut other = planner.with_key(key(1 + steps, number, guess));
                    other.next_goal(from).map(point)
                };
                let possible: Vec<_> = (0..guesses).filter_map(under).collect();
                let goal = planner.next_goal(from).map(point);
                length += goal.map_or(0.0, |to: Point2<f64>| (to - from).norm());
                (goal, possible)
            })
        }};
    }
    match planner {
        Planner::Keyed(params) => {
            let params = params.clone();
            next = guessing!(KeyedCoverage::new(
                &workplace, &parts, home, 0.1, secret, params
            )?);
        }
        Planner::Uniform => {
            next = guessing!(UniformGoals::new(&workplace, &parts, home, secret));
        }
        Planner::Bounce => {
            next = guessing!(RandomBounce::new(&workplace, &parts, home, secret));
        }
        Planner::Boustrophedon => {
            let mut lanes = Boustrophedon::new(&workplace, &parts, home, 0.1)?;
            next = Box::new(move |from| {
                let goal = lanes.next_goal(from).map(point);
                (goal, goal.into_iter().collect())
            });
        }
        Planner::Chebyshev(emission) => {
            next = chebyshev(&workplace, secret, *emission)?;
        }
    }
    let mut run = Run {
        to_95: f64::NAN,
        ..Run::default()
    };
    let mut history = vec![home];
    let (mut from, mut length) = (home, 0.0);
    swept.sweep(home, home);
    while length < LIMIT && (length < 1000.0 || run.to_95.is_nan()) {
        let (goal, possible) = next(from);
        let Some(to) = goal else { break };
        if length < WATCHED {
            run.goals += 1;
            watch(&mut run, &history, &possible, to);
        }
        let leg = (to - from).norm();
        for (mark, at) in MARKS.iter().zip(&mut run.at_marks) {
            if length < *mark && length + leg >= *mark {
                let mut there = swept.clone();
                there.sweep(from, from + (to - from) * ((mark - length) / leg));
                *at = there.rate();
            }
        }
        swept.sweep(from, to);
        length += leg;
        if run.to_95.is_nan() && swept.rate() >= 0.95 {
            run.to_95 = length;
        }
        history.push(to);
        from = to;
    }
    for (mark, at) in MARKS.iter().zip(&mut run.at_marks) {
        if length < *mark {
            *at = swept.rate();
        }
    }
    Ok(run)
}

/// Known method: the state can be recovered within some twenty sub-goals, and the next one is known.
fn chebyshev(workplace: &Workplace, secret: [u8; 32], emission: Emission) -> Result<Next, Failure> {
    let [a, b] = KeyedStream::new(secret)
        .next_unit()
        .map(|u| (u * 9.2e18) as u64);
    let mut source = ChebP::new(a, b, emission)?;
    let inner = workplace.inner();
    Ok(Box::new(move |_| {
        let [x, y] = source.next_symmetric();
        let goal = inner.center() + inner.half_extents().component_mul(&Vector2::new(x, y));
        (Some(goal), vec![goal])
    }))
}

/// Lets the observers guess `next`, the sub-goal after those in `history`.
fn watch(run: &mut Run, history: &[Point2<f64>], possible: &[Point2<f64>], next: Point2<f64>) {
    let [method, plane, coordinate, velocity] = &mut run.errors;
    if let Some(median) = geometric_median(possible) {
        method.push((median - next).norm());
        let near = |p: Point2<f64>| possible.iter().filter(|q| (*q - p).norm() < HIT).count();
        let best = possible.iter().max_by_key(|p| near(**p));
        run.hits += usize::from(best.is_some_and(|p| (p - next).norm() < HIT));
    }
    let ([.., before, last], true) = (history, history.len() > HISTORY) else {
        return;
    };
    let nearest = |distance: &dyn Fn(Point2<f64>) -> f64| {
        let pairs = history.windows(2);
        pairs
            .min_by(|a, b| distance(a[0]).total_cmp(&distance(b[0])))
            .map_or(*last, |pair| pair[1])
    };
    plane.push((nearest(&|p| (p - last).norm()) - next).norm());
    for axis in 0..2 {
        let guess = nearest(&|p| (p[axis] - last[axis]).abs());
        coordinate.push((guess[axis] - next[axis]).abs());
    }
    let onward = last + (last - before);
    let inside = onward.coords.map(|c| c.clamp(0.1, 9.9));
    velocity.push((inside - next.coords).norm());
}

/// The point with the minimum sum of distances (Weiszfeld's iteration).
fn geometric_median(points: &[Point2<f64>]) -> Option<Point2<f64>> {
    let count = points.len() as f64;
    let sum: Vector2<f64> = points.iter().map(|p| p.coords).sum();
    let mut median = Point2::from(sum / count);
    for _ in 0..100 {
        let weights = points.iter().map(|p| 1.0 / (p - median).norm().max(1e-4));
        let total: f64 = weights.clone().sum();
        let moved: Vector2<f64> = points.iter().zip(weights).map(|(p, w)| p.coords * w).sum();
        median = Point2::from(moved / total);
    }
    (!points.is_empty()).then_some(median)
}

/// Figures of all runs of one planner.
#[derive(Clone)]
struct Row {
    at_marks: [(f64, f64); 4],
    to_95: (f64, f64),
    reached_95: usize,
    keys: usize,
    goals: f64,
    hits: f64,
    /// Median errors of the four observers, and the lower quartile of the first (m).
    medians: [f64; 4],
    quartile: f64,
}

impl Row {
    fn new(runs: &[Run]) -> Self {
        let errors = [0, 1, 2, 3].map(|o| {
            let all = runs.iter().flat_map(|run| run.errors[o].iter().copied());
            let mut sorted: Vec<f64> = all.collect();
            sorted.sort_by(f64::total_cmp);
            sorted
        });
        let quantile = |sorted: &[f64], part: f64| quantile(sorted, part).unwrap_or(f64::NAN);
        let to_95: Vec<f64> = runs
            .iter()
            .map(|r| r.to_95)
            .filter(|l| !l.is_nan())
            .collect();
        let goals: usize = runs.iter().map(|r| r.goals).sum();
        let hits: usize = runs.iter().map(|r| r.hits).sum();
        Self {
            at_marks: [0, 1, 2, 3]
                .map(|m| spread(&runs.iter().map(|r| r.at_marks[m]).collect::<Vec<_>>())),
            reached_95: to_95.len(),
            to_95: spread(&to_95),
            keys: runs.len(),
            goals: goals as f64 / runs.len() as f64,
            hits: hits as f64 / errors[0].len() as f64,
            medians: errors.each_ref().map(|e| quantile(e, 0.5)),
            quartile: quantile(&errors[0], 0.25),
        }
    }

    fn print(&self, name: &str, reference: &Self) {
        let marks = self
            .at_marks
            .map(|(mean, sd)| format!("{mean:.3} ± {sd:.3}"));
        let length = match self.to_95 {
            (mean, sd) if self.reached_95 == self.keys => format!("{mean:.0} ± {sd:.0}"),
            _ => format!("{} of {}", self.reached_95, self.keys),
        };
        let [method, plane, coordinate, velocity] =
            [0, 1, 2, 3].map(|o| self.medians[o] / reference.medians[o]);
        println!(
            "| {name} | {} | {length} | {:.0} | {method:.3} | {:.3} | {:.3} | {plane:.3} | \
             {coordinate:.3} | {velocity:.3} |",
            marks.join(" | "),
            self.goals,
            self.quartile / reference.quartile,
            self.hits,
        );
    }
}

/// Mean and standard deviation.
fn spread(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
    (mean, (square / (count - 1.0).max(1.0)).sqrt())
}
