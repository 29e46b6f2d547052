//! Guards of the exits.
//!
//! Chasers that all run after the nearest evader leave the exit open. Some pursuers stay there
//! instead. Each stands at the guard pose of its exit with the least lateness for any target at any
//! entry ([`ExitSite`]). The assignment follows from the world's state and the team's beliefs
//! alone, so that every pursuer computes the same one without messages. It holds until a pursuer
//! drops out or the map changes.
//!
//! A guard leaves its guard pose only for a certain capture:
//!
//! - it sees a target (or has exact knowledge) and meets it on its predicted course before it could
//!   be out;
//! - no other target could be out before the guard were back;
//! - from its present pose it is still early at every entry for every target, that one included.
//!
//! All conditions include [`RoleParams::margin_s`] to spare. The last one is checked again in every
//! tick: if a target turns away in time, the guard returns.

use nalgebra::Point2;
use navigation::routes::RouteFinder;
use planner_view::map::PlannerMap;
use planner_view::view::{RobotView, View};
use sim_backend::team::Team;

use crate::exit_site::{ExitSite, NEVER_S, guard_time, straight_time};
use crate::goals::{Hypothesis, hypotheses};
use crate::interception::Interceptor;
use crate::params::{Knowledge, PursuerParams, RoleParams};
use crate::slots;
use crate::targets;

/// Task of a guard in a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GuardTask {
    /// Drives to its guard pose (m), or stands there.
    GuardPose(Point2<f64>),
    /// It captures this evader.
    Capture(usize),
}

/// Guards of a team, and their data of the exits.
#[derive(Debug, Clone)]
pub struct ExitGuards {
    params: RoleParams,
    /// Active pursuers and revision of the map at the assignment of the guards.
    chosen_for: Option<(Vec<usize>, u64)>,
    /// Pursuer and number of the exit it guards.
    guards: Vec<(usize, usize)>,
    /// Revision and exits for which the sites were built.
    sites_for: Option<(u64, Vec<Point2<f64>>)>,
    sites: Vec<ExitSite>,
    hypotheses: Vec<Hypothesis>,
    /// Last assessed exit: evaders and the times at which each may be at each entry (s).
    threats: Vec<(usize, Vec<f64>)>,
}

impl ExitGuards {
    /// Returns guards without an assignment.
    pub fn new(params: RoleParams) -> Self {
        Self {
            params,
            chosen_for: None,
            guards: Vec::new(),
            sites_for: None,
            sites: Vec::new(),
            hypotheses: Vec::new(),
            threats: Vec::new(),
        }
    }

    /// Returns the guards as (pursuer, number of its exit), in the order of their assignment.
    pub fn guards(&self) -> &[(usize, usize)] {
        &self.guards
    }

    /// Returns `true` if a pursuer is a guard.
    pub fn is_guard(&self, pursuer: usize) -> bool {
        self.guards.iter().any(|guard| guard.0 == pursuer)
    }

    /// Assigns the guards again if the pursuers or the map have changed.
    ///
    /// One after the other: of the exits with the fewest guards and the free pursuers, the pair
    /// with the shortest driving time; of equal ones, those listed first. `finder` must have been
    /// prepared for the map.
    pub fn choose(&mut self, map: &PlannerMap, finder: &mut RouteFinder, view: &View<'_>) {
        if self.params.exit_guard == 0 {
            return;
        }
        let pursuers: Vec<&RobotView> = view.active(Team::Police).collect();
        let wanted = (
            pursuers.iter().map(|robot| robot.index).collect::<Vec<_>>(),
            map.revision(),
        );
        self.survey(map, view);
        if self.chosen_for.as_ref() == Some(&wanted) {
            return;
        }
        self.chosen_for = Some(wanted);
        self.guards.clear();
        let mut loads = vec![0_usize; self.sites.len()];
        for _ in 0..self.params.exit_guard.min(pursuers.len()) {
            let fewest = loads.iter().copied().min().unwrap_or(0);
            let mut best: Option<(f64, usize, usize)> = None;
            for (number, site) in self.sites.iter().enumerate() {
                if loads.get(number) != Some(&fewest) {
                    continue;
                }
                for pursuer in &pursuers {
                    if self.is_guard(pursuer.index) {
                        continue;
                    }
                    let time = driving_time(map, finder, site, pursuer);
                    if best.is_none_or(|best| time < best.0) {
                        best = Some((time, pursuer.index, number));
                    }
                }
            }
            let Some((_, pursuer, number)) = best else {
                break;
            };
            self.guards.push((pursuer, number));
            if let Some(load) = loads.get_mut(number) {
                *load += 1;
            }
        }
    }

