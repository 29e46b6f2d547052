//! Check that a route is still safe.

use nalgebra::Point2;

use crate::cost::Pursuer;
use crate::motion::segment_distance;

/// Distance between two places at which threats are searched (m).
const STEP: f64 = 0.1;

/// Time ahead in which threats are searched (s).
const HORIZON_S: f64 = 3.0;

/// Returns `true` if a pursuer can be within `distance` (m) of a place on the path ahead when the
/// evader gets there, within the next `HORIZON_S` seconds. `at` returns the path ahead by the
/// distance along it (m), up to its end.
pub fn is_threatened(
    at: impl Fn(f64) -> Option<Point2<f64>>,
    own_speed: f64,
    pursuers: &[Pursuer],
    distance: f64,
) -> bool {
    if distance <= 0.0 || own_speed <= 0.0 {
        return false;
    }
    let steps = (HORIZON_S * own_speed / STEP).clamp(0.0, 1e4) as u32;
    (0..=steps).any(|step| {
        let along = f64::from(step) * STEP;
        let seconds = along / own_speed;
        at(along).is_some_and(|p| {
            pursuers
                .iter()
                .any(|q| (q.at - p).norm() - q.v_max * seconds < distance)
        })
    })
}

/// Returns the chasing-game paper's measure of the safety of the rest of a path: the minimum of the
/// pursuers' distances from its segments, each divided by a weight W that is 1 for the first
/// segment and is divided by the square of each segment's length. Infinite without segments or
/// pursuers.
pub fn papers_safety(points: &[Point2<f64>], pursuers: &[Pursuer]) -> f64 {
    let mut weight = 1.0;
    let mut least = f64::INFINITY;
    for pair in points.windows(2) {
        let &[from, to] = pair else { continue };
        for pursuer in pursuers {
            let safety = segment_distance(from, to, pursuer.at) / weight;
            least = least.min(safety);
        }
        weight /= (to - from).norm_squared();
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pursuer(x: f64, y: f64) -> Pursuer {
        Pursuer {
            at: Point2::new(x, y),
            v_max: 0.3,
        }
    }

    #[test]
    fn a_pursuer_threatens_where_it_can_be_in_time() {
        let ahead = |along: f64| (along <= 5.0).then(|| Point2::new(along, 0.0));
        let threatened = |q: Pursuer| is_threatened(ahead, 0.6, &[q], 0.3);
        // At 1.8 m after 3 s, when the pursuer can have gone 0.9 m.
        assert!(threatened(pursuer(1.8, 1.1)));
        assert!(!threatened(pursuer(1.8, 1.4)));
        assert!(!threatened(pursuer(4.5, 0.0)));
        assert!(!is_threatened(ahead, 0.6, &[pursuer(0.0, 0.0)], 0.0));
    }

    #[test]
    fn the_papers_measure_weighs_later_segments_by_the_lengths_before_them() {
        let path = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0)].map(|(x, y)| Point2::new(x, y));
        // 3 m from the second segment, which follows one of 2 m: 3 / (1 / 4).
        assert_eq!(
            papers_safety(&path, &[pursuer(5.0, 0.5)]),
            (9.25_f64).sqrt()
        );
        assert_eq!(papers_safety(&path[1..], &[pursuer(5.0, 0.5)]), 3.0);
        assert_eq!(papers_safety(&path, &[pursuer(2.0, 9.0)]), 9.0);
        assert_eq!(
            papers_safety(&path[..1], &[pursuer(2.0, 9.0)]),
            f64::INFINITY
        );
    }
}
