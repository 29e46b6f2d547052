//! Methods that predict a robot's position, behind one trait.

pub mod kalman;
pub mod key;
pub mod particles;
pub mod similar_goal;
pub mod similar_stretch;

use nalgebra::Point2;

use crate::moment::Moment;

/// Predicts the position of one robot.
pub trait Predictor {
    /// Processes a moment; moments are in the order of time.
    fn observe(&mut self, moment: &Moment<'_>);

    /// Returns the robot's position `horizon` (s) after the last moment; `None` if the method has
    /// no prediction.
    fn predict(&self, horizon: f64, moment: &Moment<'_>) -> Option<Point2<f64>>;

    /// Returns the number of detected goals; 0 for methods without goals.
    fn goals_observed(&self) -> u32 {
        0
    }

    /// Returns `true` if the key of the robot's goals is known.
    fn key_recovered(&self) -> bool {
        false
    }
}
