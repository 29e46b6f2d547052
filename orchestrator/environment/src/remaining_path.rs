//! The way that an agent has left, for rewards of progress.

use nalgebra::Point2;
use navigation::routes::RouteFinder;
use observation::facts::RobotFacts;
use planner_view::map::PlannerMap;
use planner_view::view::View;
use robot::team::Role;

use crate::error::EnvironmentError;

/// The shortest way of one agent to its goal, or that of an evader without a goal to an exit.
#[derive(Debug, Clone)]
pub struct RemainingPath {
    goal: Option<Point2<f64>>,
    is_evader: bool,
    finder: RouteFinder,
    /// Length (m) at the last observation, if there was a way.
    length: Option<f64>,
}

impl RemainingPath {
    /// Returns the ways of all agents, in a world with this many exits.
    pub fn of_agents(
        agents: &[usize],
        facts: &[RobotFacts],
        exits: usize,
    ) -> Result<Vec<Self>, EnvironmentError> {
        let ways: Vec<Self> = agents
            .iter()
            .map(|&robot| Self {
                goal: facts[robot].goal.map(|goal| goal.center()),
                is_evader: facts[robot].team.role == Role::Evader,
                finder: RouteFinder::default(),
                length: None,
            })
            .collect();
        let is_used = |way: &Self| way.goal.is_some() || (way.is_evader && exits > 0);
        if ways.iter().any(is_used) {
            Ok(ways)
        } else {
            Err(EnvironmentError::NoWay)
        }
    }

    /// Returns by how much (m) the way became shorter since the last call; 0 if it was or is unknown.
    pub fn progress(&mut self, map: &PlannerMap, view: &View<'_>) -> f64 {
        let before = self.length.take();
        let Some(own) = view.own().filter(|own| own.active) else {
            return 0.0;
        };
        self.finder.prepare(map, own.radius);
        let exits = view
            .usable_exits()
            .filter(|_| self.is_evader && self.goal.is_none());
        let ends = self.goal.into_iter().chain(exits);
        let here = own.pose.position();
        let way = self.finder.way_out(map, 0, here, ends, &[], false);
        self.length = way.map(|way| way.length);
        before
            .zip(self.length)
            .map_or(0.0, |(before, now)| before - now)
    }
}
