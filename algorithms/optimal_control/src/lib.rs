//! Minimum-time controls of a differential-drive robot among obstacles, as a local optimum.
//!
//! **Problem.** Poses, speeds and the duration T of a motion in N stages of equal time (direct
//! multiple shooting). With limited accelerations both speeds change linearly in a stage; without,
//! they are constant in a stage and step between stages. All limits of speeds, wheels and
//! accelerations are linear in the variables and hold exactly, also between nodes. Obstacles are kept
//! away from the nodes; the caller tests the path between them and lets an obstacle grow
//! ([`Search::grow`]) where it is touched.
//!
//! **Method.** A primal–dual interior-point method on the non-linear problem itself
//! (`interior_point`): second derivatives are exact, the linear system of a step is solved stage by
//! stage (`riccati`), and a filter decides how far to go (`line_search`). The sizes of states and
//! controls are known at compile time; an iteration allocates no memory. A few stages are solved first, then
//! twice as many from there (`Search`).
//!
//! All functions are pure: no clock, no randomness.
//!
//! ```
//! use geometry::shape::{Aabb, Convex};
//! use nalgebra::Point2;
//! use optimal_control::{KeepOutDisc, Node, Problem, Search};
//! use trajectory_problem::RobotLimits;
//!
//! let disc = Convex::disc(Point2::new(1.0, 0.1), 0.2);
//! let problem = Problem {
//!     start: Point2::origin(),
//!     start_heading: 0.0,
//!     start_speeds: [Some(0.0), Some(0.0)],
//!     goal: Point2::new(2.0, 0.0),
//!     goal_heading: None,
//!     goal_speed: Some(0.0),
//!     limits: RobotLimits {
//!         acceleration: Some(0.5),
//!         angular_acceleration: Some(2.0),
//!         ..RobotLimits::simple(0.5, 1.0).forwards()
//!     },
//!     bounds: Aabb { min: Point2::new(-1.0, -1.0), max: Point2::new(3.0, 1.0) },
//!     obstacles: vec![KeepOutDisc { shape: &disc, distance: 0.1 }],
//! };
//! // The guess need not keep any limit.
//! let node = |part: f64| Node { at: Point2::new(2.0 * part, -0.3), theta: 0.0, v: 0.4, omega: 0.0 };
//! let guess: Vec<Node> = (0..=40).map(|k| node(f64::from(k) / 40.0)).collect();
//! let mut search = Search::new(&problem, &guess, 5.0).unwrap();
//! let outcome = search.run(&mut |_| false);
//! assert!(outcome.is_optimal());
//! let solution = search.solution();
//! assert!(solution.duration > 5.0 && solution.duration < 5.5);
//! ```

mod errors;
mod interior_point;
mod iterate;
mod line_search;
mod motion;
mod newton;
mod problem;
mod restoration;
mod riccati;
mod rows;
mod scaled;
mod search;
mod sincos;
mod variables;

pub use interior_point::Outcome;
pub use problem::{KeepOutDisc, Node, Problem};
pub use search::{COARSE, MAX_STAGES, Search, Solution};
