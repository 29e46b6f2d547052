//! Assignment of pursuers to evaders without messages.
//!
//! All pursuers receive the same state of the world and the same beliefs in the same tick. Each
//! solves the same problem with the same deterministic algorithm and reads its own line of the
//! common solution. No message is needed, and none can be lost. A pursuer that joins late (after a
//! restart) has no earlier targets. It may therefore disagree with its colleagues by up to the cost
//! of a switch until the next change of the teams.

use nalgebra::Point2;
use navigation::routes::RouteFinder;
use planner_view::map::PlannerMap;
use planner_view::view::{RobotView, View};
use robot::team::Role;

use super::cut_off::{CutSearch, EvaderState, ExitBlocker};
use super::goals::{estimate, is_known};
use super::matching::{balanced, milliseconds};
use super::params::{AssignmentMethod, AssignmentParams};
use super::slots;

/// Minimum gain in driving time of a change of target (s); prevents two pursuers from swapping
/// repeatedly.
const SWITCH_COST_S: f64 = 2.0;

/// Maximum number of pursuers and evaders that are matched with each other; with more, each pursuer
/// takes the nearest.
const MAX_MATCHED: usize = 256;

/// Order to a pursuer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Order {
    /// The robot it chases.
    pub target: usize,
    /// Place at which it cuts that robot off (m); absent: it drives at the robot.
    pub place: Option<Point2<f64>>,
}

/// Assigns targets; stores them between ticks.
#[derive(Debug, Clone)]
pub struct Assigner {
    params: AssignmentParams,
    /// Target of each pursuer at the last assignment, as (pursuer, evader), in view order.
    targets: Vec<(usize, usize)>,
    /// Places of the pursuers that chase the same evader as this one.
    places: Vec<(usize, Option<Point2<f64>>)>,
    /// Participants in the last assignment, and its period.
    solved_for: Option<(Vec<usize>, Vec<usize>, i64)>,
}

impl Assigner {
    /// An assigner without targets.
    pub fn new(params: AssignmentParams) -> Self {
        Self {
            params,
            targets: Vec::new(),
            places: Vec::new(),
            solved_for: None,
        }
    }

    /// Returns the order of `view.me` for this tick, if any.
    ///
    /// `finder` must have been prepared for the map.
    pub fn order(
        &mut self,
        map: &PlannerMap,
        finder: &mut RouteFinder,
        view: &View<'_>,
    ) -> Option<Order> {
        let has_begun = view.time_s >= self.params.delay_s;
        if !has_begun {
            self.targets.clear();
            self.places.clear();
            self.solved_for = None;
            return None;
        }
        let target = match self.params.method {
            AssignmentMethod::NearestSticky => self.nearest_sticky(view),
            AssignmentMethod::CutOff => self.matched(map, finder, view),
        }?;
        let place = self.places.iter().find(|(who, _)| *who == view.me);
        Some(Order {
            target,
            place: place.and_then(|(_, place)| *place),
        })
    }

    fn nearest_sticky(&mut self, view: &View<'_>) -> Option<usize> {
        let kept = self.kept(view.me).filter(|&kept| {
            view.opponents(Role::Evader)
                .any(|evader| evader.index == kept)
        });
        let target = kept.or_else(|| self.nearest(view));
        self.targets.clear();
        self.targets.extend(target.map(|target| (view.me, target)));
        target
    }

    /// Returns the nearest evader to this robot along the straight line, the lower index of two.
    fn nearest(&self, view: &View<'_>) -> Option<usize> {
        let here = view.own()?.pose.position();
        let mut best: Option<(f64, usize)> = None;
        for evader in view.opponents(Role::Evader) {
            let Some(at) = estimate(view, evader.index, self.params.knowledge) else {
                continue;
            };
            let distance = (at - here).norm();
            let found = (distance, evader.index);
            if best.is_none_or(|best| found < best) {
                best = Some(found);
            }
        }
        best.map(|(_, index)| index)
    }

