//! Independent uniform sub-goals: unpredictable, and without memory of the covered area.

#[cfg(test)]
mod tests;

use nalgebra::Point2;

use crate::goal::Goal;
use crate::space::point_in;
use crate::wander::{Rule, Wander, Wanderer};

/// Sub-goals uniform over the reachable free space, from a `ChaCha20` stream. Legs are straight
/// without an obstacle, else through free rectangles.
pub type UniformGoals = Wanderer<Uniformly>;

/// The rule: any point, regardless of obstacles.
#[derive(Debug, Clone)]
pub struct Uniformly;

impl Rule for Uniformly {
    fn choose(wander: &mut Wander, from: Point2<f64>) -> Option<Goal> {
        let (rectangle, to) = draw(wander)?;
        if wander.space.is_clear(from, to) {
            return Some(wander.sub_goal(to, None));
        }
        wander.set_out(from, rectangle, to)
    }
}

/// A uniform point of the free space and its rectangle.
fn draw(wander: &mut Wander) -> Option<(usize, Point2<f64>)> {
    let all = wander.space.decomposition();
    let members = wander.space.members();
    let total: f64 = members.iter().map(|&r| all.area_of(r)).sum();
    let mut left = wander.draws.unit() * total;
    let mut chosen = *members.last()?;
    for &rectangle in members {
        left -= all.area_of(rectangle);
        if left < 0.0 {
            chosen = rectangle;
            break;
        }
    }
    let unit = [wander.draws.unit(), wander.draws.unit()];
    Some((chosen, point_in(all.rectangles().get(chosen)?, unit)))
}