    /// Returns the task of the robot `view.me` as a guard; `None` if it is not a guard.
    ///
    /// [`choose`](Self::choose) must have been called for this view.
    pub fn guard_task(
        &mut self,
        map: &PlannerMap,
        finder: &mut RouteFinder,
        interceptor: &mut Interceptor,
        view: &View<'_>,
        params: &PursuerParams,
    ) -> Option<GuardTask> {
        let &(_, number) = self.guards.iter().find(|guard| guard.0 == view.me)?;
        let site = self.sites.get(number)?.clone();
        self.assess(map, finder, view, &site, params);
        if let Some(target) = self.capture(map, finder, interceptor, view, &site, params) {
            return Some(GuardTask::Capture(target));
        }
        let guard_poses = self.guard_poses(view, number, &site, params.goals.reach);
        let guard_pose = guard_poses
            .iter()
            .find(|guard_pose| guard_pose.0 == view.me)?
            .1;
        Some(GuardTask::GuardPose(guard_pose))
    }

    /// Updates the exits' sites if the exits or the map have changed.
    fn survey(&mut self, map: &PlannerMap, view: &View<'_>) {
        let exits: Vec<_> = view.usable_exits().take(slots::MAX_EXITS).collect();
        let wanted = (map.revision(), exits);
        if self.sites_for.as_ref() == Some(&wanted) {
            return;
        }
        // All guards of a team count as large as the largest.
        let radius = view
            .active(Team::Police)
            .map(|robot| robot.radius)
            .fold(0.0, f64::max);
        let (circle, guard_poses) = (self.params.exit_radius, self.params.post_radius);
        let exits = wanted.1.iter().enumerate();
        self.sites = exits
            .map(|(number, &exit)| {
                ExitSite::new(
                    map,
                    slots::EXITS + number,
                    exit,
                    radius,
                    circle,
                    guard_poses,
                )
            })
            .collect();
        self.sites_for = Some(wanted);
        self.chosen_for = None;
    }

    /// Computes the time at which each evader may be at each entry of an exit: the mean over its
    /// belief.
    fn assess(
        &mut self,
        map: &PlannerMap,
        finder: &mut RouteFinder,
        view: &View<'_>,
        site: &ExitSite,
        params: &PursuerParams,
    ) {
        self.threats.clear();
        for evader in view.active(Team::Evader) {
            hypotheses(
                view,
                evader.index,
                params.knowledge,
                params.belief_goals,
                params.max_particles,
                &mut self.hypotheses,
            );
            let places = self.hypotheses.iter().map(|(pose, _)| pose.position());
            let Some(routes) = finder.routes(map, site.slot(), site.exit(), places) else {
                continue;
            };
            let mut sums = vec![0.0; site.entries().len()];
            let mut total = 0.0;
            for (pose, weight) in &self.hypotheses {
                let Some(leg) = routes.leg_to(pose.position()) else {
                    continue;
                };
                total += weight;
                for (sum, approach) in sums.iter_mut().zip(site.approaches(leg.waypoint)) {
                    *sum += weight * (leg.beyond + approach);
                }
            }
            if total > 0.0 && evader.v_max > 0.0 {
                for sum in &mut sums {
                    *sum = (*sum / (total * evader.v_max)).min(NEVER_S);
                }
                self.threats.push((evader.index, sums));
            }
        }
    }

    /// Returns the time at which the first of the evaders but `except` may be at each entry (s).
    fn deadlines(&self, entries: usize, except: Option<usize>) -> Vec<f64> {
        let mut deadlines = vec![NEVER_S; entries];
        for (_, times) in self.threats.iter().filter(|t| Some(t.0) != except) {
            for (deadline, time) in deadlines.iter_mut().zip(times) {
                *deadline = deadline.min(*time);
            }
        }
        deadlines
    }

