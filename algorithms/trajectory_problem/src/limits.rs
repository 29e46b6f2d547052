//! Limits of a robot, as plans keep them.

use robot::spec::RobotModel;

/// Limit of the wheel speeds: |V| + |ω| b / 2 ≤ `speed`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wheels {
    /// Maximum speed of a wheel over the ground (m/s), > 0.
    pub speed: f64,
    /// Distance b between the wheels (m), > 0.
    pub separation: f64,
}

/// Limits of the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobotLimits {
    /// Maximum forward speed V (m/s), > 0.
    pub v_max: f64,
    /// Minimum forward speed (m/s), from −`v_max` to 0: the negative of the maximum speed
    /// backwards; 0 for plans that only drive forwards.
    pub v_min: f64,
    /// Maximum turning rate ω (rad/s), > 0.
    pub omega_max: f64,
    /// Coupling of both by the wheels; `None`: independent, as in the paper.
    pub wheels: Option<Wheels>,
    /// Maximum rate of change of V (m/s²), > 0; `None`: V may step, as in the paper.
    pub acceleration: Option<f64>,
    /// Maximum rate of change of ω (rad/s²), > 0; `None`: ω may step.
    pub angular_acceleration: Option<f64>,
}

impl RobotLimits {
    /// Speed (m/s) and turning rate (rad/s) limited independently: |V| ≤ `v_max` and |ω| ≤
    /// `omega_max`.
    pub fn simple(v_max: f64, omega_max: f64) -> Self {
        Self {
            v_max,
            v_min: -v_max,
            omega_max,
            wheels: None,
            acceleration: None,
            angular_acceleration: None,
        }
    }

    /// All limits of a robot; backwards up to its `v_reverse_max`.
    pub fn of_model(model: &RobotModel) -> Self {
        Self {
            v_max: model.v_max,
            v_min: 0.0 - model.v_reverse_max,
            omega_max: model.omega_max,
            wheels: model.wheel_speed_max.map(|speed| Wheels {
                speed,
                separation: model.wheel_separation,
            }),
            acceleration: model.acceleration,
            angular_acceleration: model.angular_acceleration,
        }
    }

    /// The same limits in another unit of length, of which the present one has `scale`.
    #[must_use]
    pub fn scaled(&self, scale: f64) -> Self {
        Self {
            v_max: self.v_max * scale,
            v_min: self.v_min * scale,
            wheels: self.wheels.map(|wheels| Wheels {
                speed: wheels.speed * scale,
                separation: wheels.separation * scale,
            }),
            acceleration: self.acceleration.map(|a| a * scale),
            ..*self
        }
    }

    /// The same robot, driven forwards only.
    #[must_use]
    pub fn forwards(&self) -> Self {
        Self {
            v_min: 0.0,
            ..*self
        }
    }

    /// The same robot without limits on its accelerations.
    #[must_use]
    pub fn without_inertia(&self) -> Self {
        Self {
            acceleration: None,
            angular_acceleration: None,
            ..*self
        }
    }

    /// Returns `true` if the robot may drive backwards.
    pub fn may_reverse(&self) -> bool {
        self.v_min < 0.0
    }

    /// Returns `true` if speeds may step.
    pub fn is_without_inertia(&self) -> bool {
        self.acceleration.is_none() && self.angular_acceleration.is_none()
    }

    /// Maximum speed (m/s) on a straight line, forwards or backwards.
    pub fn top_speed(&self) -> f64 {
        let top = self.v_max.max(-self.v_min);
        self.wheels.map_or(top, |w| top.min(w.speed))
    }

    /// Maximum turning rate (rad/s) on the spot.
    pub fn top_turn_rate(&self) -> f64 {
        self.wheels.map_or(self.omega_max, |w| {
            self.omega_max.min(2.0 * w.speed / w.separation)
        })
    }

    /// Maximum speed (m/s) forwards on a path of curvature `kappa` (1/m).
    pub fn speed_at(&self, kappa: f64) -> f64 {
        let kappa = kappa.abs();
        let turning = self.omega_max / kappa.max(1e-300);
        let wheels = self.wheels.map_or(f64::INFINITY, |w| {
            w.speed / (1.0 + 0.5 * kappa * w.separation)
        });
        self.v_max.min(turning).min(wheels)
    }
}
