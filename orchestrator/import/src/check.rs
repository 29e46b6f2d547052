//! The check of scenarios before one is written.

use std::path::Path;

use config::Diagnostics;
use scenario::Loader;
use scenario::files::Base;

use super::vectors::World;
use super::{ImportError, Imported};

/// Number of seeds for which a scenario is checked.
const SEEDS: u64 = 4;

/// Returns the first of the scenarios on a world that passes `protean check` with its seed, 1, and the next ones.
///
/// # Errors
/// The problems of the last one, which this text describes.
pub fn first_valid(
    path: &Path,
    world: &World,
    scenarios: impl IntoIterator<Item = Imported>,
    last: String,
    loader: &Loader<'_>,
) -> Result<Imported, ImportError> {
    let mut problems = Diagnostics::default();
    for imported in scenarios {
        match check(&imported, loader) {
            Ok(()) => return Ok(imported),
            Err(found) => problems = found,
        }
    }
    Err(ImportError::Check {
        path: path.to_owned(),
        area: world.free_area(),
        last,
        problems,
    })
}

fn check(imported: &Imported, loader: &Loader<'_>) -> Result<(), Diagnostics> {
    let Imported {
        scenario,
        map_path,
        map,
    } = imported;
    // The map is not on disk yet.
    let named = format!("map = \"{map_path}\"\n");
    let scenario = scenario.replace(&named, "");
    let text = format!("{scenario}\n[world.map.vector]\n{map}");
    let draft = loader.draft_text("scenario.toml", &text, &Base::Nothing)?;
    for seed in 1..=SEEDS {
        let mut draft = draft.clone();
        draft.apply("--seed", &format!("run.seed={seed}"));
        draft.resolve()?;
    }
    Ok(())
}
