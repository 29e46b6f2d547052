//! Data of the page for a browser: a line of JSON whenever the log has grown.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use report::page::LivePage;
use serde_json::json;

use super::control::Control;

/// Minimum time between two states of the data.
const INTERVAL: Duration = Duration::from_millis(400);
/// Maximum share of the time that the server works on the data: one part in this many.
const SHARE: u32 = 4;

/// The data of the page, common to all browsers.
#[derive(Debug, Default)]
pub(super) struct PageData(Mutex<Latest>);

#[derive(Debug, Default)]
struct Latest {
    /// The log, and `true` if it is replayed.
    source: Option<(LivePage, bool)>,
    /// Its path.
    log: Option<PathBuf>,
    line: Arc<[u8]>,
    /// Number of the line; 0 before the first.
    number: u64,
    due: Option<Instant>,
    /// `true` if no other line follows.
    is_last: bool,
}

impl PageData {
    /// Shows this log, which is being written or `replayed`.
    pub(super) fn show(&self, log: &Path, replayed: bool) {
        let mut latest = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        latest.source = Some((LivePage::new(log), replayed));
        latest.log = Some(log.to_owned());
    }

    /// Returns the shown log once it is whole: at the end of its run, always of a replay.
    pub(super) fn whole_log(&self, ended: bool) -> Option<PathBuf> {
        let latest = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let is_replayed = latest.source.as_ref().is_some_and(|source| source.1);
        latest.log.clone().filter(|_| ended || is_replayed)
    }

    /// Returns the latest line with its number, if that is not `than`. `times_ns`: simulated time, and the latest so far (ns).
    pub(super) fn newer(
        &self,
        than: u64,
        times_ns: [u64; 2],
        ended: bool,
        control: Option<&Control>,
    ) -> Option<(u64, Arc<[u8]>)> {
        let mut latest = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let latest = &mut *latest;
        let began = Instant::now();
        let is_due = ended || latest.due.is_none_or(|due| began >= due);
        if than == latest.number && is_due && !latest.is_last {
            latest.is_last = ended;
            let data = latest.source.as_mut().map(|(page, replayed)| {
                let control = json!(control.map(Control::wish));
                page.data(replayed.then_some(times_ns), ended, &control)
            });
            let line = match data {
                Some(Ok(line)) => line,
                Some(Err(error)) => {
                    latest.is_last = true;
                    Some(json!({ "error": error.to_string() }).to_string())
                }
                None => None,
            };
            if let Some(line) = line {
                latest.line = (line + "\n").into_bytes().into();
                latest.number += 1;
            }
            latest.due = Some(Instant::now() + INTERVAL.max(began.elapsed() * SHARE));
        }
        (latest.number != than).then(|| (latest.number, Arc::clone(&latest.line)))
    }
}
