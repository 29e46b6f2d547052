//! What is seen from a place, as a polygon: for people who look on.
//!
//! The sides of free cells that border on occupied ones (or on the end of the grid) are joined to
//! straight walls. Around the eye, between the directions of two neighbouring wall ends, one wall is
//! the nearest all along: walls do not cross. So the polygon is exact, and has as many corners as
//! there are walls to be seen, not as there are rays.
//!
//! The polygon says where nothing is in the way; [`VisibilityField`](super::VisibilityField) says how
//! good the view is there.

use core::f64::consts::{PI, TAU};

use nalgebra::{Point2, Vector2};

use crate::grid::{Grid, GridFrame};
use crate::math;

/// Largest angle between two corners where the range is what ends the view [rad].
const ARC_STEP: f64 = 5.0 * PI / 180.0;
/// Directions closer to each other than this are one [rad].
const SAME_DIRECTION: f64 = 1e-9;
/// Points closer to each other than the root of this are one [m²].
const SAME_PLACE: f64 = 1e-18;
/// Least distance of an eye to the sides of its cell, in cells.
const OFF_THE_WALL: f64 = 1e-6;

/// A place to look from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Eye {
    /// Where it is [m].
    pub position: Point2<f64>,
    /// Where it looks [rad].
    pub heading: f64,
    /// What it is able to see.
    pub limits: SightLimits,
}

/// How far and how wide somebody sees.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SightLimits {
    /// Largest distance [m], > 0; unlimited if absent.
    pub range: Option<f64>,
    /// Full opening angle around the heading [rad], in (0, 2π]; all round if absent.
    pub field_of_view: Option<f64>,
}

impl SightLimits {
    /// Whether it looks into all directions.
    pub fn is_all_round(&self) -> bool {
        self.field_of_view.is_none_or(|angle| angle >= TAU)
    }
}

/// The walls of a map.
#[derive(Debug, Clone)]
pub struct Walls {
    occupied: Grid<bool>,
    walls: Vec<Wall>,
}

/// A straight piece of wall, with the free side on its left.
#[derive(Debug, Clone, Copy)]
struct Wall {
    from: Point2<f64>,
    to: Point2<f64>,
}

/// A wall as it is seen: from the eye, its ends in directions relative to where the sweep begins.
#[derive(Debug, Clone, Copy)]
struct Span {
    begins: f64,
    ends: f64,
    from: Vector2<f64>,
    along: Vector2<f64>,
}

impl Walls {
    /// The walls around the free cells of a grid.
    pub fn new(occupied: Grid<bool>) -> Self {
        let mut walls = Vec::new();
        let frame = &occupied.frame;
        let corner = |column: usize, row: usize| {
            Point2::new(
                frame.origin.x + column as f64 * frame.resolution,
                frame.origin.y + row as f64 * frame.resolution,
            )
        };
        // Everything beyond the grid is solid, as it is for lines of sight.
        let solid = |column: Option<usize>, row: Option<usize>| match (column, row) {
            (Some(column), Some(row)) if column < frame.width && row < frame.height => {
                occupied.cells[frame.index(column, row)]
            }
            _ => true,
        };
        for row in 0..=frame.height {
            joined(frame.width, |column| {
                let below = solid(Some(column), row.checked_sub(1));
                side(below, solid(Some(column), Some(row)))
            })
            .for_each(|(from, to, side)| {
                let (left, right) = (corner(from, row), corner(to, row));
                walls.push(match side {
                    Side::FreeAfter => Wall::new(left, right),
                    Side::FreeBefore => Wall::new(right, left),
                });
            });
        }
        for column in 0..=frame.width {
            joined(frame.height, |row| {
                let left = solid(column.checked_sub(1), Some(row));
                side(left, solid(Some(column), Some(row)))
            })
            .for_each(|(from, to, side)| {
                let (low, high) = (corner(column, from), corner(column, to));
                walls.push(match side {
                    Side::FreeAfter => Wall::new(high, low),
                    Side::FreeBefore => Wall::new(low, high),
                });
            });
        }
        Self { occupied, walls }
    }

