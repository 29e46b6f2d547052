//! XML that takes a parser much time.

use std::path::Path;

use super::super::{ImportError, osm, xml};

fn attributes(count: usize) -> String {
    let attributes: Vec<String> = (0..count).map(|i| format!(" a{i}='>'")).collect();
    attributes.concat()
}

#[test]
fn an_element_with_too_many_attributes_is_refused_with_its_line() {
    for (count, is_valid) in [(256, true), (257, false), (200_000, false)] {
        let text = format!("<osm>\n<node{}/></osm>", attributes(count));
        let found = xml::parse(Path::new("a.osm"), &text);
        match found {
            Ok(_) => assert!(is_valid, "{count}"),
            Err(error) => {
                let error = error.to_string();
                assert!(
                    !is_valid && error.contains("a.osm, line 2: \"node a0='>'"),
                    "{error}"
                );
                assert!(error.contains("at most 256 attributes"), "{error}");
            }
        }
    }
    // Quotes outside of tags are text.
    let quotes = "\"' ".repeat(1000);
    let text = format!(
        "<osm>{quotes}<!-- {quotes} --><a b='{}'/>{quotes}</osm>",
        "\"".repeat(999)
    );
    assert!(xml::parse(Path::new("a.osm"), &text).is_ok());
}

#[test]
fn nested_declarations_of_namespaces_are_limited() {
    let nested: Vec<String> = (0..4000)
        .map(|i| format!("<osm xmlns:n{i}='u{i}'>"))
        .collect();
    let error = osm::streets(Path::new("a.osm"), &nested.concat()).unwrap_err();
    assert!(matches!(error, ImportError::Content { .. }), "{error}");
}
