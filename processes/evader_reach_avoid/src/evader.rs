//! Controller of one evader.

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

/// Radius of the search for a place to flee to when no place is safe (m).
const NEAR: f64 = 2.0;

/// Drives to places that it reaches before any pursuer.
///
/// Apart from caches of the map and its current destination, it is a function of the view.
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
    /// Destination node.
    goal: Option<usize>,
    /// Nodes of the path there.
    way: Vec<usize>,
}

impl Evader {
    /// Returns an evader for a robot with these limits.
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

    /// Sets the exits of evaders and the capture distance of the Police (m).
    pub fn rules(&mut self, exits: &[Region], capture_radius: f64) {
        self.exits = exits.to_vec();
        self.capture = capture_radius;
        self.arena = None;
    }

    /// Prepares a new map for a robot of this radius (m) before the next tick. Otherwise
    /// [`Evader::command`] does it within a tick.
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

    /// Returns the command of the robot `view.me` for this tick. It stands still if it is not
    /// listed or no longer takes part.
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

    /// Chooses the destination and the path to it.
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

    /// Returns the furthest point of the path that it can drive to straight and safely.
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
            // The first points may lie behind the robot since the plan was made.
            map.line_is_clear(here, to, radius)
                && (2..=steps as u32).all(|i| is_safe(here + line * (f64::from(i) / steps)))
        };
        let in_sight = |to: &Point2<f64>| (to - here).norm() <= self.params.sight;
        let points = || self.way.iter().filter_map(|&node| lattice.point(node));
        let furthest = points().rev().find(|to| in_sight(to) && goes_straight(*to));
        // Too near to a wall for a straight drive: along the path, a little ahead.
        let ahead = || {
            let near = points()
                .enumerate()
                .min_by(|a, b| (a.1 - here).norm().total_cmp(&(b.1 - here).norm()))?;
            points().nth(near.0 + 1).or(Some(near.1))
        };
        furthest.or_else(ahead)
    }
}

/// Returns the worth (s) of a place to an evader of this speed (m/s). The evader reaches the place
/// `margin` (s) before any pursuer; the nearest exit is `way_out` (m) away. The worth is the margin
/// up to [`ReachAvoidParams::enough_s`], less [`ReachAvoidParams::exit_weight`] times the time to
/// the exit.
pub fn worth(margin: f64, way_out: f64, speed: f64, params: &ReachAvoidParams) -> f64 {
    margin.min(params.enough_s) - params.exit_weight * way_out / speed
}

/// Returns the place in an exit that it safely reaches with the most time to spare.
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

/// Returns the place of the highest worth that it safely reaches; the last one, if it is worth
/// hardly less.
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

/// Returns the place to flee to if no place is safe: of the near places on a straight free line,
/// the one with the most time before a pursuer comes.
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
