//! The published points that figures compare with: kept beside the results, which `protean sweep figures` draws.

use std::path::{Component, Path};

use platform::atomic_file::save;
use serde::Deserialize;

use super::error::SweepError;
use super::results::Results;
use super::spec::FigureSpec;

/// The part of an experiment file that names them.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct FigureList {
    figures: Vec<FigureSpec>,
}

/// Copies the files of published points that an experiment's figures name from the folder of the
/// experiment to its results.
///
/// # Errors
/// [`SweepError::Io`]; [`SweepError::Figure`] if a path leads out of the folder.
pub fn keep(folder: &Path, results: &Results) -> Result<(), SweepError> {
    for figure in shown(results)?.figures {
        let Some(compare) = figure.compare else {
            continue;
        };
        let plain = |c: Component<'_>| matches!(c, Component::Normal(_) | Component::CurDir);
        if !Path::new(&compare).components().all(plain) {
            return Err(SweepError::Figure {
                name: figure.name,
                reason: format!(
                    "`compare` is {compare:?}: expected a path below the experiment's folder"
                ),
            });
        }
        let (from, to) = (folder.join(&compare), results.directory().join(&compare));
        let bytes = std::fs::read(&from).map_err(SweepError::io(&from, "cannot be read"))?;
        save(&bytes, &to).map_err(|error| SweepError::Io {
            path: error.path,
            what: "cannot be written",
            source: error.source,
        })?;
    }
    Ok(())
}

fn shown(results: &Results) -> Result<FigureList, SweepError> {
    let text = results.experiment()?;
    toml::from_str(&text).map_err(|error| SweepError::Damaged {
        path: results.directory().join("experiment.toml"),
        line: error.span().map_or(1, |span| {
            text.get(..span.start)
                .map_or(1, |before| before.matches('\n').count() + 1)
        }),
        what: "not the experiment file of these results".to_owned(),
        found: error.message().to_owned(),
        expected: "the copy that `protean sweep` wrote",
    })
}
