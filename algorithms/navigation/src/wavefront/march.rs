//! Fast marching.

use super::lattice::{Lattice, NONE};
use super::medium::Medium;
use super::queue::Queue;
use super::seed::{Seed, Source, collect};
use planner_view::map::PlannerMap;

/// Arrival times of the earliest of several sources at every node of a [`Medium`].
///
/// Reuses its memory for each wave. Of equal times, the source given first wins.
#[derive(Debug, Clone, Default)]
pub struct Wave {
    nodes: usize,
    /// Final times of nodes and bends; infinite where undecided, and at [`Medium::nowhere`].
    times: Vec<f32>,
    labels: Vec<u32>,
    /// Best times so far.
    tentative: Vec<f32>,
    /// `true` for times of a straight path from a source or bend.
    straight: Vec<bool>,
    /// The place from which the wave came to each place; [`NONE`] for a source.
    origins: Vec<u32>,
    queue: Queue,
    seeds: Vec<Seed>,
    speeds: Vec<f64>,
    /// The earliest times over the speeds marched so far.
    earliest: Vec<f32>,
    earliest_labels: Vec<u32>,
}

impl Wave {
    /// Sends a wave from these sources through the whole medium; sources with numbers out of range
    /// are left out.
    ///
    /// With `limit`, a wave through the same medium, this wave goes only where it is strictly
    /// before that one.
    ///
    /// Costs one march per distinct speed: a slow wave that is first at a place must not block a
    /// faster one that arrives later.
    pub fn spread(
        &mut self,
        medium: &Medium,
        map: &PlannerMap,
        sources: &[Source],
        limit: Option<&Self>,
    ) {
        self.nodes = medium.lattice().len();
        self.speeds.clear();
        let sane = || sources.iter().filter(|source| source.is_sane());
        for source in sane() {
            if !self.speeds.contains(&source.speed) {
                self.speeds.push(source.speed);
            }
        }
        if self.speeds.is_empty() {
            self.clear(medium);
            return;
        }
        let limit = limit.map(|limit| &limit.times[..]);
        for group in 0..self.speeds.len() {
            let speed = self.speeds[group];
            self.seeds.clear();
            for source in sane().filter(|source| source.speed == speed) {
                collect(medium, map, source, &mut self.seeds);
            }
            self.march(medium, speed, limit);
            if self.speeds.len() > 1 {
                self.keep_earliest(group == 0);
            }
        }
        if self.speeds.len() > 1 {
            core::mem::swap(&mut self.times, &mut self.earliest);
            core::mem::swap(&mut self.labels, &mut self.earliest_labels);
        }
    }

    /// Time at which the wave reaches each node (s), by its number; infinite for nodes that it does
    /// not reach.
    pub fn times(&self) -> &[f32] {
        // Behind them are the bends, and the entry that stands for none.
        self.times.get(..self.nodes).unwrap_or_default()
    }

    /// Time at which the wave reaches a node (s); infinite if it does not.
    pub fn time(&self, node: usize) -> f32 {
        self.times().get(node).copied().unwrap_or(f32::INFINITY)
    }

    /// Time at which the wave reaches a node or bend (s).
    pub(crate) fn time_of(&self, place: usize) -> f32 {
        self.times.get(place).copied().unwrap_or(f32::INFINITY)
    }

    /// Lowers the time of a node or bend (s).
    pub(crate) fn advance(&mut self, place: usize, time: f32) {
        if let Some(known) = self.times.get_mut(place) {
            *known = known.min(time);
        }
    }

    /// Label of the source that is first at a node; `None` if no wave arrives.
    pub fn label(&self, node: usize) -> Option<u32> {
        let reached = self.time(node).is_finite();
        self.labels.get(node).copied().filter(|_| reached)
    }

