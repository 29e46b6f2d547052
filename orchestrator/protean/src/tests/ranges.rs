//! Ranges that the texts of keys state, against those that the keys declare.

use serde_json::{Value as Json, json};

use kinds::KINDS;

/// A bound that a text states: `true` for an upper one, and its number if the text has one in figures.
type Stated = (bool, Option<f64>);

/// A number in figures or in words.
fn number(word: &str) -> Option<f64> {
    const WORDS: [&str; 11] = [
        "zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten",
    ];
    let word = word.trim_matches(|c: char| ",;:.()[]`".contains(c));
    if let Some(n) = WORDS.iter().position(|name| *name == word) {
        return Some(n as f64);
    }
    let text = word.replace('−', "-");
    match text.strip_suffix('π') {
        Some("") => Some(core::f64::consts::PI),
        Some("-") => Some(-core::f64::consts::PI),
        Some(factor) => Some(factor.parse::<f64>().ok()? * core::f64::consts::PI),
        None => text.parse().ok(),
    }
}

/// Returns the bounds that a text states.
fn stated(text: &str) -> Vec<Stated> {
    const LOWER: [&str; 6] = ["at least", "not below", "more than", "above", ">", "≥"];
    const UPPER: [&str; 6] = ["at most", "not above", "less than", "below", "<", "≤"];
    let words: Vec<&str> = text.split_whitespace().collect();
    let mut found = Vec::new();
    for (i, word) in words.iter().enumerate() {
        let next = |n: usize| words.get(i + n).copied().unwrap_or_default();
        let pair = format!("{word} {}", next(1));
        for (phrases, is_upper) in [(LOWER, false), (UPPER, true)] {
            if phrases.contains(&pair.as_str()) {
                found.extend(number(next(2)).map(|n| (is_upper, Some(n))));
            } else if phrases.contains(word) {
                found.extend(number(next(1)).map(|n| (is_upper, Some(n))));
            }
        }
        let is_interval = word.starts_with(['(', '['])
            && word.ends_with(',')
            && next(1)
                .trim_end_matches(['.', ';', ':', ','])
                .ends_with([')', ']']);
        let limits = match (*word, next(1), next(2), next(3)) {
            (low, high, ..) if is_interval => number(low).zip(number(high)),
            (low, "to", high, _) | ("between", low, "and", high) => number(low).zip(number(high)),
            _ => None,
        };
        if let Some((low, high)) = limits {
            found.extend([(false, Some(low)), (true, Some(high))]);
        }
        let plain = word.trim_matches([',', '.', ';', ':']);
        if ["positive", "non-negative"].contains(&plain) || pair == "not negative" {
            found.push((false, None));
        }
    }
    found
}

/// The bounds that a schema declares for its number, its text, its list, or the numbers of its list.
fn declared(schema: &Json, is_upper: bool) -> Vec<f64> {
    let keywords = if is_upper {
        ["maximum", "exclusiveMaximum", "maxItems", "maxLength"]
    } else {
        ["minimum", "exclusiveMinimum", "minItems", "minLength"]
    };
    let own = keywords
        .iter()
        .filter_map(|keyword| schema.get(keyword)?.as_f64());
    let items = schema.get("items").map(|items| declared(items, is_upper));
    own.chain(items.into_iter().flatten()).collect()
}

/// Collects the keys whose text states a bound that the schema lacks, or a smaller range than the schema's.
fn undeclared(schema: &Json, path: &str, found: &mut Vec<String>) {
    if let Some(list) = schema.as_array() {
        for schema in list {
            undeclared(schema, path, found);
        }
    }
    let Some(object) = schema.as_object() else {
        return;
    };
    let is_value = ["number", "integer", "array", "string"].iter().any(|name| {
        let types = &schema["type"];
        types == name
            || types
                .as_array()
                .is_some_and(|types| types.contains(&json!(name)))
    });
    if is_value && !object.contains_key("const") && !object.contains_key("enum") {
        let text = object
            .get("description")
            .and_then(Json::as_str)
            .unwrap_or_default();
        // The second paragraph is written from the declaration.
        let text = text.split("\n\n").next().unwrap_or_default();
        let bounds = stated(text);
        for (is_upper, bound) in &bounds {
            let limits = declared(schema, *is_upper);
            // An interval in brackets is the range itself.
            let is_whole = text.contains("in (") || text.contains("in [");
            let agrees = |limit: &f64| !is_whole || bound.is_none_or(|bound| bound == *limit);
            if !limits.iter().any(agrees) {
                found.push(format!("{path}: {text}"));
                break;
            }
        }
    }
    for (keyword, value) in object {
        match keyword.as_str() {
            "properties" | "definitions" => {
                for (key, schema) in value.as_object().into_iter().flatten() {
                    undeclared(schema, &format!("{path}.{key}"), found);
                }
            }
            "default" | "const" | "enum" => {}
            _ => undeclared(value, path, found),
        }
    }
}

#[test]
fn a_range_that_a_text_states_is_declared() {
    let mut found = Vec::new();
    undeclared(
        &scenario::schema::schema(KINDS).to_value(),
        "scenario",
        &mut found,
    );
    undeclared(
        &sweep::schema::schema().to_value(),
        "experiment",
        &mut found,
    );
    assert!(found.is_empty(), "no range of\n{}", found.join("\n"));
}

#[test]
fn the_ways_to_state_a_range_are_known() {
    let pi = core::f64::consts::PI;
    for (text, low, high) in [
        ("Heading, in (−π, π].", Some(-pi), Some(pi)),
        ("Share, in [0, 1).", Some(0.0), Some(1.0)),
        ("The robots, 1 to 64.", Some(1.0), Some(64.0)),
        (
            "Between 0 and 2π: between 0 and 2π.",
            Some(0.0),
            Some(2.0 * pi),
        ),
        ("The route, at least two points.", Some(2.0), None),
        ("Changes, at most 512 of them.", None, Some(512.0)),
        ("Length, > 0.", Some(0.0), None),
        ("0 to disable; at least `unseen_below`.", None, None),
    ] {
        let expected: Vec<Stated> = [(false, low), (true, high)]
            .into_iter()
            .filter(|(_, n)| n.is_some())
            .collect();
        assert_eq!(stated(text), expected, "{text}");
        let bare = json!({ "type": ["number", "null"], "description": text });
        let mut found = Vec::new();
        undeclared(&json!({ "properties": { "key": bare } }), "", &mut found);
        assert_eq!(
            found.len(),
            usize::from(low.is_some() || high.is_some()),
            "{text}"
        );
    }
    assert_eq!(stated("A positive number."), [(false, None)]);
}
