//! Controller of one evader.

use avoidance::potential_field::{Body, Goal, attraction, compose, obstacle};
use control::feedback_linearisation::command;
use geometry::region::Region;
use nalgebra::Point2;
use navigation::bearing::Bearings;
use navigation::dominance::{Arena, Dominance, Runner};
use parameters::{ParamsError, check};
use planner_view::limits::Limits;
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::{RobotView, View};
use pursuit_evasion::escape::{self, Course, Robot, Rollout};
use robot::spec::RobotModel;
use robot::team::Role;

use crate::params::ReachAvoidParams;

/// Radius of the search for a place to flee to when no place is safe (m).
const NEAR: f64 = 2.0;

/// Largest sum of deviations from the planned drive (m) with which a course counts as followed exactly.
const EXACT: f64 = 1e-3;

/// Drives to places that it reaches before any pursuer.
///
/// Apart from caches of the map and its current destination, it is a function of the view.
#[derive(Debug, Clone)]
pub struct Evader {
    params: ReachAvoidParams,
    model: RobotModel,
    limits: Limits,
    exits: Vec<Region>,
    capture: f64,
    arena: Option<(u64, Arena)>,
    dominance: Dominance,
    police: Vec<Runner>,
    planned_in: Option<i64>,
    /// The escape that no pursuer can prevent, once there is one.
    escape: Option<CurrentCourse>,
    /// Destination node without one.
    goal: Option<usize>,
    /// Corners of the path there (m).
    path: Vec<Point2<f64>>,
}

/// A course that the evader keeps.
#[derive(Debug, Clone)]
struct CurrentCourse {
    course: Course,
    /// Position after this tick if nothing disturbs the drive (m).
    expected: Option<Point2<f64>>,
    /// Sum of the deviations from it since the plan (m).
    strayed: f64,
}

impl Evader {
    /// Returns an evader for a robot with this drive.
    ///
    /// # Errors
    /// [`ParamsError`] if a parameter or limit is out of range.
    pub fn new(params: ReachAvoidParams, model: RobotModel) -> Result<Self, ParamsError> {
        check(&params)?;
        let limits = Limits::new(model.v_max, model.v_reverse_max, model.omega_max)?;
        Ok(Self {
            model,
            dominance: Dominance::default(),
            params,
            limits,
            exits: Vec::new(),
            capture: 0.0,
            arena: None,
            police: Vec::new(),
            planned_in: None,
            escape: None,
            goal: None,
            path: Vec::new(),
        })
    }

    /// Sets the exits of evaders and the capture distance of the pursuers (m).
    pub fn rules(&mut self, exits: &[Region], capture_radius: f64) {
        self.exits = exits.to_vec();
        self.capture = capture_radius;
        self.arena = None;
    }

    /// Prepares a new map for robots as narrow as this radius (m) before the next tick. Otherwise
    /// [`Evader::command`] does it within a tick.
    pub fn prepare(&mut self, map: &PlannerMap, radius: f64) {
        let known = |(revision, arena): &(u64, Arena)| {
            *revision == map.revision() && arena.lattice().radius().to_bits() == radius.to_bits()
        };
        if !self.arena.as_ref().is_some_and(known) {
            let dominance = &self.params.dominance;
            let reach = self.capture.max(2.0 * self.model.radius);
            let arena = Arena::new(map, dominance, radius, &self.exits, reach);
            self.arena = Some((map.revision(), arena));
            self.planned_in = None;
            self.escape = None;
            self.goal = None;
            self.path.clear();
        }
    }

