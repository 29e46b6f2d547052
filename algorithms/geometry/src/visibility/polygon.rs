//! The region visible from a position, as a polygon, for display.
//!
//! The sides of free cells that border on occupied ones (or on the end of the grid) are joined to straight
//! walls. Around the viewpoint, between the directions of two neighbouring wall ends, one wall is always the
//! nearest: walls do not cross. So the polygon is exact, and the number of its corners depends on the visible
//! walls, not on a number of rays.
//!
//! The polygon contains the points with a free line of sight; [`VisibilityField`](super::VisibilityField)
//! gives the quality of the view.

mod border;
mod span;
mod sweep;

use core::f64::consts::TAU;

use nalgebra::{Point2, Vector2};

use self::border::View;
use self::span::{Span, from_begin};
use self::sweep::{Corner, Sweep};
use crate::grid::{Grid, GridFrame};
use crate::math;

/// Difference (rad) below which directions are equal.
const SAME_DIRECTION: f64 = 1e-9;
/// Minimum distance of a viewpoint from the sides of its cell, in cells.
const OFF_THE_WALL: f64 = 1e-6;

/// Position, heading and limits of a sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viewpoint {
    /// Position (m).
    pub position: Point2<f64>,
    /// Heading (rad).
    pub heading: f64,
    /// Limits of the view.
    pub limits: SightLimits,
}

/// Range and field of view.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SightLimits {
    /// Maximum distance (m), > 0; unlimited if absent.
    pub range: Option<f64>,
    /// Full opening angle around the heading (rad), in (0, 2π]; all round if absent.
    pub field_of_view: Option<f64>,
}

impl SightLimits {
    /// Returns `true` if the view covers all directions.
    pub fn is_all_round(&self) -> bool {
        self.field_of_view.is_none_or(|angle| angle >= TAU)
    }
}

/// The walls of a map.
///
/// ```
/// use geometry::grid::{Grid, GridFrame};
/// use geometry::visibility::polygon::{Viewpoint, SightLimits, Walls};
/// use nalgebra::Point2;
///
/// let frame = GridFrame { width: 4, height: 3, resolution: 1.0, origin: Point2::origin() };
/// let walls = Walls::new(Grid::filled(frame, false));
/// let viewpoint = Viewpoint {
///     position: Point2::new(1.5, 1.5),
///     heading: 0.0,
///     limits: SightLimits::default(),
/// };
/// // The four corners of the room, and where the border begins.
/// assert_eq!(walls.seen_from(&viewpoint).len(), 5);
/// ```
#[derive(Debug, Clone)]
pub struct Walls {
    occupied: Grid<bool>,
    walls: Vec<Wall>,
}

/// A straight piece of wall, with the free side on its left. Walls form closed sequences: where one ends
/// another begins, so that there are as many corners as walls, and each is processed once.
#[derive(Debug, Clone, Copy)]
struct Wall {
    from: Point2<f64>,
    along: Vector2<f64>,
    /// The wall that begins where this one ends.
    next: usize,
}

/// A wall between the grid's corners, by their numbers.
#[derive(Debug, Clone, Copy)]
struct Side {
    from: usize,
    to: usize,
}

impl Walls {
    /// The walls around the free cells of a grid.
    pub fn new(occupied: Grid<bool>) -> Self {
        let mut sides = Vec::new();
        let frame = &occupied.frame;
        let corners = frame.width + 1;
        let corner = |column: usize, row: usize| row * corners + column;
        // All space beyond the grid is solid, as it is for lines of sight.
        let solid = |column: Option<usize>, row: Option<usize>| match (column, row) {
            (Some(column), Some(row)) if column < frame.width && row < frame.height => {
                occupied.cells[frame.index(column, row)]
            }
            _ => true,
        };
        for row in 0..=frame.height {
            joined(frame.width, |column| {
                let below = solid(Some(column), row.checked_sub(1));
                free(below, solid(Some(column), Some(row)))
            })
            .for_each(|(from, to, free)| {
                let (left, right) = (corner(from, row), corner(to, row));
                sides.push(match free {
                    Free::After => Side::new(left, right),
                    Free::Before => Side::new(right, left),
                });
            });
        }
        for column in 0..=frame.width {
            joined(frame.height, |row| {
                let left = solid(column.checked_sub(1), Some(row));
                free(left, solid(Some(column), Some(row)))
            })
            .for_each(|(from, to, free)| {
                let (low, high) = (corner(column, from), corner(column, to));
                sides.push(match free {
                    Free::After => Side::new(high, low),
                    Free::Before => Side::new(low, high),
                });
            });
        }
        let walls = in_rows(&sides, |corner| {
            let (column, row) = (corner % corners, corner / corners);
            Point2::new(
                frame.origin.x + column as f64 * frame.resolution,
                frame.origin.y + row as f64 * frame.resolution,
            )
        });
        Self { occupied, walls }
    }

    /// Frame of the cells.
    pub fn frame(&self) -> &GridFrame {
        &self.occupied.frame
    }

