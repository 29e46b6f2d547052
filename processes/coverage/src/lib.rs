//! Coverage of a workplace with obstacles by sub-goals.
//!
//! After the Chebyshev coverage paper (Li et al., *A chaotic coverage path planner for the mobile
//! robot based on the Chebyshev map for special missions*, FITEE 18(9), 2017), with what its
//! printed algorithm lacks:
//!
//! 1. [`workplace`]: a rectangle with obstacles of any shape, as rectangles grown by the robot's
//!    radius;
//! 2. [`decomposition`]: its free space as disjoint rectangles, and the bridges between them;
//! 3. [`tour`]: the order in which a large loop visits the rectangles;
//! 4. [`plan`]: sub-goals drawn from a source of points, rectangle after rectangle, with transits
//!    that stay in convex free rectangles ([`transit`]);
//! 5. [`legs`]: the way between sub-goals, straight with stops or rounded by arcs.
//!
//! Planners of sub-goals of any kind have the one interface [`goal::GoalSource`].

pub mod decomposition;
pub mod goal;
pub mod legs;
pub mod plan;
pub mod tour;
pub mod transit;
pub mod workplace;
