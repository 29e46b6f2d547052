//! The curves among which the methods look for the fastest: a position for every τ of [0, 1], as a
//! function of some variables.
//!
//! - `motion_camouflage`: a B-spline, alone or hiding before a reference point ([`crate::Method::Bspline`],
//!   [`crate::Method::Vmc`]).
//! - `local_pursuit`: what pursues a prey on a B-spline ([`crate::Method::Lp`]).
//!
//! The boundary conditions are eliminated (paper, step 3 of §3.1 and Eq. 13–14): whatever the
//! variables are, the curve begins at the start and ends at the goal, and begins and ends in the
//! headings asked for, as long as its speeds there ([`Curve::start_speed`]) are positive.

pub mod bspline_basis;
pub mod knot_placement;
pub mod lgl_nodes;
mod local_pursuit;
mod motion_camouflage;

pub use local_pursuit::{PURSUIT_RATE, Pursuit};
pub use motion_camouflage::{Camouflage, Spline};

use nalgebra::Vector2;

/// What a curve must begin and end with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ends {
    /// Where it begins.
    pub start: Vector2<f64>,
    /// Where it ends.
    pub goal: Vector2<f64>,
    /// Unit vector in which it begins; `None`: any.
    pub start_heading: Option<Vector2<f64>>,
    /// Unit vector in which it ends; `None`: any.
    pub goal_heading: Option<Vector2<f64>>,
}

/// A position or derivative of a curve, and how it changes with the variables.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Row {
    /// The value.
    pub value: Vector2<f64>,
    /// Its derivatives with respect to the variables that it depends on.
    pub terms: Vec<(usize, Vector2<f64>)>,
}

impl Row {
    /// Forgets everything.
    pub fn clear(&mut self) {
        self.value = Vector2::zeros();
        self.terms.clear();
    }

    /// The linearisation's part that does not depend on the variables, at `z`.
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

    /// The curve that the variables `z` stand for, for looking at many of its points.
    fn trace(&self, z: &[f64]) -> Trace<'_>;

    /// What it begins and ends with.
    fn ends(&self) -> &Ends;

    /// The variable that is the speed at the start in the direction asked for, if there is one: the
    /// first of all.
    fn start_speed(&self) -> Option<usize> {
        self.ends().start_heading.map(|_| 0)
    }

    /// The variable that is the speed at the goal in the direction asked for, if there is one: the
    /// next.
    fn goal_speed(&self) -> Option<usize> {
        let before = usize::from(self.ends().start_heading.is_some());
        self.ends().goal_heading.map(|_| before)
    }

    /// The places between which the curve is smooth, with 0 and 1.
    fn breaks(&self) -> &[f64];

    /// How many points control it.
    fn control_points(&self) -> usize;

    /// Adds to the Hessian what a variable's own cost is, row by row: (variable, weight).
    fn own_costs(&self) -> Vec<(usize, f64)> {
        Vec::new()
    }

    /// Largest change of a variable in one step; infinite where the curve is linear in it.
    fn step_bounds(&self) -> Vec<(usize, f64)> {
        Vec::new()
    }
}
