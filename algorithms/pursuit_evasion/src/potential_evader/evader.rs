//! One evader.

use avoidance::potential_field::{
    Body, Goal, Perturbation, Repulsor, attraction, compose, obstacle, repulsion,
};
use control::feedback_linearisation::command;
use nalgebra::Point2;
use navigation::bearing::{Bearings, GoalField};
use navigation::routes::{RouteFinder, Threat};
use parameters::{ParamsError, check};
use planner_view::limits::Limits;
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::View;
use robot::team::Role;

use super::params::{EvaderParams, ThreatParams};

/// Slot of the route finder for the cheapest paths past the Police.
const PAST_POLICE: usize = 0;
/// Slot of the route finder for the shortest paths.
const PATH_SLOT: usize = 1;
/// Distance within which other robots are measured along paths (m).
const MEASURED: f64 = 4.0;

/// Drives to the nearest exit and away from the Police by potential fields.
///
/// All state except caches of the map is a function of the view.
#[derive(Debug, Clone)]
pub struct Evader {
    params: EvaderParams,
    limits: Limits,
    seed: u64,
    finder: RouteFinder,
    looked_in: Option<i64>,
    threats: Vec<Threat>,
    repulsors: Vec<Repulsor>,
}

impl Evader {
    /// Creates an evader for a robot with these limits; the seed sets the phase of its
    /// perturbation.
    ///
    /// # Errors
    /// [`ParamsError`] if a parameter is out of range.
    pub fn new(params: EvaderParams, limits: Limits, seed: u64) -> Result<Self, ParamsError> {
        check(&params)?;
        Ok(Self {
            params,
            limits,
            seed,
            finder: RouteFinder::default(),
            looked_in: None,
            threats: Vec::new(),
            repulsors: Vec::new(),
        })
    }

    /// Replaces the parameters.
    ///
    /// # Errors
    /// [`ParamsError`] if a parameter is out of range; the former ones remain.
    pub fn set_params(&mut self, params: EvaderParams) -> Result<(), ParamsError> {
        check(&params)?;
        self.params = params;
        Ok(())
    }

    /// Prepares the paths through a new map for a robot of this radius (m). [`Evader::command`]
    /// does it if necessary; here it takes no time of a tick.
    pub fn prepare(&mut self, map: &PlannerMap, radius: f64) {
        let geodesic = GoalField::Geodesic;
        if self.params.goal_field == geodesic || self.params.avoid_field == geodesic {
            self.finder.prepare(map, radius);
        }
    }

    /// The command of the robot `view.me` in this tick.
    ///
    /// The robot stops when it is not listed or no longer takes part. Without an exit, or with none
    /// that can be reached, it only avoids.
    pub fn command(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        let Some(own) = view.own().filter(|own| own.active) else {
            return Steering::stop();
        };
        let params = self.params;
        let here = own.pose.position();
        let at = params.feedback.field_point_of(&own.pose);
        self.prepare(map, own.radius);

        let (aim, waypoint) = match self.way_out(map, view, here) {
            Some((exit, waypoint)) => (Some(exit), Some(waypoint)),
            None => (None, None),
        };
        let goal = waypoint.map(|at| Goal { at, weight: 1.0 });
        // Escapes are by the axle.
        let from = match (aim, waypoint) {
            (Some(exit), Some(waypoint)) if exit == waypoint => {
                params.feedback.attracted_point_of(&own.pose, exit)
            }
            _ => at,
        };
        let pull = attraction(from, goal, &Bearings::Straight);

        self.repulsors.clear();
        self.repulsors.extend(repulsors(view, own.index, &params));
        let routes = match params.avoid_field {
            GoalField::Straight => None,
            GoalField::Geodesic => {
                // Only distances to near robots are measured along paths. A robot that is farther
                // away in a straight line is farther still along the streets, and hardly counts.
                let near = |place: &Point2<f64>| (place - here).norm() < MEASURED;
                let places = self
                    .repulsors
                    .iter()
                    .map(|repulsor| repulsor.at)
                    .filter(near);
                self.finder.routes(map, PATH_SLOT, here, places)
            }
        };
        let bearings = routes.map_or(Bearings::Straight, Bearings::Along);
        let push = repulsion(at, self.repulsors.iter().copied(), &bearings, &params.avoid);

        let sum = pull
            + push
            + obstacle(map, at, params.obstacle.fidelity)
            + Perturbation::new(params.perturbation, self.seed).at(view.time_s);
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
        Steering {
            command: command(field, own.pose.theta, &self.limits, &params.feedback),
            target: None,
            aim,
            waypoint,
            field,
        }
    }

    /// The nearest exit, and the first point on the path to it; `None` without an exit.
    fn way_out(
        &mut self,
        map: &PlannerMap,
        view: &View<'_>,
        here: Point2<f64>,
    ) -> Option<(Point2<f64>, Point2<f64>)> {
        let straight = || {
            let exits = view.usable_exits().map(|exit| ((exit - here).norm(), exit));
            exits
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .map(|(_, exit)| (exit, exit))
        };
        if self.params.goal_field == GoalField::Straight {
            return straight();
        }
        let ThreatParams {
            gain,
            reach,
            period_s,
        } = self.params.threat;
        self.threats.clear();
        if gain > 0.0 {
            let police = view
                .opponents(Role::Pursuer)
                .map(|robot| robot.pose.position());
            self.threats
                .extend(police.map(|at| Threat { at, gain, reach }));
        }
        // Saturates for extreme times; NaN becomes 0.
        let look = Some((view.time_s / period_s).floor() as i64);
        let renew = !self.threats.is_empty() && self.looked_in != look;
        self.looked_in = look;
        let exits = view.usable_exits();
        self.finder
            .way_out(map, PAST_POLICE, here, exits, &self.threats, renew)
            .map(|out| (out.exit, out.waypoint))
            .or_else(straight)
    }
}

/// The other robots with the weights of their kinds.
fn repulsors(view: &View<'_>, own: usize, params: &EvaderParams) -> impl Iterator<Item = Repulsor> {
    let (police, teammate) = (params.police_weight, params.teammate_weight);
    let wreck = params.wreck_weight;
    let police = view
        .opponents(Role::Pursuer)
        .map(move |robot| (robot, police));
    let non_opponents = view
        .non_opponents(Role::Pursuer)
        .filter(move |robot| robot.index != own)
        .map(move |robot| (robot, teammate));
    let wrecks = view.wrecks().map(move |robot| (robot, wreck));
    police
        .chain(non_opponents)
        .chain(wrecks)
        .map(|(robot, weight)| Repulsor {
            at: robot.pose.position(),
            weight,
        })
}
