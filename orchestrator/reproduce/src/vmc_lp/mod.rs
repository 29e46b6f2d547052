//! The page that compares our plans with the published ones: `docs/results/vmc-lp.md`.
//!
//! The published plans are those of Y. Xu's report on motion camouflage and local pursuit: Table 2
//! (sensitivity of the method to its parameters), Tables 3 and 4 (comparison of both methods).

mod evidence;
mod list;
mod published;
mod sensitivity;
mod versus;

#[cfg(test)]
mod tests;

pub use evidence::Evidence;
pub use list::list;

use self::evidence::{SENSITIVITY, VERSUS};
use crate::page::{Image, Page};
use crate::template::{TemplateError, Values};
use crate::words::provenance;

const TEMPLATE: &str = include_str!("../../templates/vmc-lp.md");

/// Builds the page.
///
/// # Errors
/// [`TemplateError`] if the template does not match the values.
pub fn page(evidence: &Evidence) -> Result<Page, TemplateError> {
    let mut values = Values::default();
    let mut images = Vec::new();
    let mut origin = String::new();
    if let Some(study) = &evidence.sensitivity {
        values.keep(SENSITIVITY);
        sensitivity::set(study, &mut values);
        images.push(Image {
            name: "vmc-lp-sensitivity",
            chart: sensitivity::chart(study),
        });
        origin += &provenance(SENSITIVITY, &study.seeds, &study.program);
    }
    if let Some(study) = &evidence.versus {
        values.keep(VERSUS);
        versus::set(study, &mut values);
        images.push(Image {
            name: "vmc-lp-cpu",
            chart: versus::chart(study),
        });
        origin += &provenance(VERSUS, &study.seeds, &study.program);
    }
    values.set("provenance", origin);
    let text = values.fill(TEMPLATE)?;
    Ok(Page { text, images })
}
