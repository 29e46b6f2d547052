//! Extracts of OpenStreetMap in XML (`.osm`), also from JOSM and as answers of the Overpass API.

use std::collections::BTreeMap;
use std::path::Path;

use roxmltree::Node;

use super::ImportError;
use super::project::to_plane;
use super::streets::Streets;
use super::xml;

/// Values of `highway` that are no street.
const NO_STREETS: [&str; 2] = ["no", "platform"];
/// Values of `highway`, and keys with the value `yes`, of streets that do not exist yet or no longer.
const NOT_IN_USE: [&str; 10] = [
    "abandoned",
    "construction",
    "demolished",
    "destroyed",
    "dismantled",
    "disused",
    "planned",
    "proposed",
    "razed",
    "removed",
];

/// Reads the streets of an extract: its ways with the tag `highway` that exist. The places of a way are those of its nodes,
/// or its own (`out geom` of the Overpass API). Parts of ways outside the extract are left out.
pub fn streets(path: &Path, text: &str) -> Result<Streets, ImportError> {
    let document = xml::parse(path, text)?;
    let root = document.root_element();
    if !root.has_tag_name("osm") {
        let found = format!("an element <{}>", root.tag_name().name());
        return Err(ImportError::content(path, found, "<osm>"));
    }
    let bad = |node, found: &str, expected| ImportError::at(path, node, found, expected);
    let named = |name: &'static str| {
        let nodes = root.children();
        nodes.filter(move |node| node.has_tag_name(name))
    };
    // A deleted node has no place.
    let mut places = BTreeMap::new();
    for node in named("node") {
        let at = if is_deleted(&node) { None } else { place(node) };
        match node.attribute("id") {
            Some(id) if at.is_some() || is_deleted(&node) => places.insert(id, at),
            _ => return Err(bad(node, "<node>", "id, lat and lon (degrees)")),
        };
    }
    let mut streets = Streets::default();
    let mut ways = 0;
    for way in named("way").filter(|way| !is_deleted(way) && is_street(way)) {
        ways += 1;
        let mut last = None;
        for end in way.children().filter(|node| node.has_tag_name("nd")) {
            let id = end.attribute("ref").unwrap_or_default();
            let at = if end.has_attribute("lat") {
                Some(place(end).ok_or_else(|| bad(end, "<nd>", "lat and lon (degrees)"))?)
            } else if let Some(at) = places.get(id) {
                let deleted = || bad(end, &format!("deleted node {id}"), "a node of the way");
                Some(at.ok_or_else(deleted)?)
            } else {
                None
            };
            if let (Some(from), Some(to)) = (last, at) {
                streets.add(&[from, to]);
            }
            last = at;
        }
    }
    if ways > 0 && streets.pieces.is_empty() {
        let found = format!("no places of the nodes of {ways} streets");
        let expected = "nodes with lat and lon, or lat and lon in the ways (`out geom`)";
        return Err(ImportError::content(path, found, expected));
    }
    to_plane(streets.pieces.as_flattened_mut());
    Ok(streets)
}

/// Returns longitude and latitude (degrees); `None` if they are absent or invalid.
fn place(node: Node<'_, '_>) -> Option<[f64; 2]> {
    let number = |key: &str, most: f64| {
        let value: f64 = node.attribute(key)?.parse().ok()?;
        (value.abs() <= most).then_some(value)
    };
    Some([number("lon", 180.0)?, number("lat", 89.0)?])
}

/// Returns `true` if the object is deleted: in the editor JOSM, or in the database.
fn is_deleted(object: &Node<'_, '_>) -> bool {
    object.attribute("action") == Some("delete") || object.attribute("visible") == Some("false")
}

fn is_street(way: &Node<'_, '_>) -> bool {
    let tag = |key: &str| {
        let mut tags = way.children().filter(|node| node.has_tag_name("tag"));
        tags.find(|tag| tag.attribute("k") == Some(key))
            .and_then(|tag| tag.attribute("v"))
    };
    let is_yes = |key: &&str| tag(key) == Some("yes");
    tag("highway").is_some_and(|kind| !NO_STREETS.contains(&kind) && !NOT_IN_USE.contains(&kind))
        && !NOT_IN_USE.iter().any(is_yes)
        && !is_yes(&"area")
}
