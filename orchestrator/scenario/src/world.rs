//! `[world]`: the map, read from any source and written out.

use std::path::Path;

use config::{Code, FieldPath, Node, SourceKind, nearest, parse_document};
use geometry::extent::MAX_COORDINATE;
use geometry::grid::Grid;
use geometry::map::{
    MAX_EXITS, MapSpec, Occupancy, RosMap, UnknownCells, VectorMap, VectorMapError,
};
use geometry::region::Region;
use geometry::shape::ShapeError;
use parameters::{Parameters, ParamsError, above, between};
use schemars::JsonSchema;
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};

use super::builtin;
use super::context::Context;
use super::files::{Base, PathRefusal, ScenarioFile, read_text};
use super::spec::MAX_CELLS;

/// Maximum size of a vector map's file (bytes).
const MAX_MAP_FILE: u64 = 64 << 20;
/// Prefix of the name of a built-in map.
const BUILTIN: &str = "builtin:";

/// The map, and the settings of the quantities computed from it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(super) struct WorldBlock {
    /// The map: the path of a file, `"builtin:city"`, `"builtin:hello"`, or a table.
    #[serde(rename = "map", skip_serializing)]
    #[schemars(with = "Option<MapSpec>")]
    _map: Option<IgnoredAny>,
    /// Side of the grid's cells; overrides the value of a vector map; at most 25 million cells.
    #[schemars(transform = above(0).at_most(MAX_COORDINATE).unit("m"))]
    resolution: Option<f64>,
    /// Exits in place of those of the map; those of the map if absent. `rules.exits` adds exits.
    #[schemars(length(max = MAX_EXITS))]
    exits: Option<Vec<Region>>,
    /// Standard deviation of the map's Gaussian blur, which sets how softly walls repel and how sharply
    /// corners hide.
    #[schemars(transform = between(0, 10).unit("m"))]
    blur_sigma: f64,
}

impl Parameters for WorldBlock {}

impl Default for WorldBlock {
    fn default() -> Self {
        // Three cells of 6.3 cm, as in the chasing game.
        Self {
            _map: None,
            resolution: None,
            exits: None,
            blur_sigma: 0.19,
        }
    }
}

/// Contents of `[world]`.
pub struct MapSetup {
    /// The map, written out; never [`MapSpec::File`].
    pub map: MapSpec,
    /// Occupancy of the cells of a ROS map.
    pub occupancy: Option<Grid<Occupancy>>,
    /// Standard deviation of the map's Gaussian blur (m).
    pub blur_sigma: f64,
    /// Remark about the map's file, if there is one.
    pub remark: Option<String>,
}

/// Reads `[world]` and the map, and reports all problems.
pub fn resolve(ctx: &mut Context<'_>, base: &Base) -> Option<MapSetup> {
    let world = FieldPath::key("world");
    let Some(node) = ctx.root.get("world").cloned() else {
        ctx.problems.push(
            ctx.block_problem(
                ctx.root.origin,
                &world,
                Code::MissingKey,
                "missing table `[world]`",
            )
            .expected("[world] with map = \"path/of/a/map.toml\""),
        );
        return None;
    };
    let block: WorldBlock = ctx.read(&node, &world)?;
    ctx.check_section("world", &block);
    let path = world.then("map");
    let Some(map_node) = node.get("map") else {
        ctx.problems.push(
            ctx.block_problem(node.origin, &path, Code::MissingKey, "missing key `map`")
                .expected("map = \"path/of/a/map.toml\", or [world.map.vector]"),
        );
        return None;
    };
    let spec: MapSpec = ctx.read(map_node, &path)?;
    let (mut occupancy, mut remark) = (None, None);
    let mut map = match spec {
        MapSpec::File {
            path: file,
            unknown,
        } => {
            let file = file.to_string_lossy();
            let loaded = load(ctx, base, map_node, &path, &file, unknown)?;
            (occupancy, remark) = (loaded.occupancy, loaded.remark);
            loaded.map
        }
        MapSpec::Vector(map) => {
            check_vectors(ctx, map_node.get("vector")?, &path.then("vector"), &map).then_some(())?;
            MapSpec::Vector(map)
        }
        MapSpec::Cells(map) => {
            if let Err(e) = map.validate() {
                ctx.refuse(map_node.get("cells")?, &path.then("cells"), e);
                return None;
            }
            MapSpec::Cells(map)
        }
    };
    if let Some(resolution) = block.resolution {
        let MapSpec::Vector(vectors) = &mut map else {
            let message = "a grid map has its own resolution";
            ctx.problems.push(
                ctx.problem(&node, &world, "resolution", Code::Requirement, message)
                    .expected("no resolution beside a grid map"),
            );
            return None;
        };
        vectors.resolution = resolution;
        if let Err(e) = vectors.frame() {
            ctx.refuse(&node, &world, e);
            return None;
        }
    }
    if let Some(exits) = block.exits {
        match &mut map {
            MapSpec::Vector(map) => map.exits = exits,
            MapSpec::Cells(map) => map.exits = exits,
            MapSpec::File { .. } => {}
        }
    }
    check_size(ctx, &node, &map)?;
    Some(MapSetup {
        map,
        occupancy,
        blur_sigma: block.blur_sigma,
        remark,
    })
}

