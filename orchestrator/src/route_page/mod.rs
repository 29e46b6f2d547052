//! The page that sets patrols and coverage beside the published results: `docs/patrol-results.md`.
//!
//! The published ones are those of the cat-map patrol paper (Fig. 6, 10 and 12, and the numbers of
//! its second case) and of the Chebyshev coverage paper (Table 1). [`page`] is a pure function of
//! the [`Evidence`].

mod alpha;
mod coverage;
mod evidence;
mod sequences;
mod square;
mod text;

#[cfg(test)]
mod tests;

pub use evidence::{Evidence, Study};
pub use text::page;
