//! The run in a log, done again.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

use ipc_types::messages::world::WorldHeader;
use ipc_types::topics::{Topic, WorldState};
use serde::Serialize;
use zerocopy::FromBytes as _;

use super::compare::{Comparison, compare};
use super::error::LogsError;
use super::failures::{Left, first_failure};
use super::known::{self, ENCAPSULATION};
use super::origin::{Origin, refuse_external};
use super::output::{FILTERED, MANIFEST, RESULT, RUN_DIGEST};
use super::reader::{Item, Reader};
use super::watch::Watch;
use crate::in_process::{self, InProcessOptions};
use crate::mission::{self, MissionError, MissionOptions};

/// How a run is done again.
#[derive(Debug, Clone, Copy, Default)]
pub struct RerunOptions {
    /// Whether all in one process.
    pub in_process: bool,
    /// Whether programs that are not ours may be started.
    pub allow_external: bool,
}

/// What came of doing a run again.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rerun {
    /// The scenario.
    pub scenario: String,
    /// The seed.
    pub seed: u64,
    /// The version that recorded the log, if it is another.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recorded_by: Option<String>,
    /// Fingerprint of the run in the log; absent if the run did not come to its end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub digest_logged: Option<String>,
    /// Fingerprint of the new run.
    pub digest: String,
    /// The first process that failed in the run of the log: from its tick on nothing is compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left: Option<Left>,
    /// Whether the log holds the whole run, without a failure.
    pub whole: bool,
    /// Whether the two runs are the same, as far as the log goes.
    pub same: bool,
    /// Last tick of the new run.
    pub ticks: u64,
    /// Real time that it took [s].
    pub wall_time_s: f64,
    /// Their messages; absent for a log that was cut from another.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub comparison: Option<Comparison>,
}

/// What a log says of its run.
#[derive(Debug, Default)]
struct Recorded {
    origin: Origin,
    result: BTreeMap<String, String>,
    filtered: bool,
    /// Whether the last state of the world is that of its end.
    over: bool,
    /// Whether all its messages are there.
    whole: bool,
}

/// Does the run in a log again, from the scenario in it, and compares.
///
/// # Errors
/// [`LogsError`]: the log cannot be read, or its run cannot be done again.
pub fn rerun(log: &Path, options: RerunOptions, watch: &mut Watch) -> Result<Rerun, LogsError> {
    let recorded = Recorded::read(log, watch)?;
    let mut scenario = recorded.origin.scenario(
        log,
        &[],
        "it cannot be done again the same; runs in lock-step can",
    )?;
    refuse_external(log, &scenario, options.allow_external)?;
    // Nobody looks at it.
    scenario.log.viewer_rate_hz = 0.0;
    let folder = tempfile::tempdir().map_err(|source| MissionError::System {
        what: "cannot make a temporary directory".into(),
        source,
    })?;
    let again = folder.path().join("again.mcap");
    let interrupted = Arc::clone(&watch.interrupted);
    let left = first_failure(log, |_| true, watch)?;
    let report = if options.in_process {
        in_process::run(
            &scenario,
            &InProcessOptions {
                out: Some(again.clone()),
                show: !watch.quiet,
                interrupted,
                ..InProcessOptions::default()
            },
        )?
    } else {
        mission::run(
            &scenario,
            &MissionOptions {
                out: Some(again.clone()),
                quiet: watch.quiet,
                interrupted,
                ..MissionOptions::default()
            },
        )?
    };
    if report.interrupted {
        return Err(LogsError::Interrupted);
    }
    let digest = report.summary.digest;
    let ended =
        recorded.over && recorded.result.contains_key("digest") && recorded.whole && left.is_none();
    let digest_logged = if recorded.filtered {
        recorded.result.get(RUN_DIGEST).filter(|_| left.is_none())
    } else {
        recorded.result.get("digest").filter(|_| ended)
    };
    let comparison = if recorded.filtered {
        None
    } else {
        let mut comparison = compare(log, &again, !ended, watch)?;
        if let Some(left) = &left {
            comparison.keep_before(left.tick);
        }
        Some(comparison)
    };
    let digests_agree = digest_logged.is_none_or(|logged| *logged == digest);
    let same = digests_agree && comparison.as_ref().is_none_or(|c| c.differences.is_empty());
    let version = recorded.origin.manifest.get("version");
    Ok(Rerun {
        scenario: scenario.name,
        seed: scenario.run.seed,
        recorded_by: version
            .filter(|version| *version != env!("CARGO_PKG_VERSION"))
            .cloned(),
        digest_logged: digest_logged.cloned(),
        digest,
        left,
        whole: ended || recorded.filtered && digest_logged.is_some(),
        same,
        ticks: report.summary.ticks,
        wall_time_s: report.wall_time_s,
        comparison,
    })
}

impl Recorded {
    fn read(log: &Path, watch: &mut Watch) -> Result<Self, LogsError> {
        let mut recorded = Self::default();
        let mut reader = Reader::open(log, Some(watch))?;
        let mut topics = BTreeSet::new();
        let mut states = None;
        while let Some(item) = reader.next()? {
            match item {
                Item::Metadata(record) => match record.name.as_str() {
                    MANIFEST => recorded.origin.manifest = record.metadata,
                    RESULT => recorded.result = record.metadata,
                    FILTERED => recorded.filtered = true,
                    _ => {}
                },
                Item::Attachment(header, data) if header.name == "scenario.toml" => {
                    recorded.origin.scenario = Some(data.to_vec());
                }
                Item::Channel(channel) => {
                    recorded.origin.check_layout(log, &channel)?;
                    if channel.topic == WorldState::NAME {
                        states = Some(channel.id);
                    }
                    topics.insert(channel.topic.clone());
                }
                Item::Message(header, data) if Some(header.channel_id) == states => {
                    let body = data.get(ENCAPSULATION..).unwrap_or_default();
                    recorded.over = WorldHeader::read_from_prefix(body)
                        .is_ok_and(|(state, _)| state.phase == WorldHeader::OVER);
                }
                _ => {}
            }
        }
        recorded.whole = reader.condition().data;
        recorded.origin.check(log)?;
        // A version that knew fewer topics would have said less.
        if !recorded.filtered
            && !topics.is_empty()
            && let Some(topic) = known::simulated().find(|name| !topics.contains(*name))
        {
            return Err(recorded.origin.layout(log, topic, "none"));
        }
        Ok(recorded)
    }
}
