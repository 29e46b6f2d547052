//! Parameters of the fictive obstacles.

use chaotic_maps::Key;
use parameters::{Parameters, ParamsError, above, between, each, require};

parameters::table! {
    /// Parameters of [`Fto`](super::Fto). The defaults are the paper's where it gives values.
    pub struct FtoParams {
        /// Key of a generator; the paper's logistic map if absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub key: Option<Key>,
        /// Minimum and maximum duration of an obstacle.
        pub active_s: [f64; 2] [each(above(0).unit("s"))] = [0.3, 2.5],
        /// Radius of an obstacle.
        pub radius: f64 [above(0).unit("m")] = 0.15,
        /// Minimum distance at which an obstacle appears, as a share of the distance from the robot's
        /// edge to the end of its sensor's range.
        pub nearest: f64 [between(0, 1)] = 0.5,
    }
}

impl Parameters for FtoParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        if let Some(key) = &self.key {
            key.validate()?;
        }
        let [low, high] = self.active_s;
        require(
            low <= high,
            "active_s",
            &format!("[{low}, {high}]"),
            "two finite numbers above 0, the greater one last (s)",
        )
    }
}
