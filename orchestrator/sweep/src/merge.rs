//! Merging of the parts of an experiment.

use std::path::{Path, PathBuf};

use platform::presence;

use super::error::SweepError;
use super::results::Results;
use super::row::Record;

/// Merges results of the same experiment into one directory, which may already contain some of
/// them.
///
/// The parts are not changed, and are locked while they are read. For any division and order of the
/// parts, the table is that of a single sweep of the whole experiment.
///
/// # Errors
/// [`SweepError::Other`] if they are of different experiments, [`SweepError::Contradiction`] if two
/// of them contain different results of a mission, [`SweepError`] if one cannot be read or the
/// result cannot be written.
pub fn merge<R: Record>(parts: &[PathBuf], out: &Path) -> Result<Results<R>, SweepError> {
    let mut merged: Option<Results<R>> = None;
    // The target may be one of the parts: it is opened once, as the target.
    for path in parts {
        let unreadable = SweepError::io(path, "cannot be read");
        if presence::is_same(path, out).map_err(unreadable)? {
            continue;
        }
        let part = Results::<R>::read(path)?;
        // Opening the target detects a part of another experiment, and adds its seeds.
        let text = part.experiment()?;
        if let Some(merged) = &merged
            && let Some(difference) = merged.manifest().difference(part.manifest())
        {
            return Err(SweepError::Other {
                path: path.clone(),
                difference,
            });
        }
        let mut target = match merged.take() {
            Some(target) => {
                let manifest = part.manifest().clone();
                target.widened(&manifest)?
            }
            None => Results::open(out, part.manifest(), &text)?,
        };
        target.add(&part)?;
        merged = Some(target);
    }
    let merged = match merged {
        Some(merged) => merged,
        None => Results::read(out)?,
    };
    merged.write_tables()?;
    Ok(merged)
}
