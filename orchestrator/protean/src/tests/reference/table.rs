//! The table of one type.

use core::fmt;
use std::collections::BTreeMap;

use parameters::{Range, plain_text};
use serde_json::{Map, Value};

use super::types::Types;
use super::words::{Choice, alternatives, choice_tables, default_of, description, difference};
use super::words::{numbers_of, properties_of, toml, type_name, types};

/// Rows of Markdown.
pub(super) struct Table<'a> {
    types: &'a Types<'a>,
    /// Headings of the types with their own section.
    links: &'a BTreeMap<&'a str, &'a str>,
    rows: String,
}

impl<'a> Table<'a> {
    /// The table of the type with this name.
    pub(super) fn for_type(
        types: &'a Types<'a>,
        links: &'a BTreeMap<&'a str, &'a str>,
        name: &str,
    ) -> Self {
        let mut table = Self {
            types,
            links,
            rows: String::new(),
        };
        if let Some(schema) = types.read.get(name) {
            table.add_keys("", schema, types.order.get(name), None);
            for choice in choice_tables(schema) {
                table.add_choice("", choice, types.order.get(name), true);
            }
        }
        table
    }

    /// Adds the rows of a table's keys in the order of declaration; `defaults` take precedence over
    /// the declared ones.
    fn add_keys(
        &mut self,
        prefix: &str,
        schema: &'a Value,
        order: Option<&'a Value>,
        defaults: Option<&Map<String, Value>>,
    ) {
        let Some(properties) = properties_of(schema) else {
            return;
        };
        let listed = |schema: Option<&'a Value>| {
            let keys = schema.and_then(|schema| schema.get("required")?.as_array());
            let keys = keys.map_or(&[][..], Vec::as_slice).iter();
            keys.filter_map(Value::as_str).collect::<Vec<&str>>()
        };
        let required = listed(Some(schema));
        let mut keys = listed(order);
        keys.retain(|key| properties.contains_key(*key));
        let others = properties.keys().map(String::as_str);
        let others: Vec<&str> = others.filter(|key| !keys.contains(key)).collect();
        keys.extend(others);
        for key in keys {
            let Some(schema) = properties.get(key) else {
                continue;
            };
            let given = defaults.and_then(|defaults| defaults.get(key));
            let default = given.or_else(|| schema.get("default"));
            let order = order.and_then(|order| order.get("properties")?.get(key));
            let is_required = required.contains(&key);
            self.add(
                &format!("{prefix}{key}"),
                schema,
                order,
                default,
                is_required,
            );
        }
    }

    /// Adds the row of a key, and those of its content.
    fn add(
        &mut self,
        key: &str,
        schema: &'a Value,
        order: Option<&'a Value>,
        default: Option<&Value>,
        is_required: bool,
    ) {
        let default = default.filter(|default| !default.is_null());
        let parts = alternatives(self.types, schema);
        let order = |name: Option<&str>| match name {
            Some(name) => self.types.order.get(name),
            None => order,
        };
        // A table that is always present is represented by its keys.
        if let [(name, own)] = parts[..]
            && !self.is_linked(name)
            && properties_of(own).is_some()
            && (default.is_some() || is_required)
        {
            let defaults = default.and_then(Value::as_object);
            self.add_keys(&format!("{key}."), own, order(name), defaults);
            return;
        }
        let mut names = Vec::new();
        let mut inside = Vec::new();
        for &(name, own) in &parts {
            names.push(self.type_text(name, own));
            if !self.is_linked(name) {
                inside.push((key.to_owned(), name, own));
            }
            let is_list = types(own).first() == Some(&"array");
            if let Some(items) = own.get("items").filter(|_| is_list) {
                let (name, own) = self.types.resolve(items);
                if !self.is_linked(name) {
                    inside.push((format!("{key}[]"), name, own));
                }
            }
        }
        let default = match (default, &parts[..]) {
            (Some(Value::Object(given)), [(Some(name), own)]) if self.links.contains_key(name) => {
                // Text that it shares with its section is only there.
                let changes = difference(given, &default_of(own));
                if changes.is_empty() {
                    String::new()
                } else {
                    format!("`{{ {} }}`", changes.join(", "))
                }
            }
            (Some(default), _) => format!("`{}`", toml(default)),
            (None, _) if is_required => "required".to_owned(),
            (None, _) => "–".to_owned(),
        };
        let own = parts.first().map_or(schema, |part| part.1);
        let number = numbers_of(own);
        let range = number.map_or(String::new(), |number| Range(number).short());
        let length = own.as_object().map(|own| Range(own).lengths());
        let ranges = [range, length.unwrap_or_default()];
        let ranges: Vec<String> = ranges.into_iter().filter(|part| !part.is_empty()).collect();
        let unit = number.and_then(|number| Range(number).unit());
        let is_told = |part: &&(Option<&str>, &'a Value)| !self.is_linked(part.0);
        let told = parts.iter().filter(is_told).map(|part| part.1);
        self.row([
            &format!("`{key}`"),
            &names.join(" or "),
            &default,
            &ranges.join("; "),
            unit.unwrap_or_default(),
            &description(schema, told),
        ]);
        for (key, name, own) in inside {
            let prefix = format!("{key}.");
            let order = order(name);
            self.add_keys(&prefix, own, order, None);
            for choice in choice_tables(own) {
                self.add_choice(&prefix, choice, order, false);
            }
        }
    }

    /// Adds the rows of a choice that is a table.
    fn add_choice(
        &mut self,
        prefix: &str,
        choice: Choice<'a>,
        order: Option<&'a Value>,
        with_row: bool,
    ) {
        let key = format!("{prefix}{}", choice.name);
        let (name, own) = self.types.resolve(choice.value);
        let is_linked = self.is_linked(name);
        if with_row || is_linked {
            let type_text = self.type_text(name, own);
            let text = plain_text(choice.text);
            self.row([&format!("`{key}`"), &type_text, "–", "", "", &text]);
        }
        if !is_linked {
            let same = order.and_then(|order| {
                let mut choices = choice_tables(order).into_iter();
                choices.find(|other| other.name == choice.name)
            });
            let order = match name {
                Some(name) => self.types.order.get(name),
                None => same.map(|same| same.value),
            };
            self.add_keys(&format!("{key}."), own, order, None);
        }
    }

    fn row(&mut self, cells: [&str; 6]) {
        let cells = cells.map(|cell| cell.replace('|', "\\|"));
        self.rows.push_str(&format!("| {} |\n", cells.join(" | ")));
    }

    fn is_linked(&self, name: Option<&str>) -> bool {
        name.is_some_and(|name| self.links.contains_key(name))
    }

    /// The name of a type, with a link to its section.
    fn type_text(&self, name: Option<&str>, own: &'a Value) -> String {
        let link = |name: Option<&str>| {
            let heading = self.links.get(name?)?;
            Some(format!("[{heading}](#{})", anchor(heading)))
        };
        if let Some(link) = link(name) {
            return link;
        }
        if types(own).first() == Some(&"array")
            && let Some(link) = own.get("items").and_then(|i| link(self.types.resolve(i).0))
        {
            return format!("list of {link}");
        }
        type_name(self.types, own)
    }
}

impl fmt::Display for Table<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("| key | type | default | range | unit | meaning |\n")?;
        f.write_str("|---|---|---|---|---|---|\n")?;
        f.write_str(&self.rows)
    }
}

/// The URL fragment of a heading.
fn anchor(heading: &str) -> String {
    let kept = |c: &char| c.is_alphanumeric() || matches!(c, '_' | '-' | ' ');
    let text: String = heading.chars().filter(kept).collect();
    text.to_lowercase().replace(' ', "-")
}
