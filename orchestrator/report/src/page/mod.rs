//! The page of a run for a browser: animated mission, events, figures over time, latencies,
//! outcome. One file that works without a server or a network.
//!
//! * `content` reads a log up to its end or the first damaged record, and thins out dense topics
//!   (`thinning`), so that neither memory nor the page grows with the run;
//! * `pack` encodes numbers as small integers;
//! * `html` inserts them into the page, whose parts are in `page/`;
//! * `live` is the page of a log that is being written.

mod content;
mod events;
mod facts;
mod html;
mod layers;
mod live;
mod marks;
mod pack;
mod plots;
mod regions;
mod scene;
mod series;
mod thinning;
mod timing;

#[cfg(test)]
mod tests;

use std::io::Write as _;
use std::path::{Path, PathBuf};

use diff::diff;
use flate2::Compression;
use mcap_log::derived;
use mcap_log::{Condition, DerivedError, LogReadError, ReadProgress};
use platform::atomic_file::Readers;
use serde::Serialize;
use serde_json::{Value as Json, json};

use self::content::PageContent;
use self::html::Run;
pub use self::live::LivePage;
use self::pack::{Lists, Raster};
pub use self::plots::{Plot, PlotCurve};
use recorder::RobotOutcome;

/// Maximum number of states of robots in all continuations of a page.
const MOTION_STATES: usize = 240_000;

/// A written page.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Path of the page; empty without a file.
    pub page: PathBuf,
    /// Size of the page (bytes).
    pub bytes: u64,
    /// Name of the scenario; empty if it is not in the log.
    pub scenario: String,
    /// Digest of the run; absent if the log does not contain all messages.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub digest: Option<String>,
    /// Simulated time that the page shows (s).
    pub sim_time_s: f64,
    /// Number of world states in the page.
    pub frames: usize,
    /// Outcomes of the robots.
    pub robots: Vec<RobotOutcome>,
    /// Missing parts of the run or the log, as text.
    pub missing: Vec<String>,
    /// Condition of the log.
    pub condition: Condition,
}

/// Writes the page of one log, or of several logs side by side. On an error, no file remains. `decided` are the shares of
/// outcomes among continuations of the first log, as `protean decided --json` prints them, with `log`, its name, and `examples`: what
/// [`fn@continuation`] returns of some, each with `time_s` and `stream`.
///
/// # Errors
/// [`DerivedError`]: a log cannot be read, is not a Protean log of this version, or the page cannot
/// be written.
pub fn report(
    logs: &[&Path],
    out: &Path,
    force: bool,
    decided: Option<Json>,
    watch: &mut ReadProgress,
) -> Result<Vec<Report>, DerivedError> {
    // Fails before a log is read if the page may not be written there.
    let mut file = None;
    for log in logs {
        file = Some(derived::create(out, log, force, Readers::Owner)?);
    }
    let (page, mut reports) = render(logs, decided, watch)?;
    if let Some(mut file) = file {
        file.write_all(page.as_bytes())
            .and_then(|()| file.commit())
            .map_err(derived::failed(out))?;
    }
    for report in &mut reports {
        out.clone_into(&mut report.page);
    }
    Ok(reports)
}

/// Returns the page of one log, or of several logs side by side, without a file. `decided` as for [`report`].
///
/// # Errors
/// [`LogReadError`]: a log cannot be read or is not a Protean log of this version.
pub fn render(
    logs: &[&Path],
    mut decided: Option<Json>,
    watch: &mut ReadProgress,
) -> Result<(String, Vec<Report>), LogReadError> {
    let (mut runs, mut reports) = (Vec::new(), Vec::new());
    for log in logs {
        let mut content = PageContent::read(log, watch)?;
        let (mut run, report) = run(&mut content, Compression::best())
            .map_err(|error| LogReadError::Argument(format!("{}: {error}", log.display())))?;
        if let (Some(facts), Some(decided)) = (run.facts.as_object_mut(), decided.take()) {
            facts.insert("decided".to_owned(), decided);
        }
        runs.push(run);
        reports.push(report);
    }
    let comparison = match logs {
        [a, b] => Some(comparison(a, b, watch)?),
        _ => None,
    };
    let page = html::page(&runs, comparison.as_ref(), &facts::colours());
    for report in &mut reports {
        report.bytes = page.len() as u64;
    }
    Ok((page, reports))
}