/// Reports a grid of more than [`MAX_CELLS`] cells.
fn check_size(ctx: &mut Context<'_>, node: &Node, map: &MapSpec) -> Option<()> {
    let frame = match map {
        MapSpec::Vector(map) => map.frame().ok()?,
        MapSpec::Cells(map) => map.frame(),
        MapSpec::File { .. } => return None,
    };
    if frame.len() <= MAX_CELLS {
        return Some(());
    }
    let world = FieldPath::key("world");
    ctx.problems.push(
        ctx.problem(
            node,
            &world,
            "map",
            Code::Limit,
            "the map has too many cells",
        )
        .value(format!("{} × {} cells", frame.width, frame.height))
        .expected(format!("at most {MAX_CELLS} cells"))
        .help("set a coarser world.resolution"),
    );
    None
}

/// A map from a file.
struct LoadedMap {
    map: MapSpec,
    /// States of the cells of a ROS map.
    occupancy: Option<Grid<Occupancy>>,
    remark: Option<String>,
}

impl LoadedMap {
    fn vectors(map: MapSpec) -> Self {
        Self {
            map,
            occupancy: None,
            remark: None,
        }
    }
}

/// Reads the file of `map = "…"`.
fn load(
    ctx: &mut Context<'_>,
    base: &Base,
    node: &Node,
    path: &FieldPath,
    file: &str,
    unknown: UnknownCells,
) -> Option<LoadedMap> {
    let named = file.strip_prefix(BUILTIN);
    let found = match named {
        Some(name) => {
            let path = format!("maps/{}.toml", name.strip_suffix(".toml").unwrap_or(name));
            builtin::map(&path)
                .map(ScenarioFile::Text)
                .ok_or_else(|| PathRefusal {
                    message: format!("no map `{path}` is built in"),
                    expected: config::list_choices(&builtin::map_names()),
                })
        }
        None => base.find(file),
    };
    let found = match found {
        Ok(found) => found,
        Err(e) => {
            let wanted = named.unwrap_or(file);
            let stem = Path::new(wanted)
                .file_stem()
                .and_then(|s| s.to_str())
                .unwrap_or_default();
            let names = builtin::map_stems();
            let help = match nearest(stem, names.iter().copied()) {
                Some(near) if *base != Base::Nothing => Some(format!(
                    "a map `{near}` is built in: map = \"{BUILTIN}{near}\" works from any folder"
                )),
                _ => None,
            };
            return report(ctx, node, path, e, help);
        }
    };
    match found {
        ScenarioFile::Text(text) => parse_vectors(ctx, file, text).map(LoadedMap::vectors),
        ScenarioFile::Disk(real) => {
            let extension = Path::new(file)
                .extension()
                .and_then(|e| e.to_str())
                .unwrap_or("");
            match extension.to_ascii_lowercase().as_str() {
                "toml" => match read_text(&real, MAX_MAP_FILE) {
                    Ok(text) => parse_vectors(ctx, file, &text).map(LoadedMap::vectors),
                    Err(e) => report(ctx, node, path, e, None),
                },
                "yaml" | "yml" => load_ros(ctx, base, node, path, &real, file, unknown),
                _ => {
                    let refused = PathRefusal {
                        message: "unknown kind of map".to_owned(),
                        expected: "a file ending in .toml (vectors) or .yaml (ROS map_server)"
                            .to_owned(),
                    };
                    report(ctx, node, path, refused, None)
                }
            }
        }
    }
}

fn report(
    ctx: &mut Context<'_>,
    node: &Node,
    path: &FieldPath,
    refused: PathRefusal,
    help: Option<String>,
) -> Option<LoadedMap> {
    let place = if node.as_table().is_some() {
        "file.path"
    } else {
        ""
    };
    let mut problem = ctx
        .problem(node, path, place, Code::File, refused.message)
        .value(node.render_short())
        .expected(refused.expected);
    if let Some(help) = help {
        problem = problem.help(help);
    }
    ctx.problems.push(problem);
    None
}

