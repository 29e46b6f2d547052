//! The page that compares patrols and coverage with the published results:
//! `docs/results/patrol.md`.
//!
//! The published results are those of the cat-map patrol paper (Fig. 6, 10 and 12, and the numbers
//! of its second case) and of the Chebyshev coverage paper (Table 1).

mod alpha;
mod chebyshev;
mod coverage;
mod evidence;
mod keys;
mod list;
mod sequences;
mod square;

#[cfg(test)]
mod tests;

pub use chebyshev::list as coverage_list;
pub use evidence::Evidence;
pub use keys::LapsError;
pub use list::list;

use self::evidence::{ALPHA, COVERAGE, SQUARE};
use crate::page::{Image, Page};
use crate::template::{TemplateError, Values};
use crate::words::provenance;

const TEMPLATE: &str = include_str!("../../templates/patrol.md");

/// Builds the page.
///
/// # Errors
/// [`TemplateError`] if the template does not match the values.
pub fn page(evidence: &Evidence) -> Result<Page, TemplateError> {
    let mut values = Values::default();
    let mut images = Vec::new();
    let mut origin = String::new();
    for (name, study, rows) in [
        (ALPHA, &evidence.alpha, alpha::rows as fn(&_) -> String),
        (SQUARE, &evidence.square, square::rows),
        (COVERAGE, &evidence.coverage, coverage::rows),
    ] {
        let Some(study) = study else { continue };
        values.keep(name);
        values.set(format!("{name}.rows"), rows(study));
        origin += &provenance(name, &study.seeds, &study.program);
    }
    values.set("sequences", sequences::rows());
    values.set("provenance", origin);
    let mut image = |name, chart| images.push(Image { name, chart });
    if let Some(study) = &evidence.alpha {
        image("patrol-speed", alpha::speed_chart(study));
        image("patrol-mae", alpha::mae_chart(study));
    }
    if let Some(study) = &evidence.coverage {
        image("coverage-by-way", coverage::chart(study));
    }
    let text = values.fill(TEMPLATE)?;
    Ok(Page { text, images })
}
