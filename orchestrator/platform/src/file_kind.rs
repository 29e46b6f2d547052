//! Kinds of files that users have, recognised by content and name, with the command for each.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use crate::shell::quote;

/// Number of bytes at the beginning of a file that decide its kind.
const HEAD_BYTES: u64 = 1 << 16;

/// Kind of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileKind {
    /// A file without content.
    Empty,
    /// A log: MCAP.
    Log,
    /// A file compressed as a whole: Zstandard.
    Compressed,
    /// A bag of ROS 2 in an `SQLite` database.
    SqliteBag,
    /// A bag of ROS 1.
    Ros1Bag,
    /// A scenario: TOML.
    Scenario,
    /// An experiment: TOML.
    Experiment,
    /// A vector map of a scenario: TOML.
    VectorMap,
    /// A map of ROS: YAML that names an image.
    RosMap,
    /// Other YAML.
    Yaml,
    /// Instances to plan: a JSON array.
    Instances,
    /// Other JSON.
    Json,
    /// A benchmark map, its problems, or a street graph.
    Importable,
    /// A page: HTML.
    Page,
    /// A picture.
    Picture,
    /// A table: CSV or Parquet.
    Table,
    /// A program in Python.
    Python,
}

/// Kinds of binary files, with the bytes with which they begin.
const MAGICS: [(FileKind, &[u8]); 4] = [
    (FileKind::Log, b"\x89MCAP0\r\n"),
    (FileKind::Compressed, b"\x28\xb5\x2f\xfd"),
    (FileKind::SqliteBag, b"SQLite format 3"),
    (FileKind::Ros1Bag, b"#ROSBAG"),
];

/// Kinds of TOML files, with top-level keys that the other kinds lack.
pub const TOML_KEYS: [(FileKind, &[&str]); 3] = [
    (
        FileKind::Scenario,
        &[
            "world",
            "rules",
            "defaults",
            "robots",
            "links",
            "teams",
            "processes",
            "events",
            "expect",
            "log",
        ],
    ),
    (
        FileKind::Experiment,
        &[
            "scenario",
            "kind",
            "task",
            "seeds",
            "cases",
            "parameters",
            "grid",
            "figures",
        ],
    ),
    (
        FileKind::VectorMap,
        &["bounds", "resolution", "exits", "obstacles"],
    ),
];

impl FileKind {
    /// Recognises a file; `None` if it is unreadable or of another kind.
    pub fn from_path(path: &Path) -> Option<Self> {
        // Opening a FIFO would block.
        if !path.metadata().ok()?.is_file() {
            return None;
        }
        let mut head = Vec::new();
        let file = File::open(path).ok()?.take(HEAD_BYTES);
        std::io::BufReader::new(file).read_to_end(&mut head).ok()?;
        if head.is_empty() {
            return Some(Self::Empty);
        }
        let mut of_head = MAGICS.iter().filter(|(_, magic)| head.starts_with(magic));
        if let Some((kind, _)) = of_head.next() {
            return Some(*kind);
        }
        let text = String::from_utf8_lossy(&head);
        let text = text.trim_start_matches('\u{feff}');
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        match extension.to_str()? {
            "" | "toml" => of_toml(text),
            "yaml" | "yml" if text.lines().any(|line| line.starts_with("image:")) => {
                Some(Self::RosMap)
            }
            "yaml" | "yml" => Some(Self::Yaml),
            "json" | "jsonl" if text.trim_start().starts_with('[') => Some(Self::Instances),
            "json" | "jsonl" => Some(Self::Json),
            "map" | "scen" | "graph" | "graphml" | "osm" => Some(Self::Importable),
            "html" | "htm" => Some(Self::Page),
            "svg" | "png" | "pgm" | "jpg" | "jpeg" | "pdf" => Some(Self::Picture),
            "csv" | "parquet" => Some(Self::Table),
            "py" => Some(Self::Python),
            _ => None,
        }
    }

