//! Guards of the exits.
//!
//! Chasers that all run after the nearest evader leave the exit open. Some pursuers stay there
//! instead: each of them at the guard pose of its exit from which it is least late for any target at any
//! entry ([`ExitSite`]). Who guards what, and where, follows from the world's state and the team's
//! beliefs alone, so that every pursuer comes to the same answer without a word; the choice is kept
//! until a pursuer drops out or the map changes.
//!
//! A guard leaves its guard pose only for a certain capture: it sees a target (or knows all), meets it on
//! its predicted course before it could be out; no other target could be out before the guard were
//! back; and from where it is now it is still early at every entry for everybody, itself included.
//! All of that with [`RoleParams::margin_s`] to spare. The last is asked again in every tick, so
//! that a target that turns away in time finds the guard on its way back.

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

/// What a guard does in a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GuardTask {
    /// It drives to its guard pose (m), or stands there.
    GuardPose(Point2<f64>),
    /// It captures this evader.
    Capture(usize),
}

/// The guards of a team, and what they know of their exits.
#[derive(Debug, Clone)]
pub struct ExitGuards {
    params: RoleParams,
    /// Active pursuers and revision of the map that the guards were chosen for.
    chosen_for: Option<(Vec<usize>, u64)>,
    /// Pursuer and number of the exit it guards.
    guards: Vec<(usize, usize)>,
    /// Revision and exits that the sites were built for.
    sites_for: Option<(u64, Vec<Point2<f64>>)>,
    sites: Vec<ExitSite>,
    hypotheses: Vec<Hypothesis>,
    /// Of the exit that was looked at last: evaders and when each may be at each entry (s).
    threats: Vec<(usize, Vec<f64>)>,
}

impl ExitGuards {
    /// Guards that have not been chosen yet.
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

    /// The guards as (pursuer, number of its exit), in the order in which they were chosen.
    pub fn guards(&self) -> &[(usize, usize)] {
        &self.guards
    }

    /// Whether a pursuer is a guard.
    pub fn is_guard(&self, pursuer: usize) -> bool {
        self.guards.iter().any(|guard| guard.0 == pursuer)
    }

    /// Chooses the guards anew if the pursuers or the map have changed.
    ///
    /// One after the other, of the exits with the fewest guards and the pursuers that are free, the
    /// two that are closest together by driving time; of equal ones, those listed first. `finder`
    /// must have been prepared for the map.
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

    /// What the robot `view.me` does as a guard; `None` if it is none.
    ///
    /// [`choose`](Self::choose) must have been called for this view.
    pub fn duty(
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

    /// Looks at the exits again if they or the map have changed.
    fn survey(&mut self, map: &PlannerMap, view: &View<'_>) {
        let exits: Vec<_> = view.usable_exits().take(slots::MAX_EXITS).collect();
        let wanted = (map.revision(), exits);
        if self.sites_for.as_ref() == Some(&wanted) {
            return;
        }
        // All guards of a team are taken to be as large as the largest.
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

    /// When each evader may be at each entry of an exit: the mean over what is believed of it.
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

    /// When the first of the evaders but `except` may be at each entry (s).
    fn deadlines(&self, entries: usize, except: Option<usize>) -> Vec<f64> {
        let mut deadlines = vec![NEVER_S; entries];
        for (_, times) in self.threats.iter().filter(|t| Some(t.0) != except) {
            for (deadline, time) in deadlines.iter_mut().zip(times) {
                *deadline = deadline.min(*time);
            }
        }
        deadlines
    }

    /// The guard pose of every guard of an exit (m).
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
        // Each finds the best guard pose given the others'; once more, now that all have one.
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

    /// The evader whose capture by `view.me` is certain, the first to be met of several.
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

/// Time that a pursuer needs to an exit (s); as the crow flies if no way leads there.
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

/// When a guard that starts from `from` (m) has each entry in its reach (s); `None` without a way.
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
