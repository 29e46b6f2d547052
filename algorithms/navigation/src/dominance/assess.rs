//! Dominance at one instant.

use nalgebra::Point2;

use super::arena::within_cell;
use super::{Arena, Cell, Owner};
use crate::wavefront::{MAX_ERROR, Source, Wave};
use planner_view::map::PlannerMap;

/// A robot of the game.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Runner {
    /// Position (m).
    pub at: Point2<f64>,
    /// Top speed (m/s).
    pub speed: f64,
    /// Distance between the centres at which it stops an evader (m), ≥ 0; evaders have none.
    pub reach: f64,
}

/// Guaranteed outcome for an evader.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Verdict {
    /// `true` if the evader safely reaches an exit, if turning takes no time.
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
    /// Lowest speed of the pursuers that move (m/s); infinite without one.
    slowest: f64,
    /// Places that a pursuer reaches through a wall, and when (s).
    through_walls: Vec<(usize, f32)>,
    sources: Vec<Source>,
    safe: Vec<Wave>,
    verdicts: Vec<Verdict>,
    free: Wave,
}

impl Dominance {
    /// Assesses one instant; one verdict per evader, in the order given. Robots without speed stand
    /// in the way.
    ///
    /// The arena must belong to this map. Robots with numbers out of range are ignored.
    pub fn assess(
        &mut self,
        map: &PlannerMap,
        arena: &Arena,
        police: &[Runner],
        evaders: &[Runner],
    ) -> &[Verdict] {
        self.pursue(map, arena, police);
        self.safe.resize_with(evaders.len(), Wave::default);
        self.verdicts.clear();
        for (evader, safe) in evaders.iter().zip(&mut self.safe) {
            // An evader within reach of a pursuer reaches nothing.
            let stops = |runner: &Runner| (runner.at - evader.at).norm() < runner.reach;
            let source = Source::new(evader.at, evader.speed, 0);
            let sources = if police.iter().any(stops) {
                &[][..]
            } else {
                &[source][..]
            };
            safe.spread(arena.medium(), map, sources, Some(&self.police));
            let race = |exit: usize| race(arena, exit, police, evader);
            self.verdicts.push(verdict(arena, &self.police, safe, race));
        }
        &self.verdicts
    }

    /// Computes the times at which pursuers stop an evader at each place.
    pub fn pursue(&mut self, map: &PlannerMap, arena: &Arena, police: &[Runner]) {
        self.sources.clear();
        self.sources
            .extend((0..).zip(police).map(|(label, runner)| Source {
                reach: runner.reach,
                ..Source::new(runner.at, runner.speed, label)
            }));
        self.police.spread(arena.medium(), map, &self.sources, None);
        self.slowest = self.moving().fold(f64::INFINITY, |v, s| v.min(s.speed));
        self.reach_through_walls(arena);
    }

    /// The pursuers that move.
    fn moving(&self) -> impl Iterator<Item = &Source> {
        let sane = self.sources.iter().filter(|source| source.is_sane());
        sane.filter(|source| source.speed > 0.0)
    }

    /// Lowers the times of places at which a pursuer stops an evader from behind an obstacle. The
    /// wave measures reach along paths: a pursuer itself comes to a place later than its reach.
    fn reach_through_walls(&mut self, arena: &Arena) {
        let fastest = self.moving().fold(0.0_f64, |v, s| v.max(s.speed));
        let reach = self.moving().fold(f64::INFINITY, |r, s| r.min(s.reach));
        if fastest == 0.0 {
            return;
        }
        let later = ((reach - within_cell(arena.lattice())).max(0.0) / fastest) as f32;
        self.through_walls.clear();
        for &(from, to) in arena.hidden() {
            let reached = self.police.time_of(to as usize);
            let comes = if reached > 0.0 { reached + later } else { 0.0 };
            if comes < self.police.time_of(from as usize) {
                self.through_walls.push((from as usize, comes));
            }
        }
        for &(place, time) in &self.through_walls {
            self.police.advance(place, time);
        }
    }

