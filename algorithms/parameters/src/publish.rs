//! Schemas for editors: plain-text descriptions with range and unit.

use schemars::Schema;
use schemars::generate::{SchemaGenerator, SchemaSettings};
use schemars::transform::{RecursiveTransform, Transform};
use serde_json::Value;

use crate::range::{Kind, Range};

/// A generator of schemas for TOML language servers (draft 7). Apply [`for_people`] to its result.
pub fn schema_generator() -> SchemaGenerator {
    SchemaSettings::draft07().into_generator()
}

/// Converts every description to plain text that ends with range and unit.
pub fn for_people(schema: &mut Schema) {
    RecursiveTransform(describe).transform(schema);
}

fn describe(schema: &mut Schema) {
    let Some(object) = schema.as_object_mut() else {
        return;
    };
    let kind = match object.get("type") {
        Some(Value::String(name)) => number(name),
        Some(Value::Array(names)) => names.iter().filter_map(Value::as_str).find_map(number),
        _ => None,
    };
    let text = object.get("description").and_then(Value::as_str);
    let mut text = plain_text(text.unwrap_or_default());
    let says_more = Range(object).unit().is_some() || !Range(object).short().is_empty();
    if let Some(kind) = kind.filter(|_| says_more) {
        if !text.is_empty() {
            text.push_str("\n\n");
        }
        let range = Range(object).numbers(kind);
        let (first, rest) = range.split_at(1);
        text.push_str(&format!("{}{rest}.", first.to_uppercase()));
    }
    if !text.is_empty() {
        object.insert("description".to_owned(), text.into());
    }
}

fn number(name: &str) -> Option<Kind> {
    match name {
        "number" => Some(Kind::Real),
        "integer" => Some(Kind::Whole),
        _ => None,
    }
}

/// The first paragraph of a doc comment on one line, with links replaced by their text.
pub fn plain_text(doc: &str) -> String {
    let paragraph = doc.split("\n\n").next().unwrap_or_default();
    let line = paragraph.split_whitespace().collect::<Vec<_>>().join(" ");
    let mut text = String::new();
    let mut rest = line.as_str();
    while let Some(start) = rest.find('[') {
        let (before, link) = rest.split_at(start);
        text.push_str(before);
        let Some(end) = link.find(']') else {
            rest = link;
            break;
        };
        let (name, after) = (&link[1..end], &link[end + 1..]);
        let target = after.strip_prefix('(').and_then(|a| a.split_once(')'));
        match target {
            Some((_, after)) => {
                text.push_str(name);
                rest = after;
            }
            None if name.starts_with('`') => {
                let inner = name.trim_matches('`').trim_start_matches("crate::");
                text.push_str(&format!("`{}`", inner.trim_start_matches("Self::")));
                rest = after;
            }
            None => {
                text.push_str(&link[..=end]);
                rest = after;
            }
        }
    }
    text + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_of_doc_comments_become_their_text() {
        assert_eq!(
            plain_text("See [`crate::goals`] and [the\npaper](x.md), in [0, 1].\n\nMore."),
            "See `goals` and the paper, in [0, 1]."
        );
    }
}
