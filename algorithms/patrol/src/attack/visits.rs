//! Visits of places by guards, and the times between them.

/// Number of intervals from which a probability is estimated, at least.
const MIN_INTERVALS: usize = 5;

/// Visits of one place.
#[derive(Debug, Clone, Default)]
struct Place {
    is_guarded: bool,
    /// End of the last visit (s); the first observation for a place without one.
    left_s: f64,
    is_visited: bool,
    /// Ascending times between two visits (s).
    intervals_s: Vec<f64>,
}

impl Place {
    /// Share of the intervals longer than `age_s` that last for `duration_s` more; 0 if there are too few of them.
    fn chance(&self, age_s: f64, duration_s: f64) -> f64 {
        let longer = |limit: f64| {
            let shorter = self
                .intervals_s
                .partition_point(|&interval| interval <= limit);
            self.intervals_s.len() - shorter
        };
        match longer(age_s) {
            few if few < MIN_INTERVALS => 0.0,
            all => longer(age_s + duration_s) as f64 / all as f64,
        }
    }

    /// The mean interval less the standard deviation (s); `None` for fewer than two intervals.
    fn reliable_s(&self) -> Option<f64> {
        let count = self.intervals_s.len() as f64;
        if count < 2.0 {
            return None;
        }
        let mean = self.intervals_s.iter().sum::<f64>() / count;
        let squares: f64 = self
            .intervals_s
            .iter()
            .map(|i| (i - mean) * (i - mean))
            .sum();
        Some(mean - (squares / (count - 1.0)).sqrt())
    }
}

/// Visits of all places so far, as an adversary that sees the guards knows them.
#[derive(Debug, Clone)]
pub struct Visits {
    places: Vec<Place>,
    now_s: f64,
    is_begun: bool,
}

impl Visits {
    /// No visits of this many places.
    pub fn new(places: usize) -> Self {
        Self {
            places: vec![Place::default(); places],
            now_s: 0.0,
            is_begun: false,
        }
    }

    /// Number of places.
    pub fn places(&self) -> usize {
        self.places.len()
    }

    /// Takes note of the places that are guarded at a time (s), later than the last one.
    pub fn observe(&mut self, time_s: f64, guarded: &[bool]) {
        let is_begun = core::mem::replace(&mut self.is_begun, true);
        self.now_s = time_s;
        for (place, &is_guarded) in self.places.iter_mut().zip(guarded) {
            let was_guarded = core::mem::replace(&mut place.is_guarded, is_guarded);
            if !is_begun || was_guarded && !is_guarded {
                place.left_s = time_s;
            }
            if is_guarded && !was_guarded && place.is_visited {
                let interval = time_s - place.left_s;
                let at = place
                    .intervals_s
                    .partition_point(|&other| other <= interval);
                place.intervals_s.insert(at, interval);
            }
            place.is_visited |= is_guarded;
        }
    }

    /// Returns `true` if this place is guarded.
    pub fn is_guarded(&self, place: usize) -> bool {
        self.places.get(place).is_some_and(|place| place.is_guarded)
    }

    /// Returns `true` if a guard has left this place since the last observation but one.
    pub fn is_left_now(&self, place: usize) -> bool {
        let place = self.places.get(place);
        place.is_some_and(|p| !p.is_guarded && p.is_visited && p.left_s >= self.now_s)
    }

    /// The place with the longest intervals, as their mean less their standard deviation; `None` before a place has two.
    pub fn longest(&self) -> Option<usize> {
        let known = self.places.iter().enumerate();
        let known = known.filter_map(|(at, place)| Some((at, place.reliable_s()?)));
        known.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(at, _)| at)
    }

    /// The place that is most probably without a visit for `duration_s` from now on, and the probability; of equals the one
    /// that has been without the longest. `None` without places.
    pub fn most_open(&self, duration_s: f64) -> Option<(usize, f64)> {
        let now = |place: &Place| {
            if place.is_guarded {
                return (0.0, -1.0);
            }
            let age_s = self.now_s - place.left_s;
            (place.chance(age_s, duration_s), age_s)
        };
        let all = self.places.iter().map(now).enumerate();
        let best = all.max_by(|(_, a), (_, b)| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        best.map(|(at, (chance, _))| (at, chance))
    }

    /// The highest such probability of any place at any time since its last visit.
    pub fn best_chance(&self, duration_s: f64) -> f64 {
        let chances = self.places.iter().flat_map(|place| {
            let ages = core::iter::once(&0.0).chain(&place.intervals_s);
            ages.map(|&age_s| place.chance(age_s, duration_s))
        });
        chances.fold(0.0, f64::max)
    }
}