    /// Describes the file at this path as a help text: what it is, and the command for it.
    pub fn help(self, path: &Path) -> String {
        let file = quote(&path.to_string_lossy());
        match self {
            Self::Log => format!(
                "it is a log: `protean report {file}` shows it, `protean verify {file}` runs its scenario again"
            ),
            Self::Empty => "it is empty".to_owned(),
            Self::Compressed => {
                format!("it is compressed as a whole: `zstd -d <{file} >LOG.mcap` decompresses it")
            }
            Self::SqliteBag => format!(
                "it is a ROS 2 bag in SQLite: `mcap convert {file} LOG.mcap`, or for the folder of the bag \
                 `rosbags-convert --src BAG --dst NEW --dst-storage mcap`, writes one in MCAP"
            ),
            Self::Ros1Bag => {
                format!("it is a ROS 1 bag: `mcap convert {file} LOG.mcap` writes one in MCAP")
            }
            Self::Scenario => format!("it is a scenario: `protean run {file}` runs it"),
            Self::Experiment => {
                format!("it is an experiment: `protean sweep {file}` runs its missions")
            }
            Self::VectorMap => {
                format!(
                    "it is a map: a scenario names it in [world], `map = \"{}\"`",
                    path.display()
                )
            }
            Self::RosMap => format!(
                "it is a map of ROS: `protean new NAME.toml --from {file}` makes a scenario of it"
            ),
            Self::Importable => format!(
                "it is a map to import: `protean new NAME.toml --from {file}` makes a scenario of it"
            ),
            Self::Yaml => "it is YAML: scenarios and experiments are TOML files".to_owned(),
            Self::Instances => {
                format!("it is a list of instances: `protean plan {file}` plans them")
            }
            Self::Json => {
                "it is JSON: scenarios and experiments are TOML files, logs MCAP files".to_owned()
            }
            Self::Page => "it is a page: open it in a browser".to_owned(),
            Self::Picture => {
                "it is a picture; no command reads pictures, but a map can name an image".to_owned()
            }
            Self::Table => "it is a table of results; no command reads tables".to_owned(),
            Self::Python => {
                format!(
                    "it is a program: `python3 {file}` starts it, `command` in [[processes]] names it"
                )
            }
        }
    }
}

/// Returns the kind with the most of its own top-level keys in a text, if no other kind has as many.
fn of_toml(text: &str) -> Option<FileKind> {
    let keys = top_level_keys(text);
    let counts = TOML_KEYS.map(|(kind, own)| {
        let count = keys.iter().filter(|key| own.contains(key)).count();
        (count, kind)
    });
    let most = counts
        .iter()
        .map(|(count, _)| *count)
        .max()
        .filter(|count| *count > 0)?;
    let mut kinds = counts.into_iter().filter(|(count, _)| *count == most);
    match (kinds.next(), kinds.next()) {
        (Some((_, kind)), None) => Some(kind),
        _ => None,
    }
}

/// Returns the keys before the first table of a TOML text, and the first keys of its tables.
fn top_level_keys(text: &str) -> Vec<&str> {
    let mut keys = Vec::new();
    let (mut in_text, mut in_table) = (false, false);
    for line in text.lines() {
        let quotes = line.matches("\"\"\"").count() + line.matches("'''").count();
        let was_in_text = in_text;
        in_text ^= quotes % 2 == 1;
        if was_in_text {
            continue;
        }
        let is_header = line.starts_with('[');
        in_table |= is_header;
        let key = match line.split_once('=') {
            _ if is_header => line.trim_start_matches('['),
            Some((key, _)) if !in_table => key,
            _ => continue,
        };
        keys.push(key.split(['.', ']']).next().unwrap_or_default().trim());
    }
    keys.sort_unstable();
    keys.dedup();
    keys
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_recognised_by_content_and_name() {
        let folder = tempfile::tempdir().unwrap();
        let kind = |name: &str, content: &[u8]| {
            let path = folder.path().join(name);
            std::fs::write(&path, content).unwrap();
            FileKind::from_path(&path)
        };
        for (name, content, expected) in [
            ("a", &b"\x89MCAP0\r\n"[..], Some(FileKind::Log)),
            ("a.toml", b"\x89MCAP0\r\n", Some(FileKind::Log)),
            (
                "s.toml",
                b"title = 't'\n[world]\nmap = 'm'\n[[robots]]\nname = 'a'",
                Some(FileKind::Scenario),
            ),
            (
                "bom.toml",
                b"\xef\xbb\xbfworld.map = 'm'",
                Some(FileKind::Scenario),
            ),
            (
                "e",
                b"scenario = 'builtin:chase'\nseeds.count = 3",
                Some(FileKind::Experiment),
            ),
            (
                "text.toml",
                b"description = '''\n[world]\n[rules]\n'''\n[grid]\n",
                Some(FileKind::Experiment),
            ),
            ("half.toml", b"[world]\n[grid]\n", None),
            ("other.toml", b"[package]\nname = 'x'", None),
            (
                "m.toml",
                b"bounds = {}\n[[obstacles]]\n",
                Some(FileKind::VectorMap),
            ),
            (
                "m.yaml",
                b"# map\nimage: hall.pgm\n",
                Some(FileKind::RosMap),
            ),
            ("s.YML", b"world:\n  image: x", Some(FileKind::Yaml)),
            ("i.json", b"\n [{}]", Some(FileKind::Instances)),
            ("r.json", b"{}", Some(FileKind::Json)),
            ("x.unknown", b"[world]\n", None),
        ] {
            assert_eq!(kind(name, content), expected, "{name}");
        }
        assert_eq!(FileKind::from_path(folder.path()), None);
        assert_eq!(FileKind::from_path(&folder.path().join("none.toml")), None);
    }
}
