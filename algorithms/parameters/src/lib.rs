//! Parameters, each declared once: type, default, range, unit and description.
//!
//! A struct of parameters is declared by [`table!`]. The type of a field gives the type of the parameter, the doc comment
//! the description; range and unit are a [`Bounds`] in brackets, and the default follows. An enum of parameters is
//! declared by [`choice!`].
//!
//! ```
//! use parameters::{Parameters, above, at_least, check};
//!
//! parameters::table! {
//!     /// Parameters of an assignment.
//!     struct Assignment {
//!         /// Time between two assignments.
//!         period_s: f64 [above(0.0).unit("s")] = 1.0,
//!         /// Number of robots that are assigned.
//!         robots: usize [at_least(1)] = 4,
//!     }
//! }
//!
//! impl Parameters for Assignment {}
//!
//! let params = Assignment { period_s: 0.0, ..Assignment::default() };
//! assert_eq!(
//!     check(&params).unwrap_err().to_string(),
//!     "`period_s` is 0: expected a finite number above 0 (s)"
//! );
//! ```
//!
//! [`fn@check`] and [`faults`] compare every value with its range, in the order of declaration; only relations
//! between fields are checked by code ([`Parameters::check_relations`]). [`unusual`] finds numbers that are accepted and
//! probably in another unit. [`schema_generator`] writes the same
//! declarations for editors.

mod bounds;
mod check;
mod error;
mod fidelity;
mod publish;
mod range;
mod schema;
mod table;

pub use bounds::{Bounds, above, at_least, between, each, unit};
pub use check::{Parameters, Unusual, check, faults, unusual};
pub use error::{Fault, ParamsError, not_negative, positive, require, within};
pub use fidelity::Fidelity;
pub use publish::{for_people, plain_text, schema_generator};
pub use range::Range;
