//! Guards of a team that leave their patrol and pursue intruders.
//!
//! Each guard computes the same from the state and the team's beliefs of a tick, without messages of its own:
//!
//! - An intruder is a hostile evader in play. One that is seen and that no guard pursues gets the nearest of the guards
//!   that are on patrol, first of those with a free line to it.
//! - The pursuit ends when the intruder is caught or has escaped, when the guard is out of play, and when the intruder has
//!   not been seen for [`Pursuits::new`]'s time.
//!
//! A process that starts in a pursuit does not know of it: it sends a guard at the next sighting.

use nalgebra::Point2;
use planner_view::map::PlannerMap;
use planner_view::view::{RobotView, View};
use robot::team::Role;

/// A guard and its intruder.
#[derive(Debug, Clone, Copy)]
struct Pursuit {
    guard: usize,
    intruder: usize,
    /// Time at which the intruder was last seen (s).
    seen_s: f64,
}

/// The pursuits of a team.
#[derive(Debug, Clone)]
pub struct Pursuits {
    guards: Vec<usize>,
    lost_s: f64,
    all: Vec<Pursuit>,
}

impl Pursuits {
    /// The guards with these indices, without an intruder; one that has not been seen for `lost_s` (s) is lost.
    pub fn new(guards: &[u32], lost_s: f64) -> Self {
        Self {
            guards: guards.iter().map(|&guard| guard as usize).collect(),
            lost_s,
            all: Vec::new(),
        }
    }

    /// Follows the intruders in a tick.
    pub fn observe(&mut self, map: &PlannerMap, view: &View<'_>) {
        let seen = |intruder: usize| view.belief(intruder).is_some_and(|belief| belief.seen);
        for pursuit in &mut self.all {
            if seen(pursuit.intruder) {
                pursuit.seen_s = view.time_s;
            }
        }
        let in_play = |robot: usize| view.robot(robot).is_some_and(|robot| robot.active);
        let lost_s = self.lost_s;
        self.all.retain(|pursuit| {
            let is_fresh = view.time_s - pursuit.seen_s <= lost_s;
            is_fresh && in_play(pursuit.guard) && in_play(pursuit.intruder)
        });
        for intruder in view.opponents(Role::Evader).map(|robot| robot.index) {
            if self.pursued_by(intruder).is_some() {
                continue;
            }
            let Some(belief) = view.belief(intruder).filter(|belief| belief.seen) else {
                continue;
            };
            if let Some(guard) = self.nearest(map, view, belief.mean.position()) {
                self.all.push(Pursuit {
                    guard,
                    intruder,
                    seen_s: view.time_s,
                });
            }
        }
    }

    /// Returns the guard on patrol that is nearest to a place (m), first of those with a free line to it.
    fn nearest(&self, map: &PlannerMap, view: &View<'_>, at: Point2<f64>) -> Option<usize> {
        let on_patrol = self
            .guards
            .iter()
            .filter(|&&g| self.intruder_of(g).is_none());
        let guards = on_patrol.filter_map(|&guard| view.robot(guard).filter(|guard| guard.active));
        let rank = |guard: &RobotView| {
            let here = guard.pose.position();
            (!map.line_is_clear(here, at, 0.0), (here - at).norm())
        };
        let ranked = guards.map(|guard| (rank(guard), guard.index));
        let nearest = ranked.min_by(|((a_hidden, a_m), _), ((b_hidden, b_m), _)| {
            a_hidden.cmp(b_hidden).then(a_m.total_cmp(b_m))
        });
        nearest.map(|(_, guard)| guard)
    }

    /// Returns the intruder that a guard pursues.
    pub fn intruder_of(&self, guard: usize) -> Option<usize> {
        let mut pursuits = self.all.iter();
        let found = pursuits.find(|pursuit| pursuit.guard == guard);
        found.map(|pursuit| pursuit.intruder)
    }

    /// Returns the guard that pursues an intruder.
    fn pursued_by(&self, intruder: usize) -> Option<usize> {
        let mut pursuits = self.all.iter();
        let found = pursuits.find(|pursuit| pursuit.intruder == intruder);
        found.map(|pursuit| pursuit.guard)
    }

    /// Writes the robots as the guards on patrol see them to `into` (cleared first): one that pursues an intruder is out
    /// of play, but a body.
    pub fn on_patrol(&self, robots: &[RobotView], into: &mut Vec<RobotView>) {
        into.clear();
        into.extend(robots.iter().map(|robot| RobotView {
            active: robot.active && self.intruder_of(robot.index).is_none(),
            ..*robot
        }));
    }

    /// Writes the robots as the pursuing guards see them to `into` (cleared first): all but these guards and their
    /// intruders are bodies without a part in the game.
    pub fn in_pursuit(&self, robots: &[RobotView], into: &mut Vec<RobotView>) {
        let takes_part =
            |robot: usize| self.intruder_of(robot).or(self.pursued_by(robot)).is_some();
        into.clear();
        into.extend(robots.iter().map(|robot| RobotView {
            team: if takes_part(robot.index) {
                robot.team
            } else {
                Role::Neutral.into()
            },
            ..*robot
        }));
    }
}

#[cfg(test)]
mod tests;
