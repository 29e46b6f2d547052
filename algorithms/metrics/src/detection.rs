//! Detection of attacks on places by the robots that guard them.
//!
//! An attack at a place is *detected* if a guard comes within a distance of the place, or sees it, while the attack
//! lasts. The share of the start times at which an attack would be detected is an integral over a whole patrol, without
//! an adversary; its minimum over the places is what an adversary that knows these shares leaves to the guards.

use nalgebra::Point2;

/// Number of consecutive blocks of start times from which an interval is computed.
pub const BLOCKS: usize = 10;

/// Quantile 0.975 of Student's t distribution with [`BLOCKS`] − 1 degrees of freedom.
const STUDENT: f64 = 2.262_157_162_740_992;

/// Way in which guards detect an attack.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DetectionRule {
    /// Distance from the place at which a guard detects it (m), ≥ 0.
    pub distance: f64,
    /// Range at which a guard with a free line of sight detects it (m); 0 for guards that do not see.
    pub sight: f64,
}

impl DetectionRule {
    /// Returns `true` if a guard at a point detects an attack at a place (m); the line of sight is computed only within
    /// its range.
    pub fn detects(
        &self,
        place: Point2<f64>,
        guard: Point2<f64>,
        is_visible: impl FnOnce(Point2<f64>, Point2<f64>) -> bool,
    ) -> bool {
        let distance = (guard - place).norm();
        distance <= self.distance || distance <= self.sight && is_visible(guard, place)
    }
}

/// Share of start times at which an attack is detected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DetectionShare {
    /// The share, 0 to 1.
    pub share: f64,
    /// Its 95 % interval by batch means: of the shares of [`BLOCKS`] equal blocks of consecutive start times, with
    /// Student's t. Blocks count as independent, so that the interval is too narrow for blocks not longer than a lap.
    pub interval: [f64; 2],
}

impl DetectionShare {
    /// Computes it for one place: `guarded` tells for each of the ascending times (s) whether a guard detects an attack
    /// there. Every time is a start, if the attack of this duration (s) ends by the last time. `None` for fewer starts than
    /// [`BLOCKS`].
    pub fn from_samples(times_s: &[f64], guarded: &[bool], duration_s: f64) -> Option<Self> {
        let last_s = *times_s.last()?;
        let mut next_s = f64::INFINITY;
        let mut detected = Vec::with_capacity(times_s.len());
        for (&time_s, &is_guarded) in times_s.iter().zip(guarded).rev() {
            if is_guarded {
                next_s = time_s;
            }
            let end_s = time_s + duration_s;
            if end_s <= last_s {
                detected.push(f64::from(u8::from(next_s <= end_s)));
            }
        }
        detected.reverse();
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let count = detected.len();
        if count < BLOCKS {
            return None;
        }
        let block = |number| &detected[number * count / BLOCKS..(number + 1) * count / BLOCKS];
        let blocks: Vec<f64> = (0..BLOCKS).map(|number| mean(block(number))).collect();
        let (share, middle) = (mean(&detected), mean(&blocks));
        let squares: f64 = blocks.iter().map(|b| (b - middle) * (b - middle)).sum();
        let error = libm::sqrt(squares / ((BLOCKS - 1) * BLOCKS) as f64);
        Some(Self {
            share,
            interval: [-1.0, 1.0].map(|side| (share + side * STUDENT * error).clamp(0.0, 1.0)),
        })
    }
}

