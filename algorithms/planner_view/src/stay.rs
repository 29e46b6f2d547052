//! Robots that do not get on.

use nalgebra::Point2;

/// Time without motion after which a robot that is not where it should be counts as lost (s).
pub const STOOD_S: f64 = 10.0;

/// Time after which such a robot counts as lost if it has only driven around on one spot (s).
pub const LINGERED_S: f64 = 20.0;

/// Stay of a robot of a team at a place: its team does without it while it is lost.
#[derive(Debug, Clone, Copy, Default)]
pub struct Stay {
    /// Last positions away from which it has not moved by its radius, and by the radius of a spot (m), and the times of
    /// them (s).
    since: Option<[(Point2<f64>, f64); 2]>,
    is_lost: bool,
}

impl Stay {
    /// Follows the robot at a time (s): is it lost? `reach` is its radius and that of a spot (m), `is_due` whether it is where
    /// it should be. A lost robot counts again when it has left its spot.
    pub fn is_lost(
        &mut self,
        here: Point2<f64>,
        time_s: f64,
        reach: [f64; 2],
        is_due: bool,
    ) -> bool {
        let since = self.since.get_or_insert([(here, time_s); 2]);
        let moved = (here - since[0].0).norm();
        if self.is_lost && moved > reach[1] {
            *self = Self::default();
            return self.is_lost(here, time_s, reach, is_due);
        }
        if self.is_lost {
            return true;
        }
        for (place, reach) in since.iter_mut().zip(reach) {
            if is_due || (here - place.0).norm() > reach {
                *place = (here, time_s);
            }
        }
        let [rested_s, stayed_s] = since.map(|(_, since_s)| time_s - since_s);
        self.is_lost = rested_s >= STOOD_S || stayed_s >= LINGERED_S;
        self.is_lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The times at which a robot of radius 0.2 m becomes lost and counts again, for positions along x (m) by time (s).
    fn changes(x: impl Fn(f64) -> f64, is_due: bool) -> Vec<f64> {
        let (mut stay, mut was_lost) = (Stay::default(), false);
        let times = (0..1000).map(|tick| 0.1 * f64::from(tick));
        let changes = times.filter(|&time_s| {
            let is_lost = stay.is_lost(Point2::new(x(time_s), 0.0), time_s, [0.2, 2.0], is_due);
            core::mem::replace(&mut was_lost, is_lost) != is_lost
        });
        changes
            .map(|time_s| (time_s * 10.0).round() / 10.0)
            .collect()
    }

    #[test]
    fn one_that_stands_or_lingers_is_lost_until_it_leaves_its_spot() {
        assert_eq!(changes(|_| 1.0, false), [10.0]);
        assert_eq!(changes(|time_s| time_s % 2.0, false), [20.0]);
        // It stands for a minute, then drives on.
        let drives = |time_s: f64| (time_s - 60.0).max(0.0);
        assert_eq!(changes(drives, false), [10.0, 62.1]);
    }

    #[test]
    fn one_that_drives_slowly_or_is_where_it_should_be_is_not_lost() {
        assert_eq!(changes(|time_s| 0.11 * time_s, false), [0.0; 0]);
        assert_eq!(changes(|_| 1.0, true), [0.0; 0]);
    }
}
