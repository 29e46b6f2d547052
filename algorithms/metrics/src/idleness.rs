//! Idleness of a patrolled contour: the time since the last visit of each of its places, and the distances of its
//! robots (Machado et al., *Multi-agent patrolling*, 2002).
//!
//! A robot visits the place of the contour that is nearest to it, and all between two positions. Idleness counts
//! from the moment at which every place has been visited twice, without the time in which the robots gather.

use nalgebra::Point2;

/// Places of a contour.
const PLACES: usize = 480;

/// Distance from the contour, as a share of its length, beyond which a robot visits no place.
const REACH: f64 = 1.0 / 16.0;

/// A contour on which robots have distances along it.
#[derive(Debug, Clone)]
pub struct Ring {
    points: Vec<Point2<f64>>,
    length: f64,
    is_closed: bool,
}

impl Ring {
    /// A contour through points (m), closed if the last one is the first; `None` without a length.
    pub fn new(points: &[Point2<f64>]) -> Option<Self> {
        let length: f64 = points.windows(2).map(|p| (p[1] - p[0]).norm()).sum();
        (length > 0.0 && length.is_finite()).then(|| Self {
            points: points.to_vec(),
            length,
            is_closed: points.first() == points.last(),
        })
    }

    /// Length of the contour (m).
    pub fn length(&self) -> f64 {
        self.length
    }

    /// The length from its start to the place nearest to a point, and the distance of both (m).
    fn place(&self, at: Point2<f64>) -> (f64, f64) {
        let (mut covered, mut nearest) = (0.0, (0.0, f64::INFINITY));
        for pair in self.points.windows(2) {
            let (from, side) = (pair[0], pair[1] - pair[0]);
            let length = side.norm();
            let share = (at - from).dot(&side) / (length * length).max(f64::MIN_POSITIVE);
            let share = share.clamp(0.0, 1.0);
            let distance = (at - (from + side * share)).norm();
            if distance < nearest.1 {
                nearest = (covered + length * share, distance);
            }
            covered += length;
        }
        nearest
    }

    /// The point after a length of the contour (m); its end beyond.
    fn at(&self, length: f64) -> Point2<f64> {
        let mut left = length;
        for pair in self.points.windows(2) {
            let side = pair[1] - pair[0];
            let share = left / side.norm().max(f64::MIN_POSITIVE);
            if share <= 1.0 {
                return pair[0] + side * share;
            }
            left -= side.norm();
        }
        *self.points.last().unwrap_or(&Point2::origin())
    }

    /// The way along the contour from a length to another one (m), negative if backwards: the shorter one.
    fn way(&self, from: f64, to: f64) -> f64 {
        let way = to - from;
        if self.is_closed {
            way - self.length * (way / self.length).round()
        } else {
            way
        }
    }

    /// The distance along the contour between the places nearest to two points (m).
    pub fn between(&self, a: Point2<f64>, b: Point2<f64>) -> f64 {
        self.way(self.place(a).0, self.place(b).0).abs()
    }
}

/// Figures of a patrol.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IdlenessFigures {
    /// Mean over places and time (s).
    pub mean_s: f64,
    /// Longest time without a visit of a place (s).
    pub worst_s: f64,
    /// Standard deviation over places and time (s).
    pub std_s: f64,
    /// Least distance of two robots along the contour (m); `None` for a robot that is alone.
    pub nearest_m: Option<f64>,
}

/// Idleness of the places at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IdlenessNow {
    /// Mean of the times since the last visit of each place, or since time 0 without one (s).
    pub mean_s: f64,
    /// Longest of these times (s).
    pub worst_s: f64,
    /// Middle of the first place with this time, x and y (m).
    pub worst_at: [f64; 2],
    /// Share of the places that have been visited, 0 to 1.
    pub visited: f64,
}

/// Idleness of a contour over time.
#[derive(Debug, Clone)]
pub struct Idleness {
    ring: Ring,
    /// Time of the last visit of each place (s).
    visited_s: Vec<Option<f64>>,
    /// `true` for each place that has been visited in this round over all places, and number of the others.
    is_visited: Vec<bool>,
    unvisited: usize,
    /// Number of rounds over all places.
    rounds: u32,
    /// Place of each robot at the last time, as a length (m).
    before: Vec<Option<f64>>,
    now_s: f64,
    /// Time at which every place had been visited twice (s).
    began_s: Option<f64>,
    sums: Sums,
    nearest_m: f64,
}

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

impl Idleness {
    /// A contour that none of this many robots has visited.
    pub fn new(ring: Ring, robots: usize) -> Self {
        Self {
            ring,
            visited_s: vec![None; PLACES],
            is_visited: vec![false; PLACES],
            unvisited: PLACES,
            rounds: 0,
            before: vec![None; robots],
            now_s: 0.0,
            began_s: None,
            sums: Sums::default(),
            nearest_m: f64::INFINITY,
        }
    }

