//! Publicly known rule by which goals are made: everything but the key.

use nalgebra::{Point2, Vector2};

/// Frame of a goal that is the affine image of one output of a generator, in the unit square or in
/// [−1, 1]².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Image of the output (0, 0) (m).
    pub origin: Point2<f64>,
    /// Image of the first axis (m).
    pub first: Vector2<f64>,
    /// Image of the second axis (m); not parallel to the first.
    pub second: Vector2<f64>,
}

impl Frame {
    /// The goal of an output.
    pub fn goal(&self, [x, y]: [f64; 2]) -> Point2<f64> {
        self.origin + self.first * x + self.second * y
    }

    /// Returns the area in which its goals lie (m²).
    pub fn area(&self) -> f64 {
        self.first.perp(&self.second).abs()
    }

    /// Returns the output of a goal; `None` if the axes are parallel.
    pub fn output(&self, goal: Point2<f64>) -> Option<[f64; 2]> {
        let area = self.first.perp(&self.second);
        let offset = goal - self.origin;
        (area != 0.0 && area.is_finite()).then(|| {
            [
                offset.perp(&self.second) / area,
                self.first.perp(&offset) / area,
            ]
        })
    }
}

/// One of the goals, in the order of visits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Slot {
    /// Always at the same place.
    Fixed(Point2<f64>),
    /// Position from the generator's next output.
    Drawn(Frame),
}

/// Goals of a route that repeats itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    slots: Vec<Slot>,
}

impl Layout {
    /// Returns a route that repeats these goals; `None` without goals.
    pub fn new(slots: Vec<Slot>) -> Option<Self> {
        (!slots.is_empty()).then_some(Self { slots })
    }

    /// Returns the goal with this number, counted from 0 over all rounds.
    pub fn slot(&self, number: u64) -> Slot {
        let at = (number % self.slots.len() as u64) as usize;
        self.slots
            .get(at)
            .copied()
            .unwrap_or(Slot::Fixed(Point2::origin()))
    }

    /// Goals of a round.
    pub fn round(&self) -> u64 {
        self.slots.len() as u64
    }

    /// Returns the area in which a drawn goal lies (m²): that of the first; 1 if none is drawn.
    pub fn area(&self) -> f64 {
        let areas = self.slots.iter().filter_map(|slot| match slot {
            Slot::Drawn(frame) => Some(frame.area()),
            Slot::Fixed(_) => None,
        });
        areas.into_iter().find(|area| *area > 0.0).unwrap_or(1.0)
    }

    /// Returns the number in the round of a fixed goal within `tolerance` (m) of a place; the
    /// nearest one, of equals the first.
    pub fn fixed_near(&self, place: Point2<f64>, tolerance: f64) -> Option<u64> {
        let mut best: Option<(f64, u64)> = None;
        for (number, slot) in (0..).zip(&self.slots) {
            let Slot::Fixed(point) = slot else { continue };
            let distance = (place - point).norm();
            if distance <= tolerance && best.is_none_or(|(least, _)| distance < least) {
                best = Some((distance, number));
            }
        }
        best.map(|(_, number)| number)
    }

    /// Returns the first and the last of the consecutive goals of a round that are drawn in the same
    /// frame as the goal with this number in the round.
    pub fn run_of(&self, number: u64) -> [u64; 2] {
        let at = (number % self.round()) as usize;
        let (before, after) = self.slots.split_at(at);
        let slot = after.first();
        let same = |other: &&Slot| Some(*other) == slot && matches!(other, Slot::Drawn(_));
        let earlier = before.iter().rev().take_while(same).count();
        let later = after.iter().skip(1).take_while(same).count();
        [(at - earlier) as u64, (at + later) as u64]
    }

    /// Returns `true` if consecutive goals are drawn in one frame.
    pub fn has_runs(&self) -> bool {
        let pairs = self.slots.iter().zip(self.slots.iter().skip(1));
        pairs
            .into_iter()
            .any(|(a, b)| a == b && matches!(a, Slot::Drawn(_)))
    }

    /// Returns minus the logarithm of the density of goals in a frame, relative to that of the first
    /// one.
    pub fn spread_cost(&self, frame: &Frame) -> f64 {
        let ratio = frame.area() / self.area();
        // Frames of one size have areas that differ by rounding.
        if (ratio - 1.0).abs() < 1e-9 {
            0.0
        } else {
            geometry::math::ln(ratio)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_inverted() {
        let frame = Frame {
            origin: Point2::new(1.0, 2.0),
            first: Vector2::new(1.2, -0.7),
            second: Vector2::new(0.7, 1.2),
        };
        let [x, y] = frame.output(frame.goal([0.3, -0.8])).unwrap();
        assert!((x - 0.3).abs() < 1e-14 && (y + 0.8).abs() < 1e-14);
        let flat = Frame {
            second: frame.first,
            ..frame
        };
        assert_eq!(flat.output(Point2::origin()), None);
    }

    #[test]
    fn rounds_repeat_and_fixed_goals_are_found() {
        let corner = Point2::new(3.0, 0.0);
        let frame = Frame {
            origin: Point2::origin(),
            first: Vector2::x(),
            second: Vector2::y(),
        };
        let layout = Layout::new(vec![Slot::Drawn(frame), Slot::Fixed(corner)]).unwrap();
        assert_eq!(layout.slot(7), Slot::Fixed(corner));
        assert_eq!(layout.fixed_near(Point2::new(3.05, 0.0), 0.1), Some(1));
        assert_eq!(layout.fixed_near(Point2::new(3.5, 0.0), 0.1), None);
        assert_eq!(Layout::new(Vec::new()), None);
    }

    #[test]
    fn goals_of_one_rectangle_are_a_run_and_large_rectangles_cost_more() {
        let frame = |side: f64| Frame {
            origin: Point2::origin(),
            first: Vector2::x() * side,
            second: Vector2::y(),
        };
        let slots = [1.0, 1.0, 1.0, 2.0, 1.0].map(|side| Slot::Drawn(frame(side)));
        let layout = Layout::new(slots.to_vec()).unwrap();
        let runs = [0, 1, 2, 3, 4, 6].map(|number| layout.run_of(number));
        assert_eq!(runs, [[0, 2], [0, 2], [0, 2], [3, 3], [4, 4], [0, 2]]);
        assert_eq!(layout.spread_cost(&frame(1.0)), 0.0);
        assert!((layout.spread_cost(&frame(2.0)) - core::f64::consts::LN_2).abs() < 1e-12);
    }
}
