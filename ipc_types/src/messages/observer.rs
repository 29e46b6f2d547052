//! Positions of robots as an observer predicts them.

use crate::message::ZeroCopySend;

use crate::message;

message! {
    /// Predicted position of one robot, by one method for one time ahead, in `observer/prediction`.
    pub struct Prediction = "protean/Prediction" {
        horizon_s: f64 = "how far ahead [s]",
        x: f64 = "predicted position, x [m]; infinite if the method makes no prediction",
        y: f64 = "predicted position, y [m]; infinite if the method makes no prediction",
        error: f64 = "distance between where the robot is now and where it was predicted to be, that time ago [m]; infinite if no prediction was made then",
        robot: u32 = "index of the robot",
        goals_observed: u32 = "goals that the method has made out so far; 0 for methods that look for none",
        method: u8 = "how it was predicted: an index of the method names",
        due: u8 = "1 if a prediction has come due, or would have; only then the error counts",
        visible: u8 = "1 if the robot is seen now",
        key_recovered: u8 = "1 if the method has found the key of the robot's goals",
        reserved: [u8; 4] = "always 0",
    }
}

impl Prediction {
    /// Code of the Kalman filter of constant velocity.
    pub const KALMAN: u8 = 0;
    /// Code of the particle filter.
    pub const PARTICLES: u8 = 1;
    /// Code of the successor of the most similar stretch of the path.
    pub const SIMILAR_STRETCH: u8 = 2;
    /// Code of the successor of the most similar goal.
    pub const SIMILAR_GOAL: u8 = 3;
    /// Code of the same, each coordinate separately.
    pub const SIMILAR_GOAL_PER_AXIS: u8 = 4;
    /// Code of the recovered key of a cat map.
    pub const CAT_KEY: u8 = 5;
    /// Code of the recovered key of Chebyshev maps.
    pub const CHEBYSHEV_KEY: u8 = 6;

    /// The methods by their code.
    pub const METHODS: [&'static str; 7] = [
        "kalman",
        "particles",
        "similar_stretch",
        "similar_goal",
        "similar_goal_per_axis",
        "cat_key",
        "chebyshev_key",
    ];

    /// The name of a method; `unknown` for an unknown code.
    pub fn method_name(method: u8) -> &'static str {
        Self::METHODS
            .get(usize::from(method))
            .copied()
            .unwrap_or("unknown")
    }
}
