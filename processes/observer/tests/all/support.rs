//! Robot that drives from goal to goal, and its observer.

use geometry::blur::BlurredMap;
use geometry::grid::{Grid, GridFrame};
use geometry::math;
use geometry::pose::Pose2;
use nalgebra::Point2;
use observer::legs::Legs;
use observer::moment::{Look, MeasuredPose, Moment, ReachedGoal};
use observer::predictors::Predictor;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use tracking::params::SensorParams;
use tracking::sighting::gaussian_pair;
use tracking::space::Space;
use tracking::watch::Watch;

/// Length of a tick (s).
pub const DT: f64 = 0.05;
/// Distance at which the robot turns to its next goal (m).
pub const ARRIVAL: f64 = 0.05;
const SPEED: f64 = 1.0;
const TURN: f64 = 3.0;

/// Empty space of 1 m², for predictors that do not use it.
pub fn nowhere() -> (Space, Watch) {
    let frame = GridFrame {
        width: 10,
        height: 10,
        resolution: 0.1,
        origin: Point2::new(0.0, 0.0),
    };
    let map = BlurredMap::new(&Grid::filled(frame, true), 0.1).unwrap();
    (Space::new(&map), Watch::new(&SensorParams::default()))
}

/// Unicycle that turns towards its goal, on the spot if it lies far to the side, and continues to
/// the next goal as soon as it is within [`ARRIVAL`].
pub struct Robot<G> {
    pub pose: Pose2,
    pub goal: Point2<f64>,
    goals: G,
    pub reached: Vec<Point2<f64>>,
}

impl<G: Iterator<Item = Point2<f64>>> Robot<G> {
    pub fn new(start: Point2<f64>, mut goals: G) -> Self {
        Self {
            pose: Pose2::new(start.x, start.y, 0.3),
            goal: goals.next().unwrap(),
            goals,
            reached: Vec::new(),
        }
    }

    pub fn tick(&mut self) {
        while (self.goal - self.pose.position()).norm() <= ARRIVAL {
            self.reached.push(self.goal);
            self.goal = self.goals.next().unwrap();
        }
        let offset = self.goal - self.pose.position();
        let wanted = math::atan2(offset.y, offset.x);
        let bearing = math::angle_difference(wanted, self.pose.theta);
        let omega = (10.0 * bearing).clamp(-TURN, TURN);
        let mut v = if bearing.abs() > 0.8 { 0.0 } else { SPEED };
        // The speed of the circle to a near goal.
        let bend = 2.0 * math::sin(bearing).abs() / offset.norm();
        if bend * v > TURN {
            v = TURN / bend;
        }
        let middle = self.pose.theta + 0.5 * omega * DT;
        let (sin, cos) = math::sincos(middle);
        self.pose = Pose2::new(
            self.pose.x + v * DT * cos,
            self.pose.y + v * DT * sin,
            math::wrap_angle(self.pose.theta + omega * DT),
        );
    }
}

/// Observes with noise and passes its measurements to a predictor.
pub struct NoisyObserver {
    pub legs: Legs,
    pub sigma: f64,
    pub heading_sigma: f64,
    rng: ChaCha8Rng,
    scene: (Space, Watch),
    tick: u64,
}

impl NoisyObserver {
    pub fn new(sigma: f64, heading_sigma: f64, seed: u64) -> Self {
        Self {
            legs: Legs::new(ARRIVAL),
            sigma,
            heading_sigma,
            rng: ChaCha8Rng::seed_from_u64(seed),
            scene: nowhere(),
            tick: 0,
        }
    }

    /// Runs one tick; `seen` is `true` while the robot is in sight. Returns the detected goal.
    pub fn look(
        &mut self,
        pose: Pose2,
        seen: bool,
        predictor: &mut dyn Predictor,
    ) -> Option<ReachedGoal> {
        let ((x, y), (turn, _)) = (gaussian_pair(&mut self.rng), gaussian_pair(&mut self.rng));
        let look = Look {
            time: self.tick as f64 * DT,
            dt: DT,
            seen: seen.then(|| MeasuredPose {
                position: Point2::new(pose.x + self.sigma * x, pose.y + self.sigma * y),
                heading: pose.theta + self.heading_sigma * turn,
                sigma: self.sigma,
                heading_sigma: self.heading_sigma,
            }),
            visibility: f64::from(u8::from(seen)),
        };
        self.tick += 1;
        let goal = self.legs.observe(&look);
        let moment = self.moment(look, goal);
        predictor.observe(&moment);
        goal
    }

    /// Returns the predictor's current result for a robot out of sight.
    pub fn predict(&self, predictor: &dyn Predictor, horizon: f64) -> Option<Point2<f64>> {
        self.predict_with(predictor, None, horizon)
    }

    /// Returns the predictor's current result for a robot that is observed without noise.
    pub fn predict_seen(
        &self,
        predictor: &dyn Predictor,
        pose: Pose2,
        horizon: f64,
    ) -> Option<Point2<f64>> {
        let seen = MeasuredPose {
            position: pose.position(),
            heading: pose.theta,
            sigma: 0.0,
            heading_sigma: 0.0,
        };
        self.predict_with(predictor, Some(seen), horizon)
    }

    fn predict_with(
        &self,
        predictor: &dyn Predictor,
        seen: Option<MeasuredPose>,
        horizon: f64,
    ) -> Option<Point2<f64>> {
        let look = Look {
            time: self.tick as f64 * DT,
            dt: DT,
            seen,
            visibility: f64::from(u8::from(seen.is_some())),
        };
        let moment = Moment {
            look,
            goal: None,
            goals_lost: false,
            space: &self.scene.0,
            watch: &self.scene.1,
        };
        predictor.predict(horizon, &moment)
    }

    fn moment(&mut self, look: Look, goal: Option<ReachedGoal>) -> Moment<'_> {
        Moment {
            look,
            goal,
            goals_lost: look.seen.is_some() && self.legs.take_lost(),
            space: &self.scene.0,
            watch: &self.scene.1,
        }
    }
}
