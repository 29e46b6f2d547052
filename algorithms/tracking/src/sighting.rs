//! Simulated measurement of one opponent at one tick.

use geometry::math;
use geometry::pose::Pose2;
use nalgebra::Point2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::params::{HeadingModel, SensorParams};
use crate::space::Space;
use crate::watch::Watch;

/// A noisy measurement of an opponent's position, and of its heading if the sensor measures that.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement {
    /// Measured position (m).
    pub position: Point2<f64>,
    /// Standard deviation of x and of y, independent of each other (m); 0 if exact.
    pub sigma: f64,
    /// Measured heading (rad) and its standard deviation (rad) (0 if exact); `None` if the sensor
    /// does not measure headings.
    pub heading: Option<(f64, f64)>,
}

/// Sighting of an opponent at one tick, seen or unseen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sighting {
    /// Largest line-of-sight visibility over the observers, 0…1.
    pub visibility: f64,
    /// Index of the observer with the best view; `None` if the opponent is unseen.
    pub observer: Option<usize>,
    /// The measurement; `None` if the opponent is unseen.
    pub measurement: Option<Measurement>,
}

impl Sighting {
    /// Returns `true` if there is a measurement.
    pub fn is_seen(&self) -> bool {
        self.measurement.is_some()
    }

    /// Standard deviation of the measured coordinates (m); infinite if unseen.
    pub fn sigma(&self) -> f64 {
        self.measurement.map_or(f64::INFINITY, |m| m.sigma)
    }
}

/// Simulates the sensor (chasing-game paper, section III.C): V is the best visibility over all
/// observers. The opponent is unseen for V below a threshold and measured exactly above another. In
/// between, x and y have Gaussian noise of standard deviation g·(1/V − 1).
///
/// The result contains only the measured quantities of the true pose. Noise is drawn by the
/// Box–Muller transform.
pub fn sense(
    sensor: &SensorParams,
    space: &Space,
    watch: &Watch,
    truth: Pose2,
    rng: &mut ChaCha8Rng,
) -> Sighting {
    let Some((visibility, observer)) = watch.best(space.field(), truth.position()) else {
        return Sighting::default();
    };
    if visibility < sensor.unseen_below {
        return Sighting {
            visibility,
            ..Sighting::default()
        };
    }
    let sigma = if visibility > sensor.exact_above {
        0.0
    } else {
        sensor.sigma_gain * (1.0 / visibility - 1.0)
    };
    let (nx, ny) = gaussian_pair(rng);
    let position = Point2::new(truth.x + sigma * nx, truth.y + sigma * ny);
    let heading = match sensor.heading {
        HeadingModel::None => None,
        HeadingModel::Exact => Some((truth.theta, 0.0)),
        HeadingModel::Noisy { sigma } => Some((
            math::wrap_angle(truth.theta + sigma * gaussian_pair(rng).0),
            sigma,
        )),
    };
    let measurement = Some(Measurement {
        position,
        sigma,
        heading,
    });
    Sighting {
        visibility,
        observer: Some(observer),
        measurement,
    }
}

/// Two independent standard normal numbers (Box–Muller).
pub fn gaussian_pair(rng: &mut ChaCha8Rng) -> (f64, f64) {
    // 1 − u is in (0, 1]: its logarithm is finite.
    let (u, angle) = (
        1.0 - rng.random::<f64>(),
        core::f64::consts::TAU * rng.random::<f64>(),
    );
    let radius = (-2.0 * math::ln(u)).sqrt();
    let (sin, cos) = math::sincos(angle);
    (radius * cos, radius * sin)
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;
    use crate::space::tests::room;

    fn view(sensor: &SensorParams, observer: Pose2, truth: Pose2, seed: u64) -> Sighting {
        let space = Space::new(&room());
        let mut watch = Watch::new(sensor);
        watch.set(space.field(), &[observer]);
        sense(
            sensor,
            &space,
            &watch,
            truth,
            &mut ChaCha8Rng::seed_from_u64(seed),
        )
    }

    #[test]
    fn close_by_in_the_open_is_exact_and_behind_the_block_is_unseen() {
        let sensor = SensorParams::default();
        let observer = Pose2::new(2.4, 0.0, 0.0);
        let close = view(&sensor, observer, Pose2::new(2.41, 0.0, 1.0), 1);
        let m = close.measurement.unwrap();
        assert!(close.visibility > 0.999);
        assert_eq!((m.position, m.sigma), (Point2::new(2.41, 0.0), 0.0));
        let hidden = view(&sensor, observer, Pose2::new(-2.0, 0.0, 1.0), 1);
        assert_eq!(hidden, Sighting::default());
        assert_eq!(hidden.sigma(), f64::INFINITY);
        let far = Pose2::new(-3.7, 2.75, 1.0);
        let dim = view(&sensor, Pose2::new(2.4, 2.75, 0.0), far, 1);
        assert!(dim.sigma() > 0.05, "{dim:?}");
    }

    #[test]
    fn the_noise_has_the_stated_spread_and_no_bias() {
        let sensor = SensorParams::default();
        let space = Space::new(&room());
        let mut watch = Watch::new(&sensor);
        watch.set(space.field(), &[Pose2::new(2.4, 2.7, 0.0)]);
        let truth = Pose2::new(-3.0, 2.7, 0.3);
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let n = 20_000;
        let (mut sum, mut squares, mut product) = ([0.0; 2], [0.0; 2], 0.0);
        let mut sigma = 0.0;
        for _ in 0..n {
            let m = sense(&sensor, &space, &watch, truth, &mut rng)
                .measurement
                .unwrap();
            sigma = m.sigma;
            let e = [m.position.x - truth.x, m.position.y - truth.y];
            product += e[0] * e[1];
            for i in 0..2 {
                sum[i] += e[i];
                squares[i] += e[i] * e[i];
            }
        }
        let n = f64::from(n);
        assert!(sigma > 0.02, "{sigma}");
        for i in 0..2 {
            assert!((sum[i] / n).abs() < 4.0 * sigma / n.sqrt());
            assert!(((squares[i] / n).sqrt() / sigma - 1.0).abs() < 0.02);
        }
        assert!((product / n).abs() < 4.0 * sigma * sigma / n.sqrt());
    }

    #[test]
    fn the_heading_is_not_leaked_unless_the_sensor_measures_it() {
        let observer = Pose2::new(2.4, 0.5, 0.0);
        let sighting = |heading, theta| {
            let sensor = SensorParams {
                heading,
                ..SensorParams::default()
            };
            view(&sensor, observer, Pose2::new(2.0, 0.0, theta), 4)
        };
        assert_eq!(
            sighting(HeadingModel::None, 1.0),
            sighting(HeadingModel::None, -2.0)
        );
        let exact = sighting(HeadingModel::Exact, 1.0).measurement.unwrap();
        assert_eq!(exact.heading, Some((1.0, 0.0)));
        let noisy = sighting(HeadingModel::Noisy { sigma: 0.1 }, 3.1)
            .measurement
            .unwrap();
        let (theta, sigma) = noisy.heading.unwrap();
        assert_eq!(sigma, 0.1);
        assert!(
            theta != 3.1 && math::angle_difference(theta, 3.1).abs() < 0.5,
            "{theta}"
        );
    }
}
