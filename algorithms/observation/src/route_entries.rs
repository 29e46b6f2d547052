//! Shortest ways of a robot to the exits, the action of the potential-field evader, and who is where first.

use core::f64::consts::FRAC_1_SQRT_2;
use std::sync::Arc;

use nalgebra::{Point2, Vector2};
use navigation::routes::{Lengths, LengthsFrom, RouteEnd, RouteFinder};
use planner_view::map::PlannerMap;
use planner_view::view::{RobotView, View};
use robot::spec::RobotModel;

use crate::action::{ActionKind, action};
use crate::facts::RobotFacts;
use crate::field_evader::FieldEvader;
use crate::parts::{MAX_EXITS, Parts};
use crate::relative::{Heading, Offset};

/// Number of directions around the robot.
const DIRECTIONS: usize = 8;
/// Unit vectors along them, in the robot's frame.
const AROUND: [[f64; 2]; DIRECTIONS] = [
    [1.0, 0.0],
    [FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [0.0, 1.0],
    [-FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [-1.0, 0.0],
    [-FRAC_1_SQRT_2, -FRAC_1_SQRT_2],
    [0.0, -1.0],
    [FRAC_1_SQRT_2, -FRAC_1_SQRT_2],
];
/// Distance of the places in these directions (m), if no obstacle is nearer.
const REACH: f64 = 1.0;
/// Largest difference of two lengths in an observation (m).
const SCALE: f64 = 10.0;

/// Number of entries of the way out.
const OUT_LENGTH: usize = 4;
/// Number of entries of the potential-field evader.
const POTENTIAL_LENGTH: usize = 4;
/// Number of entries of an opponent.
const OPPONENT_LENGTH: usize = 2;
/// Number of entries of a direction.
const DIRECTION_LENGTH: usize = 3;

/// Slot of the route finder.
const OUT: usize = 0;

/// Writes the parts `path` and `potential` of the observations of one robot, and keeps what it knows of the map between ticks.
///
/// In this order, those of `potential` only with that part and all others only with `path`; all 0 for what is unknown or not
/// in the game:
///
/// - `path` (4): cosine and sine of the bearing of the first straight leg of the shortest way to an exit; its length / 10 m,
///   at most 1; 1 / (1 + length in m);
/// - `potential` (4), 0 for a robot that is no evader: what the potential-field evader does with its default parameters:
///   cosine and sine of the bearing of the first straight leg of its way past the opponents, and its action;
/// - `path_to.` every opponent in the scenario's order (2 each): 1 / (1 + length in m) of the shortest way to it; the
///   length of its own way to an exit less that of this robot / 10 m;
/// - `around.0` … (3 each): places 1 m away, or at the nearest obstacle, in eight directions from the heading
///   counter-clockwise: the distance / 1 m; how much shorter the way to an exit is from there / 1 m; 1 / (1 + length in m)
///   of the shortest way of an opponent to there.
///
/// Ways are those of a disc of the robot's radius along a grid of about 0.25 m.
#[derive(Debug, Clone)]
pub struct RouteEntries {
    start: usize,
    me: usize,
    opponents: Vec<usize>,
    finder: RouteFinder,
    /// Map and radius (m) of the lengths.
    built_for: Option<(u64, f64)>,
    lengths: Option<Arc<Lengths>>,
    exits: [LengthsFrom; MAX_EXITS],
    opponents_from: Vec<LengthsFrom>,
    parts: Parts,
    /// The potential-field evader, for an evader whose observations have it.
    potential: Option<FieldEvader>,
    own: RobotModel,
}

impl RouteEntries {
    /// Creates the memory of a robot, for observations whose ways begin at entry `start`.
    pub(crate) fn new(
        parts: Parts,
        start: usize,
        me: usize,
        own: &RobotFacts,
        opponents: Vec<usize>,
    ) -> Self {
        let potential = || FieldEvader::new(ActionKind::default(), own, me).ok();
        Self {
            start,
            me,
            parts,
            potential: parts.potential.then(potential).flatten(),
            own: own.model,
            opponents_from: vec![LengthsFrom::default(); opponents.len()],
            opponents,
            finder: RouteFinder::default(),
            built_for: None,
            lengths: None,
            exits: Default::default(),
        }
    }

    /// Returns the names of the entries, with the names of the opponents.
    pub(crate) fn names<'a>(parts: Parts, opponents: impl Iterator<Item = &'a str>) -> Vec<String> {
        let mut names = Vec::new();
        let mut add = |prefix: &str, entries: &[&str]| {
            names.extend(entries.iter().map(|entry| format!("{prefix}.{entry}")));
        };
        let bearing = ["bearing_cos", "bearing_sin"];
        if parts.path {
            add("path", &bearing);
            add("path", &["length", "proximity"]);
        }
        if parts.potential {
            add("potential", &bearing);
            add("potential", &["speed", "turn"]);
        }
        if !parts.path {
            return names;
        }
        for opponent in opponents {
            let prefix = format!("path_to.{opponent}");
            add(&prefix, &["proximity", "exit_lead"]);
        }
        for direction in 0..DIRECTIONS {
            let prefix = format!("around.{direction}");
            add(&prefix, &["free", "nearer", "danger"]);
        }
        names
    }

    /// Writes the ways of a tick into an observation that [`Layout::write`](crate::layout::Layout::write) has written.
    pub fn write(&mut self, map: &PlannerMap, view: &View<'_>, observation: &mut [f32]) {
        let Some(out) = observation.get_mut(self.start..) else {
            return;
        };
        out.fill(0.0);
        let own = view.robot(self.me);
        let Some(own) = own.filter(|own| own.active || own.present) else {
            return;
        };
        let mut rest = out;
        let mut take = |length: usize| {
            let length = length.min(rest.len());
            rest.split_off_mut(..length).unwrap_or_default()
        };
        let path = take(if self.parts.path { OUT_LENGTH } else { 0 });
        let potential = take(if self.parts.potential {
            POTENTIAL_LENGTH
        } else {
            0
        });
        self.write_potential(map, view, own, potential);
        if !self.parts.path {
            return;
        }
        self.finder.prepare(map, own.radius);
        self.write_out(map, view, own, path);
        let opponents = take(self.opponents.len() * OPPONENT_LENGTH);
        let around = rest;
        self.write_places(map, view, own, opponents, around);
    }

    /// Writes the shortest way out.
    fn write_out(&mut self, map: &PlannerMap, view: &View<'_>, own: &RobotView, out: &mut [f32]) {
        let here = own.pose.position();
        let exits = view.usable_exits();
        if let Some(found) = self.finder.way_out(map, OUT, here, exits, &[], false) {
            let [cos, sin] = bearing(own, found.waypoint);
            let length = scaled(found.length);
            put(out, [cos, sin, length, proximity(found.length)]);
        }
    }

    /// Writes what the potential-field evader does.
    fn write_potential(
        &mut self,
        map: &PlannerMap,
        view: &View<'_>,
        own: &RobotView,
        out: &mut [f32],
    ) {
        let Some(potential) = &mut self.potential else {
            return;
        };
        let steering = potential.steering(map, view);
        let [cos, sin] = steering.waypoint.map_or([0.0; 2], |to| bearing(own, to));
        let [speed, turn] = action(steering.command, &self.own);
        put(out, [cos, sin, speed, turn]);
    }

    /// Writes the ways of the opponents, and the places around the robot.
    fn write_places(
        &mut self,
        map: &PlannerMap,
        view: &View<'_>,
        own: &RobotView,
        opponents: &mut [f32],
        around: &mut [f32],
    ) {
        let here = own.pose.position();
        let built_for = Some((map.revision(), own.radius));
        if self.built_for != built_for {
            self.built_for = built_for;
            self.lengths = Some(Lengths::of_map(map, own.radius));
            self.exits.fill(LengthsFrom::default());
            self.opponents_from.fill(LengthsFrom::default());
        }
        let Some(lengths) = &self.lengths else {
            return;
        };
        let (sin, cos) = geometry::math::sincosf(own.pose.theta as f32);
        let (sin, cos) = (f64::from(sin), f64::from(cos));
        let steps = AROUND.map(|[x, y]| Vector2::new(cos * x - sin * y, sin * x + cos * y));
        let free = map.free_runs(steps.map(|step| (here, here + REACH * step)), own.radius);
        let places: [_; DIRECTIONS] =
            core::array::from_fn(|i| (free[i], lengths.end(here + free[i] * steps[i])));
        let here = lengths.end(here);
        let mut to_exit = [f64::INFINITY; DIRECTIONS];
        let mut own_to_exit = f64::INFINITY;
        for (exit, from) in view.usable_exits().zip(&mut self.exits) {
            if lengths.start(exit, from) {
                own_to_exit = own_to_exit.min(from.to(here));
                shorten(&mut to_exit, from, &places);
            }
        }
        let mut to_opponent = [f64::INFINITY; DIRECTIONS];
        let entries = opponents.as_chunks_mut::<OPPONENT_LENGTH>().0;
        let all = self.opponents.iter().zip(&mut self.opponents_from);
        for ((&index, from), entry) in all.zip(entries) {
            let at = position(view, index);
            if !at.is_some_and(|at| lengths.start(at, from)) {
                continue;
            }
            shorten(&mut to_opponent, from, &places);
            let exits = view.usable_exits().take(MAX_EXITS);
            let exit = exits
                .map(|exit| from.to(lengths.end(exit)))
                .fold(f64::INFINITY, f64::min);
            // NaN, if there is no way for both, becomes 0.
            *entry = [proximity(from.to(here)), scaled(exit - own_to_exit)];
        }
        let entries = around.as_chunks_mut::<DIRECTION_LENGTH>().0;
        let found = places.iter().zip(to_exit).zip(to_opponent);
        for (entry, (((free, _), to_exit), to_opponent)) in entries.iter_mut().zip(found) {
            let nearer = (own_to_exit - to_exit) / REACH;
            // NaN, if there is no way from here either, becomes 0.
            *entry = [
                in_range(free / REACH),
                in_range(nearer),
                proximity(to_opponent),
            ];
        }
    }
}

/// Returns the position (m) of a robot in the game.
fn position(view: &View<'_>, index: usize) -> Option<Point2<f64>> {
    let robot = view.robot(index).filter(|robot| robot.active);
    robot.map(|robot| robot.pose.position())
}

/// Replaces lengths by those of other ways that are shorter.
fn shorten(known: &mut [f64], from: &LengthsFrom, places: &[(f64, Option<RouteEnd>)]) {
    for (known, &(_, place)) in known.iter_mut().zip(places) {
        *known = known.min(from.to(place));
    }
}

/// Returns cosine and sine of the bearing of a point.
fn bearing(own: &RobotView, to: Point2<f64>) -> [f32; 2] {
    let heading = Heading::new(own.pose.theta);
    let [_, _, cos, sin, _] = Offset::new(own.pose.position(), to, 0.0).entries(heading);
    [cos, sin]
}

fn proximity(length: f64) -> f32 {
    (1.0 / (1.0 + length)) as f32
}

fn scaled(length: f64) -> f32 {
    in_range(length / SCALE)
}

/// Returns a number clamped to −1..1; 0 for NaN.
fn in_range(value: f64) -> f32 {
    if value.is_nan() {
        0.0
    } else {
        value.clamp(-1.0, 1.0) as f32
    }
}

/// Writes entries to the begin of a slice that has room for them.
fn put<const N: usize>(out: &mut [f32], entries: [f32; N]) {
    if let Some(slots) = out.first_chunk_mut::<N>() {
        *slots = entries;
    }
}
