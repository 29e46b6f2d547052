//! The scenario of a log, prepared for another run.

use std::path::Path;

use mcap_log::{LogReadError, Origin};

use scenario::files::Base;
use scenario::kind::Kind;
use scenario::spec::Mode;
use scenario::{Loader, ResolvedScenario};

/// Returns the scenario of the run with these changes. A scenario in real time is refused unless `so` is empty; `so`
/// is the consequence in the error message. `kinds` are the kinds of this program.
///
/// # Errors
/// [`LogReadError`] if the scenario of the log is unreadable or refused.
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
        return refuse("its scenario is not the one of the run".to_owned());
    }
    let Ok(text) = str::from_utf8(text) else {
        return refuse("its scenario is not text".to_owned());
    };
    let loader = Loader::new(kinds);
    let load =
        |changes: &[String]| loader.load_text("scenario.toml", text, &Base::Nothing, changes, None);
    let scenario = match load(&[]) {
        Ok(scenario) => scenario,
        Err(problems) => {
            return refuse(format!(
                "its scenario is not valid for this version of protean{}:\n{problems}",
                match origin.manifest.get("version") {
                    Some(version) => format!(" (it is from version {version})"),
                    None => String::new(),
                }
            ));
        }
    };
    if scenario.run.mode == Mode::RealTime && !so.is_empty() {
        return refuse(format!(
            "it was recorded in real time: the messages that processes received depended on the clock, so \
             that {so}"
        ));
    }
    if changes.is_empty() {
        return Ok(scenario);
    }
    let next = load(&for_log(changes, &scenario))
        .map_err(|problems| LogReadError::Argument(format!("--set:\n{problems}")))?;
    // The same seed repeats the run.
    if next == scenario && !changes.iter().all(|text| text.starts_with("run.seed=")) {
        return Err(changes_nothing(&changes.join(" ")));
    }
    Ok(next)
}

/// Returns overrides with limits of teams as those of their robots, and with keys of kinds as those of their processes: a scenario
/// in a log has neither teams nor processes for several robots.
pub(crate) fn for_log(changes: &[String], now: &ResolvedScenario) -> Vec<String> {
    let of_team = |text: &str| {
        let (team, rest) = text.strip_prefix("teams.")?.split_once(".limits.")?;
        let robots = now.world.robots.iter().filter(|robot| robot.team == team);
        let keys = robots.map(|robot| format!("robots.{}.limits.{rest}", robot.name));
        Some(keys.collect())
    };
    let of_kind = |text: &str| {
        let (kind, rest) = text.strip_prefix("processes.")?.split_once('.')?;
        let all = || now.processes.iter();
        let processes = all().filter(|process| process.program.kind_name() == Some(kind));
        let keys = processes.map(|process| format!("processes.{}.{rest}", process.name));
        let keys: Vec<String> = keys.collect();
        (!keys.is_empty() && all().all(|process| process.name != kind)).then_some(keys)
    };
    let all = changes.iter();
    all.flat_map(|text| {
        let known = of_team(text).or_else(|| of_kind(text));
        known.unwrap_or_else(|| vec![text.clone()])
    })
    .collect()
}

/// The error of overrides without an effect on the scenario of a log.
pub(crate) fn changes_nothing(changes: &str) -> LogReadError {
    LogReadError::Argument(format!(
        "{changes}: changes nothing: expected another value; in a log each robot has its limits (robots.NAME.…) and each \
         process its parameters (processes.NAME.params.…)"
    ))
}

/// Error of a comparison without a digest and without messages: nothing shows that the runs are identical.
pub(super) fn nothing_to_compare(log: &Path) -> LogReadError {
    LogReadError::NotRepeatable {
        path: log.to_owned(),
        reason: "there is nothing to compare: no digest of the whole run, and no message before the first failure"
            .to_owned(),
    }
}

/// Refuses external programs that the user has not permitted.
///
/// # Errors
/// [`LogReadError::NotRepeatable`] names them.
pub fn refuse_external(
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
            "its scenario starts external programs; check them and add \
             --allow-external:{}",
            external.concat()
        ),
    })
}