    fn matched(
        &mut self,
        map: &PlannerMap,
        finder: &mut RouteFinder,
        view: &View<'_>,
    ) -> Option<usize> {
        let knowledge = self.params.knowledge;
        let pursuers = || view.teammates(Role::Pursuer).take(MAX_MATCHED);
        let known = || {
            view.opponents(Role::Evader)
                .filter(|evader| is_known(view, evader.index, knowledge))
                .take(MAX_MATCHED)
        };
        let index = |robot: &RobotView| robot.index;
        let period = (view.time_s / self.params.period_s).floor() as i64;
        let is_solved = self.solved_for.as_ref().is_some_and(|(own, other, at)| {
            *at == period
                && pursuers().map(index).eq(own.iter().copied())
                && known().map(index).eq(other.iter().copied())
        });
        if !is_solved {
            let teams: (Vec<usize>, Vec<usize>) = (
                pursuers().map(index).collect(),
                known().map(index).collect(),
            );
            let pursuers: Vec<&RobotView> = pursuers().collect();
            let evaders: Vec<(&RobotView, Point2<f64>)> = known()
                .filter_map(|evader| Some((evader, estimate(view, evader.index, knowledge)?)))
                .collect();
            let costs = self.costs(map, finder, &pursuers, &evaders);
            self.targets = balanced(&costs, pursuers.len(), evaders.len())
                .into_iter()
                .map(|(row, column)| (teams.0[row], teams.1[column]))
                .collect();
            self.solved_for = Some((teams.0, teams.1, period));
            self.cut_off(map, finder, view, (pursuers.as_slice(), evaders.as_slice()));
        }
        self.kept(view.me)
    }

    /// Finds the places of all pursuers that chase the same evader as `view.me`.
    fn cut_off(
        &mut self,
        map: &PlannerMap,
        finder: &mut RouteFinder,
        view: &View<'_>,
        (pursuers, evaders): (&[&RobotView], &[(&RobotView, Point2<f64>)]),
    ) {
        self.places.clear();
        let Some(target) = self.kept(view.me) else {
            return;
        };
        let Some(&(evader, at)) = evaders.iter().find(|(robot, _)| robot.index == target) else {
            return;
        };
        let (who, blockers): (Vec<usize>, Vec<ExitBlocker>) = pursuers
            .iter()
            .enumerate()
            .filter(|(_, pursuer)| self.kept(pursuer.index) == Some(target))
            .map(|(row, pursuer)| {
                let blocker = ExitBlocker {
                    at: pursuer.pose.position(),
                    v_max: pursuer.v_max,
                    slot: slots::ASSIGNMENT + row,
                };
                (pursuer.index, blocker)
            })
            .unzip();
        let radius = self.params.block_radius;
        let evader = EvaderState {
            at,
            v_max: evader.v_max,
        };
        let exits = view.usable_exits();
        // Its memory is as large as the map, and used once per period.
        let mut search = CutSearch::default();
        let places = search.places(map, finder, exits, &evader, &blockers, radius);
        self.places = who.into_iter().zip(places).collect();
    }

    fn kept(&self, pursuer: usize) -> Option<usize> {
        self.targets
            .iter()
            .find(|(who, _)| *who == pursuer)
            .map(|(_, target)| *target)
    }

    /// Computes the driving times of the pursuers to the evaders (ms), pursuer by pursuer, with the
    /// cost of a switch.
    fn costs(
        &self,
        map: &PlannerMap,
        finder: &mut RouteFinder,
        pursuers: &[&RobotView],
        evaders: &[(&RobotView, Point2<f64>)],
    ) -> Vec<i64> {
        let mut costs = Vec::with_capacity(pursuers.len() * evaders.len());
        for (row, pursuer) in pursuers.iter().enumerate() {
            let here = pursuer.pose.position();
            let places = evaders.iter().map(|&(_, at)| at);
            let routes = finder.routes(map, slots::ASSIGNMENT + row, here, places);
            for (evader, at) in evaders {
                let distance = routes
                    .and_then(|routes| routes.distance_to(*at))
                    .unwrap_or((at - here).norm());
                let kept = self
                    .kept(pursuer.index)
                    .is_none_or(|kept| kept == evader.index);
                let switch = if kept { 0.0 } else { SWITCH_COST_S };
                costs.push(milliseconds(distance / pursuer.v_max + switch));
            }
        }
        costs
    }
}
