//! The curves among which the methods search for the fastest: a position for every τ of [0, 1], as a
//! function of some variables.
//!
//! - `motion_camouflage`: a B-spline, alone or in front of a reference point (methods `bspline` and `vmc`).
//! - `local_pursuit`: a curve that pursues a prey on a B-spline (method `lp`).
//!
//! The boundary conditions are eliminated (paper, step 3 of §3.1 and Eq. 13–14): for all variables, the
//! curve begins at the start and ends at the goal, with the prescribed headings, as long as its speeds
//! there ([`Curve::start_speed`]) are positive.

pub mod bspline_basis;
pub mod lgl_nodes;
mod local_pursuit;
mod motion_camouflage;

pub use local_pursuit::{PURSUIT_RATE, Pursuit};
pub use motion_camouflage::{Camouflage, Spline};

use nalgebra::Vector2;

/// Boundary conditions of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ends {
    /// Start position.
    pub start: Vector2<f64>,
    /// Goal position.
    pub goal: Vector2<f64>,
    /// Unit vector of the heading at the start; `None`: any.
    pub start_heading: Option<Vector2<f64>>,
    /// Unit vector of the heading at the goal; `None`: any.
    pub goal_heading: Option<Vector2<f64>>,
}

/// A position or derivative of a curve, with its derivatives by the variables.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Row {
    /// The value.
    pub value: Vector2<f64>,
    /// Its derivatives with respect to the variables that it depends on.
    pub terms: Vec<(usize, Vector2<f64>)>,
}

impl Row {
    /// Resets value and terms.
    pub fn clear(&mut self) {
        self.value = Vector2::zeros();
        self.terms.clear();
    }

    /// The part of the linearisation at `z` that does not depend on the variables.
    pub fn constant(&self, z: &[f64]) -> Vector2<f64> {
        let moved = self.terms.iter().map(|&(var, term)| term * z[var]);
        self.value - moved.sum::<Vector2<f64>>()
    }
}

/// Position, velocity and acceleration (with respect to τ) at τ.
pub type Trace<'a> = Box<dyn Fn(f64) -> [Vector2<f64>; 3] + 'a>;

/// A family of curves.
pub trait Curve {
    /// Number of variables.
    fn variables(&self) -> usize;

    /// Degree of the polynomials between the breaks.
    fn degree(&self) -> usize;

    /// Returns `true` if positions are linear in the variables.
    fn is_linear(&self) -> bool;

    /// Position (order 0) or velocity (order 1) at τ, linearised at the variables `z`.
    fn row(&self, at: f64, order: usize, z: &[f64], row: &mut Row);

    /// The curve of the variables `z`, for evaluation at many points.
    fn trace(&self, z: &[f64]) -> Trace<'_>;

    /// The boundary conditions.
    fn ends(&self) -> &Ends;

    /// The variable of the speed at the start in the prescribed direction, if there is one: the first of
    /// all.
    fn start_speed(&self) -> Option<usize> {
        self.ends().start_heading.map(|_| 0)
    }

    /// The variable of the speed at the goal in the prescribed direction, if there is one: the next.
    fn goal_speed(&self) -> Option<usize> {
        let before = usize::from(self.ends().start_heading.is_some());
        self.ends().goal_heading.map(|_| before)
    }

    /// The parameters between which the curve is smooth, including 0 and 1.
    fn breaks(&self) -> &[f64];

    /// Number of control points.
    fn control_points(&self) -> usize;

    /// Costs of single variables for the diagonal of the Hessian: (variable, weight).
    fn own_costs(&self) -> Vec<(usize, f64)> {
        Vec::new()
    }

    /// Maximum change of a variable in one step; infinite where the curve is linear in it.
    fn step_bounds(&self) -> Vec<(usize, f64)> {
        Vec::new()
    }
}
