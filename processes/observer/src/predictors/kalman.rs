//! Constant velocity with white-noise acceleration: a Kalman filter whose only model is inertia.

use nalgebra::{Matrix2, Point2, Vector2};

use super::Predictor;
use crate::moment::Moment;

/// Lower bound of the measurement noise (m): it keeps the covariance regular.
const MIN_SIGMA: f64 = 1e-6;

/// Kalman filter of position and velocity. Both axes have the same noise, hence one covariance.
#[derive(Debug, Clone)]
pub struct Kalman {
    /// Spectral density of the acceleration (m²/s³).
    density: f64,
    /// Initial standard deviation of the speed of a robot that has just been seen (m/s).
    speed_sigma: f64,
    /// Position and velocity along x and along y; `None` before the first measurement.
    state: Option<[Vector2<f64>; 2]>,
    covariance: Matrix2<f64>,
}

impl Kalman {
    /// Returns a filter for accelerations of this spectral density (m²/s³), ≥ 0, and speeds up to
    /// about `v_max` (m/s), ≥ 0.
    pub fn new(density: f64, v_max: f64) -> Self {
        Self {
            density,
            speed_sigma: v_max.max(MIN_SIGMA),
            state: None,
            covariance: Matrix2::zeros(),
        }
    }

    /// Returns the current position (m) and velocity (m/s); `None` before the first measurement.
    pub fn state(&self) -> Option<(Point2<f64>, Vector2<f64>)> {
        let [x, y] = self.state?;
        Some((Point2::new(x[0], y[0]), Vector2::new(x[1], y[1])))
    }

    fn advance(&mut self, dt: f64) {
        let Some(state) = &mut self.state else { return };
        let f = Matrix2::new(1.0, dt, 0.0, 1.0);
        for axis in state {
            *axis = f * *axis;
        }
        let (d2, d3) = (dt * dt / 2.0, dt * dt * dt / 3.0);
        let noise = self.density * Matrix2::new(d3, d2, d2, dt);
        self.covariance = f * self.covariance * f.transpose() + noise;
    }
}

impl Predictor for Kalman {
    fn observe(&mut self, moment: &Moment<'_>) {
        self.advance(moment.look.dt);
        let Some(seen) = moment.look.seen else { return };
        let variance = seen.sigma.max(MIN_SIGMA) * seen.sigma.max(MIN_SIGMA);
        let Some(state) = &mut self.state else {
            self.state = Some([
                Vector2::new(seen.position.x, 0.0),
                Vector2::new(seen.position.y, 0.0),
            ]);
            self.covariance = Matrix2::new(variance, 0.0, 0.0, self.speed_sigma * self.speed_sigma);
            return;
        };
        let p = self.covariance;
        let gain = Vector2::new(p[(0, 0)], p[(1, 0)]) / (p[(0, 0)] + variance);
        for (axis, measured) in state.iter_mut().zip([seen.position.x, seen.position.y]) {
            *axis += gain * (measured - axis[0]);
        }
        // Joseph's form stays symmetric and positive in finite precision.
        let keep = Matrix2::new(1.0 - gain[0], 0.0, -gain[1], 1.0);
        self.covariance = keep * p * keep.transpose() + gain * gain.transpose() * variance;
    }

    fn predict(&self, horizon: f64, _: &Moment<'_>) -> Option<Point2<f64>> {
        let (position, velocity) = self.state()?;
        Some(position + velocity * horizon)
    }
}