    /// Time at which the wave reaches a point (m), by linear interpolation between the centres of
    /// the cells around it; infinite if it reaches none of them.
    pub fn time_at(&self, lattice: &Lattice, p: nalgebra::Point2<f64>) -> f64 {
        let frame = lattice.frame();
        let x = (p.x - frame.origin.x) / frame.resolution - 0.5;
        let y = (p.y - frame.origin.y) / frame.resolution - 0.5;
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let (mut sum, mut weights) = (0.0, 0.0);
        for (dx, dy, weight) in [
            (0, 0, (1.0 - fx) * (1.0 - fy)),
            (1, 0, fx * (1.0 - fy)),
            (0, 1, (1.0 - fx) * fy),
            (1, 1, fx * fy),
        ] {
            let (col, row) = (x.floor() + f64::from(dx), y.floor() + f64::from(dy));
            let inside =
                col >= 0.0 && row >= 0.0 && col < frame.width as f64 && row < frame.height as f64;
            let node = inside
                .then(|| frame.index(col as usize, row as usize))
                .and_then(|cell| lattice.node_of_cell(cell));
            let time = node.map_or(f64::INFINITY, |node| f64::from(self.time(node)));
            if time.is_finite() {
                sum += weight * time;
                weights += weight;
            }
        }
        // A point in a wall takes the times of the free cells around it.
        if weights > 1e-6 {
            sum / weights
        } else {
            f64::INFINITY
        }
    }

    /// The place before this one on a straight path, or else the neighbour that decided its time;
    /// `None` after a source. Second, `true` if the path is straight.
    pub(super) fn origin(&self, place: usize) -> (Option<usize>, bool) {
        let origin = self.origins.get(place).filter(|&&origin| origin != NONE);
        let straight = self.straight.get(place).copied().unwrap_or_default();
        (origin.map(|&origin| origin as usize), straight)
    }

    /// Returns `true` if its sources have one speed, so that each place is reached from its origin.
    pub(super) fn has_one_speed(&self) -> bool {
        self.speeds.len() == 1
    }

    fn clear(&mut self, medium: &Medium) {
        let places = medium.nowhere() + 1;
        for times in [&mut self.times, &mut self.tentative] {
            times.clear();
            times.resize(places, f32::INFINITY);
        }
        self.labels.clear();
        self.labels.resize(places, 0);
        self.straight.clear();
        self.straight.resize(places, false);
        self.origins.clear();
        self.origins.resize(places, NONE);
    }

    /// Marches from the seeds at a speed (m/s).
    fn march(&mut self, medium: &Medium, speed: f64, limit: Option<&[f32]>) {
        self.clear(medium);
        let step = (medium.lattice().pitch() / speed) as f32;
        let slowness = (1.0 / speed) as f32;
        self.queue.reset(step);
        self.enter_seeds(limit);
        let nowhere = medium.nowhere();
        while let Some((time, place)) = self.queue.pop() {
            let at = place as usize;
            if self.times[at].is_finite() || time > self.tentative[at] {
                continue;
            }
            self.times[at] = time;
            if at >= self.nodes {
                self.turn(medium, at, slowness, limit);
                continue;
            }
            for next in medium.neighbours(at) {
                let next = next as usize;
                if next == nowhere || self.times[next].is_finite() {
                    continue;
                }
                // Next to a straight path, differences add nothing.
                if self.straight[next] && self.tentative[next] <= time + 1.5 * step {
                    continue;
                }
                let (time, from) = self.arrival(medium, next, step);
                self.offer(next, time, from as u32, false, limit);
            }
            if let Some(bend) = medium.bends().beside(at) {
                let bend = self.nodes + bend;
                if !self.straight[bend] {
                    self.offer(bend, time + step, place, false, limit);
                }
            }
        }
    }

    /// Enters the seeds, the earliest first. Under a limit, a seed is entered only if the straight
    /// path to it is within the limit as well.
    fn enter_seeds(&mut self, limit: Option<&[f32]>) {
        // Stable: equal times keep the order of their sources.
        self.seeds.sort_by(|a, b| a.time.total_cmp(&b.time));
        for i in 0..self.seeds.len() {
            let Seed {
                time,
                node,
                label,
                back,
            } = self.seeds[i];
            let cut_off = limit.is_some()
                && back.is_some_and(|back| !self.tentative[back as usize].is_finite());
            if !cut_off && self.offer(node as usize, time, NONE, true, limit) {
                self.labels[node as usize] = label;
            }
        }
    }