    /// Where the cells lie.
    pub fn frame(&self) -> &GridFrame {
        &self.occupied.frame
    }

    /// The border of what an eye sees, counter-clockwise, as seen from it; it can be cut into
    /// triangles that all begin at the eye. Empty if the eye is not in free space. With a field of
    /// view of less than a full turn the first and the last point are the ends of its opening, and
    /// the polygon closes over the eye.
    pub fn seen_from(&self, eye: &Eye) -> Vec<Point2<f64>> {
        let Some(place) = self.stand(eye.position) else {
            return Vec::new();
        };
        let turn = eye.limits.field_of_view.map_or(TAU, |angle| angle.min(TAU));
        let begin = eye.heading - 0.5 * turn;
        let mut spans = self.spans(place, begin);
        let mut directions: Vec<f64> = spans
            .iter()
            .flat_map(|span| [span.begins, span.ends])
            .filter(|angle| *angle > 0.0 && *angle < turn)
            .chain([0.0, turn])
            .collect();
        directions.sort_unstable_by(f64::total_cmp);
        directions.dedup_by(|a, b| *a - *b < SAME_DIRECTION);
        spans.sort_unstable_by(|a, b| a.begins.total_cmp(&b.begins));
        let mut view = View {
            place,
            begin,
            range: eye.limits.range.unwrap_or(f64::INFINITY),
            border: Vec::new(),
        };
        let (mut open, mut coming) = (Vec::new(), spans.into_iter().peekable());
        // The nearest wall, and between which directions it is.
        let mut run: Option<(Span, f64, f64)> = None;
        for pair in directions.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let middle = f64::midpoint(from, to);
            while let Some(span) = coming.next_if(|span| span.begins < middle) {
                open.push(span);
            }
            open.retain(|span: &Span| span.ends > middle);
            let ray = direction(begin + middle);
            let nearest = open
                .iter()
                .min_by(|a, b| a.distance(ray).total_cmp(&b.distance(ray)));
            let Some(nearest) = nearest else {
                continue;
            };
            match &mut run {
                Some((span, _, end)) if span.from == nearest.from => *end = to,
                _ => {
                    if let Some((span, from, to)) = run.replace((*nearest, from, to)) {
                        view.add(&span, from, to);
                    }
                }
            }
        }
        if let Some((span, from, to)) = run {
            view.add(&span, from, to);
        }
        let mut border = view.border;
        // All round, it ends where it began.
        if eye.limits.is_all_round()
            && let [first, .., last] = border.as_slice()
            && (first - last).norm_squared() < SAME_PLACE
        {
            border.pop();
        }
        border
    }

    /// Where an eye is that stands here, off the sides of its cell; `None` if that is not free.
    fn stand(&self, place: Point2<f64>) -> Option<Point2<f64>> {
        let frame = self.frame();
        let (column, row) = frame.cell_at(place)?;
        if self.occupied.cells[frame.index(column, row)] {
            return None;
        }
        let within = |value: f64, origin: f64, cell: usize| {
            let low = origin + (cell as f64 + OFF_THE_WALL) * frame.resolution;
            let high = origin + (cell as f64 + 1.0 - OFF_THE_WALL) * frame.resolution;
            value.max(low).min(high)
        };
        Some(Point2::new(
            within(place.x, frame.origin.x, column),
            within(place.y, frame.origin.y, row),
        ))
    }

    /// The walls that face a place, those in two parts over which the sweep begins.
    fn spans(&self, place: Point2<f64>, begin: f64) -> Vec<Span> {
        let mut spans = Vec::with_capacity(self.walls.len() / 2 + 2);
        for wall in &self.walls {
            let (from, along) = (wall.from - place, wall.to - wall.from);
            if from.perp(&along) <= 0.0 {
                continue;
            }
            let to = wall.to - place;
            let angle = |v: Vector2<f64>| (math::atan2(v.y, v.x) - begin).rem_euclid(TAU);
            let (begins, ends) = (angle(from), angle(to));
            let span = Span {
                begins,
                ends,
                from,
                along,
            };
            if begins <= ends {
                spans.push(span);
            } else {
                spans.push(Span { ends: TAU, ..span });
                spans.push(Span {
                    begins: 0.0,
                    ..span
                });
            }
        }
        spans
    }
}

