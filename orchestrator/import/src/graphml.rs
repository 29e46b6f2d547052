//! Street graphs in GraphML, as OSMnx and `NetworkX` write them.

use std::collections::BTreeMap;
use std::path::Path;

use roxmltree::Node;

use super::ImportError;
use super::project::{to_origin, to_plane};
use super::streets::Streets;
use super::{wkt, xml};

/// Names of the coordinates of a node, and whether they are degrees.
const COORDINATES: [([&str; 2], bool); 4] = [
    (["x", "y"], false),
    (["lon", "lat"], true),
    (["longitude", "latitude"], true),
    (["Longitude", "Latitude"], true),
];
/// Returns `true` if this value of the graph's `crs` means degrees: `epsg:4326`, in older files of OSMnx
/// `{'init': 'epsg:4326'}`.
fn is_geographic(crs: &str) -> bool {
    crs.to_ascii_lowercase().contains("epsg:4326") || crs.trim() == "WGS84"
}

/// Reads a graph whose nodes have the data x and y (m; degrees if the graph's `crs` says so), or longitude and latitude
/// (degrees). An edge is straight, or follows its `geometry` ([`wkt::FORM`]), whatever the direction of that is.
pub fn streets(path: &Path, text: &str) -> Result<Streets, ImportError> {
    let document = xml::parse(path, text)?;
    let named = |name: &'static str| {
        let nodes = document.descendants();
        nodes.filter(move |node| node.tag_name().name() == name)
    };
    let Some(graph) = named("graph").next() else {
        return Err(ImportError::content(path, "no <graph>", "GraphML"));
    };
    // Data refer to keys, which have names.
    let names: BTreeMap<&str, &str> = named("key")
        .filter_map(|key| Some((key.attribute("id")?, key.attribute("attr.name")?)))
        .collect();
    let data = |node: Node<'_, '_>, name: &str| {
        let mut data = node.children().filter(|n| n.tag_name().name() == "data");
        let found = data.find(|data| {
            let key = data.attribute("key").unwrap_or_default();
            names.get(key).copied().unwrap_or(key) == name
        });
        found.map(|data| data.text().unwrap_or_default().to_owned())
    };
    let mut about = graph.children().filter_map(|node| node.text());
    let is_geographic = about.any(is_geographic);
    let bad = |node, found: &str, expected| ImportError::at(path, node, found, expected);

    let mut places = BTreeMap::new();
    let mut in_degrees = false;
    for node in named("node") {
        let found = COORDINATES.iter().find_map(|(names, degrees)| {
            let [x, y] = names.map(|name| data(node, name)?.trim().parse::<f64>().ok());
            Some(([x?, y?], *degrees || is_geographic))
        });
        let (Some(id), Some((at, degrees))) = (node.attribute("id"), found) else {
            let expected = "an id and the data x and y, or longitude and latitude";
            return Err(bad(node, "<node>", expected));
        };
        in_degrees |= degrees;
        if in_degrees && !(at[0].abs() <= 180.0 && at[1].abs() <= 89.0) {
            return Err(bad(node, &format!("{at:?}"), "degrees"));
        }
        places.insert(id, at);
    }
    let mut streets = Streets::default();
    for edge in named("edge") {
        let end = |key: &str| places.get(edge.attribute(key)?).copied();
        let (Some(from), Some(to)) = (end("source"), end("target")) else {
            return Err(bad(edge, "<edge>", "source and target, two nodes"));
        };
        match data(edge, "geometry") {
            None => streets.add(&[from, to]),
            Some(text) => {
                let lines = wkt::lines(&text).ok_or_else(|| bad(edge, &text, wkt::FORM))?;
                streets.add_edge(from, to, &lines);
            }
        }
    }
    let points = streets.pieces.as_flattened_mut();
    if in_degrees {
        to_plane(points);
    } else {
        to_origin(points);
    }
    Ok(streets)
}
