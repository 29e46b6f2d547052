//! Prediction of the next goal by the most similar past one: the best that an observer without
//! knowledge of the method can do.

use nalgebra::Point2;

use super::statistics::ErrorStatistics;

/// State of a goal for the prediction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum View {
    /// Both coordinates together: suitable for a map of the plane.
    Plane,
    /// Each coordinate separately: suitable for one map per axis.
    PerAxis,
}

/// Goals so far, and the next goal if the past repeats.
#[derive(Debug, Clone, PartialEq)]
pub struct NearestNeighbour {
    view: View,
    goals: Vec<Point2<f64>>,
}

impl NearestNeighbour {
    /// Creates a predictor without observations.
    pub fn new(view: View) -> Self {
        Self {
            view,
            goals: Vec::new(),
        }
    }

    /// Adds the goal that came next.
    pub fn observe(&mut self, goal: Point2<f64>) {
        self.goals.push(goal);
    }

    /// Number of goals.
    pub fn len(&self) -> usize {
        self.goals.len()
    }

    /// Returns `true` if there are no goals.
    pub fn is_empty(&self) -> bool {
        self.goals.is_empty()
    }

    /// The goals, oldest first.
    pub fn goals(&self) -> &[Point2<f64>] {
        &self.goals
    }

    /// The successor of the past goal most similar to the last one; `None` with fewer than two
    /// goals. Of equally similar ones the earliest counts.
    pub fn predict(&self) -> Option<Point2<f64>> {
        self.after(*self.goals.last()?)
    }

    /// The successor of the past goal most similar to `goal`; `None` if no goal has a successor.
    pub fn after(&self, goal: Point2<f64>) -> Option<Point2<f64>> {
        match self.view {
            View::Plane => self.follower(|past| (past - goal).norm_squared()),
            View::PerAxis => {
                let x = self.follower(|past| (past.x - goal.x).abs())?.x;
                let y = self.follower(|past| (past.y - goal.y).abs())?.y;
                Some(Point2::new(x, y))
            }
        }
    }

    fn follower(&self, distance: impl Fn(&Point2<f64>) -> f64) -> Option<Point2<f64>> {
        let mut best: Option<(f64, Point2<f64>)> = None;
        for pair in self.goals.windows(2) {
            let [past, next] = pair else { continue };
            let d = distance(past);
            if best.is_none_or(|(least, _)| d < least) {
                best = Some((d, *next));
            }
        }
        best.map(|(_, next)| next)
    }
}

/// Accuracy of predictions of the goals after a stretch of history.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NextGoal {
    /// Distance of the predicted goal from the real one.
    pub plane: ErrorStatistics,
    /// The same along x and y, the errors of both combined.
    pub per_axis: ErrorStatistics,
}

/// Errors of next-goal prediction: `observed` goals are history, then every following goal is
/// predicted from all before it. `None` if no goal remains to predict, or no history.
pub fn next_goal_errors(goals: &[Point2<f64>], observed: usize, view: View) -> Option<NextGoal> {
    let history = goals.get(..observed)?;
    let mut neighbour = NearestNeighbour {
        view,
        goals: history.to_vec(),
    };
    let (mut plane, mut per_axis) = (Vec::new(), Vec::new());
    for goal in goals.iter().skip(observed) {
        if let Some(predicted) = neighbour.predict() {
            let error = predicted - goal;
            plane.push(libm::hypot(error.x, error.y));
            per_axis.extend([error.x.abs(), error.y.abs()]);
        }
        neighbour.observe(*goal);
    }
    Some(NextGoal {
        plane: ErrorStatistics::from_errors(&plane)?,
        per_axis: ErrorStatistics::from_errors(&per_axis)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repetitions_are_predicted_and_the_first_of_equals_counts() {
        let cycle = [[0.0, 0.0], [1.0, 0.5], [0.3, 0.9]].map(Point2::from);
        let goals: Vec<_> = (0..12).map(|k| cycle[k % 3]).collect();
        for view in [View::Plane, View::PerAxis] {
            let errors = next_goal_errors(&goals, 4, view).unwrap();
            assert_eq!(errors.plane.max, 0.0);
            assert_eq!(errors.plane.count, 8);
        }
        let mut neighbour = NearestNeighbour::new(View::Plane);
        assert_eq!(neighbour.predict(), None);
        neighbour.observe(cycle[0]);
        assert_eq!(neighbour.predict(), None);
        neighbour.observe(cycle[1]);
        assert_eq!(neighbour.predict(), Some(cycle[1]));
        assert_eq!(next_goal_errors(&goals, 99, View::Plane), None);
        assert_eq!(next_goal_errors(&goals, 12, View::Plane), None);
    }

    #[test]
    fn axes_are_matched_apart() {
        let mut neighbour = NearestNeighbour::new(View::PerAxis);
        for goal in [[0.0, 5.0], [1.0, 6.0], [2.0, 0.0], [3.0, 7.0]] {
            neighbour.observe(Point2::from(goal));
        }
        // x is nearest to 1, whose successor has x = 2; y is nearest to 5, whose successor has y =
        // 6.
        let after = neighbour.after(Point2::new(0.9, 4.9));
        assert_eq!(after, Some(Point2::new(2.0, 6.0)));
    }
}
