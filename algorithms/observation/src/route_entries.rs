//! Shortest ways of a robot: to the exits, past its opponents, and who is where first.

use core::f64::consts::TAU;

use nalgebra::{Point2, Vector2};
use navigation::routes::{Lengths, LengthsFrom, RouteFinder, Threat};
use planner_view::map::PlannerMap;
use planner_view::view::{RobotView, View};

use crate::parts::MAX_EXITS;
use crate::relative::{Heading, Offset};

/// Number of directions around the robot.
const DIRECTIONS: usize = 8;
/// Distance of the places in these directions (m), if no obstacle is nearer.
const REACH: f64 = 1.0;
/// Largest difference of two lengths in an observation (m).
const SCALE: f64 = 10.0;
/// Extra cost (m) per metre of a way past the opponents, at distance `DANGER_REACH` (m) from one of them: those of
/// `evader_potential`.
const DANGER_GAIN: f64 = 3.0;
const DANGER_REACH: f64 = 1.5;

/// Number of entries of a way out.
const OUT_LENGTH: usize = 4;
/// Number of entries of an opponent.
const OPPONENT_LENGTH: usize = 2;
/// Number of entries of a direction.
const DIRECTION_LENGTH: usize = 3;

/// Slots of the route finder.
const OUT: usize = 0;
const PAST: usize = 1;

/// Writes the part `way` of the observations of one robot, and keeps what it knows of the map between ticks.
///
/// In this order; all 0 for what is unknown or not in the game:
///
/// - `way` (4): cosine and sine of the bearing of the first straight leg of the shortest way to an exit; its length / 10 m,
///   at most 1; 1 / (1 + length in m);
/// - `past` (4): the same for the way that is cheapest if passing an opponent costs more, the more the nearer;
/// - `way_to.` every opponent in the scenario's order (2 each): 1 / (1 + length in m) of the shortest way to it; the
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
    exits: [LengthsFrom; MAX_EXITS],
    opponents_from: Vec<LengthsFrom>,
    threats: Vec<Threat>,
}

impl RouteEntries {
    /// Creates the memory of a robot, for observations whose ways begin at entry `start`.
    pub(crate) fn new(start: usize, me: usize, opponents: Vec<usize>) -> Self {
        Self {
            start,
            me,
            threats: Vec::with_capacity(opponents.len()),
            opponents_from: vec![LengthsFrom::default(); opponents.len()],
            opponents,
            finder: RouteFinder::default(),
            built_for: None,
            exits: Default::default(),
        }
    }

    /// Returns the number of entries with this many opponents.
    pub(crate) fn length(opponents: usize) -> usize {
        2 * OUT_LENGTH + opponents * OPPONENT_LENGTH + DIRECTIONS * DIRECTION_LENGTH
    }

    /// Returns the names of the entries, with the names of the opponents.
    pub(crate) fn names<'a>(opponents: impl Iterator<Item = &'a str>) -> Vec<String> {
        let mut names = Vec::new();
        let mut add = |prefix: &str, entries: &[&str]| {
            names.extend(entries.iter().map(|entry| format!("{prefix}.{entry}")));
        };
        for way in ["way", "past"] {
            add(way, &["bearing_cos", "bearing_sin", "length", "proximity"]);
        }
        for opponent in opponents {
            let prefix = format!("way_to.{opponent}");
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
        self.finder.prepare(map, own.radius);
        let (outs, out) = out.split_at_mut((2 * OUT_LENGTH).min(out.len()));
        let opponents = (self.opponents.len() * OPPONENT_LENGTH).min(out.len());
        let (opponents, around) = out.split_at_mut(opponents);
        let (out, past) = outs.split_at_mut(OUT_LENGTH.min(outs.len()));
        self.write_out(map, view, own, OUT, out);
        self.write_out(map, view, own, PAST, past);
        self.write_places(map, view, own, opponents, around);
    }

    /// Writes the way out of a slot.
    fn write_out(
        &mut self,
        map: &PlannerMap,
        view: &View<'_>,
        own: &RobotView,
        slot: usize,
        out: &mut [f32],
    ) {
        self.threats.clear();
        if slot == PAST {
            let threats = active(view, &self.opponents).map(|(_, at)| Threat {
                at,
                gain: DANGER_GAIN,
                reach: DANGER_REACH,
            });
            self.threats.extend(threats);
        }
        let here = own.pose.position();
        let exits = view.usable_exits();
        // Opponents move, so that the way past them is another one in every tick.
        let renew = slot == PAST;
        let found = self
            .finder
            .way_out(map, slot, here, exits, &self.threats, renew);
        if let Some(found) = found {
            let [cos, sin] = bearing(own, found.waypoint);
            let length = scaled(found.length);
            put(out, [cos, sin, length, proximity(found.length)]);
        }
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
        let places: [(f64, Point2<f64>); DIRECTIONS] = core::array::from_fn(|k| {
            let angle = own.pose.theta + TAU * k as f64 / DIRECTIONS as f64;
            let (sin, cos) = geometry::math::sincosf(angle as f32);
            let step = Vector2::new(f64::from(cos), f64::from(sin));
            let free = map.free_run(here, here + REACH * step, own.radius);
            (free, here + free * step)
        });
        let lengths = Lengths::of_map(map, own.radius);
        let built_for = Some((map.revision(), own.radius));
        if self.built_for != built_for {
            self.built_for = built_for;
            self.exits.fill(LengthsFrom::default());
            self.opponents_from.fill(LengthsFrom::default());
        }
        let mut to_exit = [f64::INFINITY; DIRECTIONS];
        let mut own_to_exit = f64::INFINITY;
        for (exit, from) in view.usable_exits().zip(&mut self.exits) {
            if lengths.start(exit, from) {
                own_to_exit = own_to_exit.min(lengths.to(from, here));
                shorten(&mut to_exit, &lengths, from, &places);
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
            shorten(&mut to_opponent, &lengths, from, &places);
            let exits = view.usable_exits().take(MAX_EXITS);
            let exit = exits
                .map(|exit| lengths.to(from, exit))
                .fold(f64::INFINITY, f64::min);
            // NaN, if there is no way for both, becomes 0.
            *entry = [
                proximity(lengths.to(from, here)),
                scaled(exit - own_to_exit),
            ];
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

/// Returns the robots of this list that are in the game, with their positions (m).
fn active<'a>(
    view: &'a View<'_>,
    robots: &'a [usize],
) -> impl Iterator<Item = (usize, Point2<f64>)> + use<'a> {
    let robots = robots.iter();
    robots.filter_map(|&robot| Some((robot, position(view, robot)?)))
}

/// Replaces lengths by those of other ways that are shorter.
fn shorten(
    known: &mut [f64],
    lengths: &Lengths,
    from: &LengthsFrom,
    places: &[(f64, Point2<f64>)],
) {
    for (known, &(_, place)) in known.iter_mut().zip(places) {
        *known = known.min(lengths.to(from, place));
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
