//! Declarations as tables of a reference in Markdown: a section per type, a row per key.

use std::collections::BTreeMap;

use schemars::generate::SchemaSettings;
use schemars::{Schema, SchemaGenerator};
use serde_json::Value;

use parameters::plain_text;

use super::table::Table;
use super::types::{Types, referred};
use super::words::is_table;

/// Tables of parameters in Markdown, written from their declarations.
///
/// A type with its own section is linked from all its other occurrences. A table with several
/// occurrences and no section gets one at the end.
#[derive(Debug)]
pub struct Reference {
    generator: SchemaGenerator,
    /// Generates schemas whose `required` lists all fields, in the order of declaration.
    order: SchemaGenerator,
    sections: Vec<Section>,
}

#[derive(Debug)]
struct Section {
    heading: String,
    text: String,
    /// Name of the type.
    name: String,
}

impl Default for Reference {
    fn default() -> Self {
        let settings = SchemaSettings::draft2020_12();
        Self {
            generator: settings.clone().into_generator(),
            order: settings.for_serialize().into_generator(),
            sections: Vec::new(),
        }
    }
}

/// Function that generates the schema of a type.
type SchemaOf = fn(&mut SchemaGenerator) -> Schema;

impl Reference {
    /// Returns the sections as Markdown, each with a heading and the type of the schema that a function generates.
    pub fn of(sections: &[(&str, SchemaOf)]) -> String {
        let mut reference = Self::default();
        for (heading, schema) in sections {
            reference.add(heading, "", schema);
        }
        reference.markdown()
    }

    /// Adds a section about the type of the schema that a function generates; without a text, it has the description of
    /// the type.
    pub fn add(
        &mut self,
        heading: &str,
        text: &str,
        schema: impl Fn(&mut SchemaGenerator) -> Schema,
    ) {
        schema(&mut self.order);
        let made = schema(&mut self.generator).to_value();
        self.sections.push(Section {
            heading: heading.to_owned(),
            text: text.to_owned(),
            name: referred(&made).unwrap_or_default().to_owned(),
        });
    }

    /// The sections as Markdown.
    pub fn markdown(&self) -> String {
        let types = Types {
            read: self.generator.definitions(),
            order: self.order.definitions(),
        };
        let mut sections: Vec<(String, String, &str)> = Vec::new();
        for section in &self.sections {
            let (heading, text) = (section.heading.clone(), section.text.clone());
            sections.push((heading, text, &section.name));
        }
        for (name, heading) in shared(&types, &self.sections) {
            sections.push((heading, String::new(), name));
        }
        let links: BTreeMap<&str, &str> = sections
            .iter()
            .map(|(heading, _, name)| (*name, heading.as_str()))
            .collect();
        let mut markdown = String::new();
        for (heading, text, name) in &sections {
            let schema = types.read.get(*name).unwrap_or(&Value::Null);
            let own = schema.get("description").and_then(Value::as_str);
            let text = match text.as_str() {
                "" => plain_text(own.unwrap_or_default()),
                text => text.to_owned(),
            };
            let table = Table::for_type(&types, &links, name);
            markdown.push_str(&format!("\n## {heading}\n\n{text}\n\n{table}"));
        }
        markdown
    }
}

/// The tables without a section that occur several times, with a heading for each: the key of the
/// first occurrence, or the type's name if it occurs in lists only.
fn shared<'a>(types: &Types<'a>, sections: &[Section]) -> Vec<(&'a str, String)> {
    let mut places: Vec<Place<'a>> = Vec::new();
    let mut seen: Vec<&str> = Vec::new();
    let mut ahead: Vec<&str> = sections.iter().rev().map(|s| s.name.as_str()).collect();
    while let Some(name) = ahead.pop() {
        if seen.contains(&name) {
            continue;
        }
        seen.push(name);
        let Some((_, schema)) = types.read.get_key_value(name) else {
            continue;
        };
        let before = places.len();
        find_places(schema, None, &mut places);
        ahead.extend(places[before..].iter().rev().map(|place| place.name));
    }
    let mut shared: Vec<(&str, String)> = Vec::new();
    for Place { name, .. } in &places {
        let of_type: Vec<&Place<'_>> = places.iter().filter(|p| p.name == *name).collect();
        let has_section = sections.iter().any(|section| section.name == *name);
        let is_known = shared.iter().any(|(known, _)| known == name);
        let Some(schema) = types.read.get(*name) else {
            continue;
        };
        if of_type.len() < 2 || has_section || is_known || !is_table(types, schema) {
            continue;
        }
        let key = of_type.iter().find_map(|place| place.key);
        let heading = key.map_or_else(|| format!("`{name}`"), |key| format!("`{key}`"));
        let is_taken = shared.iter().any(|(_, taken)| *taken == heading);
        let heading = if is_taken {
            format!("{heading} ({name})")
        } else {
            heading
        };
        shared.push((name, heading));
    }
    shared
}

/// An occurrence of a named type.
struct Place<'a> {
    name: &'a str,
    /// The key that contains it, unless it is an element of a list.
    key: Option<&'a str>,
}

fn find_places<'a>(schema: &'a Value, key: Option<&'a str>, places: &mut Vec<Place<'a>>) {
    if let Some(name) = referred(schema) {
        places.push(Place { name, key });
    }
    match schema {
        Value::Object(object) => {
            for (keyword, value) in object {
                match (keyword.as_str(), value) {
                    ("properties", Value::Object(properties)) => {
                        for (key, schema) in properties {
                            find_places(schema, Some(key), places);
                        }
                    }
                    ("items", _) => find_places(value, None, places),
                    ("default", _) => {}
                    _ => find_places(value, key, places),
                }
            }
        }
        Value::Array(schemas) => {
            for schema in schemas {
                find_places(schema, key, places);
            }
        }
        _ => {}
    }
}
