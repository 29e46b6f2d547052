//! Where a run's log goes when nobody says.

use std::path::{Path, PathBuf};

/// Directory of logs without a name of their own.
const DIRECTORY: &str = "logs";

/// A path in `logs/` that nothing has yet: `<scenario>-<seed>.mcap`, or with a number behind.
///
/// Two runs may choose the same name at the same moment; the recorder creates the file exclusively
/// and the loser asks again.
///
/// # Errors
/// If the directory cannot be made, or holds a million logs of this name.
pub fn free_path(scenario: &str, seed: u64) -> std::io::Result<PathBuf> {
    std::fs::create_dir_all(DIRECTORY)?;
    let stem = format!("{scenario}-{seed}");
    (1..1_000_000_u32)
        .map(|n| {
            let name = if n == 1 {
                format!("{stem}.mcap")
            } else {
                format!("{stem}-{n}.mcap")
            };
            Path::new(DIRECTORY).join(name)
        })
        .find(|path| !path.exists())
        .ok_or_else(|| std::io::ErrorKind::AlreadyExists.into())
}
