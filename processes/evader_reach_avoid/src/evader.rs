//! One evader.

use geometry::region::Region;
use nalgebra::Point2;
use navigation::bearing::Bearings;
use navigation::dominance::{Arena, Dominance, Runner};
use parameters::{ParamsError, check};
use planner_view::limits::Limits;
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::{RobotView, View};
use sim_backend::team::Team;
use steering::feedback_linearisation::command;
use steering::potential_field::{Body, Goal, attraction, compose, obstacle};

use crate::params::ReachAvoidParams;

/// Distance within which a place to flee to is looked for when no place is safe (m).
const NEAR: f64 = 2.0;

/// Goes where no pursuer can stop it.
///
/// Everything but caches of the map, and the place that it is heading for, is a function of the
/// view.
#[derive(Debug, Clone)]
pub struct Evader {
    params: ReachAvoidParams,
    limits: Limits,
    exits: Vec<Region>,
    capture: f64,
    arena: Option<(u64, Arena)>,
    dominance: Dominance,
    police: Vec<Runner>,
    planned_in: Option<i64>,
    /// The node that it is heading for.
    goal: Option<usize>,
    /// The nodes on the way there.
    way: Vec<usize>,
}

impl Evader {
    /// An evader for a robot with these limits.
    ///
    /// # Errors
    /// [`ParamsError`] if a parameter is out of range.
    pub fn new(params: ReachAvoidParams, limits: Limits) -> Result<Self, ParamsError> {
        check(&params)?;
        Ok(Self {
            dominance: Dominance::default(),
            params,
            limits,
            exits: Vec::new(),
            capture: 0.0,
            arena: None,
            police: Vec::new(),
            planned_in: None,
            goal: None,
            way: Vec::new(),
        })
    }

    /// Takes note of where evaders get away, and within which distance Police catch them (m).
    pub fn rules(&mut self, exits: &[Region], capture_radius: f64) {
        self.exits = exits.to_vec();
        self.capture = capture_radius;
        self.arena = None;
    }

    /// Lays out a new map for a robot of this radius (m). [`Evader::command`] does it too if it has
    /// not been done; here it does not cost time in a tick.
    pub fn prepare(&mut self, map: &PlannerMap, radius: f64) {
        let known = |(revision, arena): &(u64, Arena)| {
            *revision == map.revision() && arena.lattice().radius().to_bits() == radius.to_bits()
        };
        if !self.arena.as_ref().is_some_and(known) {
            let arena = Arena::new(map, &self.params.dominance, radius, &self.exits);
            self.arena = Some((map.revision(), arena));
            self.planned_in = None;
            self.goal = None;
            self.way.clear();
        }
    }

    /// What the robot `view.me` does in this tick. It stands still when it is not listed or no
    /// longer takes part.
    pub fn command(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        let Some(own) = view.own().filter(|own| own.active) else {
            return Steering::stop();
        };
        self.prepare(map, own.radius);
        // Saturates for absurd times; NaN becomes 0.
        let period = Some((view.time_s / self.params.period_s).floor() as i64);
        if self.planned_in != period {
            self.planned_in = period;
            self.plan(map, view, own);
        }
        let params = &self.params;
        let at = params.feedback.field_point_of(&own.pose);
        let waypoint = self.waypoint(map, own);
        let goal = waypoint.map(|at| Goal { at, weight: 1.0 });
        let pull = attraction(at, goal, &Bearings::Straight);
        let sum = pull + obstacle(map, at, params.obstacle.fidelity);
        let bodies = view.other_bodies(own).map(Body::from);
        let field = compose(
            map,
            own,
            at,
            sum,
            bodies,
            params.body_guard,
            &params.obstacle,
        );
        let arena = self.arena.as_ref().map(|(_, arena)| arena);
        Steering {
            command: command(field, own.pose.theta, &self.limits, &params.feedback),
            target: None,
            aim: self.goal.and_then(|goal| arena?.lattice().point(goal)),
            waypoint,
            field,
        }
    }

    /// Chooses the place to go to, and the way there.
    fn plan(&mut self, map: &PlannerMap, view: &View<'_>, own: &RobotView) {
        let Some((_, arena)) = &self.arena else {
            return;
        };
        let params = &self.params;
        self.police.clear();
        self.police
            .extend(view.active(Team::Police).map(|robot| Runner {
                at: robot.pose.position(),
                speed: robot.v_max,
            }));
        let runner = Runner {
            at: own.pose.position(),
            speed: own.v_max * params.speed_fraction,
        };
        let reach = self.capture + params.keep_away;
        let verdicts = self
            .dominance
            .assess(map, arena, &self.police, &[runner], reach);
        let certain = verdicts
            .first()
            .is_some_and(|verdict| verdict.escape_possible);
        let before = self.goal;
        self.goal = if certain {
            best_exit(arena, &self.dominance)
        } else {
            best_place(arena, &self.dominance, runner.speed, params, before)
        };
        self.way.clear();
        if let (Some(goal), Some(safe)) = (self.goal, self.dominance.safe(0)) {
            safe.way_to(arena.lattice(), goal, &mut self.way);
        } else {
            self.goal = farthest_from_police(map, arena, &self.dominance, &runner);
            self.way.extend(self.goal);
        }
    }