    /// Returns the command of the robot `view.me` for this tick. It stands still if it is not
    /// listed or no longer takes part.
    pub fn command(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        let Some(own) = view.own().filter(|own| own.active) else {
            return Steering::stop();
        };
        let chase = view.opponents(Role::Pursuer).map(|robot| robot.radius);
        self.prepare(map, chase.fold(own.radius, f64::min));
        // Saturates for absurd times; NaN becomes 0.
        let period = Some((view.time_s / self.params.period_s).floor() as i64);
        self.look_for_deviations(own);
        if self.planned_in != period {
            self.planned_in = period;
            self.plan(map, view, own);
        }
        if let Some(steering) = self.escape(map, view, own) {
            return steering;
        }
        let params = &self.params;
        let at = params.feedback.field_point_of(&own.pose);
        let waypoint = self.waypoint(map, own);
        let goal = waypoint.map(|at| Goal { at, weight: 1.0 });
        // Escapes are by the axle.
        let arrives = waypoint.filter(|at| self.path.last() == Some(at));
        let from = arrives.map_or(at, |place| {
            params.feedback.attracted_point_of(&own.pose, place)
        });
        let pull = attraction(from, goal, &Bearings::Straight);
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

    fn robot(&self, view: &View<'_>, own: &RobotView) -> Robot {
        Robot {
            pose: own.pose,
            twist: own.twist,
            model: self.model,
            dt: view.dt,
        }
    }

    /// Adds up how far the robot is from where its course should have taken it.
    fn look_for_deviations(&mut self, own: &RobotView) {
        if let Some(escape) = &mut self.escape
            && let Some(expected) = escape.expected
        {
            escape.strayed += (own.pose.position() - expected).norm();
        }
    }

    /// Returns the command along the course of its escape, if it has one.
    fn escape(&mut self, map: &PlannerMap, view: &View<'_>, own: &RobotView) -> Option<Steering> {
        let robot = self.robot(view, own);
        let escape = self.escape.as_mut()?;
        let tracking = escape.course.follow(map, &own.pose, &self.limits)?;
        escape.expected = Some(robot.after(tracking.command).pose.position());
        Some(Steering {
            command: tracking.command,
            target: None,
            aim: escape.course.points().last().copied(),
            waypoint: Some(tracking.target),
            field: nalgebra::Vector2::zeros(),
        })
    }

    /// Chooses the course of an escape, or else a destination and the path to it.
    ///
    /// A course whose drive goes as planned stays safe for any motion of the pursuers, and is kept. If
    /// something changed the drive, it is kept if it still is safe from where the robot is.
    fn plan(&mut self, map: &PlannerMap, view: &View<'_>, own: &RobotView) {
        let robot = self.robot(view, own);
        let Some((_, arena)) = &self.arena else {
            return;
        };
        if self
            .escape
            .as_ref()
            .is_some_and(|escape| escape.strayed <= EXACT)
        {
            return;
        }
        obstructions(view, own, self.capture, &mut self.police);
        if let Some(escape) = &mut self.escape {
            let dominance = &mut self.dominance;
            dominance.pursue(map, arena, &self.police);
            let rollout = Rollout::from_course(map, arena, dominance, &escape.course, &robot);
            if rollout.is_some_and(|rollout| rollout.is_safe()) {
                escape.strayed = 0.0;
                return;
            }
        }
        let runner = Runner {
            at: own.pose.position(),
            speed: own.v_max,
            reach: 0.0,
        };
        self.dominance.assess(map, arena, &self.police, &[runner]);
        let escape = escape::plan(map, arena, &mut self.dominance, 0, &runner, &robot);
        self.escape = escape.map(|escape| CurrentCourse {
            course: escape.course,
            expected: None,
            strayed: 0.0,
        });
        if self.escape.is_some() {
            self.goal = None;
            return;
        }
        let params = &self.params;
        for pursuer in &mut self.police {
            pursuer.reach += params.avoid_radius;
        }
        let slower = Runner {
            speed: own.v_max * params.speed_fraction,
            ..runner
        };
        self.dominance.assess(map, arena, &self.police, &[slower]);
        let before = self.goal;
        let exit = self.dominance.safest_exit(arena, 0);
        self.goal = exit
            .map(|(_, node)| node)
            .or_else(|| best_place(arena, &self.dominance, slower.speed, params, before));
        self.path.clear();
        if let (Some(goal), Some(safe)) = (self.goal, self.dominance.safe(0)) {
            safe.path_to(arena.medium(), goal, &mut self.path);
            let region = exit.and_then(|(exit, _)| arena.exit(exit));
            // An exit that is smaller than a cell.
            let beside = |region: &&Region| self.path.last().is_some_and(|p| !region.contains(*p));
            let center = region.filter(beside).map(Region::center);
            self.path.extend(center);
        } else {
            self.goal = farthest_from_police(map, arena, &self.dominance, &slower);
            let goal = self.goal.and_then(|goal| arena.lattice().point(goal));
            self.path.extend(goal);
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
        let points = || self.path.iter().copied();
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

/// Lists what can stop an evader: hostile pursuers within the capture radius (m) or in contact, and other
/// bodies, except evaders in play, in contact.
fn obstructions(view: &View<'_>, own: &RobotView, capture: f64, runners: &mut Vec<Runner>) {
    runners.clear();
    let evades = |other: &RobotView| other.active && other.team.role == Role::Evader;
    runners.extend(
        view.other_bodies(own)
            .filter(|other| !evades(other))
            .map(|other| {
                let contact = own.radius + other.radius;
                Runner {
                    at: other.pose.position(),
                    speed: if other.active { other.v_max } else { 0.0 },
                    reach: if view.is_opponent(other, Role::Pursuer) {
                        capture.max(contact)
                    } else {
                        contact
                    },
                }
            }),
    );
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
