//! Controller of one Police robot.

use avoidance::potential_field::{
    Body, Goal, Perturbation, Repulsor, attraction, compose, obstacle, repulsion,
};
use control::feedback_linearisation::command;
use nalgebra::{Point2, Vector2};
use navigation::bearing::{Bearings, GoalField};
use navigation::routes::{MARGIN, RouteFinder};
use parameters::ParamsError;
use planner_view::limits::Limits;
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::{RobotView, View};
use robot::team::Role;

use super::assignment::{Assigner, Order};
use super::goals::{Hypothesis, estimate, goals, hypotheses, may_be_within};
use super::params::{Knowledge, PursuerParams};
use super::slots;

/// Distance to a visible target below which a pursuer that cuts it off drives at it (m).
const CLOSE: f64 = 1.0;

/// Chases evaders by potential fields (chasing-game paper, §III-B).
///
/// It stores its target between ticks and caches of the map; all else is a function of the view.
#[derive(Debug, Clone)]
pub struct Pursuer {
    params: PursuerParams,
    limits: Limits,
    perturbation: Perturbation,
    assigner: Assigner,
    finder: RouteFinder,
    hypotheses: Vec<Hypothesis>,
    goals: Vec<Goal>,
}

impl Pursuer {
    /// Returns a pursuer for a robot with these limits; the seed sets the phase of its
    /// perturbation.
    ///
    /// # Errors
    /// [`ParamsError`] if a parameter is out of range.
    pub fn new(params: PursuerParams, limits: Limits, seed: u64) -> Result<Self, ParamsError> {
        parameters::check(&params)?;
        Ok(Self {
            params,
            limits,
            perturbation: Perturbation::new(params.perturbation, seed),
            assigner: Assigner::new(params.assignment),
            finder: RouteFinder::default(),
            hypotheses: Vec::new(),
            goals: Vec::new(),
        })
    }

    /// Computes the paths through a new map for a robot of this radius (m) before the next tick.
    /// Otherwise [`Pursuer::command`] does it within a tick.
    pub fn prepare(&mut self, map: &PlannerMap, radius: f64) {
        self.finder.prepare(map, radius);
    }

    /// Returns the command of the robot `view.me` for this tick.
    ///
    /// It stands still if it is not listed, no longer takes part, has no target, or has no
    /// information on its target.
    pub fn command(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        let Some(own) = view.own().filter(|own| own.active) else {
            return Steering::stop();
        };
        self.finder.prepare(map, own.radius);
        match self.assigner.order(map, &mut self.finder, view) {
            None => Steering::stop(),
            Some(Order {
                target,
                place: Some(place),
            }) if !self.is_close(map, view, own, target) => {
                self.cut_off(map, view, own, target, place)
            }
            Some(Order { target, .. }) => self.pursue(map, view, own, target),
        }
    }

    /// Returns `true` if a target can be driven at directly.
    fn is_close(&self, map: &PlannerMap, view: &View<'_>, own: &RobotView, target: usize) -> bool {
        let here = own.pose.position();
        let belief = view.belief(target);
        let belief = belief.filter(|_| self.params.knowledge == Knowledge::Belief);
        if belief.is_some_and(|belief| !may_be_within(belief, here, CLOSE)) {
            return false;
        }
        estimate(view, target, self.params.knowledge).is_some_and(|there| {
            (there - here).norm() <= CLOSE && map.line_is_clear(here, there, 0.0)
        })
    }

    /// Drives at a target.
    fn pursue(
        &mut self,
        map: &PlannerMap,
        view: &View<'_>,
        own: &RobotView,
        target: usize,
    ) -> Steering {
        hypotheses(
            view,
            target,
            self.params.knowledge,
            self.params.belief_goals,
            self.params.max_particles,
            &mut self.hypotheses,
        );
        if self.hypotheses.is_empty() {
            return Steering {
                target: Some(target),
                ..Steering::stop()
            };
        }
        let params = &self.params;
        let at = params.feedback.field_point_of(&own.pose);
        let here = own.pose.position();
        let room = own.radius + MARGIN;
        {
            let hypothesised = self.hypotheses.iter().map(|(pose, _)| pose.position());
            let bearings = bearings(&mut self.finder, params, map, here, hypothesised);
            let distance_to = |to| {
                bearings
                    .bearing(at, to)
                    .map_or(0.0, |bearing| bearing.distance)
            };
            goals(
                map,
                &self.hypotheses,
                distance_to,
                room,
                params.fidelity,
                &mut self.goals,
            );
        }
        Steering {
            target: Some(target),
            ..self.steer(map, view, own, at)
        }
    }

