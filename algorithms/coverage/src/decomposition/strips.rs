//! Strips of equal free area, one for each robot of a team.

use geometry::shape::Aabb;
use nalgebra::Point2;

use super::{Decomposition, DecompositionError, area};
use crate::workplace::Workplace;

/// Number of halvings that find a line to the last digit.
const HALVINGS: usize = 60;

/// A robot of a team that divides a workplace.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Its start (m), which decides the order of the robots.
    pub start: Point2<f64>,
    /// Its position (m).
    pub here: Point2<f64>,
}

impl Decomposition {
    /// The same for one robot of a team, by its number `own` in the team, and the number of its part:
    /// the component in which it is, in strips of equal area across the longer side, one for each
    /// robot there, in the order of their starts. Rectangles end at the lines between strips.
    ///
    /// # Errors
    /// [`DecompositionError`] if the borders are too many.
    pub fn divided(
        self,
        workplace: &Workplace,
        team: &[Place],
        own: usize,
    ) -> Result<(Self, usize), DecompositionError> {
        let component = |place: &Place| {
            let (nearest, _) = self.nearest_rectangle(place.here)?;
            self.component_of(nearest)
        };
        let home = team.get(own).and_then(component);
        let mut order: Vec<(usize, &Place)> = team.iter().enumerate().collect();
        order.retain(|(_, place)| home.is_some() && component(place) == home);
        let rectangles = home.into_iter().flat_map(|home| self.component(home));
        let rectangles: Vec<Aabb> = rectangles.map(|r| self.rectangles[r]).collect();
        if order.len() < 2 {
            return Ok((self, 0));
        }
        let low = rectangles
            .iter()
            .fold(Point2::from([f64::MAX; 2]), |low, r| low.inf(&r.min));
        let high = rectangles
            .iter()
            .fold(Point2::from([f64::MIN; 2]), |high, r| high.sup(&r.max));
        let axis = usize::from(high.y - low.y > high.x - low.x);
        order.sort_by(|(_, a), (_, b)| a.start[axis].total_cmp(&b.start[axis]));
        let part = order.iter().position(|&(number, _)| number == own);
        let part = part.unwrap_or(0);
        let share = rectangles.iter().map(area).sum::<f64>() / order.len() as f64;
        let cuts = (1..order.len()).map(|number| {
            cut(
                &rectangles,
                axis,
                [low[axis], high[axis]],
                share * number as f64,
            )
        });
        let cuts: Vec<f64> = cuts.collect();
        Ok((Self::in_strips(workplace, axis, &cuts, part)?, part))
    }
}

/// The line across an axis (m), within these limits, below which rectangles have this area (m²).
fn cut(rectangles: &[Aabb], axis: usize, [mut low, mut high]: [f64; 2], share: f64) -> f64 {
    for _ in 0..HALVINGS {
        let line = 0.5 * (low + high);
        let parts = rectangles.iter().map(|r| {
            let length = line.clamp(r.min[axis], r.max[axis]) - r.min[axis];
            length * (r.max - r.min)[1 - axis]
        });
        if parts.sum::<f64>() < share {
            low = line;
        } else {
            high = line;
        }
    }
    high
}
