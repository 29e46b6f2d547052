//! The scenario in a log, as a run can be made of it once more.

use std::path::Path;

use mcap_log::{LogReadError, Origin};

use scenario::files::Base;
use scenario::kind::Kind;
use scenario::spec::Mode;
use scenario::{Loader, ResolvedScenario};

/// The scenario as it was run, with these changes; one in real time only if `so` is empty,
/// which else says what follows from that. `kinds` are those of this program.
///
/// # Errors
/// The scenario of the log cannot be read, or is refused: [`LogReadError`].
pub fn scenario_of(
    origin: &Origin,
    log: &Path,
    changes: &[String],
    so: &str,
    kinds: &[Kind],
) -> Result<ResolvedScenario, LogReadError> {
    let refuse = |reason: String| {
        Err(LogReadError::NotRepeatable {
            path: log.to_owned(),
            reason,
        })
    };
    let text = origin.scenario.as_deref().unwrap_or_default();
    if let Some(expected) = origin.manifest.get("scenario_blake3")
        && *expected != blake3::hash(text).to_hex().as_str()
    {
        return refuse("the scenario in it is not the one that was run".to_owned());
    }
    let Ok(text) = str::from_utf8(text) else {
        return refuse("the scenario in it is not text".to_owned());
    };
    let loader = Loader::new(kinds);
    let load =
        |changes: &[String]| loader.load_text("scenario.toml", text, &Base::Nothing, changes, None);
    let scenario = match load(&[]) {
        Ok(scenario) => scenario,
        Err(problems) => {
            return refuse(format!(
                "the scenario in it is not one for this version of protean{}:\n{problems}",
                match origin.manifest.get("version") {
                    Some(version) => format!(" (it is of {version})"),
                    None => String::new(),
                }
            ));
        }
    };
    if scenario.run.mode == Mode::RealTime && !so.is_empty() {
        return refuse(format!(
            "it was recorded in real time: what the processes heard depended on the clock, so \
             that {so}"
        ));
    }
    if changes.is_empty() {
        return Ok(scenario);
    }
    load(changes).map_err(|problems| LogReadError::Argument(format!("--set:\n{problems}")))
}

/// Programs that are not ours are started only if somebody has looked at them.
pub(super) fn refuse_external(
    log: &Path,
    scenario: &ResolvedScenario,
    allowed: bool,
) -> Result<(), LogReadError> {
    let external: Vec<String> = scenario
        .external_commands()
        .map(|process| {
            let line = process.program.command_line().unwrap_or_default();
            format!("\n    {}: {line}", process.name)
        })
        .collect();
    if external.is_empty() || allowed {
        return Ok(());
    }
    Err(LogReadError::NotRepeatable {
        path: log.to_owned(),
        reason: format!(
            "its scenario starts programs that are not Protean's own; look at them and add \
             --allow-external:{}",
            external.concat()
        ),
    })
}