fn load_ros(
    ctx: &mut Context<'_>,
    base: &Base,
    node: &Node,
    path: &FieldPath,
    real: &Path,
    file: &str,
    unknown: UnknownCells,
) -> Option<LoadedMap> {
    let file_error = |e: String| PathRefusal {
        message: e,
        expected: "a ROS map".to_owned(),
    };
    let ros = match RosMap::read(real) {
        Ok(ros) => ros,
        Err(e) => return report(ctx, node, path, file_error(e.to_string()), None),
    };
    // The image path is relative to the YAML and restricted to the scenario's folder, like every file.
    let image = Path::new(file)
        .parent()
        .unwrap_or(Path::new(""))
        .join(&ros.image);
    let image = match base.find(&image.to_string_lossy()) {
        Ok(ScenarioFile::Disk(image)) => image,
        // The program contains no image for a YAML file on a disk.
        Ok(ScenarioFile::Text(_)) => return None,
        Err(e) => {
            let refused = PathRefusal {
                message: format!("image of {file}: {}", e.message),
                ..e
            };
            return report(ctx, node, path, refused, None);
        }
    };
    // The checked file is the one that is read: the YAML may be a link to another folder.
    let loaded = ros.load_image(&image).and_then(|cells| {
        let map = MapSpec::Cells(ros.cell_map(&cells, unknown)?);
        Ok(LoadedMap {
            map,
            occupancy: Some(cells),
            remark: ignored_keys(file, &ros.ignored),
        })
    });
    match loaded {
        Ok(loaded) => Some(loaded),
        Err(e) => report(ctx, node, path, file_error(e.to_string()), None),
    }
}

/// Returns the remark about keys that a ROS map does not have.
fn ignored_keys(file: &str, keys: &[(String, usize)]) -> Option<String> {
    const MAX_LISTED: usize = 5;
    let known = [
        "image",
        "resolution",
        "origin",
        "negate",
        "occupied_thresh",
        "free_thresh",
        "mode",
    ];
    let listed = keys.iter().take(MAX_LISTED).map(|(key, line)| {
        let near = nearest(key, known).map_or(String::new(), |near| format!(", not `{near}`"));
        let key: String = key.chars().take(40).collect();
        format!("`{key}` (line {line}{near})")
    });
    let mut listed = listed.collect::<Vec<_>>().join(", ");
    if keys.len() > MAX_LISTED {
        listed += &format!(" and {} more", keys.len() - MAX_LISTED);
    }
    (!keys.is_empty()).then(|| format!("map {file}: keys without effect: {listed}"))
}

/// Reads the text of a vector map; problems contain positions in it.
fn parse_vectors(ctx: &mut Context<'_>, name: &str, text: &str) -> Option<MapSpec> {
    let source = ctx.sources.add(SourceKind::File, name, text);
    let node = parse_document(&ctx.sources, source, &mut ctx.problems)?;
    let path = FieldPath::default();
    let map: VectorMap = ctx.read(&node, &path)?;
    check_vectors(ctx, &node, &path, &map).then_some(MapSpec::Vector(map))
}

fn check_vectors(ctx: &mut Context<'_>, node: &Node, path: &FieldPath, map: &VectorMap) -> bool {
    let found = match map.validate() {
        Ok(()) => return true,
        Err(e) => e,
    };
    match found {
        VectorMapError::Field(e) => ctx.refuse(node, path, e),
        VectorMapError::Obstacle { index, source, .. } => {
            let (field, code) = match source {
                ShapeError::Field(e) => {
                    let e = e.within("shape").within(&format!("obstacles[{index}]"));
                    ctx.refuse(node, path, e);
                    return false;
                }
                _ => (format!("obstacles[{index}].shape"), Code::Geometry),
            };
            ctx.problems
                .push(ctx.problem(node, path, &field, code, source.to_string()));
        }
        VectorMapError::DuplicateName {
            ref name, second, ..
        } => {
            let field = format!("obstacles[{second}].name");
            ctx.problems.push(
                ctx.problem(node, path, &field, Code::Duplicate, found.to_string())
                    .value(format!("{name:?}")),
            );
        }
    }
    false
}

/// Converts a shape's error into a field and its expected value.
pub fn shape_problem(e: ShapeError) -> ParamsError {
    match e {
        ShapeError::Field(e) => e,
        other => {
            let text = other.to_string();
            let (what, expected) = text.split_once(": expected ").unwrap_or((&text, "a shape"));
            ParamsError::new("polygon.vertices", what, expected)
        }
    }
}
