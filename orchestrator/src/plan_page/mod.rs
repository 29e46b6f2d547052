//! The page that sets our plans beside the published ones: `docs/vmc-lp-results.md`.
//!
//! The published ones are those of Y. Xu's report on motion camouflage and local
//! pursuit: Table 2 (how sensitive the method is to its parameters), Tables 3 and 4 (both methods
//! beside each other). [`page`] is a pure function of the [`Evidence`].

mod evidence;
mod published;
mod sensitivity;
mod text;
mod versus;

#[cfg(test)]
mod tests;

pub use evidence::{Evidence, Study};
pub use text::page;
