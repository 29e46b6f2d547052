//! The page that sets our chases beside the published ones: `docs/chase-results.md`.
//!
//! The published game is that of I. M. Gomes Ribeiro, J. Fiala and R. Shah, *Multi-robot Navigation
//! in the Context of a Chasing Game*. The page has curves, a table of all cells, the critical speeds,
//! and for each of the paper's claims a test and its verdict. [`page`] is a pure function of the
//! [`Evidence`]: the same results give the same page, byte for byte.

mod claims;
mod critical;
mod curves;
mod evidence;
mod measure;
mod plans;
mod published;
mod read;
mod table;
mod text;
pub(crate) mod words;

#[cfg(test)]
mod tests;

pub use claims::{Claim, Finding, Verdict, claims};
pub use evidence::{Cell, Evidence, Method, Study};
pub use measure::{MeasureError, measure};
pub use plans::{Plan, Plans, PlansError};
pub use read::StudyError;
pub use text::{Image, MARK, Page, page};
