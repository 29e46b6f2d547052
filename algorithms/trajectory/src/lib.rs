//! Minimum-time trajectories of a differential-drive robot among obstacles.
//!
//! The problem is that of Y. Xu, *Performance Analysis of the Enhanced Bio-Inspired Planning Algorithm
//! for Rapid Situation Awareness Response* (AFRL-RV-PS-TR-2013-0106, 2013): from a pose to a position
//! in the shortest time, with limited forward speed V and turning rate ω, at a minimum distance of the
//! robot's centre from obstacles. Beyond the paper: convex polygons besides discs, wheels that couple V
//! and ω, limited accelerations, prescribed speeds and headings at both ends.
//!
//! **Approach.** Turning is quick compared to driving, so without inertia the problem is geometric: the
//! exact shortest path ([`navigation::tangent_graph`]) at full speed is a lower bound
//! ([`lower_bound()`]) and selects the corridor. A few convex programs (`convex`) find a smooth curve
//! of the method's family ([`curves`]) in it; it is sampled densely (`drive::sample_curve`) and driven
//! as fast as its curvature and the limits allow (`drive::speed_profile`). Where the robot turns slowly
//! or has inertia, the bound is loose and the path itself changes: `controls` searches for local optima
//! in the controls. Every result passes the [`trajectory_check`], which shares no code with this crate. If no smooth trajectory
//! passes, the result is the shortest path itself, with turns on the spot
//! (`drive::shortest_path_plan`).
//!
//! **Methods** ([`Method`]): `bspline` (recommended), `lp` and `vmc` (the paper's parametrisations,
//! exact in their equations but with obstacles tested everywhere and not only at nodes), and `tangent`.
//!
//! Errors of the paper, corrected: Eq. 4 divides by cos θ (here: the velocity's length and angle); Eq.
//! 5 lacks dots (curvature is (ẋÿ − ẏẍ) / V³); the pseudo-inverse of Eq. 14 gives up the initial
//! velocity (here all conditions at the ends are eliminated exactly); trajectories that avoid obstacles
//! at the nodes only hit them between nodes ([`trajectory_problem::Constraints::Nodes`] shows it).
//!
//! All functions are pure: no clock, no randomness. The same problem, options and last plan give the
//! same plan, bit for bit, unless `stop` ends the search early.
//!
//! ```
//! use nalgebra::Point2;
//! use trajectory::{Options, Problem, RobotLimits, plan};
//! use geometry::pose::Pose2;
//! use geometry::shape::{Aabb, Convex};
//!
//! let problem = Problem {
//!     start: Pose2::new(0.5, 1.0, 0.6),
//!     start_speed: None,
//!     start_turn_rate: None,
//!     goal: Point2::new(3.5, 1.0),
//!     goal_heading: None,
//!     goal_speed: None,
//!     limits: RobotLimits::simple(0.15, 16.0),
//!     obstacles: vec![Convex::disc(Point2::new(2.0, 1.0), 0.2)],
//!     clearance: 0.1,
//!     bounds: Aabb { min: Point2::new(0.0, 0.0), max: Point2::new(4.0, 2.0) },
//!     start_tolerance: 0.005,
//! };
//! let plan = plan(&problem, &Options::default(), None, &mut || false).unwrap();
//! assert!(plan.gap() < 1e-3);
//! assert!(plan.min_clearance > -1e-3);
//! ```

mod attempt;
mod backwards;
mod controls;
mod convex;
mod corridors;
mod course;
mod curve_plan;
mod drive;
mod guesses;
mod guide;
mod lower_bound;
pub mod obstacle_field;
mod path_points;
pub mod plan;
mod solve;
pub mod validity_check;

pub use lower_bound::lower_bound;
pub use plan::{Basis, Plan, PlanError, Sample, Status};
pub use solve::plan;
pub use trajectory_problem::{Method, Options, Problem, ProblemError, RobotLimits, Wheels};
