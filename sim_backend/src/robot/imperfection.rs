//! Imperfections of a drive.

use geometry::pose::Twist2;
use robot::drive::limit;
use robot::spec::{ActuatorSpec, RobotModel};

use crate::random::Stream;

/// Number of standard deviations at which noise is cut off.
const MAX_SIGMAS: f64 = 3.0;

/// The twist of an imperfect drive; within the robot's limits.
pub(crate) fn perturb(
    model: &RobotModel,
    actuator: &ActuatorSpec,
    twist: Twist2,
    noise: &mut Stream,
) -> Twist2 {
    let mut normal = || noise.normal().clamp(-MAX_SIGMAS, MAX_SIGMAS);
    let (n_v, n_omega, n_veer) = (normal(), normal(), normal());
    let v = twist.v * (1.0 - actuator.slip) * (1.0 + actuator.noise * n_v);
    let omega =
        twist.omega * (1.0 - actuator.angular_slip) * (1.0 + actuator.angular_noise * n_omega)
            + v * actuator.veer * n_veer;
    limit(&model.without_inertia(), twist, Twist2::new(v, omega), 0.0)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn noise_keeps_the_limits(
            v in -0.5..1.0f64, omega in -4.0..4.0f64, seed in any::<u64>(),
        ) {
            let model = RobotModel {
                radius: 0.1, wheel_separation: 0.2, v_max: 1.0, v_reverse_max: 0.5, omega_max: 4.0,
                acceleration: Some(2.0), angular_acceleration: Some(3.0),
                wheel_speed_max: Some(1.2),
            };
            let current = limit(&model.without_inertia(), Twist2::STOP, Twist2::new(v, omega), 0.0);
            let actuator = ActuatorSpec { noise: 0.5, angular_noise: 0.5, veer: 1.0, ..Default::default() };
            let twist = perturb(&model, &actuator, current, &mut Stream::new(seed, 0, 0));
            prop_assert!((-0.5..=1.0).contains(&twist.v) && twist.omega.abs() <= 4.0);
            prop_assert!(twist.v.abs() + twist.omega.abs() * 0.1 <= 1.2 + 1e-12);
        }
    }
}
