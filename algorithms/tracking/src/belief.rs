//! Summary of a belief.

use geometry::math;
use geometry::pose::Pose2;

use crate::fast;

/// One weighted hypothesis, as published.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Particle {
    /// x (m).
    pub x: f32,
    /// y (m).
    pub y: f32,
    /// Heading (rad), in [−π, π].
    pub theta: f32,
    /// Share of the belief; the weights of a belief sum to 1 (within rounding).
    pub weight: f32,
}

/// Summary of a belief.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Belief {
    /// Weighted mean position (m, m) and circular mean of the headings (rad).
    pub mean: Pose2,
    /// Variance of x (m²).
    pub covariance_xx: f64,
    /// Covariance of x and y (m²).
    pub covariance_xy: f64,
    /// Variance of y (m²).
    pub covariance_yy: f64,
    /// 1 − length of the mean heading vector: 0 if all headings agree, 1 if the heading is unknown.
    pub heading_spread: f64,
    /// 1/Σw² of the normalised weights before resampling: 1 to the number of particles.
    pub effective_sample_size: f64,
    /// `true` if an observer saw the opponent at this tick.
    pub seen: bool,
    /// Time since the opponent was last seen (s); infinite if it never was.
    pub unseen_for: f64,
}

impl Belief {
    /// Standard deviation of the position, √(σx² + σy²) (m).
    pub fn position_std(&self) -> f64 {
        (self.covariance_xx + self.covariance_yy).sqrt()
    }
}

/// Weighted moments of positions and headings, summed in a fixed order in f64.
///
/// Returns the mean pose, the covariance (xx, xy, yy) (m²) and the heading spread.
pub(crate) fn moments(
    xs: &[f32],
    ys: &[f32],
    headings: &[f32],
    weights: &[f32],
) -> (Pose2, [f64; 3], f64) {
    // Relative to the first particle, so that squares lose no precision far from the origin.
    let (x0, y0) = (
        xs.first().copied().unwrap_or(0.0),
        ys.first().copied().unwrap_or(0.0),
    );
    let mut sums = [0.0_f64; 8];
    for (((&x, &y), &heading), &w) in xs.iter().zip(ys).zip(headings).zip(weights) {
        let (dx, dy, w) = (f64::from(x - x0), f64::from(y - y0), f64::from(w));
        let (sin, cos) = fast::sincos(heading);
        let terms = [
            1.0,
            dx,
            dy,
            dx * dx,
            dx * dy,
            dy * dy,
            f64::from(cos),
            f64::from(sin),
        ];
        for (sum, term) in sums.iter_mut().zip(terms) {
            *sum += w * term;
        }
    }
    let [total, ..] = sums;
    if total <= 0.0 {
        return (Pose2::default(), [0.0; 3], 1.0);
    }
    let [_, mx, my, xx, xy, yy, cos, sin] = sums.map(|s| s / total);
    let mean = Pose2::new(
        f64::from(x0) + mx,
        f64::from(y0) + my,
        math::atan2(sin, cos),
    );
    let covariance = [
        (xx - mx * mx).max(0.0),
        xy - mx * my,
        (yy - my * my).max(0.0),
    ];
    let spread = (1.0 - (cos * cos + sin * sin).sqrt()).clamp(0.0, 1.0);
    (mean, covariance, spread)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_a_weighted_pair() {
        let (mean, [xx, xy, yy], spread) =
            moments(&[1001.0, 1005.0], &[2.0, 4.0], &[3.1, -3.1], &[3.0, 1.0]);
        assert_eq!((mean.x, mean.y), (1002.0, 2.5));
        assert_eq!((xx, xy, yy), (3.0, 1.5, 0.75));
        // Circular: between 3.1 and −3.1 across π, nearer to 3.1.
        assert!(mean.theta.abs() > 3.1, "{}", mean.theta);
        assert!(spread > 0.0 && spread < 0.002);
    }

    #[test]
    fn opposite_headings_are_unknown_and_no_weight_is_no_mean() {
        let (_, _, spread) = moments(
            &[0.0, 0.0],
            &[0.0, 0.0],
            &[0.0, core::f32::consts::PI],
            &[1.0, 1.0],
        );
        assert!(spread > 0.999_999);
        assert_eq!(moments(&[], &[], &[], &[]).0, Pose2::default());
    }
}
