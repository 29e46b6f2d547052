//! Markdown templates: text with slots for numbers and tables.
//!
//! `{{name}}` is a slot. The lines between a line `{{#name}}` and a line `{{/name}}` are a block:
//! kept if its results exist, else replaced by a sentence that there are none.

use std::collections::{BTreeMap, BTreeSet};

/// The first line of every page.
const MARK: &str =
    "<!-- Written by `protean reproduce` from results; edits belong into its templates. -->\n\n";
/// The text in place of a block without results.
const NO_RESULTS: &str = "*No results of this experiment.*";

/// Mismatch of template and values.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum TemplateError {
    /// A slot without a value.
    #[error("the template has a slot `{0}`, for which there is no value")]
    NoValue(String),
    /// A value without a slot.
    #[error("there is a value `{0}`, for which the template has no slot")]
    NoSlot(String),
    /// A slot or block without an end.
    #[error("`{0}` has no end in the template")]
    Open(String),
}

/// The values of a template.
#[derive(Debug, Default)]
pub struct Values {
    blocks: BTreeSet<String>,
    slots: BTreeMap<String, String>,
}

impl Values {
    /// Keeps a block.
    pub fn keep(&mut self, block: &str) {
        self.blocks.insert(block.to_owned());
    }

    /// Sets the value of a slot, without trailing line breaks.
    pub fn set(&mut self, slot: impl Into<String>, value: impl AsRef<str>) {
        let value = value.as_ref().trim_end().to_owned();
        self.slots.insert(slot.into(), value);
    }

    /// Fills the template with these values.
    ///
    /// # Errors
    /// [`TemplateError`] if a slot has no value, or a value no slot.
    pub fn fill(&self, template: &str) -> Result<String, TemplateError> {
        let mut text = MARK.to_owned();
        let mut used = BTreeSet::new();
        // Current block without results, which is left out.
        let mut left_out: Option<String> = None;
        for line in template.lines() {
            let directive = |sign: &str| {
                let name = line.strip_prefix("{{")?.strip_prefix(sign)?;
                name.strip_suffix("}}").map(str::to_owned)
            };
            if let Some(name) = directive("/") {
                left_out = left_out.filter(|block| *block != name);
            } else if left_out.is_none() {
                if let Some(name) = directive("#") {
                    if !self.blocks.contains(&name) {
                        text += NO_RESULTS;
                        text.push('\n');
                        left_out = Some(name);
                    }
                } else {
                    self.fill_line(line, &mut text, &mut used)?;
                    text.push('\n');
                }
            }
        }
        if let Some(name) = left_out {
            return Err(TemplateError::Open(name));
        }
        match self.slots.keys().find(|name| !used.contains(name.as_str())) {
            Some(name) => Err(TemplateError::NoSlot(name.clone())),
            None => Ok(text),
        }
    }

    fn fill_line<'t>(
        &self,
        line: &'t str,
        text: &mut String,
        used: &mut BTreeSet<&'t str>,
    ) -> Result<(), TemplateError> {
        let mut rest = line;
        while let Some((before, slot)) = rest.split_once("{{") {
            let (name, after) = slot
                .split_once("}}")
                .ok_or_else(|| TemplateError::Open(line.to_owned()))?;
            let value = self.slots.get(name);
            *text += before;
            *text += value.ok_or_else(|| TemplateError::NoValue(name.to_owned()))?;
            used.insert(name);
            rest = after;
        }
        *text += rest;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEMPLATE: &str = "a {{x}} b {{y}}\n{{#t}}\n| {{z}} |\n{{/t}}\nend\n";

    fn filled(blocks: &[&str], slots: &[&str]) -> Result<String, TemplateError> {
        let mut values = Values::default();
        for block in blocks {
            values.keep(block);
        }
        for slot in slots {
            values.set(*slot, format!("<{slot}>\n\n"));
        }
        values.fill(TEMPLATE)
    }

    #[test]
    fn slots_are_filled_and_blocks_with_results_are_kept() {
        let text = filled(&["t"], &["x", "y", "z"]).unwrap();
        assert_eq!(text, format!("{MARK}a <x> b <y>\n| <z> |\nend\n"));
        let text = filled(&[], &["x", "y"]).unwrap();
        assert_eq!(text, format!("{MARK}a <x> b <y>\n{NO_RESULTS}\nend\n"));
    }

    #[test]
    fn slots_and_values_that_do_not_fit_are_named() {
        let no_value = TemplateError::NoValue("y".to_owned());
        assert_eq!(filled(&[], &["x"]), Err(no_value));
        let no_slot = TemplateError::NoSlot("z".to_owned());
        assert_eq!(filled(&[], &["x", "y", "z"]), Err(no_slot));
    }

    #[test]
    fn the_pages_of_the_documentation_are_those_of_the_templates() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        for name in ["chase.md", "vmc-lp.md", "patrol.md"] {
            let read = |path: &str| std::fs::read_to_string(root.join(path)).unwrap();
            let page = read(&format!("../../docs/results/{name}"));
            assert!(page.starts_with(MARK));
            let template = read(&format!("templates/{name}"));
            for line in template.lines().filter(|line| !line.contains("{{")) {
                assert!(page.lines().any(|l| l == line), "{line}");
            }
        }
    }
}
