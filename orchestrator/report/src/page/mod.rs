//! A run as one page for a browser: the mission, animated, its events, its figures over time, its
//! latencies, its outcome. One file that needs nothing else, neither a server nor a network.
//!
//! * `gather` reads a log as far as it goes and thins out what comes densely
//!   (`sampled`), so that neither memory nor the page grow with the run;
//! * `pack` makes small whole numbers of it;
//! * `html` puts them into the page, whose parts are in `page/`.

mod facts;
mod gather;
mod happened;
mod html;
mod layers;
mod measured;
mod pack;
mod plots;
mod sampled;
mod scene;
mod timing;

#[cfg(test)]
mod tests;

use std::io::Write as _;
use std::path::{Path, PathBuf};

use mcap_log::derived;
use mcap_log::{Condition, DerivedError, ReadProgress};
use platform::atomic_file::Readers;
use serde::Serialize;

use self::gather::Gathered;
use self::pack::{Lists, Raster};
use recorder::RobotOutcome;
use scenario::kind::Kind;

/// What was written.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// The page.
    pub page: PathBuf,
    /// Its size (bytes).
    pub bytes: u64,
    /// The scenario; empty if the log does not say.
    pub scenario: String,
    /// Fingerprint of the simulated history; absent if the log does not hold all of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub digest: Option<String>,
    /// Simulated time that the page shows (s).
    pub sim_time_s: f64,
    /// States of the world that the page can show.
    pub frames: usize,
    /// What became of the robots.
    pub robots: Vec<RobotOutcome>,
    /// What is missing, for people.
    pub missing: Vec<String>,
    /// In what condition the log is.
    pub condition: Condition,
}

/// Writes the page of a log, whole or not at all.
///
/// # Errors
/// [`DerivedError`]: the log cannot be read, is not one of ours or of another version, or the page
/// cannot be written.
pub fn report(
    log: &Path,
    kinds: &'static [Kind],
    out: &Path,
    force: bool,
    watch: &mut ReadProgress,
) -> Result<Report, DerivedError> {
    // Whether the page may stand there is known before the log has been read.
    let mut file = derived::create(out, log, force, Readers::Owner)?;
    let mut gathered = Gathered::read(log, kinds, watch)?;
    let (page, mut report) = page(&mut gathered, kinds).map_err(derived::failed(out))?;
    file.write_all(page.as_bytes())
        .and_then(|()| file.commit())
        .map_err(derived::failed(out))?;
    out.clone_into(&mut report.page);
    Ok(report)
}

/// The page and what it says.
fn page(gathered: &mut Gathered, kinds: &[Kind]) -> std::io::Result<(String, Report)> {
    fit_bounds(gathered);
    let raster = Raster::of(gathered.static_scene.min, gathered.static_scene.max);
    let frames = gathered.frames.len();
    let mut lists = Lists::default();
    let mut facts = facts::facts(gathered, kinds);
    let plots = plots::plots(gathered, &mut lists);
    scene::pack(gathered, raster, &mut lists);
    if let Some(facts) = facts.as_object_mut() {
        facts.insert("plots".to_owned(), plots);
        facts.insert("raster".to_owned(), serde_json::json!(raster));
        facts.insert("lists".to_owned(), lists.contents());
    }
    let page = html::page(&facts, &lists.finish()?, &facts::colours());
    let text = |key: &str| facts.get(key).and_then(serde_json::Value::as_str);
    let report = Report {
        page: PathBuf::new(),
        bytes: page.len() as u64,
        scenario: text("scenario").unwrap_or_default().to_owned(),
        digest: text("digest").map(str::to_owned),
        sim_time_s: gathered.end_ns as f64 / 1e9,
        frames,
        robots: facts::outcome(gathered),
        missing: facts::missing(gathered),
        condition: gathered.condition.clone(),
    };
    Ok((page, report))
}

/// A world whose map is not in the log is as large as where its robots were.
fn fit_bounds(gathered: &mut Gathered) {
    let static_scene = &mut gathered.static_scene;
    if static_scene.min != static_scene.max {
        return;
    }
    let starts = gathered
        .scenario
        .robots
        .iter()
        .map(|r| (r.start.x, r.start.y));
    let states = gathered.frames.iter().flat_map(|f| &f.item.robots);
    for (x, y) in starts.chain(states.map(|s| (s.x, s.y))) {
        static_scene.min = [
            static_scene.min[0].min(x - 1.0),
            static_scene.min[1].min(y - 1.0),
        ];
        static_scene.max = [
            static_scene.max[0].max(x + 1.0),
            static_scene.max[1].max(y + 1.0),
        ];
    }
}
