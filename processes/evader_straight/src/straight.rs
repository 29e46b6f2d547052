//! The command of the evader.

use geometry::pose::Twist2;
use planner_view::limits::Limits;

use crate::StraightParams;

/// Straight ahead at a fraction of the highest speed.
pub fn command(params: &StraightParams, limits: &Limits) -> Twist2 {
    limits.clip(Twist2::new(params.speed_fraction * limits.v_max(), 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_speed_is_the_fraction_of_the_highest() {
        let limits = Limits::new(0.4, 0.1, 1.0).unwrap();
        let half = StraightParams {
            speed_fraction: 0.5,
        };
        assert_eq!(command(&half, &limits), Twist2::new(0.2, 0.0));
    }
}
