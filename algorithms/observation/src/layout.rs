//! Entries of the observation of one robot.

use nalgebra::Point2;
use planner_view::view::{BeliefView, ScanView, View};

use crate::error::{LayoutError, WriteError};
use crate::facts::RobotFacts;
use crate::parts::{MAX_EXITS, Parts};
use crate::relative::{self, Heading, Offset, bounded};
use crate::route_entries::RouteEntries;
use crate::scene::{RobotSnapshot, Scene};

/// Names of the entries of the own state.
const OWN: [&str; 7] = [
    "active",
    "x",
    "y",
    "heading_cos",
    "heading_sin",
    "speed",
    "turn",
];
/// Number of entries of another robot.
const ROBOT_LENGTH: usize = 5 + relative::LENGTH;
/// Number of entries of a belief.
const BELIEF_LENGTH: usize = 5 + relative::LENGTH;

/// Entries of the observation of one robot. Its length depends on the scenario only.
///
/// In this order:
///
/// - `own` (7): 1 in the game, 0 after it; x and y in the map (−1 and 1 are the sides of the smallest square about its
///   bounds); cosine and sine of the heading; speed / maximum forward speed; turning rate / maximum;
/// - `goal` (5), if it has one: relative position of the centre;
/// - `exit_1` … (5 each): relative position of the nearest exits, nearest first, at most [`MAX_EXITS`];
/// - `state`: every other robot in the scenario's order (10 each): 1 in the game; relative position; cosine and sine of
///   its heading relative to the own one; speed / its maximum; 1 if it is an opponent and no obstacle hides it. All 0
///   once its body has gone;
/// - `scan`: range / maximum range of every beam: 1 without an echo, 0 if too near;
/// - `belief`: every opponent in the scenario's order (10 each): 1 if there is a belief; 1 if a robot of the team sees
///   it; relative position of the mean; cosine and sine of its mean heading relative to the own one; 1 / (1 + σ) with
///   the standard deviation σ of the position (m). All 0 without a belief;
/// - `path`, `potential`: see [`RouteEntries`], which writes them.
///
/// A *relative position* has 5 entries: the parts ahead and to the left, divided by the diagonal of the map; cosine and
/// sine of the bearing; 1 / (1 + d) with the distance d (m).
#[derive(Debug, Clone)]
pub struct Layout {
    parts: Parts,
    me: usize,
    goal: Option<Point2<f64>>,
    exits: usize,
    others: Vec<usize>,
    opponents: Vec<usize>,
    beams: usize,
    /// The empty memory of `path` and `potential`, if these are among the parts.
    ways: Option<RouteEntries>,
    names: Vec<String>,
}

impl Layout {
    /// Creates the layout of the robot with index `me`, in a world with this many exits.
    ///
    /// # Errors
    /// [`LayoutError`] if the robot does not exist, or lacks what a part needs.
    pub fn new(
        parts: Parts,
        robots: &[RobotFacts],
        me: usize,
        exits: usize,
    ) -> Result<Self, LayoutError> {
        let own = robots.get(me).ok_or(LayoutError::Robot {
            robot: me,
            robots: robots.len(),
        })?;
        let others = |wanted: bool| (0..robots.len()).filter(move |&i| wanted && i != me);
        let is_opponent = |&i: &usize| {
            let other = robots.get(i);
            other.is_some_and(|other| other.team.is_hostile_to(own.team))
        };
        let mut layout = Self {
            parts,
            me,
            goal: own.goal.map(|goal| goal.center()),
            exits: exits.min(MAX_EXITS),
            others: others(parts.state).collect(),
            opponents: others(parts.belief).filter(is_opponent).collect(),
            beams: if parts.scan { own.beams } else { 0 },
            ways: None,
            names: Vec::new(),
        };
        let robot = own.name.clone();
        if parts.scan && layout.beams == 0 {
            return Err(LayoutError::NoScan { robot });
        }
        if parts.belief && layout.opponents.is_empty() {
            return Err(LayoutError::NoOpponents { robot });
        }
        layout.names = layout.entry_names(robots);
        if parts.path || parts.potential {
            let opponents: Vec<usize> = others(true).filter(is_opponent).collect();
            let name = |&i: &usize| robots.get(i).map_or("", |robot| &robot.name);
            let names = RouteEntries::names(parts, opponents.iter().map(name));
            let start = layout.names.len();
            layout.names.extend(names);
            layout.ways = Some(RouteEntries::new(parts, start, me, own, opponents));
        }
        Ok(layout)
    }