    /// Drives to a place that cuts a target off.
    fn cut_off(
        &mut self,
        map: &PlannerMap,
        view: &View<'_>,
        own: &RobotView,
        target: usize,
        place: Point2<f64>,
    ) -> Steering {
        self.goals.clear();
        self.goals.push(Goal {
            at: place,
            weight: 1.0,
        });
        let at = self.params.feedback.field_point_of(&own.pose);
        Steering {
            target: Some(target),
            ..self.steer(map, view, own, at)
        }
    }

    /// Drives by the field at a point towards the goals.
    fn steer(
        &mut self,
        map: &PlannerMap,
        view: &View<'_>,
        own: &RobotView,
        at: Point2<f64>,
    ) -> Steering {
        let params = &self.params;
        let here = own.pose.position();
        let wanted = self.goals.iter().map(|goal| goal.at);
        let bearings = bearings(&mut self.finder, params, map, here, wanted);
        let pull = attraction(at, self.goals.iter().copied(), &bearings);
        let sum = pull
            + scatter(params, view, own, at)
            + obstacle(map, at, params.obstacle.fidelity)
            + self.perturbation.at(view.time_s);
        let field = in_bounds(params, map, view, own, at, sum);
        Steering {
            command: command(field, own.pose.theta, &self.limits, &params.feedback),
            target: None,
            aim: aim(&self.goals),
            waypoint: waypoint(&self.goals, at, pull, &bearings),
            field,
        }
    }
}

/// Returns the field at a point with this sum of parts. Hostile evaders in play are no obstacles.
fn in_bounds(
    params: &PursuerParams,
    map: &PlannerMap,
    view: &View<'_>,
    own: &RobotView,
    at: Point2<f64>,
    sum: Vector2<f64>,
) -> Vector2<f64> {
    let bodies = view
        .other_bodies(own)
        .filter(|other| !view.is_opponent(other, Role::Evader))
        .map(Body::from);
    compose(
        map,
        own,
        at,
        sum,
        bodies,
        params.body_guard,
        &params.obstacle,
    )
}

/// Returns the configured measure of bearings to these points.
fn bearings<'a>(
    finder: &'a mut RouteFinder,
    params: &PursuerParams,
    map: &'a PlannerMap,
    here: Point2<f64>,
    targets: impl IntoIterator<Item = Point2<f64>>,
) -> Bearings<'a> {
    match params.goal_field {
        GoalField::Straight => Bearings::Straight,
        GoalField::Geodesic => finder
            .routes(map, slots::OWN, here, targets)
            .map_or(Bearings::Straight, Bearings::Along),
    }
}

/// Returns the repulsion from the colleagues and from bodies in the way.
fn scatter(
    params: &PursuerParams,
    view: &View<'_>,
    own: &RobotView,
    at: Point2<f64>,
) -> Vector2<f64> {
    let colleagues = view
        .non_opponents(Role::Evader)
        .filter(|other| params.fidelity.is_published() || other.index != own.index)
        .map(|other| (other, params.scatter_weight));
    let wrecks = view.wrecks().map(|wreck| (wreck, params.wreck_weight));
    let repulsors = colleagues.chain(wrecks).map(|(robot, weight)| Repulsor {
        at: robot.pose.position(),
        weight,
    });
    repulsion(at, repulsors, &Bearings::Straight, &params.scatter)
}

/// The weighted mean of the goals.
fn aim(goals: &[Goal]) -> Option<Point2<f64>> {
    let total: f64 = goals.iter().map(|goal| goal.weight).sum();
    let sum: Vector2<f64> = goals.iter().map(|goal| goal.at.coords * goal.weight).sum();
    let mean = sum / total;
    mean.norm().is_finite().then(|| Point2::from(mean))
}

/// Returns the first waypoint towards one goal; for several goals, a point 1 m in the direction of
/// their common attraction.
fn waypoint(
    goals: &[Goal],
    at: Point2<f64>,
    pull: Vector2<f64>,
    bearings: &Bearings<'_>,
) -> Option<Point2<f64>> {
    if let [goal] = goals {
        return bearings
            .bearing(at, goal.at)
            .map(|bearing| bearing.waypoint);
    }
    let norm = pull.norm();
    (norm > 0.0).then(|| at + pull / norm)
}
