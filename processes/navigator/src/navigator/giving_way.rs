//! Giving way to another robot in a lane that is too narrow for both.
//!
//! The robot with the lower index has the right of way. The other one gives way as soon as it knows
//! no way around: it drives to a place from which the first can pass, waits there, and continues
//! when it has a way to its goal. If it has no such place, it stands, and the robot with the right
//! of way gives way after a while.

use nalgebra::Point2;
use navigation::passing::{Meeting, Retreat, retreat};
use planner_view::free_space::FreeSpace;
use planner_view::view::{RobotView, View};

use super::{GOAL_TOLERANCE, Navigator, ReplanReason};
use crate::follow::STANDING;

/// Standstill after which a robot gives up its right of way (s).
const INSIST_S: f64 = 5.0;

/// A robot gives way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct GivingWay {
    /// Index of the robot that may pass.
    pub to: usize,
    /// Place from which it can pass (m).
    pub place: Point2<f64>,
    /// `true` once the robot waits there for a way to its goal.
    pub waits: bool,
}

impl Navigator {
    /// Returns the place that the next plan leads to (m).
    pub(super) fn destination(&self) -> Option<Point2<f64>> {
        match &self.giving_way {
            Some(giving_way) if !giving_way.waits => Some(giving_way.place),
            _ => self.goal(),
        }
    }

    /// Notes since when the robot stands before another one; `who` blocks its path now.
    pub(super) fn note_standoff(&mut self, who: Option<usize>, stands: bool, time_s: f64) {
        self.standoff = match (who.filter(|_| stands), self.standoff) {
            (Some(who), Some((since, before))) if who == before => Some((since, who)),
            (Some(who), _) => Some((time_s, who)),
            (None, _) => None,
        };
        // Before another robot there may be a way around.
        self.is_boxed_in &= self.standoff.is_some();
    }

    /// Begins to give way, waits at the place, or ends it.
    pub(super) fn look_at_right_of_way(
        &mut self,
        space: &FreeSpace,
        view: &View<'_>,
        own: &RobotView,
    ) {
        self.trail.add(own.pose.position());
        if self.asked.is_some() {
            return;
        }
        let Some(giving_way) = self.giving_way else {
            return self.begin_to_give_way(space, view, own);
        };
        if self.traffic.active(giving_way.to).is_none() {
            self.giving_way = None;
            self.want = Some(ReplanReason::Need);
        } else if giving_way.waits {
            self.want = Some(ReplanReason::Need);
        } else if self.follow.as_ref().is_some_and(|follow| {
            let end = follow.trajectory.at(f64::INFINITY).0.position();
            (end - giving_way.place).norm() <= GOAL_TOLERANCE && follow.left() <= 0.0
        }) && own.twist.v.abs() < STANDING
        {
            self.giving_way = Some(GivingWay {
                waits: true,
                ..giving_way
            });
            self.want = Some(ReplanReason::Need);
        }
    }

    fn begin_to_give_way(&mut self, space: &FreeSpace, view: &View<'_>, own: &RobotView) {
        let Some((since, who)) = self.standoff.filter(|_| self.is_boxed_in) else {
            return;
        };
        let has_right_of_way = view.me < who;
        if has_right_of_way && view.time_s - since < INSIST_S {
            return;
        }
        let Some(other) = self.traffic.active(who) else {
            return;
        };
        // The map changes and the other robot moves: a later failure may find another place.
        self.is_boxed_in = false;
        let model = self.drive.model();
        let meeting = Meeting {
            at: own.pose.position(),
            other: other.at,
            clearance: model.radius + self.params.margin,
            apart: other.apart_to_pass(),
        };
        let Some(Retreat::Aside(place) | Retreat::Back(place)) =
            retreat(space, &self.trail, &meeting)
        else {
            return;
        };
        self.giving_way = Some(GivingWay {
            to: who,
            place,
            waits: false,
        });
        self.ignore_robots = false;
        self.want = Some(ReplanReason::Need);
        self.not_before = 0.0;
    }
}