    /// The furthest point of the way to which it can go straight and safely.
    fn waypoint(&self, map: &PlannerMap, own: &RobotView) -> Option<Point2<f64>> {
        let lattice = self.arena.as_ref().map(|(_, arena)| arena.lattice())?;
        let safe = self.dominance.safe(0)?;
        let here = own.pose.position();
        let radius = own.radius + self.params.margin;
        let is_safe = |p: Point2<f64>| {
            lattice
                .node_at(p)
                .is_none_or(|node| safe.time(node).is_finite())
        };
        let goes_straight = |to: Point2<f64>| {
            let line = to - here;
            let steps = (line.norm() / lattice.pitch()).ceil().max(1.0);
            // What is near has been left behind since the plan was made.
            map.line_is_clear(here, to, radius)
                && (2..=steps as u32).all(|i| is_safe(here + line * (f64::from(i) / steps)))
        };
        let in_sight = |to: &Point2<f64>| (to - here).norm() <= self.params.sight;
        let points = || self.way.iter().filter_map(|&node| lattice.point(node));
        let furthest = points().rev().find(|to| in_sight(to) && goes_straight(*to));
        // Too near to a wall to go straight anywhere: along the way, a little ahead.
        let ahead = || {
            let near = points()
                .enumerate()
                .min_by(|a, b| (a.1 - here).norm().total_cmp(&(b.1 - here).norm()))?;
            points().nth(near.0 + 1).or(Some(near.1))
        };
        furthest.or_else(ahead)
    }
}

/// What a place is worth (s) that is reached `margin` (s) before any pursuer and lies `way_out` (m)
/// from the nearest exit, to an evader of this speed (m/s): its margin up to
/// [`ReachAvoidParams::enough_s`], less [`ReachAvoidParams::exit_weight`] times the time to the exit.
pub fn worth(margin: f64, way_out: f64, speed: f64, params: &ReachAvoidParams) -> f64 {
    margin.min(params.enough_s) - params.exit_weight * way_out / speed
}

/// The place in an exit that it safely reaches with the most time to spare.
fn best_exit(arena: &Arena, dominance: &Dominance) -> Option<usize> {
    let safe = dominance.safe(0)?;
    let mut best: Option<(f32, usize)> = None;
    for &node in (0..arena.exits()).flat_map(|exit| arena.exit_nodes(exit)) {
        let node = node as usize;
        let time = safe.time(node);
        let margin = dominance.police().time(node) - time;
        if time.is_finite() && best.is_none_or(|(most, _)| margin > most) {
            best = Some((margin, node));
        }
    }
    best.map(|(_, node)| node)
}

/// The place that it safely reaches and that is worth most; the one before, if that is hardly worth
/// less.
fn best_place(
    arena: &Arena,
    dominance: &Dominance,
    speed: f64,
    params: &ReachAvoidParams,
    before: Option<usize>,
) -> Option<usize> {
    let safe = dominance.safe(0)?;
    let worth_of = |node: usize| {
        let time = safe.time(node);
        let ways = (0..arena.exits()).filter_map(|exit| arena.way_to(exit));
        let way_out = ways.map(|way| way.time(node)).fold(f32::INFINITY, f32::min);
        // Without an exit in reach all places are equally far from it.
        let way_out = if way_out.is_finite() { way_out } else { 0.0 };
        let margin = dominance.police().time(node) - time;
        time.is_finite()
            .then(|| worth(f64::from(margin), f64::from(way_out), speed, params))
    };
    let mut best: Option<(f64, usize)> = None;
    for node in 0..arena.lattice().len() {
        if let Some(worth) = worth_of(node)
            && best.is_none_or(|(most, _)| worth > most)
        {
            best = Some((worth, node));
        }
    }
    let (most, node) = best?;
    let keeps = |&before: &usize| worth_of(before).is_some_and(|worth| worth >= most);
    Some(before.filter(keeps).unwrap_or(node))
}

/// When nothing is safe: of the places near by that it can go to straight, the one that it has the
/// most time at before a pursuer comes.
fn farthest_from_police(
    map: &PlannerMap,
    arena: &Arena,
    dominance: &Dominance,
    runner: &Runner,
) -> Option<usize> {
    let lattice = arena.lattice();
    let mut best: Option<(f64, usize)> = None;
    lattice.for_each_within(runner.at, NEAR, |node, distance| {
        let time = f64::from(dominance.police().time(node)) - distance / runner.speed;
        let better = best.is_none_or(|(most, _)| time > most);
        if better
            && lattice
                .point(node)
                .is_some_and(|p| map.line_is_clear(runner.at, p, 0.9 * lattice.radius()))
        {
            best = Some((time, node));
        }
    });
    best.map(|(_, node)| node)
}
