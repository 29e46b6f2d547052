//! Extracts of OpenStreetMap in XML (`.osm`).

use std::collections::BTreeMap;
use std::path::Path;

use roxmltree::{Document, Node};

use super::ImportError;
use super::project::to_plane;
use super::streets::Streets;

/// Values of `highway` that are no street yet, or no longer.
const NO_STREETS: [&str; 6] = [
    "abandoned",
    "construction",
    "planned",
    "platform",
    "proposed",
    "razed",
];

/// Reads the streets of an extract: its ways with the tag `highway`. Parts of ways outside the extract are left out.
pub fn streets(path: &Path, text: &str) -> Result<Streets, ImportError> {
    let document = Document::parse(text).map_err(|source| ImportError::Xml {
        path: path.to_owned(),
        source,
    })?;
    let root = document.root_element();
    if !root.has_tag_name("osm") {
        let found = format!("an element <{}>", root.tag_name().name());
        return Err(ImportError::content(path, found, "<osm>"));
    }
    let mut streets = Streets::default();
    let mut number_of = BTreeMap::new();
    for node in root.children().filter(|node| node.has_tag_name("node")) {
        let (Some(id), Some(at)) = (node.attribute("id"), place(node)) else {
            let line = document.text_pos_at(node.range().start).row as usize;
            let expected = "id, lat and lon (degrees)";
            return Err(ImportError::line(path, line, "<node>", expected));
        };
        number_of.insert(id, streets.points.len());
        streets.points.push(at);
    }
    let ways = root.children().filter(|node| node.has_tag_name("way"));
    for way in ways.filter(is_street) {
        let ends = way.children().filter(|node| node.has_tag_name("nd"));
        let ends: Vec<Option<usize>> = ends
            .map(|end| number_of.get(end.attribute("ref")?).copied())
            .collect();
        for pair in ends.windows(2) {
            if let &[Some(from), Some(to)] = pair {
                streets.pieces.push([from, to]);
            }
        }
    }
    // Nodes of other ways would move the middle.
    streets.drop_unused();
    to_plane(&mut streets.points);
    Ok(streets)
}

fn place(node: Node<'_, '_>) -> Option<[f64; 2]> {
    let number = |key: &str, most: f64| {
        let value: f64 = node.attribute(key)?.parse().ok()?;
        (value.abs() <= most).then_some(value)
    };
    Some([number("lon", 180.0)?, number("lat", 89.0)?])
}

fn is_street(way: &Node<'_, '_>) -> bool {
    let tag = |key: &str| {
        let mut tags = way.children().filter(|node| node.has_tag_name("tag"));
        tags.find(|tag| tag.attribute("k") == Some(key))
            .and_then(|tag| tag.attribute("v"))
    };
    tag("highway").is_some_and(|kind| !NO_STREETS.contains(&kind)) && tag("area") != Some("yes")
}
