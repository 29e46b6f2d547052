//! Coverage of a workplace with obstacles by sub-goals.
//!
//! After the Chebyshev coverage paper (Li et al., *A chaotic coverage path planner for the mobile
//! robot based on the Chebyshev map for special missions*, FITEE 18(9), 2017), with the parts that its
//! printed algorithm lacks:
//!
//! 1. [`workplace`]: a rectangle with obstacles of any shape, as rectangles grown by the robot's
//!    radius;
//! 2. [`decomposition`]: its free space as disjoint rectangles, and the bridges between them;
//! 3. [`tour`]: the order in which a large loop visits the rectangles;
//! 4. [`plan`]: sub-goals drawn from a source of points, rectangle after rectangle, with transits
//!    that stay in convex free rectangles ([`transit`]);
//! 5. [`legs`]: the path between sub-goals, straight with stops or rounded by arcs.
//!
//! All planners of sub-goals have the interface [`goal::GoalSource`]. Besides the plan of the paper:
//!
//! - [`keyed`]: fast, and hard to predict for an observer that knows the method but not the key;
//! - [`boustrophedon`], [`random_bounce`], [`uniform`]: baselines, from the most efficient to the
//!   least predictable.
//!
//! [`sub_goals`] contains the common parts of all planners of sub-goals: their site, their parameters,
//! their drivers.
//!
//! They move in a [`space::Space`]; the remaining area is a [`freshness::Freshness`]; planners that
//! draw their sub-goals one by one share [`wander`].
//!
//! ```
//! use coverage::boustrophedon::Boustrophedon;
//! use coverage::decomposition::Decomposition;
//! use coverage::goal::GoalSource as _;
//! use coverage::workplace::Workplace;
//! use geometry::shape::Aabb;
//! use nalgebra::Point2;
//!
//! // 2 m × 1 m without obstacles, for a robot of radius 0.1 m.
//! let bounds = Aabb {
//!     min: Point2::origin(),
//!     max: Point2::new(2.0, 1.0),
//! };
//! let workplace = Workplace::new(bounds, 0.1, &[], 0.01)?;
//! let rectangles = Decomposition::new(&workplace)?;
//! let mut at = Point2::new(0.1, 0.1);
//! let mut planner = Boustrophedon::new(&workplace, &rectangles, at, 0.1)?;
//! let mut length = 0.0;
//! while let Some(goal) = planner.next_goal(at) {
//!     length += (goal.waypoint.point - at).norm();
//!     at = goal.waypoint.point;
//! }
//! assert!(length > 8.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod boustrophedon;
mod counter;
pub mod decomposition;
mod draws;
pub mod freshness;
pub mod goal;
pub mod keyed;
pub mod legs;
pub mod plan;
pub mod random_bounce;
pub mod space;
pub mod sub_goals;
#[cfg(test)]
mod testing;
pub mod tour;
pub mod transit;
pub mod uniform;
pub mod wander;
pub mod workplace;
