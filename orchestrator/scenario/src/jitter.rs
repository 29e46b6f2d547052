//! Seeded displacement of the robots' starts.

use core::f64::consts::TAU;

use geometry::math;
use geometry::pose::Pose2;
use nalgebra::Point2;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::spec::{Distribution, StartJitter};

/// Maximum number of draws for one robot until its start is free.
pub const MAX_DRAWS: usize = 200;

/// Domain of the start jitter, which separates it from other uses of the run's seed.
const DOMAIN: u64 = 0x7374_6172_745f_6a69;

/// A robot to be placed.
#[derive(Debug, Clone, Copy)]
pub struct Placement {
    /// Nominal pose.
    pub start: Pose2,
    /// Radius of the body (m).
    pub radius: f64,
    /// Displacement, if any.
    pub jitter: Option<StartJitter>,
}

/// Draws the poses of all robots. Robots without jitter keep their start. The others are displaced in
/// order, and drawn again while they touch a wall (`is_free` returns `false` for centre and radius (m)) or
/// a robot placed before. Each robot has its own random stream, so that an added robot at the end does not
/// move the others.
///
/// # Errors
/// The index of the first robot without a free start in [`MAX_DRAWS`] draws.
pub fn place(
    robots: &[Placement],
    seed: u64,
    is_free: impl Fn(Point2<f64>, f64) -> bool,
) -> Result<Vec<Pose2>, usize> {
    let mut placed: Vec<Option<Pose2>> = robots
        .iter()
        .map(|r| r.jitter.is_none().then_some(r.start))
        .collect();
    for (i, robot) in robots.iter().enumerate() {
        let Some(jitter) = &robot.jitter else {
            continue;
        };
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ DOMAIN);
        rng.set_stream(i as u64);
        let stands_free = |pose: &Pose2| {
            is_free(pose.position(), robot.radius)
                && robots.iter().zip(&placed).all(|(other, at)| {
                    at.is_none_or(|at| {
                        let distance = (at.position() - pose.position()).norm();
                        distance > other.radius + robot.radius
                    })
                })
        };
        let pose = (0..MAX_DRAWS)
            .map(|_| displaced(robot.start, jitter, &mut rng))
            .find(stands_free);
        let Some(pose) = pose else { return Err(i) };
        if let Some(slot) = placed.get_mut(i) {
            *slot = Some(pose);
        }
    }
    Ok(placed
        .into_iter()
        .zip(robots)
        .map(|(at, r)| at.unwrap_or(r.start))
        .collect())
}

fn displaced(start: Pose2, jitter: &StartJitter, rng: &mut ChaCha8Rng) -> Pose2 {
    let mut draw = |size: f64| size * deviate(jitter.distribution, rng);
    let (dx, dy, dtheta) = (draw(jitter.x), draw(jitter.y), draw(jitter.theta));
    Pose2::new(start.x + dx, start.y + dy, start.theta + dtheta)
}

/// Draws a number in [−1, 1], or a standard normal one cut off at ±3.
fn deviate(distribution: Distribution, rng: &mut ChaCha8Rng) -> f64 {
    match distribution {
        Distribution::Uniform => 2.0 * unit(rng) - 1.0,
        Distribution::Normal => {
            // Box–Muller transform; 1 − u lies in (0, 1], so that the logarithm is finite.
            let radius = (-2.0 * math::ln(1.0 - unit(rng))).sqrt();
            let (sin, _) = math::sincos(TAU * unit(rng));
            (radius * sin).clamp(-3.0, 3.0)
        }
    }
}

/// Draws a number in [0, 1) with 53 random bits.
fn unit(rng: &mut ChaCha8Rng) -> f64 {
    (rng.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn robot(x: f64, jitter: f64) -> Placement {
        Placement {
            start: Pose2::new(x, 0.0, 0.0),
            radius: 0.1,
            jitter: (jitter > 0.0).then_some(StartJitter {
                x: jitter,
                y: jitter,
                theta: jitter,
                ..StartJitter::default()
            }),
        }
    }

    #[test]
    fn the_same_seed_draws_the_same_starts_and_another_does_not() {
        let robots = [robot(0.0, 0.05), robot(1.0, 0.05)];
        let draw = |seed| place(&robots, seed, |_, _| true).unwrap();
        assert_eq!(draw(1), draw(1));
        assert_ne!(draw(1), draw(2));
        let longer = [robot(0.0, 0.05), robot(1.0, 0.05), robot(2.0, 0.05)];
        assert_eq!(place(&longer, 1, |_, _| true).unwrap()[..2], draw(1)[..]);
    }

    #[test]
    fn uniform_jitter_stays_in_its_range_and_uses_it() {
        let robots = [robot(0.0, 0.05)];
        let mut widest: f64 = 0.0;
        for seed in 0..300 {
            let pose = place(&robots, seed, |_, _| true).unwrap()[0];
            for v in [pose.x, pose.y, pose.theta] {
                assert!(v.abs() <= 0.05);
                widest = widest.max(v.abs());
            }
        }
        assert!(widest > 0.045, "{widest}");
    }

    #[test]
    fn normal_jitter_has_its_standard_deviation() {
        let jitter = StartJitter {
            x: 0.1,
            distribution: Distribution::Normal,
            ..StartJitter::default()
        };
        let robots = [Placement {
            jitter: Some(jitter),
            ..robot(0.0, 0.0)
        }];
        let xs: Vec<f64> = (0..2000)
            .map(|seed| place(&robots, seed, |_, _| true).unwrap()[0].x)
            .collect();
        let variance = xs.iter().map(|x| x * x).sum::<f64>() / xs.len() as f64;
        assert!((variance.sqrt() - 0.1).abs() < 0.006, "{}", variance.sqrt());
    }

    #[test]
    fn robots_are_drawn_again_until_their_start_is_free() {
        // Two robots at the same place, with room around them; a wall at x < 0.
        let robots = [robot(0.0, 0.4), robot(0.0, 0.4), robot(0.3, 0.0)];
        for seed in 0..50 {
            let at = place(&robots, seed, |p, r| p.x - r >= 0.0).unwrap();
            assert_eq!(at[2], robots[2].start);
            for i in 0..3 {
                assert!(at[i].x >= 0.1 || i == 2);
                for j in 0..i {
                    assert!((at[i].position() - at[j].position()).norm() > 0.2);
                }
            }
        }
    }

    #[test]
    fn a_robot_without_a_free_start_is_reported() {
        let robots = [robot(0.0, 0.0), robot(0.0, 0.01)];
        assert_eq!(place(&robots, 1, |_, _| true), Err(1));
    }
}
