//! Specification of a map in a scenario.

use core::fmt;
use std::borrow::Cow;
use std::io;
use std::path::{Path, PathBuf};

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, MapAccess, Visitor};
use serde::{Deserialize, Serialize};

use crate::text_file;

use super::{CellMap, RosMap, RosMapError, UnknownCells, VectorMap, VectorMapError};

/// Maximum size of a vector map file (bytes).
const MAX_VECTOR_FILE: u64 = 64 << 20;

/// The map of a world.
///
/// In TOML either a path, `map = "maps/city.toml"` (vectors) or `map = "maps/office.yaml"` (ROS
/// `map_server`), or a table: `map = { file = { path = "maps/office.yaml", unknown = "free" } }`,
/// `map = { vector = { bounds = …, obstacles = [ … ] } }`, or `map = { cells = { … } }`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum MapSpec {
    /// A file, by its extension: `.toml` is a [`VectorMap`], `.yaml` or `.yml` a ROS map.
    File {
        /// Path of the file; relative paths are taken from the directory that
        /// [`MapSpec::load`] is given.
        path: PathBuf,
        /// Meaning of the cells that are unknown in the ROS map.
        unknown: UnknownCells,
    },
    /// Vectors, inline.
    Vector(VectorMap),
    /// An occupancy grid, inline.
    Cells(CellMap),
}

/// Reason why a map is invalid.
#[derive(Debug, thiserror::Error)]
pub enum MapError {
    /// The file is missing or unreadable.
    #[error("map {}: cannot be read: {source}", path.display())]
    Io {
        /// The map's file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The file's extension does not determine its format.
    #[error("map {}: unknown kind of file: expected .toml (vectors) or .yaml (ROS map_server)", path.display())]
    UnknownKind {
        /// The map's file.
        path: PathBuf,
    },
    /// The TOML of a vector map is invalid; the message points at the line.
    #[error("map {}: {source}", path.display())]
    Toml {
        /// The map's file.
        path: PathBuf,
        /// Error and position.
        source: toml::de::Error,
    },
    /// The ROS map is invalid.
    #[error(transparent)]
    Ros(#[from] RosMapError),
    /// The vector map is invalid.
    #[error("{}{source}", path.as_ref().map(|p| format!("map {}: ", p.display())).unwrap_or_default())]
    Vector {
        /// The map's file, if there is one.
        path: Option<PathBuf>,
        /// Error of the map.
        source: Box<VectorMapError>,
    },
}

impl MapError {
    pub(super) fn vector(path: Option<&Path>, source: VectorMapError) -> Self {
        Self::Vector {
            path: path.map(Path::to_owned),
            source: Box::new(source),
        }
    }
}

impl MapSpec {
    /// Returns the map with the content of its file (never [`MapSpec::File`]), so that a stored map
    /// is complete.
    ///
    /// # Errors
    /// The error names the file, the line or field, the value, and the expected one.
    pub fn load(&self, base: &Path) -> Result<Self, MapError> {
        match self {
            Self::File { path, unknown } => load_file(&base.join(path), *unknown),
            Self::Vector(map) => {
                map.validate().map_err(|e| MapError::vector(None, e))?;
                Ok(self.clone())
            }
            Self::Cells(map) => {
                map.validate()
                    .map_err(|e| MapError::vector(None, e.into()))?;
                Ok(self.clone())
            }
        }
    }
}

fn load_file(path: &Path, unknown: UnknownCells) -> Result<MapSpec, MapError> {
    let extension = path
        .extension()
        .and_then(|e| e.to_str())
        .unwrap_or_default();
    match extension.to_ascii_lowercase().as_str() {
        "toml" => {
            let io = |source| MapError::Io {
                path: path.to_owned(),
                source,
            };
            let file = text_file::open(path).map_err(io)?;
            let text = text_file::read(file, MAX_VECTOR_FILE).map_err(io)?;
            let map: VectorMap = toml::from_str(&text).map_err(|source| MapError::Toml {
                path: path.to_owned(),
                source,
            })?;
            map.validate()
                .map_err(|e| MapError::vector(Some(path), e))?;
            Ok(MapSpec::Vector(map))
        }
        "yaml" | "yml" => {
            let ros = RosMap::read(path)?;
            Ok(MapSpec::Cells(ros.cell_map(&ros.load()?, unknown)?))
        }
        _ => Err(MapError::UnknownKind {
            path: path.to_owned(),
        }),
    }
}

/// The table forms; [`MapSpec`] adds the plain path.
#[derive(Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[schemars(rename = "MapTable")]
enum Table {
    /// A file, by its extension.
    File(FileTable),
    /// Vectors, inline.
    Vector(VectorMap),
    /// An occupancy grid, inline.
    Cells(CellMap),
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "MapFile")]
struct FileTable {
    /// Path of the file: `.toml` is a vector map, `.yaml` or `.yml` a ROS map.
    path: PathBuf,
    /// Meaning of the cells that are unknown in the ROS map.
    #[serde(default)]
    unknown: UnknownCells,
}

impl JsonSchema for MapSpec {
    fn schema_name() -> Cow<'static, str> {
        "Map".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        json_schema!({ "anyOf": [{ "type": "string" }, generator.subschema_for::<Table>()] })
    }
}