    /// Adds the positions of all robots (m) at a time (s), not before the last one; `None` for a robot that does not
    /// take part.
    pub fn add(&mut self, time_s: f64, robots: impl Iterator<Item = Option<Point2<f64>>>) {
        self.now_s = time_s;
        let mut before = core::mem::take(&mut self.before);
        for (before, at) in before.iter_mut().zip(robots) {
            let place = at.map(|at| self.ring.place(at));
            let place = place.filter(|(_, distance)| *distance <= REACH * self.ring.length);
            let last = core::mem::replace(before, place.map(|(length, _)| length));
            if let Some(to) = *before {
                self.visit(last.unwrap_or(to), to);
            }
        }
        self.before = before;
        if self.unvisited == 0 && self.began_s.is_none() {
            self.rounds += 1;
            if self.rounds == 2 {
                self.began_s = Some(time_s);
            } else {
                (self.is_visited, self.unvisited) = (vec![false; PLACES], PLACES);
            }
        }
        if self.began_s.is_some() {
            for (i, &a) in self.before.iter().enumerate() {
                for &b in &self.before[..i] {
                    if let (Some(a), Some(b)) = (a, b) {
                        self.nearest_m = self.nearest_m.min(self.ring.way(a, b).abs());
                    }
                }
            }
        }
    }

    /// Visits the places from one length to another (m).
    fn visit(&mut self, from: f64, to: f64) {
        let per_m = PLACES as f64 / self.ring.length;
        let way = self.ring.way(from, to);
        let (low, high) = (from.min(from + way) * per_m, from.max(from + way) * per_m);
        let (low, high) = (low.floor() as i64, high.floor() as i64);
        for place in low..=high {
            let place = place.rem_euclid(PLACES as i64) as usize;
            let last_s = self.visited_s[place].replace(self.now_s).unwrap_or(0.0);
            if let Some(began_s) = self.began_s {
                self.sums
                    .add((began_s - last_s).max(0.0), self.now_s - last_s);
            } else if !core::mem::replace(&mut self.is_visited[place], true) {
                self.unvisited -= 1;
            }
        }
    }

    /// Time of the last visit of each place (s), in their order along the contour; `None` without one.
    pub fn last_visits(&self) -> &[Option<f64>] {
        &self.visited_s
    }

    /// Both ends of each place (m), in their order along the contour.
    pub fn ends(&self) -> impl Iterator<Item = [Point2<f64>; 2]> {
        let per_place = self.ring.length / PLACES as f64;
        let at = move |bound| self.ring.at(bound as f64 * per_place);
        (0..PLACES).map(move |place| [at(place), at(place + 1)])
    }

    /// Time since the last visit of each place, or since time 0 without one (s).
    pub fn idle_s(&self) -> impl Iterator<Item = f64> {
        let last_visits = self.visited_s.iter();
        last_visits.map(|last_s| self.now_s - last_s.unwrap_or(0.0))
    }

    /// Idleness at the last time.
    pub fn now(&self) -> IdlenessNow {
        let (mut sum, mut worst_s, mut worst_place) = (0.0, f64::NEG_INFINITY, 0);
        for (place, idle_s) in self.idle_s().enumerate() {
            sum += idle_s;
            if idle_s > worst_s {
                (worst_s, worst_place) = (idle_s, place);
            }
        }
        let visited = self.visited_s.iter().flatten().count();
        let middle = (worst_place as f64 + 0.5) * self.ring.length / PLACES as f64;
        IdlenessNow {
            mean_s: sum / PLACES as f64,
            worst_s,
            worst_at: self.ring.at(middle).into(),
            visited: visited as f64 / PLACES as f64,
        }
    }

