//! Street graphs in GraphML, as OSMnx and `NetworkX` write them.

use std::collections::BTreeMap;
use std::path::Path;

use roxmltree::{Document, Node};

use super::ImportError;
use super::project::{to_origin, to_plane};
use super::streets::Streets;

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
/// (degrees). An edge is straight, or follows its `geometry` (`LINESTRING`).
pub fn streets(path: &Path, text: &str) -> Result<Streets, ImportError> {
    let document = Document::parse(text).map_err(|source| ImportError::Xml {
        path: path.to_owned(),
        source,
    })?;
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
        found.and_then(|data| data.text()).map(str::to_owned)
    };
    let mut about = graph.children().filter_map(|node| node.text());
    let is_geographic = about.any(is_geographic);
    let line = |node: Node<'_, '_>| document.text_pos_at(node.range().start).row as usize;

    let mut streets = Streets::default();
    let mut number_of = BTreeMap::new();
    let mut in_degrees = false;
    for node in named("node") {
        let found = COORDINATES.iter().find_map(|(names, degrees)| {
            let [x, y] = names.map(|name| data(node, name)?.trim().parse::<f64>().ok());
            Some(([x?, y?], *degrees || is_geographic))
        });
        let (Some(id), Some((at, degrees))) = (node.attribute("id"), found) else {
            let expected = "an id and the data x and y, or longitude and latitude";
            return Err(ImportError::line(path, line(node), "<node>", expected));
        };
        in_degrees |= degrees;
        if in_degrees && !(at[0].abs() <= 180.0 && at[1].abs() <= 89.0) {
            let found = format!("{at:?}");
            return Err(ImportError::line(path, line(node), &found, "degrees"));
        }
        number_of.insert(id, streets.points.len());
        streets.points.push(at);
    }
    for edge in named("edge") {
        let end = |key: &str| number_of.get(edge.attribute(key)?).copied();
        let (Some(from), Some(to)) = (end("source"), end("target")) else {
            let expected = "source and target, two nodes";
            return Err(ImportError::line(path, line(edge), "<edge>", expected));
        };
        let bends = data(edge, "geometry").and_then(|text| line_string(&text));
        let mut last = from;
        // The ends of the line are the nodes.
        let bends = bends.unwrap_or_default();
        for bend in bends.iter().skip(1).take(bends.len().saturating_sub(2)) {
            streets.points.push(*bend);
            streets.pieces.push([last, streets.points.len() - 1]);
            last = streets.points.len() - 1;
        }
        streets.pieces.push([last, to]);
    }
    streets.drop_unused();
    if in_degrees {
        to_plane(&mut streets.points);
    } else {
        to_origin(&mut streets.points);
    }
    Ok(streets)
}

/// Reads `LINESTRING (x y, x y, …)`.
fn line_string(text: &str) -> Option<Vec<[f64; 2]>> {
    let inner = text.trim().strip_prefix("LINESTRING")?.trim();
    let inner = inner.strip_prefix('(')?.strip_suffix(')')?;
    let points = inner.split(',').map(|point| {
        let mut numbers = point.split_whitespace().map(str::parse::<f64>);
        Some([numbers.next()?.ok()?, numbers.next()?.ok()?])
    });
    points.collect()
}
