//! Guesses of a moving robot that first stops straight ahead.

use geometry::pose::Pose2;

use crate::plan::Sample;
use crate::problem::Problem;

/// Number of stages of the stop.
const STAGES: usize = 16;

/// The pose of a robot that has stopped straight ahead; `None` if it stands or its speed can step.
pub fn stop(problem: &Problem) -> Option<Stop> {
    let acceleration = problem.limits.acceleration?;
    let speed = problem.start_speed.filter(|&v| v != 0.0)?;
    Some(Stop {
        from: problem.start,
        speed,
        time: speed.abs() / acceleration,
    })
}

/// A stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    from: Pose2,
    speed: f64,
    time: f64,
}

impl Stop {
    /// The sample at a part of its time.
    fn at(&self, part: f64) -> Sample {
        let t = part * self.time;
        let length = self.speed * t * (1.0 - 0.5 * part);
        let (sin, cos) = geometry::math::sincos(self.from.theta);
        Sample {
            t,
            x: self.from.x + length * cos,
            y: self.from.y + length * sin,
            theta: self.from.theta,
            v: self.speed * (1.0 - part),
            omega: 0.0,
        }
    }

    /// Its last pose.
    pub fn end(&self) -> Pose2 {
        let end = self.at(1.0);
        Pose2::new(end.x, end.y, end.theta)
    }

    /// A guess that begins with the stop, before one from its end.
    pub fn before(&self, guess: &[Sample]) -> Vec<Sample> {
        let stop = (0..STAGES).map(|i| self.at(i as f64 / STAGES as f64));
        let rest = guess.iter().map(|sample| Sample {
            t: sample.t + self.time,
            ..*sample
        });
        stop.chain(rest).collect()
    }
}