impl<'de> Deserialize<'de> for MapSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct PathOrTable;

        impl<'de> Visitor<'de> for PathOrTable {
            type Value = MapSpec;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the path of a map, or one table `file`, `vector` or `cells`")
            }

            fn visit_str<E>(self, path: &str) -> Result<MapSpec, E> {
                Ok(MapSpec::File {
                    path: path.into(),
                    unknown: UnknownCells::default(),
                })
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<MapSpec, A::Error> {
                Ok(match Table::deserialize(MapAccessDeserializer::new(map))? {
                    Table::File(FileTable { path, unknown }) => MapSpec::File { path, unknown },
                    Table::Vector(map) => MapSpec::Vector(map),
                    Table::Cells(map) => MapSpec::Cells(map),
                })
            }
        }

        deserializer.deserialize_any(PathOrTable)
    }
}

#[cfg(test)]
mod tests {
    use expect_test::expect;

    use super::*;

    #[derive(Deserialize, Serialize)]
    struct Holder {
        map: MapSpec,
    }

    fn parse(text: &str) -> Result<MapSpec, toml::de::Error> {
        toml::from_str::<Holder>(text).map(|h| h.map)
    }

    #[test]
    fn a_map_is_a_path_or_a_table() {
        let path = parse("map = 'maps/city.toml'").unwrap();
        assert_eq!(
            path,
            MapSpec::File {
                path: "maps/city.toml".into(),
                unknown: UnknownCells::Occupied
            }
        );
        let file = parse("map = { file = { path = 'a.yaml', unknown = 'free' } }").unwrap();
        assert_eq!(
            file,
            MapSpec::File {
                path: "a.yaml".into(),
                unknown: UnknownCells::Free
            }
        );
        let vector = parse("map = { vector = { bounds = { min = [0,0], max = [1,1] } } }").unwrap();
        assert!(matches!(vector, MapSpec::Vector(_)));
        for map in [path, file, vector] {
            let text = toml::to_string(&Holder { map: map.clone() }).unwrap();
            assert_eq!(parse(&text).unwrap(), map);
        }
    }

    #[test]
    fn the_error_of_a_wrong_table_lists_the_known_keys() {
        let errors = ["map = { files = { path = 'a.yaml' } }", "map = 3"]
            .map(|text| parse(text).unwrap_err().to_string());
        expect![[r#"
            TOML parse error at line 1, column 9
              |
            1 | map = { files = { path = 'a.yaml' } }
              |         ^^^^^
            unknown variant `files`, expected one of `file`, `vector`, `cells`

            TOML parse error at line 1, column 7
              |
            1 | map = 3
              |       ^
            invalid type: integer `3`, expected the path of a map, or one table `file`, `vector` or `cells`
        "#]].assert_eq(&errors.join("\n"));
    }

    #[test]
    fn missing_and_unknown_files_are_named() {
        let file = |path: &str| MapSpec::File {
            path: path.into(),
            unknown: UnknownCells::default(),
        };
        let errors = ["no/such.toml", "map.bmp"].map(|path| {
            let loaded = file(path).load(Path::new("/nowhere"));
            loaded.unwrap_err().to_string()
        });
        expect![[r#"
            map /nowhere/no/such.toml: cannot be read: No such file or directory (os error 2)
            map /nowhere/map.bmp: unknown kind of file: expected .toml (vectors) or .yaml (ROS map_server)"#]].assert_eq(&errors.join("\n"));
    }
}