/// Computes the share of each place for attacks that guards within a distance (m) detect. `robots` has the positions of
/// all guards at the first time, then at the second one, and so on; a position that is not finite is that of a robot out of
/// play. `None` for fewer start times than [`BLOCKS`].
pub fn detection_by_place(
    times_s: &[f64],
    robots: &[Point2<f64>],
    places: &[Point2<f64>],
    distance: f64,
    duration_s: f64,
) -> Option<Vec<DetectionShare>> {
    let rule = DetectionRule {
        distance,
        sight: 0.0,
    };
    let per_time = robots.len().checked_div(times_s.len())?.max(1);
    let share = |&place: &Point2<f64>| {
        let detects = |&robot: &Point2<f64>| rule.detects(place, robot, |_, _| false);
        let guarded: Vec<bool> = robots
            .chunks(per_time)
            .map(|all| all.iter().any(detects))
            .collect();
        DetectionShare::from_samples(times_s, &guarded, duration_s)
    };
    places.iter().map(share).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK_S: f64 = 0.25;

    /// Times and positions of two robots that drive around a circle of 40 m at 1 m/s, the second one half a lap behind
    /// with a gap that changes.
    fn drive() -> (Vec<f64>, Vec<Point2<f64>>) {
        let times_s: Vec<f64> = (0..4000).map(|tick| f64::from(tick) * TICK_S).collect();
        let at = |length: f64| {
            let (sin, cos) = libm::sincos(length / 40.0 * core::f64::consts::TAU);
            Point2::new(sin, cos) * (20.0 / core::f64::consts::PI)
        };
        let robots = times_s
            .iter()
            .flat_map(|&t| [at(t), at(t + 20.0 + 5.0 * libm::sin(t / 90.0))]);
        let robots = robots.collect();
        (times_s, robots)
    }

    #[test]
    fn shares_are_those_of_every_attack_tried() {
        let (times_s, robots) = drive();
        let radius = 20.0 / core::f64::consts::PI;
        let places = [
            Point2::new(0.0, radius),
            Point2::new(0.0, -radius),
            Point2::origin(),
        ];
        let (distance, duration_s) = (1.0, 15.0);
        let shares = detection_by_place(&times_s, &robots, &places, distance, duration_s).unwrap();
        for (place, share) in places.iter().zip(&shares) {
            let starts: Vec<f64> = times_s
                .iter()
                .copied()
                .filter(|t| t + duration_s <= times_s[times_s.len() - 1])
                .collect();
            let is_detected = |&&start: &&f64| {
                times_s.iter().enumerate().any(|(i, &t)| {
                    let near = |robot: &Point2<f64>| (robot - place).norm() <= distance;
                    (start..=start + duration_s).contains(&t)
                        && robots[2 * i..2 * i + 2].iter().any(near)
                })
            };
            let detected = starts.iter().filter(is_detected).count();
            let expected = detected as f64 / starts.len() as f64;
            assert!((share.share - expected).abs() < 1e-12, "{share:?}");
            let [low, high] = share.interval;
            assert!(low <= share.share && share.share <= high, "{share:?}");
        }
        // An attack of 15 s ends between two visits that are about 20 s apart, and no robot comes to the centre.
        assert!(shares[0].share > 0.6 && shares[0].share < 1.0, "{shares:?}");
        assert_eq!((shares[2].share, shares[2].interval), (0.0, [0.0, 0.0]));
    }

    #[test]
    fn an_attack_must_end_before_the_last_time() {
        let times_s: Vec<f64> = (0..30).map(f64::from).collect();
        let mut guarded = [false; 30];
        guarded[29] = true;
        let share = DetectionShare::from_samples(&times_s, &guarded, 9.0).unwrap();
        // Of the starts 0 to 20 the last one only.
        assert!((share.share - 1.0 / 21.0).abs() < 1e-12);
        assert_eq!(DetectionShare::from_samples(&times_s, &guarded, 20.5), None);
        assert_eq!(DetectionShare::from_samples(&[], &[], 1.0), None);
    }

    #[test]
    fn guards_detect_within_a_distance_or_in_sight() {
        let rule = DetectionRule {
            distance: 1.0,
            sight: 5.0,
        };
        let place = Point2::origin();
        let guard = |x| Point2::new(x, 0.0);
        assert!(rule.detects(place, guard(1.0), |_, _| false));
        assert!(!rule.detects(place, guard(4.0), |_, _| false));
        assert!(rule.detects(place, guard(4.0), |_, _| true));
        assert!(!rule.detects(place, guard(5.1), |_, _| true));
        assert!(!rule.detects(place, guard(f64::NAN), |_, _| true));
    }
}