    /// Returns the contents.
    pub fn parts(&self) -> Parts {
        self.parts
    }

    /// Returns the index of the robot.
    pub fn robot(&self) -> usize {
        self.me
    }

    /// Returns the number of entries.
    pub fn length(&self) -> usize {
        self.names.len()
    }

    /// Returns the names of all entries, such as `own.x` and `police_1.proximity`.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Returns the memory for the ways of the robot, if these are among the parts.
    pub fn ways(&self) -> Option<RouteEntries> {
        self.ways.clone()
    }

    fn entry_names(&self, robots: &[RobotFacts]) -> Vec<String> {
        let name = |i: usize| robots.get(i).map_or("", |robot| &robot.name);
        let mut names = Vec::new();
        let mut add = |prefix: &str, entries: &[&str]| {
            names.extend(entries.iter().map(|entry| format!("{prefix}.{entry}")));
        };
        add("own", &OWN);
        if self.goal.is_some() {
            add("goal", &relative::NAMES);
        }
        for exit in 1..=self.exits {
            add(&format!("exit_{exit}"), &relative::NAMES);
        }
        for &other in &self.others {
            add(name(other), &["active"]);
            add(name(other), &relative::NAMES);
            add(
                name(other),
                &["heading_cos", "heading_sin", "speed", "visible"],
            );
        }
        for beam in 0..self.beams {
            add("scan", &[&beam.to_string()]);
        }
        for &opponent in &self.opponents {
            let belief = format!("belief.{}", name(opponent));
            add(&belief, &["known", "seen"]);
            add(&belief, &relative::NAMES);
            add(&belief, &["heading_cos", "heading_sin", "certainty"]);
        }
        names
    }

    /// Writes the observation of a tick, except the ways, which [`RouteEntries::write`] writes. `scene` has the robots of
    /// the same tick.
    ///
    /// # Errors
    /// [`WriteError`] if `out` has another length than the layout, or the own robot is not in the view.
    pub fn write(&self, scene: &Scene, view: &View<'_>, out: &mut [f32]) -> Result<(), WriteError> {
        let expected = self.length();
        if out.len() != expected {
            let given = out.len();
            return Err(WriteError::Length { expected, given });
        }
        let Some(own) = scene.robot(self.me) else {
            // A robot that has left: its view stays valid, with nothing in it.
            out.fill(0.0);
            let listed = view
                .robots
                .iter()
                .any(|robot| robot.index == self.me && robot.is_sane());
            let robot = self.me;
            return listed.then_some(()).ok_or(WriteError::Robot { robot });
        };
        let to = |at| Offset::new(own.position, at, scene.per_diagonal()).entries(own.heading);
        let mut rest = Rest(out);
        rest.put(bounded([
            f32::from(u8::from(own.active)),
            own.place[0],
            own.place[1],
            own.heading.cos,
            own.heading.sin,
            own.speed,
            own.turn,
        ]));
        if let Some(goal) = self.goal {
            rest.put(to(goal));
        }
        for exit in nearest(view, own.position, self.exits) {
            rest.put(exit.map_or([0.0; relative::LENGTH], to));
        }
        for &other in &self.others {
            rest.put(self.other(scene, own, other));
        }
        if self.parts.scan {
            write_scan(view.scan.as_ref(), rest.take(self.beams));
        }
        for &opponent in &self.opponents {
            let belief = view.belief(opponent);
            let belief = belief.map_or([0.0; BELIEF_LENGTH], |b| {
                belief_entries(b, own, scene.per_diagonal())
            });
            rest.put(belief);
        }
        Ok(())
    }

