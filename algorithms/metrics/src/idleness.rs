//! Idleness of patrols: the time since the last visit of each place, and the distances of robots on a contour
//! (Machado et al., *Multi-agent patrolling*, 2002).
//!
//! On a contour a robot visits the place that is nearest to it, and all between two positions; on a graph the nodes
//! within a distance of it. Idleness counts from the moment at which every place has been visited twice, without the time
//! in which the robots gather.

mod places;

use nalgebra::Point2;

pub use places::{IdlenessNow, PlaceFigures, Places};

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
    /// Longest time without a visit of a place (s): the refresh time.
    pub worst_s: f64,
    /// Standard deviation over places and time (s).
    pub std_s: f64,
    /// Mean over places of the mean time from one arrival of a robot to the next (s): the average graph idleness of
    /// Portugal and Rocha (2011). `None` before every place has been visited again.
    pub interval_s: Option<f64>,
    /// Least distance of two robots along the contour (m); `None` on a graph, and for a robot that is alone.
    pub nearest_m: Option<f64>,
}

/// Idleness of a contour over time.
#[derive(Debug, Clone)]
pub struct Idleness {
    ring: Ring,
    places: Places,
    /// Place of each robot at the last time, as a length (m).
    before: Vec<Option<f64>>,
    nearest_m: f64,
}

impl Idleness {
    /// A contour that none of this many robots has visited.
    pub fn new(ring: Ring, robots: usize) -> Self {
        Self {
            ring,
            places: Places::new(PLACES),
            before: vec![None; robots],
            nearest_m: f64::INFINITY,
        }
    }

    /// Adds the positions of all robots (m) at a time (s), not before the last one; `None` for a robot that does not
    /// take part.
    pub fn add(&mut self, time_s: f64, robots: impl Iterator<Item = Option<Point2<f64>>>) {
        self.places.begin(time_s);
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
        self.places.end();
        if self.places.counts() {
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
            self.places.visit(place.rem_euclid(PLACES as i64) as usize);
        }
    }

    /// The places along the contour.
    pub fn places(&self) -> &Places {
        &self.places
    }

    /// Both ends of each place (m), in their order along the contour.
    pub fn ends(&self) -> impl Iterator<Item = [Point2<f64>; 2]> {
        let per_place = self.ring.length / PLACES as f64;
        let at = move |bound| self.ring.at(bound as f64 * per_place);
        (0..PLACES).map(move |place| [at(place), at(place + 1)])
    }

    /// The figures up to the last time; `None` before every place has been visited twice, and in the second after
    /// that.
    pub fn figures(&self) -> Option<IdlenessFigures> {
        Some(IdlenessFigures {
            nearest_m: Some(self.nearest_m).filter(|m| m.is_finite()),
            ..self.places.figures()?
        })
    }
}

/// Idleness of the nodes of a graph over time.
#[derive(Debug, Clone)]
pub struct NodeIdleness {
    nodes: Vec<Point2<f64>>,
    within_m: f64,
    places: Places,
}

impl NodeIdleness {
    /// Nodes (m) that robots visit within a distance (m); none has been visited.
    pub fn new(nodes: Vec<Point2<f64>>, within_m: f64) -> Self {
        Self {
            places: Places::new(nodes.len()),
            nodes,
            within_m,
        }
    }

    /// Adds the positions of all robots that take part (m) at a time (s), not before the last one.
    pub fn add(&mut self, time_s: f64, robots: impl Iterator<Item = Point2<f64>>) {
        self.places.begin(time_s);
        for at in robots {
            for (place, node) in self.nodes.iter().enumerate() {
                if (node - at).norm() <= self.within_m {
                    self.places.visit(place);
                }
            }
        }
        self.places.end();
    }

    /// The figures up to the last time; `None` before every node has been visited twice, and in the second after
    /// that.
    pub fn figures(&self) -> Option<IdlenessFigures> {
        self.places.figures()
    }

    /// The nodes.
    pub fn places(&self) -> &Places {
        &self.places
    }

    /// Each node (m) with its figures.
    pub fn nodes(&self) -> impl Iterator<Item = (Point2<f64>, PlaceFigures)> {
        self.nodes.iter().copied().zip(self.places.of_each())
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
        let now = idleness.places().now();
        assert!((now.visited - 0.25).abs() <= 1.0 / 480.0, "{now:?}");
        assert_eq!((now.worst_s, now.worst_place), (10.0, 121));
        let mean_s = 0.25 * 5.0 + 0.75 * 10.0;
        assert!((now.mean_s - mean_s).abs() < 0.05, "{now:?}");
        let places: Vec<PlaceFigures> = idleness.places().of_each().collect();
        assert_eq!((places[120].visits, places[120].idle_s), (1, 0.0));
        assert_eq!((places[121].visits, places[121].idle_s), (0, 10.0));
        let ends: Vec<_> = idleness.ends().collect();
        assert_eq!(ends.len(), places.len());
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

    #[test]
    fn nodes_are_visited_from_near_and_each_stay_counts_once() {
        let nodes = [0.0, 10.0, 20.0, 30.0].map(at).to_vec();
        let mut idleness = NodeIdleness::new(nodes, 0.5);
        for tick in 0..4000 {
            let time_s = f64::from(tick) * TICK_S;
            idleness.add(time_s, [at(time_s)].into_iter());
        }
        let figures = idleness.figures().unwrap();
        // A node has a robot for 1 s of 40 s (at a corner for as long as on a side).
        assert!((figures.worst_s - 39.0).abs() < 0.2, "{figures:?}");
        let interval_s = figures.interval_s.unwrap();
        assert!((interval_s - 40.0).abs() < 0.2, "{figures:?}");
        assert_eq!(figures.nearest_m, None);
        for (node, of_node) in idleness.nodes() {
            assert!((5..=6).contains(&of_node.visits), "{node}: {of_node:?}");
            assert!((of_node.worst_s - 39.0).abs() < 0.2, "{node}: {of_node:?}");
        }
    }
}