    /// The figures up to the last time; `None` before every place has been visited twice, and in the second after
    /// that.
    pub fn figures(&self) -> Option<IdlenessFigures> {
        let began_s = self.began_s?;
        let mut sums = self.sums;
        for last_s in &self.visited_s {
            let last_s = last_s.unwrap_or(0.0);
            sums.add((began_s - last_s).max(0.0), self.now_s - last_s);
        }
        let total_s = PLACES as f64 * (self.now_s - began_s);
        let mean_s = sums.first / total_s;
        let variance = sums.second / total_s - mean_s * mean_s;
        (self.now_s - began_s >= 1.0).then(|| IdlenessFigures {
            mean_s,
            worst_s: sums.worst_s,
            std_s: libm::sqrt(variance.max(0.0)),
            nearest_m: Some(self.nearest_m).filter(|m| m.is_finite()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK_S: f64 = 0.05;

    fn square() -> Ring {
        let corners = [
            [0.0, 0.0],
            [10.0, 0.0],
            [10.0, 10.0],
            [0.0, 10.0],
            [0.0, 0.0],
        ];
        Ring::new(&corners.map(Point2::from)).unwrap()
    }

    /// The point of the square after this length.
    fn at(length: f64) -> Point2<f64> {
        let length = length.rem_euclid(40.0);
        let along = length % 10.0;
        match (length / 10.0) as u32 {
            0 => Point2::new(along, 0.0),
            1 => Point2::new(10.0, along),
            2 => Point2::new(10.0 - along, 10.0),
            _ => Point2::new(0.0, 10.0 - along),
        }
    }

    /// Robots at these lengths that drive at 1 m/s for 200 s.
    fn drive(starts: &[f64]) -> IdlenessFigures {
        let mut idleness = Idleness::new(square(), starts.len());
        assert_eq!(idleness.figures(), None);
        for tick in 0..4000 {
            let time_s = f64::from(tick) * TICK_S;
            let robots = starts.iter().map(|start| Some(at(start + time_s)));
            idleness.add(time_s, robots);
        }
        idleness.figures().unwrap()
    }

    #[test]
    fn robots_at_equal_distances_visit_every_place_once_in_their_share_of_a_lap() {
        for count in 1..=5 {
            let part_s = 40.0 / f64::from(count);
            let starts: Vec<f64> = (0..count).map(|robot| part_s * f64::from(robot)).collect();
            let figures = drive(&starts);
            assert!((figures.worst_s - part_s).abs() < 0.2, "{figures:?}");
            // It grows evenly from 0 to the longest time.
            assert!((figures.mean_s - part_s / 2.0).abs() < 0.1, "{figures:?}");
            let std_s = part_s / 12.0_f64.sqrt();
            assert!((figures.std_s - std_s).abs() < 0.1, "{figures:?}");
            let nearest_m = figures.nearest_m.unwrap_or(40.0);
            assert!((nearest_m - part_s).abs() < 1e-9, "{figures:?}");
        }
    }

    #[test]
    fn the_place_without_a_visit_for_longest_is_the_one_behind_the_gap() {
        let mut idleness = Idleness::new(square(), 1);
        for tick in 0..=200 {
            let time_s = f64::from(tick) * TICK_S;
            idleness.add(time_s, core::iter::once(Some(at(time_s))));
        }
        // After 10 s at 1 m/s a quarter is visited, and the rest waits since time 0.
        let now = idleness.now();
        assert!((now.visited - 0.25).abs() <= 1.0 / 480.0, "{now:?}");
        assert_eq!(now.worst_s, 10.0);
        assert!(
            (Point2::from(now.worst_at) - Point2::new(10.0, 0.125)).norm() < 1e-9,
            "{now:?}"
        );
        let mean_s = 0.25 * 5.0 + 0.75 * 10.0;
        assert!((now.mean_s - mean_s).abs() < 0.05, "{now:?}");
        let visits = idleness.last_visits();
        assert_eq!(
            (visits[0], visits[120], visits[121]),
            (Some(0.1), Some(10.0), None)
        );
        let ends: Vec<_> = idleness.ends().collect();
        assert_eq!(ends.len(), visits.len());
        assert!((ends[120][0] - Point2::new(10.0, 0.0)).norm() < 1e-9);
        assert!((ends[479][1] - ends[0][0]).norm() < 1e-9);
    }

    #[test]
    fn a_convoy_leaves_places_alone_for_almost_a_lap() {
        let figures = drive(&[0.0, 1.0, 2.0]);
        assert!((figures.worst_s - 38.0).abs() < 0.2, "{figures:?}");
        assert!((figures.nearest_m.unwrap() - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_place_that_no_robot_visits_leaves_no_figures() {
        let mut idleness = Idleness::new(square(), 2);
        for tick in 0..4000 {
            let along = 1.0 + (f64::from(tick % 800) * 0.02 - 8.0).abs();
            let far = Some(Point2::new(5.0, 5.0));
            idleness.add(f64::from(tick) * TICK_S, [Some(at(along)), far].into_iter());
        }
        assert_eq!(idleness.figures(), None);
    }

    #[test]
    fn distances_are_along_the_contour() {
        let ring = square();
        let (a, b) = (Point2::new(1.0, 0.5), Point2::new(-0.5, 2.0));
        assert!((ring.between(a, b) - 3.0).abs() < 1e-12);
        let open = Ring::new(&[at(0.0), at(10.0), at(20.0), at(30.0)]).unwrap();
        assert!((open.between(at(1.0), at(29.0)) - 28.0).abs() < 1e-12);
        assert!(Ring::new(&[at(0.0), at(0.0)]).is_none());
    }
}