    /// The border of the region visible from a viewpoint, counter-clockwise; it can be cut into triangles that
    /// all begin at the viewpoint. Empty if the viewpoint is not in free space. With a field of view of less
    /// than a full turn the first and the last point are the ends of its opening, and the polygon closes over
    /// the viewpoint.
    pub fn seen_from(&self, viewpoint: &Viewpoint) -> Vec<Point2<f64>> {
        let Some(place) = self.stand(viewpoint.position) else {
            return Vec::new();
        };
        let turn = viewpoint
            .limits
            .field_of_view
            .map_or(TAU, |angle| angle.min(TAU));
        let begin = viewpoint.heading - 0.5 * turn;
        let (spans, corners) = self.spans(place, begin);
        let mut directions = Vec::with_capacity(corners.len() + 2);
        directions.push(0.0);
        directions.extend(
            corners
                .iter()
                .map(|corner| corner.direction)
                .filter(|angle| *angle > 0.0 && *angle < turn),
        );
        directions.push(turn);
        directions.dedup_by(|a, b| *a - *b < SAME_DIRECTION);
        let range = viewpoint.limits.range.unwrap_or(f64::INFINITY);
        let mut view = View::new(place, begin, range);
        let mut sweep = Sweep::new(begin, spans);
        let mut coming = corners.iter().peekable();
        // The nearest wall, and its range of directions.
        let mut run: Option<(usize, f64, f64)> = None;
        for pair in directions.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let middle = f64::midpoint(from, to);
            let mut ray = None;
            while let Some(corner) = coming.next_if(|corner| corner.direction < middle) {
                if let Some(span) = corner.begins {
                    sweep.open(span, middle, &mut ray);
                }
            }
            let Some(nearest) = sweep.nearest(middle, &mut ray) else {
                continue;
            };
            match &mut run {
                Some((span, _, end)) if sweep.is_one_wall(*span, nearest) => *end = to,
                _ => {
                    if let Some((span, from, to)) = run.replace((nearest, from, to)) {
                        view.add(sweep.span(span), from, to);
                    }
                }
            }
        }
        if let Some((span, from, to)) = run {
            view.add(sweep.span(span), from, to);
        }
        view.finish(viewpoint.limits.is_all_round())
    }

    /// The position of a viewpoint, moved off the sides of its cell; `None` if it is not free.
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

    /// The walls that face a position (walls across the start of the sweep in two parts), and their ends in
    /// the order of the sweep.
    fn spans(&self, place: Point2<f64>, begin: f64) -> (Vec<Span>, Vec<Corner>) {
        let angle = |v: Vector2<f64>| from_begin(math::atan2(v.y, v.x) - begin);
        let mut spans = Vec::with_capacity(self.walls.len() / 2 + 2);
        let mut corners = Vec::with_capacity(self.walls.len());
        // Starts of walls, for the wall before and the wall behind.
        let mut directions = vec![f64::NAN; self.walls.len()];
        let mut direction = |wall: usize, from: Vector2<f64>| {
            if directions[wall].is_nan() {
                directions[wall] = angle(from);
            }
            directions[wall]
        };
        let faces = |wall: &Wall| (wall.from - place).perp(&wall.along) > 0.0;
        for (index, wall) in self.walls.iter().enumerate() {
            if !faces(wall) {
                continue;
            }
            let (from, along) = (wall.from - place, wall.along);
            let next = &self.walls[wall.next];
            let begins = direction(index, from);
            let ends = direction(wall.next, next.from - place);
            let span = Span {
                begins,
                ends,
                from,
                along,
            };
            corners.push(Corner {
                direction: begins,
                begins: Some(spans.len()),
            });
            // A wall that begins there is registered by itself.
            if !faces(next) {
                corners.push(Corner {
                    direction: ends,
                    begins: None,
                });
            }
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
        corners.sort_unstable_by(|a, b| a.direction.total_cmp(&b.direction));
        (spans, corners)
    }
}

/// Finds the successor of every wall. Where four walls meet, either of the two that begin is valid.
fn in_rows(sides: &[Side], place: impl Fn(usize) -> Point2<f64>) -> Vec<Wall> {
    let by = |corner: fn(&Side) -> usize| {
        let mut order: Vec<usize> = (0..sides.len()).collect();
        order.sort_by_key(|&side| corner(&sides[side]));
        order
    };
    let mut walls: Vec<Wall> = sides
        .iter()
        .map(|side| {
            let from = place(side.from);
            Wall {
                from,
                along: place(side.to) - from,
                next: 0,
            }
        })
        .collect();
    // At every corner as many walls end as begin.
    for (ending, beginning) in by(|side| side.to).into_iter().zip(by(|side| side.from)) {
        walls[ending].next = beginning;
    }
    walls
}

impl Side {
    fn new(from: usize, to: usize) -> Self {
        Self { from, to }
    }
}

/// Side of a line between two cells on which free space lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Free {
    Before,
    After,
}

fn free(solid_before: bool, solid_after: bool) -> Option<Free> {
    match (solid_before, solid_after) {
        (false, true) => Some(Free::Before),
        (true, false) => Some(Free::After),
        _ => None,
    }
}

/// Joins neighbours of one kind: from, to and kind of every run.
fn joined(
    count: usize,
    kind: impl Fn(usize) -> Option<Free>,
) -> impl Iterator<Item = (usize, usize, Free)> {
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
