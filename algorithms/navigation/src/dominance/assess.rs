//! Dominance at one instant.

use nalgebra::Point2;

use super::{Arena, Cell, Owner};
use crate::wavefront::{Source, Wave};
use planner_view::map::PlannerMap;

/// A robot of the game.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Runner {
    /// Position (m).
    pub at: Point2<f64>,
    /// Top speed (m/s).
    pub speed: f64,
}

/// Guaranteed outcome for an evader.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Verdict {
    /// `true` if the evader safely reaches an exit.
    pub escape_possible: bool,
    /// The exit with the greatest margin; `None` if the evader could reach no exit even without
    /// pursuers.
    pub exit: Option<usize>,
    /// Lead over the first pursuer at that exit (s); −∞ without an exit, ∞ without pursuers. If an
    /// escape is possible, the lead on the safe path with the greatest margin. If not, the lead on
    /// the shortest path. It may still be positive then: the evader would be first, but a pursuer
    /// can cut off the path.
    pub margin: f64,
    /// Time of the safe path to the exit (s); infinite if there is none.
    pub time: f64,
    /// Share of all places where a robot fits that the evader safely reaches, 0..1.
    pub area_share: f64,
}

/// Computes dominance; keeps its memory between calls.
#[derive(Debug, Clone, Default)]
pub struct Dominance {
    police: Wave,
    sources: Vec<Source>,
    safe: Vec<Wave>,
    verdicts: Vec<Verdict>,
    free: Wave,
}

impl Dominance {
    /// Assesses one instant; one verdict per evader, in the order given. A pursuer catches within
    /// `capture` (m).
    ///
    /// The arena must belong to this map. Robots with numbers out of range are ignored.
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
            // Within the capture radius the evader reaches nothing.
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

    /// Times at which a pursuer reaches each place, after the last assessment.
    pub fn police(&self) -> &Wave {
        &self.police
    }

    /// Times at which an evader safely reaches each place, after the last assessment.
    pub fn safe(&self, evader: usize) -> Option<&Wave> {
        self.safe.get(evader)
    }

    /// Dominance cell by cell, in the order of the lattice's frame, at the last assessed instant
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

/// Lead of an evader over the first pursuer at an exit (s) if both take the shortest path; −∞ if the
/// evader cannot reach the exit.
fn race(arena: &Arena, exit: usize, police: &[Runner], evader: &Runner, capture: f64) -> f64 {
    let lattice = arena.lattice();
    let Some(path) = arena.way_to(exit) else {
        return f64::NEG_INFINITY;
    };
    let time = |runner: &Runner, reach: f64| {
        let left = (path.time_at(lattice, runner.at) - reach).max(0.0);
        // A robot at the exit needs no speed.
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
