//! Visits of places, and what follows from their times.

use super::IdlenessFigures;

/// Integrals of the idleness over time, of all places.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    worst_s: f64,
    first: f64,
    second: f64,
}

impl Sums {
    /// Adds a time without visits, of which `began_s` has passed before it counts (s).
    fn add(&mut self, began_s: f64, idle_s: f64) {
        let (from, to) = (began_s * began_s, idle_s * idle_s);
        self.worst_s = self.worst_s.max(idle_s);
        self.first += (to - from) / 2.0;
        self.second += (to * idle_s - from * began_s) / 3.0;
    }
}

/// Figures of one place.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PlaceFigures {
    /// Number of arrivals of robots since the start.
    pub visits: u32,
    /// Mean time from one arrival to the next, since every place has been visited twice (s); `None` without two.
    pub interval_s: Option<f64>,
    /// Longest time without a robot in that time (s).
    pub worst_s: f64,
    /// Time since the last visit, or since time 0 without one (s).
    pub idle_s: f64,
}

/// Idleness of all places at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IdlenessNow {
    /// Mean of the times since the last visit of each place, or since time 0 without one (s).
    pub mean_s: f64,
    /// Longest of these times (s).
    pub worst_s: f64,
    /// Index of the first place with this time.
    pub worst_place: usize,
    /// Share of the places that have been visited, 0 to 1.
    pub visited: f64,
}

/// One place.
#[derive(Debug, Clone, Copy, Default)]
struct Place {
    visited_s: f64,
    arrived_s: f64,
    visits: u32,
    /// Intervals that count, and their sum (s).
    intervals: u32,
    sum_s: f64,
    worst_s: f64,
    /// `true` if it has been visited in this round over all places.
    is_visited: bool,
}

/// Places that robots visit.
#[derive(Debug, Clone)]
pub struct Places {
    all: Vec<Place>,
    /// Number of places that have not been visited in this round, and number of rounds.
    unvisited: usize,
    rounds: u32,
    now_s: f64,
    before_s: f64,
    /// Time at which every place had been visited twice (s).
    began_s: Option<f64>,
    sums: Sums,
}

impl Places {
    /// This many places, none of which has been visited.
    pub(super) fn new(count: usize) -> Self {
        Self {
            all: vec![Place::default(); count],
            unvisited: count,
            rounds: 0,
            now_s: 0.0,
            before_s: 0.0,
            began_s: None,
            sums: Sums::default(),
        }
    }

    /// Begins the visits of a time (s).
    pub(super) fn begin(&mut self, time_s: f64) {
        self.before_s = core::mem::replace(&mut self.now_s, time_s);
    }

    /// A robot visits a place.
    pub(super) fn visit(&mut self, place: usize) {
        let (now_s, before_s) = (self.now_s, self.before_s);
        let Some(place) = self.all.get_mut(place) else {
            return;
        };
        let last_s = core::mem::replace(&mut place.visited_s, now_s);
        // A robot that stays has arrived once.
        if last_s < before_s || place.visits == 0 {
            let arrived_s = core::mem::replace(&mut place.arrived_s, now_s);
            if self.began_s.is_some() && place.visits > 0 {
                place.intervals += 1;
                place.sum_s += now_s - arrived_s;
            }
            place.visits += 1;
        }
        if let Some(began_s) = self.began_s {
            place.worst_s = place.worst_s.max(now_s - last_s);
            self.sums.add((began_s - last_s).max(0.0), now_s - last_s);
        } else if !core::mem::replace(&mut place.is_visited, true) {
            self.unvisited -= 1;
        }
    }

    /// Ends the visits of a time.
    pub(super) fn end(&mut self) {
        if self.unvisited == 0 && self.began_s.is_none() {
            self.rounds += 1;
            if self.rounds == 2 {
                self.began_s = Some(self.now_s);
            } else {
                self.unvisited = self.all.len();
                for place in &mut self.all {
                    place.is_visited = false;
                }
            }
        }
    }

    /// Returns `true` if every place has been visited twice.
    pub(super) fn counts(&self) -> bool {
        self.began_s.is_some()
    }

    /// The figures of all; `None` before they count, and in the second after that.
    pub(super) fn figures(&self) -> Option<IdlenessFigures> {
        let began_s = self.began_s?;
        let mut sums = self.sums;
        for place in &self.all {
            sums.add(
                (began_s - place.visited_s).max(0.0),
                self.now_s - place.visited_s,
            );
        }
        let total_s = self.all.len() as f64 * (self.now_s - began_s);
        let mean_s = sums.first / total_s;
        let variance = sums.second / total_s - mean_s * mean_s;
        let intervals: Option<f64> = self.of_each().map(|place| place.interval_s).sum();
        (self.now_s - began_s >= 1.0).then(|| IdlenessFigures {
            mean_s,
            worst_s: sums.worst_s,
            std_s: libm::sqrt(variance.max(0.0)),
            interval_s: intervals.map(|sum_s| sum_s / self.all.len() as f64),
            nearest_m: None,
        })
    }

    /// Idleness at the last time.
    pub fn now(&self) -> IdlenessNow {
        let (mut sum, mut worst_s, mut worst_place) = (0.0, f64::NEG_INFINITY, 0);
        let mut visited = 0_u32;
        for (index, place) in self.of_each().enumerate() {
            sum += place.idle_s;
            visited += u32::from(place.visits > 0);
            if place.idle_s > worst_s {
                (worst_s, worst_place) = (place.idle_s, index);
            }
        }
        let count = self.all.len() as f64;
        IdlenessNow {
            mean_s: sum / count,
            worst_s,
            worst_place,
            visited: f64::from(visited) / count,
        }
    }

    /// The figures of each.
    pub fn of_each(&self) -> impl Iterator<Item = PlaceFigures> {
        self.all.iter().map(|place| PlaceFigures {
            visits: place.visits,
            interval_s: (place.intervals > 0).then(|| place.sum_s / f64::from(place.intervals)),
            worst_s: place.worst_s.max(self.now_s - place.visited_s),
            idle_s: self.now_s - place.visited_s,
        })
    }
}
