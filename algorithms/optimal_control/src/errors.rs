//! Errors of the first-order conditions.

/// Errors of the first-order conditions at an iterate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errors {
    /// Largest error of stationarity or of a constraint.
    most: f64,
    /// Smallest and largest product of a slack and its multiplier.
    products: [f64; 2],
    /// Sum of the violations of the constraints.
    pub violation: f64,
}

impl Errors {
    /// The errors of no condition.
    pub fn none() -> Self {
        Self {
            most: 0.0,
            products: [f64::INFINITY, 0.0],
            violation: 0.0,
        }
    }

    /// Largest error of the conditions of the barrier's problem; of the problem itself for 0.
    pub fn residual(&self, barrier: f64) -> f64 {
        let [least, most] = self.products;
        // The violation is no number if any constraint is none, which a maximum would not show.
        if self.violation.is_finite() {
            self.most.max(most - barrier).max(barrier - least)
        } else {
            f64::INFINITY
        }
    }

    /// Adds an element of the Lagrangian's gradient.
    pub fn add_gradient(&mut self, error: f64) {
        self.most = self.most.max(error.abs());
    }

    /// Adds the violation of a constraint.
    pub fn add_constraint(&mut self, error: f64) {
        self.most = self.most.max(error.abs());
        self.violation += error.abs();
    }

    /// Adds the product of a slack and its multiplier.
    pub fn add_product(&mut self, product: f64) {
        let [least, most] = self.products;
        self.products = [least.min(product), most.max(product)];
    }
}
