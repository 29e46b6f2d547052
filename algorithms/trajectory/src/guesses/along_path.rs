//! A path driven ahead or backwards from the start's pose to the goal's.

use core::f64::consts::PI;

use free_motion::Motion;
use free_motion::words::{self, Word};
use geometry::math;
use geometry::pose::Pose2;
use navigation::tangent_graph::PathLeg;

use super::turning_radius;
use crate::guide::Guide;
use trajectory_problem::Problem;

/// Distances from an end of the path at which a word may join it, in turning radii.
const JOINTS: [f64; 7] = [0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0];

/// Connection of a prescribed heading to the path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Join {
    /// A turn on the spot.
    Spot,
    /// A word in the direction in which the path is driven.
    Forwards,
    /// A Reeds–Shepp word: with cusps.
    ReedsShepp,
}

/// A path to be driven in one direction.
pub struct Along<'a> {
    problem: &'a Problem,
    guide: Guide,
    backwards: bool,
}

impl<'a> Along<'a> {
    /// `None` for a path without length.
    pub fn new(problem: &'a Problem, path: &[PathLeg], backwards: bool) -> Option<Self> {
        Some(Self {
            problem,
            guide: Guide::new(path.to_vec())?,
            backwards,
        })
    }

    /// The motions along the path, with this connection at its ends.
    pub fn motions(&self, join: Join) -> Vec<Motion> {
        let start = self.problem.start;
        let goal = self.problem.goal_heading;
        let length = self.guide.length();
        let mut motions = Vec::new();
        if join == Join::Spot {
            let turn = math::angle_difference(self.pose(0.0).theta, start.theta);
            motions.extend(Motion::turn(turn));
            self.follow(0.0, length, &mut motions);
            if let Some(theta) = goal {
                let turn = math::angle_difference(theta, self.pose(length).theta);
                motions.extend(Motion::turn(turn));
            }
            return motions;
        }
        let half = 0.5 * length;
        let (from, first) = self.joint(join, half, |s| (start, self.pose(s)));
        let (to, last) = match goal {
            Some(theta) => {
                let goal = Pose2::new(self.problem.goal.x, self.problem.goal.y, theta);
                let (to, last) = self.joint(join, half, |s| (self.pose(length - s), goal));
                (length - to, last)
            }
            None => (length, Vec::new()),
        };
        motions.extend(first);
        self.follow(from, to, &mut motions);
        motions.extend(last);
        motions
    }

    /// The distance (m) from an end of the path at which the word between the two poses and the rest
    /// of the path take the least time, and that word.
    fn joint(
        &self,
        join: Join,
        most: f64,
        ends: impl Fn(f64) -> (Pose2, Pose2),
    ) -> (f64, Vec<Motion>) {
        let radius = turning_radius(self.problem);
        let mut best: Option<(f64, f64, Word)> = None;
        for s in JOINTS.map(|part| (part * radius).min(most)) {
            let (from, to) = ends(s);
            for word in self.words(join, &from, &to, radius) {
                let detour = word.cost() - s;
                if best.as_ref().is_none_or(|(least, ..)| detour < *least) {
                    best = Some((detour, s, word));
                }
            }
        }
        best.map_or((0.0, Vec::new()), |(_, s, word)| (s, word.motions()))
    }

    fn words(&self, join: Join, from: &Pose2, to: &Pose2, radius: f64) -> Vec<Word> {
        match (join, self.backwards) {
            (Join::ReedsShepp, _) => words::reeds_shepp(from, to, radius),
            (_, false) => words::forwards(from, to, radius),
            // The robot turned around drives ahead.
            (_, true) => words::forwards(&turned(from), &turned(to), radius)
                .into_iter()
                .map(Word::backwards)
                .collect(),
        }
    }

    /// Length of the path (m).
    pub fn length(&self) -> f64 {
        self.guide.length()
    }

    /// Returns `true` if it is driven backwards.
    pub fn is_backwards(&self) -> bool {
        self.backwards
    }

    /// The robot's pose after a length (m) of the path.
    pub fn pose(&self, s: f64) -> Pose2 {
        let part = s / self.guide.length();
        let (at, u) = (self.guide.at(part), self.guide.heading(part));
        let theta = math::atan2(u.y, u.x);
        let pose = Pose2::new(at.x, at.y, theta);
        if self.backwards { turned(&pose) } else { pose }
    }

    /// Adds the motions along the path from one length (m) to another.
    fn follow(&self, from: f64, to: f64, motions: &mut Vec<Motion>) {
        let sign = if self.backwards { -1.0 } else { 1.0 };
        let mut heading: Option<f64> = None;
        for (s, leg) in self.guide.legs() {
            let length = leg.length();
            let (begin, end) = ((from - s).max(0.0), (to - s).min(length));
            if begin >= end {
                continue;
            }
            let direction = |part: f64| {
                let u = leg.heading(part);
                math::atan2(u.y, u.x)
            };
            // A kink, where the path leaves an obstacle that contains its start.
            if let Some(before) = heading {
                motions.extend(Motion::turn(math::angle_difference(direction(0.0), before)));
            }
            heading = Some(direction(1.0));
            motions.extend(Motion::drive(sign * (end - begin), sign * leg.curvature()));
        }
    }
}

fn turned(pose: &Pose2) -> Pose2 {
    Pose2::new(pose.x, pose.y, pose.theta + PI)
}
