//! Dominance at one moment.

use nalgebra::Point2;

use super::{Arena, Cell, Owner};
use crate::wavefront::{Source, Wave};
use planner_view::map::PlannerMap;

/// A robot that takes part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Runner {
    /// Where it is (m).
    pub at: Point2<f64>,
    /// Its top speed (m/s).
    pub speed: f64,
}

/// What an evader can be sure of.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Verdict {
    /// Whether it safely reaches an exit.
    pub escape_possible: bool,
    /// The exit with the greatest margin; `None` if there is no exit that it could reach even
    /// without pursuers.
    pub exit: Option<usize>,
    /// How much earlier than any pursuer it is at that exit (s); −∞ without an exit, ∞ without
    /// pursuers. If an escape is possible, on the safe way with the greatest margin. If not, on the
    /// shortest way, and then it may still be positive: the evader would be first, but a pursuer
    /// can cut off the way.
    pub margin: f64,
    /// Time of the safe way to the exit (s); infinite if there is none.
    pub time: f64,
    /// Share of all places where a robot fits that it safely reaches, 0..1.
    pub area_share: f64,
}

/// Computes dominance; keeps its memory from one moment to the next.
#[derive(Debug, Clone, Default)]
pub struct Dominance {
    police: Wave,
    sources: Vec<Source>,
    safe: Vec<Wave>,
    verdicts: Vec<Verdict>,
    free: Wave,
}

impl Dominance {
    /// Assesses one moment; a verdict per evader, in the order given. A pursuer catches within
    /// `capture` (m).
    ///
    /// The arena must have been made from this map. Robots with numbers out of range are treated as
    /// if they were not there.
    pub fn assess(
        &mut self,
        map: &PlannerMap,
        arena: &Arena,
        police: &[Runner],
        evaders: &[Runner],
        capture: f64,
    ) -> &[Verdict] {
        let medium = arena.medium();
        self.sources.clear();
        self.sources
            .extend((0..).zip(police).map(|(label, runner)| Source {
                reach: capture.max(0.0),
                ..Source::new(runner.at, runner.speed, label)
            }));
        self.police.spread(medium, map, &self.sources, None);
        self.safe.resize_with(evaders.len(), Wave::default);
        self.verdicts.clear();
        for ((label, evader), safe) in (0..).zip(evaders).zip(&mut self.safe) {
            // Within the capture radius it is too late for everything.
            let caught = |runner: &Runner| (runner.at - evader.at).norm() < capture;
            let source = Source::new(evader.at, evader.speed, label);
            let sources = if police.iter().any(caught) {
                &[][..]
            } else {
                &[source][..]
            };
            safe.spread(medium, map, sources, Some(&self.police));
            let race = |exit: usize| race(arena, exit, police, evader, capture);
            self.verdicts.push(verdict(arena, &self.police, safe, race));
        }
        &self.verdicts
    }

    /// The verdicts of the last assessment.
    pub fn verdicts(&self) -> &[Verdict] {
        &self.verdicts
    }

    /// When each place is reached by a pursuer, after the last assessment.
    pub fn police(&self) -> &Wave {
        &self.police
    }

    /// When each place is safely reached by an evader, after the last assessment.
    pub fn safe(&self, evader: usize) -> Option<&Wave> {
        self.safe.get(evader)
    }

    /// Dominance cell by cell, in the order of the lattice's frame; of the moment assessed last,
    /// with the same robots.
    ///
    /// Costs one more wave than the assessment.
    pub fn cells(
        &mut self,
        map: &PlannerMap,
        arena: &Arena,
        evaders: &[Runner],
        cells: &mut Vec<Cell>,
    ) {
        let lattice = arena.lattice();
        self.sources.clear();
        self.sources.extend(
            (0..)
                .zip(evaders)
                .map(|(label, runner)| Source::new(runner.at, runner.speed, label)),
        );
        self.free.spread(arena.medium(), map, &self.sources, None);
        cells.clear();
        cells.extend((0..lattice.frame().len()).map(|cell| {
            lattice
                .node_of_cell(cell)
                .map_or_else(Cell::default, |node| self.cell(node))
        }));
    }

    fn cell(&self, node: usize) -> Cell {
        let police = self.police.time(node);
        let mut safest: Option<(f32, u32)> = None;
        for (evader, safe) in (0..).zip(&self.safe) {
            let time = safe.time(node);
            if time.is_finite() && safest.is_none_or(|(least, _)| time < least) {
                safest = Some((time, evader));
            }
        }
        if let Some((time, first)) = safest {
            return Cell {
                owner: Owner::Evader,
                first,
                margin: police - time,
            };
        }
        let free = self.free.time(node);
        if free < police {
            let first = self.free.label(node).unwrap_or_default();
            let margin = police - free;
            return Cell {
                owner: Owner::CutOff,
                first,
                margin,
            };
        }
        self.police
            .label(node)
            .map_or_else(Cell::default, |first| Cell {
                owner: Owner::Police,
                first,
                margin: police - free,
            })
    }
}

/// The verdict on an evader from its safe wave.
fn verdict(arena: &Arena, police: &Wave, safe: &Wave, race: impl Fn(usize) -> f64) -> Verdict {
    let reached = safe.times().iter().filter(|time| time.is_finite()).count();
    let mut best = Verdict {
        margin: f64::NEG_INFINITY,
        time: f64::INFINITY,
        area_share: reached as f64 / (arena.lattice().len().max(1)) as f64,
        ..Verdict::default()
    };
    for exit in 0..arena.exits() {
        for &node in arena.exit_nodes(exit) {
            let time = f64::from(safe.time(node as usize));
            let margin = f64::from(police.time(node as usize)) - time;
            if time.is_finite() && (margin > best.margin || !best.escape_possible) {
                best.escape_possible = true;
                best.exit = Some(exit);
                best.margin = margin;
                best.time = time;
            }
        }
    }
    if best.escape_possible {
        return best;
    }
    for exit in 0..arena.exits() {
        let margin = race(exit);
        if margin > best.margin {
            best.exit = Some(exit);
            best.margin = margin;
        }
    }
    best
}

/// How much earlier than any pursuer an evader is at an exit (s) if both go the shortest way; −∞ if
/// the evader cannot get there.
fn race(arena: &Arena, exit: usize, police: &[Runner], evader: &Runner, capture: f64) -> f64 {
    let lattice = arena.lattice();
    let Some(way) = arena.way_to(exit) else {
        return f64::NEG_INFINITY;
    };
    let time = |runner: &Runner, reach: f64| {
        let left = (way.time_at(lattice, runner.at) - reach).max(0.0);
        // A robot that is there needs no speed.
        if left > 0.0 { left / runner.speed } else { 0.0 }
    };
    let own = time(evader, 0.0);
    if !own.is_finite() {
        return f64::NEG_INFINITY;
    }
    police
        .iter()
        .map(|runner| time(runner, capture.max(0.0)))
        .fold(f64::INFINITY, f64::min)
        - own
}