    /// Turns the wave around a corner: continues straight from a bend that it has reached.
    fn turn(&mut self, medium: &Medium, at: usize, slowness: f32, limit: Option<&[f32]>) {
        let start = self.times[at];
        for target in medium.bends().targets(at - self.nodes) {
            let to = target.to as usize;
            let time = start + target.distance * slowness;
            if time >= self.tentative[to] || self.times[to].is_finite() {
                continue;
            }
            let cut_off = limit.is_some()
                && target.back != NONE
                && !self.tentative[target.back as usize].is_finite();
            if !cut_off {
                self.offer(to, time, at as u32, true, limit);
            }
        }
    }

    /// Lowers the time of a place reached from `origin` ([`NONE`]: from a source), if this time is
    /// earlier and within the limit; returns `true` if so.
    fn offer(
        &mut self,
        to: usize,
        time: f32,
        origin: u32,
        straight: bool,
        limit: Option<&[f32]>,
    ) -> bool {
        let allowed = limit.is_none_or(|limit| limit.get(to).is_some_and(|&limit| time < limit));
        let earlier = time < self.tentative[to] && allowed;
        if earlier {
            self.tentative[to] = time;
            if origin != NONE {
                self.labels[to] = self.labels[origin as usize];
            }
            self.origins[to] = origin;
            self.straight[to] = straight;
            self.queue.push(time, to as u32);
        }
        earlier
    }

    /// The arrival time at a node from its decided neighbours, and the earlier of them.
    ///
    /// Solves Σ w(T − t)² = step² over both axes, where t and w are a neighbour's time and 1, or of
    /// second order (4t₁ − t₂)/3 and 9/4 (Sethian 1999, §8.3).
    fn arrival(&self, medium: &Medium, node: usize, step: f32) -> (f32, usize) {
        let beside = medium.neighbours(node);
        let axis = |forth: usize, back: usize| {
            let (a, b) = (
                self.times[beside[forth] as usize],
                self.times[beside[back] as usize],
            );
            let (time, to) = if a < b { (a, forth) } else { (b, back) };
            let neighbour = beside[to] as usize;
            if time.is_finite() {
                let behind = self.times[medium.neighbours(neighbour)[to] as usize];
                if behind <= time {
                    return (time, (4.0 * time - behind) / 3.0, 2.25, neighbour);
                }
            }
            (time, time, 1.0, neighbour)
        };
        let (first_x, x, weight_x, from_x) = axis(0, 2);
        let (first_y, y, weight_y, from_y) = axis(1, 3);
        let from = if first_x <= first_y { from_x } else { from_y };
        let one_sided = |time: f32, weight: f32| time + step / weight.sqrt();
        if first_x.is_finite() && first_y.is_finite() {
            let (weights, apart) = (weight_x + weight_y, y - x);
            let root = step * step * weights - weight_x * weight_y * apart * apart;
            if root >= 0.0 {
                let time = x + (weight_y * apart + root.sqrt()) / weights;
                if time >= first_x.max(first_y) {
                    return (time, from);
                }
            }
        }
        let time = if first_x <= first_y {
            one_sided(x, weight_x)
        } else {
            one_sided(y, weight_y)
        };
        (time.max(first_x.min(first_y)), from)
    }

    fn keep_earliest(&mut self, first: bool) {
        if first {
            self.earliest.clone_from(&self.times);
            self.earliest_labels.clone_from(&self.labels);
            return;
        }
        let kept = self.earliest.iter_mut().zip(&mut self.earliest_labels);
        for ((time, label), (&new, &new_label)) in kept.zip(self.times.iter().zip(&self.labels)) {
            if new < *time {
                *time = new;
                *label = new_label;
            }
        }
    }
}
