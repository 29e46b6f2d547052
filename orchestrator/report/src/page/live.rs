//! The page of a log that is being written, or replayed.

use std::path::{Path, PathBuf};

use flate2::Compression;
use mcap_log::LogReadError;
use mcap_log::reader::Reader;
use serde_json::{Value as Json, json};

use super::content::PageParts;
use super::marks::Marks;
use super::{facts, html, run};

/// Reader of a log for a page that grows with it; each part of the log is read once.
#[derive(Debug)]
pub struct LivePage {
    log: PathBuf,
    open: Option<(Reader<'static>, PageParts)>,
    /// Time of the last message, times of a replay, end and control at the last call.
    before: Option<(u64, Option<[u64; 2]>, bool, Json)>,
}

impl LivePage {
    /// Creates the page of a log, without its data.
    pub fn new(log: &Path) -> Self {
        Self {
            log: log.to_owned(),
            open: None,
            before: None,
        }
    }

    /// Returns the page that asks its server for the data.
    pub fn html() -> String {
        html::page(&[], None, &facts::colours())
    }

    /// Returns the data of the page (JSON, in one line): of the whole log so far, or of a replay, given its time and the latest
    /// so far, up to which it is shown (ns); `None` if nothing is new, and before the first message of the log. `ended`: the
    /// run or the replay is over; `control`: what pages hold, null if they hold nothing.
    ///
    /// # Errors
    /// [`LogReadError`]: the log cannot be read or is not a Protean log of this version.
    pub fn data(
        &mut self,
        replayed_ns: Option<[u64; 2]>,
        ended: bool,
        control: &Json,
    ) -> Result<Option<String>, LogReadError> {
        if self.open.is_none() {
            let (marks, has_message) = Marks::from_log(&self.log);
            if !has_message {
                return Ok(None);
            }
            self.open = Some((Reader::open(&self.log, None)?, PageParts::new(marks)));
        }
        let Some((reader, parts)) = &mut self.open else {
            return Ok(None);
        };
        reader.resume()?;
        let last_ns =
            parts.read_on(reader, replayed_ns.map_or(u64::MAX, |[_, reached]| reached))?;
        let state = Some((last_ns, replayed_ns, ended, control.clone()));
        if std::mem::replace(&mut self.before, state.clone()) == state {
            return Ok(None);
        }
        if ended {
            reader.check_all()?;
        }
        let mut content = parts.clone().content(reader)?;
        let failed = |error| LogReadError::Argument(format!("{}: {error}", self.log.display()));
        let (mut page, _) = run(&mut content, Compression::fast()).map_err(failed)?;
        let now_s =
            replayed_ns.map_or(content.end_ns, |[now, _]| now.min(content.end_ns)) as f64 / 1e9;
        if let Some(facts) = page.facts.as_object_mut() {
            let replayed = replayed_ns.is_some();
            let live =
                json!({ "now_s": now_s, "ended": ended, "control": control, "replayed": replayed });
            facts.insert("live".to_owned(), live);
            let is_whole = content.condition.complete || ended && replayed_ns.is_none();
            if !is_whole {
                facts.insert("missing".to_owned(), json!(content.notes));
            }
        }
        let data = json!({ "facts": page.facts, "data": page.data });
        Ok(Some(data.to_string()))
    }
}