impl Wall {
    fn new(from: Point2<f64>, to: Point2<f64>) -> Self {
        Self { from, to }
    }
}

impl Span {
    /// Where on the wall a ray hits it, 0 to 1 from its beginning.
    fn part(&self, ray: Vector2<f64>) -> f64 {
        (ray.perp(&self.from) / self.along.perp(&ray)).clamp(0.0, 1.0)
    }

    /// How far away the wall is in a direction.
    fn distance(&self, ray: Vector2<f64>) -> f64 {
        self.from.perp(&self.along) / ray.perp(&self.along)
    }
}

/// The border of what is seen, as it grows.
struct View {
    place: Point2<f64>,
    begin: f64,
    range: f64,
    border: Vec<Point2<f64>>,
}

impl View {
    /// Adds what is seen of a wall between two directions, or of the range before it.
    fn add(&mut self, span: &Span, from: f64, to: f64) {
        let (first, last) = (
            span.part(direction(self.begin + from)),
            span.part(direction(self.begin + to)),
        );
        let point = |part: f64| span.from + span.along * part;
        if self.range == f64::INFINITY {
            self.put(point(first));
            self.put(point(last));
            return;
        }
        // The part of the wall's line within the range: |from + part × along| ≤ range.
        let (a, b) = (span.along.norm_squared(), span.from.dot(&span.along));
        let c = span.from.norm_squared() - self.range * self.range;
        let root = b * b - a * c;
        let half = root.max(0.0).sqrt();
        let (near, far) = (
            first.max((-b - half) / a).min(last),
            last.min((-b + half) / a).max(first),
        );
        if root <= 0.0 || near >= far {
            self.arc(from, to);
            return;
        }
        let angle = |part: f64| {
            let v = point(part);
            let relative = (math::atan2(v.y, v.x) - self.begin).rem_euclid(TAU);
            // At its ends it may have come out on the other side of the beginning.
            if (from..=to).contains(&relative) {
                relative
            } else if part > f64::midpoint(first, last) {
                to
            } else {
                from
            }
        };
        let (in_range_from, in_range_to) = (angle(near), angle(far));
        if near > first {
            self.arc(from, in_range_from);
        }
        self.put(point(near));
        self.put(point(far));
        if far < last {
            self.arc(in_range_to, to);
        }
    }

    /// Adds an arc at the range.
    fn arc(&mut self, from: f64, to: f64) {
        let steps = ((to - from) / ARC_STEP).ceil().max(1.0) as u32;
        for step in 0..=steps {
            let angle = from + (to - from) * f64::from(step) / f64::from(steps);
            self.put(direction(self.begin + angle) * self.range);
        }
    }

    fn put(&mut self, offset: Vector2<f64>) {
        let point = self.place + offset;
        if self
            .border
            .last()
            .is_none_or(|last| (point - last).norm_squared() > SAME_PLACE)
        {
            self.border.push(point);
        }
    }
}

fn direction(angle: f64) -> Vector2<f64> {
    let (sin, cos) = math::sincos(angle);
    Vector2::new(cos, sin)
}

/// On which side of a line between two cells is free space.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    FreeBefore,
    FreeAfter,
}

fn side(solid_before: bool, solid_after: bool) -> Option<Side> {
    match (solid_before, solid_after) {
        (false, true) => Some(Side::FreeBefore),
        (true, false) => Some(Side::FreeAfter),
        _ => None,
    }
}

/// Joins neighbours of one kind: from, to and kind of every run.
fn joined(
    count: usize,
    kind: impl Fn(usize) -> Option<Side>,
) -> impl Iterator<Item = (usize, usize, Side)> {
    let mut next = 0;
    core::iter::from_fn(move || {
        while next < count {
            let from = next;
            let here = kind(from);
            while next < count && kind(next) == here {
                next += 1;
            }
            if let Some(here) = here {
                return Some((from, next, here));
            }
        }
        None
    })
}

#[cfg(test)]
mod tests;