/// Returns the motion in the log of a branch from its moment on (s), for a page with as many continuations as `of` (`examples` of
/// [`report`]).
///
/// # Errors
/// As [`render`].
pub fn continuation(
    log: &Path,
    from_s: f64,
    of: usize,
    watch: &mut ReadProgress,
) -> Result<Json, LogReadError> {
    let from_ns = (from_s * 1e9).round() as u64;
    let mut content = PageContent::read_motion(log, from_ns, MOTION_STATES / of.max(1), watch)?;
    let run = run(&mut content, Compression::best());
    let (run, _) =
        run.map_err(|error| LogReadError::Argument(format!("{}: {error}", log.display())))?;
    let part = |at: &str| run.facts.pointer(at);
    let lists = part("/lists")
        .and_then(Json::as_array)
        .into_iter()
        .flatten();
    let lists = lists.filter(|list| list.get("length") != Some(&json!(0)));
    Ok(json!({
        "end_s": part("/end_s"), "outcome": part("/outcome"), "events": part("/events"),
        "changes": part("/ground/changes"), "raster": part("/raster"),
        "lists": lists.collect::<Vec<_>>(), "data": run.data,
    }))
}

/// Returns the differences of two logs for a page of both, or the reason why they cannot be compared (JSON).
///
/// # Errors
/// [`LogReadError::Interrupted`].
pub fn comparison(a: &Path, b: &Path, watch: &mut ReadProgress) -> Result<Json, LogReadError> {
    match diff(a, b, watch) {
        Ok(report) => Ok(json!({ "report": report })),
        Err(LogReadError::Interrupted) => Err(LogReadError::Interrupted),
        Err(error) => Ok(json!({ "error": error.to_string() })),
    }
}

/// Returns the plots of the page of a log.
///
/// # Errors
/// As [`render`].
pub fn plots(log: &Path, watch: &mut ReadProgress) -> Result<Vec<Plot>, LogReadError> {
    Ok(plots::plots(&mut PageContent::read(log, watch)?))
}

/// Returns a run for the page and its summary.
fn run(content: &mut PageContent, compression: Compression) -> std::io::Result<(Run, Report)> {
    fit_bounds(content);
    let raster = Raster::from_bounds(content.static_scene.min, content.static_scene.max);
    let frames = content.frames.len();
    let mut lists = Lists::default();
    let mut facts = facts::facts(content);
    let plots = plots::pack(&plots::plots(content), &mut lists);
    scene::pack(content, raster, &mut lists);
    if let Some(facts) = facts.as_object_mut() {
        facts.insert("plots".to_owned(), plots);
        facts.insert("raster".to_owned(), serde_json::json!(raster));
        facts.insert("lists".to_owned(), lists.contents());
    }
    let text = |key: &str| facts.get(key).and_then(serde_json::Value::as_str);
    let report = Report {
        page: PathBuf::new(),
        bytes: 0,
        scenario: text("scenario").unwrap_or_default().to_owned(),
        digest: text("digest").map(str::to_owned),
        sim_time_s: content.end_ns as f64 / 1e9,
        frames,
        robots: facts::outcome(content),
        missing: facts::missing(content),
        condition: content.condition.clone(),
    };
    let data = lists.finish(compression)?;
    Ok((Run { facts, data }, report))
}

/// Without a map in the log, the bounds of the world are those of the robots' positions.
fn fit_bounds(content: &mut PageContent) {
    let static_scene = &mut content.static_scene;
    if static_scene.min != static_scene.max {
        return;
    }
    let robots = content.scenario.robots.iter();
    let starts = robots.map(|r| (r.start.x, r.start.y));
    let states = content.frames.iter().flat_map(|f| &f.item.robots);
    for (x, y) in starts.chain(states.map(|s| (s.x, s.y))) {
        let ([left, bottom], [right, top]) = (static_scene.min, static_scene.max);
        static_scene.min = [left.min(x - 1.0), bottom.min(y - 1.0)];
        static_scene.max = [right.max(x + 1.0), top.max(y + 1.0)];
    }
}
