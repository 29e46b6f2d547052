//! Driver through sub-goals without stops.
//!
//! Arcs join the legs (Chebyshev coverage paper, Fig. 9b and c; [`crate::legs`]), and pure pursuit tracks
//! the path ([`control::path_tracking`]). A sub-goal whose corner is an arc is passed at the end of the
//! arc; the robot drives to a sub-goal without an arc.

use std::collections::VecDeque;

use crate::goal::Goal;
use crate::legs::{Piece, Rounder, Rounding, RoundingError};
use avoidance::waypoint_driver::{DriverOutput, MIN_TIME_S, Situation};
use control::go_to::distance_to_segment;
use control::path_tracking::{Path, PathTracker, TrackingParams};
use geometry::pose::Twist2;
use geometry::shape::Aabb;
use nalgebra::Point2;
use planner_view::limits::Limits;
use planner_view::waypoint::{WaypointOutcome, WaypointReport};

use crate::sub_goals::params::FollowParams;

/// Distance between the points of a path on an arc (m).
const STEP: f64 = 0.02;

/// Minimum radius of an arc (m): at a corner with less room the robot turns on the spot.
const MIN_RADIUS: f64 = 0.02;

/// Maximum number of sub-goals that may end in a tick.
const MAX_PER_TICK: usize = 64;

/// A sub-goal and the path to it, up to the end of the arc there.
#[derive(Debug, Clone)]
struct Stretch {
    goal: Goal,
    points: Vec<Point2<f64>>,
    /// `true` if the path continues without a corner.
    smooth: bool,
    /// Duration at full speed (s).
    duration: f64,
}

/// The current stretch.
#[derive(Debug, Clone, Copy)]
struct Leg {
    started_s: f64,
    until_s: f64,
    closest: f64,
    /// Its end on the tracked path (m).
    end: f64,
}

/// Drives a robot along rounded legs.
#[derive(Debug, Clone)]
pub struct ArcDriver {
    limits: Limits,
    tracking: TrackingParams,
    rounding: Rounding,
    /// Duration of a half turn (s).
    half_turn_s: f64,
    time_limit_factor: f64,
    rounder: Option<Rounder>,
    /// The goal whose corner is not known yet.
    pending: Option<Goal>,
    /// End of the last finished stretch (m).
    tail: Point2<f64>,
    stretches: VecDeque<Stretch>,
    leg: Option<Leg>,
    tracker: PathTracker,
    before: Option<Point2<f64>>,
}

impl ArcDriver {
    /// Creates a driver for a robot with these limits.
    ///
    /// # Errors
    /// [`RoundingError`] if the limits or the minimum radius allow no arcs.
    pub fn new(params: &FollowParams, limits: Limits) -> Result<Self, RoundingError> {
        let tracking = params.tracking;
        let v = limits.v_max() * tracking.speed_fraction;
        let omega = limits.restricted(1.0, tracking.omega_cap).omega_max();
        Ok(Self {
            limits,
            tracking,
            rounding: Rounding::new(v, omega, params.max_miss, MIN_RADIUS)?,
            half_turn_s: core::f64::consts::PI / omega,
            time_limit_factor: params.driver.time_limit_factor,
            rounder: None,
            pending: None,
            tail: Point2::origin(),
            stretches: VecDeque::new(),
            leg: None,
            tracker: PathTracker::default(),
            before: None,
        })
    }

    /// The current sub-goal.
    pub fn current(&self) -> Option<&Goal> {
        self.stretches.front().map(|stretch| &stretch.goal)
    }