    /// Returns the guard pose of every guard of an exit (m).
    fn guard_poses(
        &self,
        view: &View<'_>,
        number: usize,
        site: &ExitSite,
        reach: f64,
    ) -> Vec<(usize, Point2<f64>)> {
        let team: Vec<&RobotView> = self
            .guards
            .iter()
            .filter(|guard| guard.1 == number)
            .filter_map(|guard| view.robot(guard.0))
            .collect();
        let deadlines = self.deadlines(site.entries().len(), None);
        let mut guard_poses: Vec<(usize, Point2<f64>)> = Vec::with_capacity(team.len());
        // Each guard finds the best guard pose given the others'; a second round uses the poses of
        // all.
        let rounds = if team.len() > 1 { 2 } else { 1 };
        for _ in 0..rounds {
            for guard in &team {
                guard_poses.retain(|guard_pose| guard_pose.0 != guard.index);
                let mut covered = vec![NEVER_S; site.entries().len()];
                for (other, guard_pose) in &guard_poses {
                    let speed = view.robot(*other).map_or(0.0, |robot| robot.v_max);
                    for (time, &entry) in covered.iter_mut().zip(site.entries()) {
                        *time = time.min(straight_time(*guard_pose, entry, speed, reach));
                    }
                }
                let others: Vec<_> = guard_poses.iter().map(|guard_pose| guard_pose.1).collect();
                let guard_pose =
                    site.best_guard_pose(guard.v_max, reach, &deadlines, &covered, &others);
                guard_poses.push((guard.index, guard_pose));
            }
        }
        guard_poses
    }

    /// Returns the evader whose capture by `view.me` is certain; of several the first to be met.
    fn capture(
        &self,
        map: &PlannerMap,
        finder: &mut RouteFinder,
        interceptor: &mut Interceptor,
        view: &View<'_>,
        site: &ExitSite,
        params: &PursuerParams,
    ) -> Option<usize> {
        let own = view.own()?;
        let margin = self.params.margin_s;
        let reach = params.goals.reach;
        let entries = site.entries();
        let here = own.pose.position();
        let now = times_from(map, finder, site, here, own.v_max, reach)?;
        if ExitSite::lateness(&now, &self.deadlines(entries.len(), None)) > -margin {
            return None;
        }
        let mut best: Option<(f64, usize)> = None;
        for (evader, times) in &self.threats {
            let known = params.knowledge == Knowledge::Exact
                || view.belief(*evader).is_some_and(|belief| belief.seen);
            let Some(target) = targets::target(view, *evader, params.knowledge).filter(|_| known)
            else {
                continue;
            };
            let Some(meeting) = interceptor.meeting(map, finder, own, view.usable_exits(), &target)
            else {
                continue;
            };
            let out = times.iter().copied().fold(NEVER_S, f64::min);
            if meeting.time_s + margin > out {
                continue;
            }
            let Some(back) = times_from(map, finder, site, meeting.at, own.v_max, reach) else {
                continue;
            };
            let others = self.deadlines(entries.len(), Some(*evader));
            if ExitSite::lateness(&back, &others) + meeting.time_s + margin > 0.0 {
                continue;
            }
            if best.is_none_or(|best| meeting.time_s < best.0) {
                best = Some((meeting.time_s, *evader));
            }
        }
        best.map(|(_, evader)| evader)
    }
}

/// Returns the driving time of a pursuer to an exit (s); along the straight line if no path leads
/// there.
fn driving_time(
    map: &PlannerMap,
    finder: &mut RouteFinder,
    site: &ExitSite,
    pursuer: &RobotView,
) -> f64 {
    let here = pursuer.pose.position();
    let distance = finder
        .routes(map, site.slot(), site.exit(), [here])
        .and_then(|routes| routes.distance_to(here))
        .unwrap_or((site.exit() - here).norm());
    guard_time(distance, pursuer.v_max, 0.0)
}

/// Returns the time at which a guard that starts from `from` (m) has each entry in its reach (s);
/// `None` without a path.
fn times_from(
    map: &PlannerMap,
    finder: &mut RouteFinder,
    site: &ExitSite,
    from: Point2<f64>,
    speed: f64,
    reach: f64,
) -> Option<Vec<f64>> {
    let routes = finder.routes(map, site.slot(), site.exit(), [from])?;
    let leg = routes.leg_to(from)?;
    let time =
        |entry: &Point2<f64>| guard_time(leg.beyond + (leg.waypoint - entry).norm(), speed, reach);
    Some(site.entries().iter().map(time).collect())
}