    /// Computes the places that an evader of the last assessment safely reaches if it starts `delay`
    /// (s) later.
    pub fn delay(
        &mut self,
        map: &PlannerMap,
        arena: &Arena,
        index: usize,
        evader: &Runner,
        delay: f64,
    ) {
        if let Some(safe) = self.safe.get_mut(index) {
            let source = Source {
                delay,
                ..Source::new(evader.at, evader.speed, 0)
            };
            safe.spread(arena.medium(), map, &[source], Some(&self.police));
        }
    }

    /// The exit, and the node in it, that an evader safely reaches with the greatest margin.
    pub fn safest_exit(&self, arena: &Arena, evader: usize) -> Option<(usize, usize)> {
        safest_exit(arena, &self.police, self.safe.get(evader)?)
    }

    /// Lower bound of the time at which a pursuer of the last assessment stops a robot of `radius`
    /// (m) at a point (s): 0 if none is known, infinite where no pursuer comes.
    ///
    /// A pursuer that stops a robot at this point at the time T is d/v later at a place at the distance
    /// d: T is at least that place's time less d/v. Places nearer than the diameter of a robot have no
    /// obstacle between them. The greatest bound counts.
    pub fn stopped_from(&self, arena: &Arena, p: Point2<f64>, radius: f64) -> f64 {
        let lattice = arena.lattice();
        let near = (radius + lattice.radius()).max(lattice.pitch());
        let stands_at = |s: &Source| s.speed == 0.0 && (s.at - p).norm() < s.reach;
        if self.sources.iter().any(stands_at) {
            return 0.0;
        }
        let mut bound = 0.0_f64;
        lattice.for_each_within(p, near, |node, distance| {
            let time = f64::from(self.police.time(node)) * (1.0 - MAX_ERROR);
            bound = bound.max(if time.is_finite() {
                time - distance / self.slowest
            } else {
                time
            });
        });
        bound
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
        let sources: Vec<Source> = (0..)
            .zip(evaders)
            .map(|(label, runner)| Source::new(runner.at, runner.speed, label))
            .collect();
        self.free.spread(arena.medium(), map, &sources, None);
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
    if let Some((exit, node)) = safest_exit(arena, police, safe) {
        let time = f64::from(safe.time(node));
        return Verdict {
            escape_possible: true,
            exit: Some(exit),
            margin: f64::from(police.time(node)) - time,
            time,
            ..best
        };
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

/// The exit, and the node in it, that an evader safely reaches with the greatest margin.
fn safest_exit(arena: &Arena, police: &Wave, safe: &Wave) -> Option<(usize, usize)> {
    let mut best: Option<(f32, usize, usize)> = None;
    for exit in 0..arena.exits() {
        for &node in arena.exit_nodes(exit) {
            let node = node as usize;
            let margin = police.time(node) - safe.time(node);
            let reached = safe.time(node).is_finite();
            if reached && best.is_none_or(|(most, ..)| margin > most) {
                best = Some((margin, exit, node));
            }
        }
    }
    best.map(|(_, exit, node)| (exit, node))
}

/// Lead of an evader over the first pursuer at an exit (s) if both take the shortest path; −∞ if the
/// evader cannot reach the exit.
fn race(arena: &Arena, exit: usize, police: &[Runner], evader: &Runner) -> f64 {
    let lattice = arena.lattice();
    let Some(path) = arena.way_to(exit) else {
        return f64::NEG_INFINITY;
    };
    let time = |runner: &Runner| {
        let left = (path.time_at(lattice, runner.at) - runner.reach).max(0.0);
        // A robot at the exit needs no speed.
        if left > 0.0 { left / runner.speed } else { 0.0 }
    };
    let own = time(evader);
    if !own.is_finite() {
        return f64::NEG_INFINITY;
    }
    police.iter().map(time).fold(f64::INFINITY, f64::min) - own
}