    /// Executes one tick: ends sub-goals that are passed or late, takes the `next` ones (two ahead), and
    /// drives. Appends their outcomes to `reports`. A pose or time that is not finite stops the robot and
    /// changes nothing else.
    pub fn drive(
        &mut self,
        next: &mut dyn FnMut() -> Option<Goal>,
        situation: &Situation<'_>,
        reports: &mut Vec<WaypointReport>,
    ) -> DriverOutput {
        let stop = DriverOutput {
            command: Twist2::STOP,
            towards: None,
            mode: None,
        };
        let Situation { pose, time_s, .. } = *situation;
        if !(pose.is_finite() && time_s.is_finite()) {
            return stop;
        }
        let here = pose.position();
        let from = self.before.replace(here).unwrap_or(here);
        for _ in 0..MAX_PER_TICK {
            self.fill(next, here);
            if self.leg.is_none() && !self.set_out(time_s) {
                return stop;
            }
            let (Some(stretch), Some(leg)) = (self.stretches.front(), self.leg.as_mut()) else {
                return stop;
            };
            let goal = stretch.goal.waypoint.point;
            leg.closest = leg.closest.min(distance_to_segment(goal, from, here));
            let ahead = self.stretches.get(1).filter(|_| stretch.smooth);
            let rectangles = [Some(stretch), ahead].map(|s| s.and_then(|s| s.goal.within));
            let tracking =
                self.tracker
                    .track(&pose, &self.limits, &self.tracking, |pose, target| {
                        sees(&rectangles, pose.position(), target)
                    });
            let passed = tracking.is_none_or(|tracking| match ahead {
                // The tracked path continues, and may end near the part where the robot is.
                Some(_) => self.tracker.progress() >= leg.end - 1e-9,
                None => tracking.arrived,
            });
            let outcome = if passed {
                WaypointOutcome::Reached
            } else if time_s >= leg.until_s {
                WaypointOutcome::TimedOut
            } else if let Some(tracking) = tracking {
                return DriverOutput {
                    command: tracking.command,
                    towards: Some(tracking.target),
                    mode: None,
                };
            } else {
                return stop;
            };
            reports.push(WaypointReport {
                waypoint: stretch.goal.waypoint,
                outcome,
                started_s: leg.started_s,
                ended_s: time_s,
                closest: leg.closest,
            });
            self.leg = None;
            self.stretches.pop_front();
        }
        stop
    }

    /// Takes goals until two stretches are known or there are no more.
    fn fill(&mut self, next: &mut dyn FnMut() -> Option<Goal>, here: Point2<f64>) {
        while self.stretches.len() < 2 {
            let mut pieces = Vec::new();
            let goal = next();
            if let Some(goal) = &goal {
                let rounding = self.rounding;
                if self.rounder.is_none() {
                    self.tail = here;
                }
                let rounder = self
                    .rounder
                    .get_or_insert_with(|| Rounder::new(rounding, here, None));
                rounder.push(goal, &mut pieces);
            } else if let Some(mut rounder) = self.rounder.take() {
                rounder.finish(&mut pieces);
            }
            let Some(before) = core::mem::replace(&mut self.pending, goal) else {
                if self.pending.is_none() {
                    return;
                }
                continue;
            };
            let mut points = vec![self.tail];
            for piece in &pieces {
                match piece {
                    Piece::Straight { to, .. } => points.push(*to),
                    Piece::Arc(_) => points.extend(piece.poses(STEP).map(|p| p.position())),
                    Piece::Turn { .. } => {}
                }
            }
            self.tail = points.last().copied().unwrap_or(self.tail);
            self.stretches.push_back(Stretch {
                goal: before,
                points,
                smooth: matches!(pieces.last(), Some(Piece::Arc(_))),
                duration: pieces.iter().map(|p| p.duration(&self.rounding)).sum(),
            });
        }
    }

    /// Begins the first stretch; returns `false` if there is none.
    fn set_out(&mut self, time_s: f64) -> bool {
        let Some(stretch) = self.stretches.front() else {
            return false;
        };
        let end = Path::new(stretch.points.iter().copied()).length();
        // A look-ahead beyond a corner would cut the corner.
        let ahead = self.stretches.get(1).filter(|_| stretch.smooth);
        let beyond = ahead.into_iter().flat_map(|stretch| &stretch.points);
        let path = Path::new(stretch.points.iter().chain(beyond).copied());
        // The robot may have to turn first: its pose differs slightly from the path's.
        let expected = stretch.duration + self.half_turn_s;
        let allowed = (self.time_limit_factor * expected).max(MIN_TIME_S);
        self.leg = Some(Leg {
            started_s: time_s,
            until_s: time_s + allowed,
            closest: f64::INFINITY,
            end,
        });
        self.tracker.set_path(path);
        true
    }
}

/// Returns `true` if one of the rectangles, which are convex, contains both ends of a segment; a segment
/// without a rectangle counts as clear.
fn sees(rectangles: &[Option<Aabb>; 2], from: Point2<f64>, to: Point2<f64>) -> bool {
    let mut known = rectangles.iter().flatten().peekable();
    known.peek().is_none() || known.any(|r| r.contains(from) && r.contains(to))
}

#[cfg(test)]
mod tests;
