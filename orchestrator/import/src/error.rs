//! Error of an import.

use std::path::{Path, PathBuf};

use config::Diagnostics;
use geometry::map::RosMapError;
use platform::file_kind::FileKind;
use roxmltree::Node;
use scenario::files::Refused;

use super::read::extension;

/// Reason why a file cannot be imported.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// A file is missing or unreadable.
    #[error("{}: expected {}", _0.message, _0.expected)]
    File(Refused),
    /// A file to which the file refers is missing, unreadable or outside its folder.
    #[error(
        "{} refers to {other}: {}: expected {}",
        path.display(),
        refused.message,
        refused.expected
    )]
    Other {
        /// The file.
        path: PathBuf,
        /// The file that it refers to, as written.
        other: String,
        /// Reason and expectation.
        refused: Refused,
    },
    /// The file's extension does not determine its format.
    #[error("{}: {}", path.display(), kind(path))]
    Kind {
        /// The file.
        path: PathBuf,
    },
    /// A map of ROS is invalid.
    #[error(transparent)]
    Ros(#[from] RosMapError),
    /// A line is invalid.
    #[error("{}, line {line}: {found}: expected {expected}", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// Line number, from 1.
        line: usize,
        /// Actual text.
        found: String,
        /// Expected text.
        expected: String,
    },
    /// The file is not XML.
    #[error("{}: {source}", path.display())]
    Xml {
        /// The file.
        path: PathBuf,
        /// Error and position.
        source: roxmltree::Error,
    },
    /// No scenario on the file's world passes the check.
    #[error(
        "{}: no scenario passes the check on its {area:.2} m² of free space, not even {last}: {}",
        path.display(),
        messages(problems)
    )]
    Check {
        /// The file.
        path: PathBuf,
        /// Area of the free space (m²).
        area: f64,
        /// Description of the scenario that needs the least space.
        last: String,
        /// Its problems.
        problems: Diagnostics,
    },
    /// The file as a whole cannot become a scenario.
    #[error("{}: {found}: expected {expected}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// Fault.
        found: String,
        /// Expected content.
        expected: String,
    },
}

impl From<Refused> for ImportError {
    fn from(refused: Refused) -> Self {
        Self::File(refused)
    }
}

impl ImportError {
    pub(crate) fn line(path: &Path, line: usize, found: &str, expected: &str) -> Self {
        const MAX_SHOWN: usize = 60;
        Self::Line {
            path: path.to_owned(),
            line,
            found: format!("{:?}", found.chars().take(MAX_SHOWN).collect::<String>()),
            expected: expected.to_owned(),
        }
    }

    /// The line of an element is invalid.
    pub(crate) fn at(path: &Path, node: Node<'_, '_>, found: &str, expected: &str) -> Self {
        let line = node.document().text_pos_at(node.range().start).row;
        Self::line(path, line as usize, found, expected)
    }

    pub(crate) fn other(path: &Path, other: &str, refused: Refused) -> Self {
        Self::Other {
            path: path.to_owned(),
            other: other.to_owned(),
            refused,
        }
    }

    pub(crate) fn content(
        path: &Path,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self::Content {
            path: path.to_owned(),
            found: found.into(),
            expected: expected.into(),
        }
    }
}

/// Extensions of images, which have no size.
const IMAGES: [&str; 8] = ["pgm", "png", "jpg", "jpeg", "bmp", "gif", "tif", "tiff"];

fn kind(path: &Path) -> String {
    if IMAGES.contains(&extension(path).as_str()) {
        return "an image without its scale: expected the .yaml of the ROS map that names it"
            .to_owned();
    }
    let help = FileKind::of(path).map(|kind| format!("; {}", kind.help(path)));
    format!(
        "unknown kind of file: expected {}{}",
        super::EXTENSIONS,
        help.unwrap_or_default()
    )
}

/// Returns the problems without their places in the unwritten scenario.
fn messages(problems: &Diagnostics) -> String {
    let texts: Vec<String> = problems
        .iter()
        .map(|problem| match &problem.value {
            Some(value) => format!("{} ({value})", problem.message),
            None => problem.message.clone(),
        })
        .collect();
    texts.join("; ")
}
