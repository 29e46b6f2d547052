//! Ways to predict where a robot will be, behind one trait.

pub mod kalman;
pub mod key;
pub mod particles;
pub mod similar_goal;
pub mod similar_stretch;

use nalgebra::Point2;

use crate::moment::Moment;

/// Foretells where one robot will be.
pub trait Predictor {
    /// Takes up a moment; moments come in the order of time.
    fn observe(&mut self, moment: &Moment<'_>);

    /// Where the robot will be `horizon` (s) after the last moment; `None` if the method cannot say.
    fn predict(&self, horizon: f64, moment: &Moment<'_>) -> Option<Point2<f64>>;

    /// Goals made out so far; 0 for methods that look for none.
    fn goals_observed(&self) -> u32 {
        0
    }

    /// Whether the key of the robot's goals is known.
    fn key_recovered(&self) -> bool {
        false
    }
}
