//! Path and speed of a robot between goals.

use nalgebra::Point2;

use crate::moment::{Moment, ReachedGoal};

/// Number of legs over which the speed is averaged.
const LEGS: usize = 8;

/// Returns the position of a robot that drives from `from` (m) through `goals` (m) along straight
/// lines for `length` (m). It stays at the last goal; `None` if there is none and it has to
/// continue.
pub fn along(
    from: Point2<f64>,
    goals: impl IntoIterator<Item = Point2<f64>>,
    length: f64,
) -> Option<Point2<f64>> {
    let (mut at, mut left, mut any) = (from, length, false);
    for goal in goals {
        any = true;
        let leg = goal - at;
        let distance = leg.norm();
        if distance >= left && distance > 0.0 {
            return Some(at + leg * (left / distance));
        }
        left -= distance;
        at = goal;
    }
    (any || length <= 0.0).then_some(at)
}

/// Mean speed over the last legs, turns included, and last observed position.
#[derive(Debug, Clone, Default)]
pub struct Pace {
    /// Times (s) and places of the last goals, oldest first.
    goals: Vec<ReachedGoal>,
    last: Option<Point2<f64>>,
    /// Time since then (s).
    unseen_for: f64,
}

impl Pace {
    /// Processes a moment.
    pub fn observe(&mut self, moment: &Moment<'_>) {
        if moment.goals_lost {
            self.goals.clear();
        }
        if let Some(goal) = moment.goal {
            self.goals.push(goal);
            if self.goals.len() > LEGS + 1 {
                self.goals.remove(0);
            }
        }
        if let Some(seen) = moment.look.seen {
            self.last = Some(seen.position);
            self.unseen_for = 0.0;
        } else {
            self.unseen_for += moment.look.dt;
        }
    }

    /// Returns the mean speed (m/s); `None` before the second goal.
    pub fn speed(&self) -> Option<f64> {
        let (first, last) = (self.goals.first()?, self.goals.last()?);
        let time = last.time - first.time;
        let way: f64 = self
            .goals
            .windows(2)
            .map(|pair| match pair {
                [a, b] => (b.point - a.point).norm(),
                _ => 0.0,
            })
            .sum();
        (time > 0.0).then(|| way / time)
    }

    /// Returns the robot's last observed position (m), and the distance that it covers from there
    /// until `horizon` (s) from now (m). `None` before it has been observed and before the second
    /// goal.
    pub fn way(&self, horizon: f64) -> Option<(Point2<f64>, f64)> {
        Some((self.last?, self.speed()? * (self.unseen_for + horizon)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_is_followed_through_its_goals_and_ends_at_the_last() {
        let start = Point2::new(0.0, 0.0);
        let goals = [Point2::new(1.0, 0.0), Point2::new(1.0, 2.0)];
        let at = |length| along(start, goals, length).unwrap();
        assert_eq!(at(0.5), Point2::new(0.5, 0.0));
        assert_eq!(at(1.5), Point2::new(1.0, 0.5));
        assert_eq!(at(9.0), goals[1]);
        assert_eq!(along(start, [], 1.0), None);
        assert_eq!(
            along(start, [start, goals[0]], 0.5),
            Some(Point2::new(0.5, 0.0))
        );
    }
}