    /// Returns the entries of another robot.
    fn other(&self, scene: &Scene, own: &RobotSnapshot, index: usize) -> [f32; ROBOT_LENGTH] {
        let Some((other, [ahead, left, bearing_cos, bearing_sin, proximity], is_visible)) =
            scene.other(self.me, own.heading, index)
        else {
            return [0.0; ROBOT_LENGTH];
        };
        let [heading_cos, heading_sin] = own.heading.relative(other.heading);
        let [heading_cos, heading_sin, speed] = bounded([heading_cos, heading_sin, other.speed]);
        [
            f32::from(u8::from(other.active)),
            ahead,
            left,
            bearing_cos,
            bearing_sin,
            proximity,
            heading_cos,
            heading_sin,
            speed,
            f32::from(u8::from(is_visible)),
        ]
    }
}

fn belief_entries(
    belief: &BeliefView<'_>,
    own: &RobotSnapshot,
    per_diagonal: f32,
) -> [f32; BELIEF_LENGTH] {
    let spread = belief.position_std;
    if !(belief.mean.is_finite() && spread.is_finite() && spread >= 0.0) {
        return [0.0; BELIEF_LENGTH];
    }
    let offset = Offset::new(own.position, belief.mean.position(), per_diagonal);
    let [ahead, left, bearing_cos, bearing_sin, proximity] = offset.entries(own.heading);
    let [heading_cos, heading_sin] = bounded(own.heading.relative(Heading::new(belief.mean.theta)));
    [
        1.0,
        f32::from(u8::from(belief.seen)),
        ahead,
        left,
        bearing_cos,
        bearing_sin,
        proximity,
        heading_cos,
        heading_sin,
        1.0 / (1.0 + spread as f32),
    ]
}

/// Writes the ranges of a scan; beams that it lacks have no echo.
fn write_scan(scan: Option<&ScanView<'_>>, out: &mut [f32]) {
    let ranges = scan.map_or(&[][..], |scan| scan.ranges);
    let scale = scan.map_or(0.0, |scan| (1.0 / scan.range_max) as f32);
    let ranges = ranges.iter().map(Some).chain(core::iter::repeat(None));
    for (slot, range) in out.iter_mut().zip(ranges) {
        let share = range.map_or(1.0, |range| range * scale);
        *slot = if share.is_nan() {
            1.0
        } else {
            share.clamp(0.0, 1.0)
        };
    }
}

/// Returns the centres of the exits that are nearest to a point (m), nearest first; of equally near ones the first.
fn nearest(
    view: &View<'_>,
    from: Point2<f64>,
    count: usize,
) -> impl Iterator<Item = Option<Point2<f64>>> {
    let mut found = [(f64::INFINITY, None); MAX_EXITS];
    for exit in view.usable_exits() {
        let mut entry = ((exit - from).norm_squared(), Some(exit));
        for slot in found.iter_mut().take(count) {
            if entry.0 < slot.0 {
                core::mem::swap(slot, &mut entry);
            }
        }
    }
    found.into_iter().take(count).map(|(_, exit)| exit)
}

/// The part of an observation that is still to be written.
struct Rest<'a>(&'a mut [f32]);

impl Rest<'_> {
    /// Writes the next entries. The caller has checked the length of the whole.
    fn put<const N: usize>(&mut self, entries: [f32; N]) {
        if let Some((slot, rest)) = core::mem::take(&mut self.0).split_first_chunk_mut::<N>() {
            *slot = entries;
            self.0 = rest;
        }
    }
}

impl<'a> Rest<'a> {
    /// Returns the next entries.
    fn take(&mut self, count: usize) -> &'a mut [f32] {
        let all = core::mem::take(&mut self.0);
        let (taken, rest) = all.split_at_mut(count.min(all.len()));
        self.0 = rest;
        taken
    }
}
