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
use super::known::{self, ENCAPSULATION};
use super::output::{FILTERED, MANIFEST, RESULT, RUN_DIGEST};
use super::reader::{Channel, Item, Reader};
use super::watch::Watch;
use crate::in_process::{self, InProcessOptions};
use crate::mission::{self, MissionOptions};
use crate::scenario::files::Base;
use crate::scenario::spec::Mode;
use crate::scenario::{Loader, Program, ResolvedScenario};

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
    /// Whether the log holds the whole run.
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
    manifest: BTreeMap<String, String>,
    scenario: Option<Vec<u8>>,
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
    let scenario = recorded.scenario(log, options)?;
    let folder = tempfile::tempdir().map_err(|source| LogsError::Write {
        path: std::env::temp_dir(),
        source,
    })?;
    let again = folder.path().join("again.mcap");
    let interrupted = Arc::clone(&watch.interrupted);
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
    let ended = recorded.over && recorded.result.contains_key("digest") && recorded.whole;
    let digest_logged = if recorded.filtered {
        recorded.result.get(RUN_DIGEST)
    } else {
        recorded.result.get("digest").filter(|_| ended)
    };
    let comparison = if recorded.filtered {
        None
    } else {
        Some(compare(log, &again, !ended, watch)?)
    };
    let digests_agree = digest_logged.is_none_or(|logged| *logged == digest);
    let same = digests_agree && comparison.as_ref().is_none_or(|c| c.differences.is_empty());
    let version = recorded.manifest.get("version");
    Ok(Rerun {
        scenario: scenario.name,
        seed: scenario.run.seed,
        recorded_by: version
            .filter(|version| *version != env!("CARGO_PKG_VERSION"))
            .cloned(),
        digest_logged: digest_logged.cloned(),
        digest,
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
                    MANIFEST => recorded.manifest = record.metadata,
                    RESULT => recorded.result = record.metadata,
                    FILTERED => recorded.filtered = true,
                    _ => {}
                },
                Item::Attachment(header, data) if header.name == "scenario.toml" => {
                    recorded.scenario = Some(data.to_vec());
                }
                Item::Channel(channel) => {
                    recorded.check_layout(log, &channel)?;
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
        let foreign = |missing| LogsError::Foreign {
            path: log.to_owned(),
            missing,
        };
        if recorded.manifest.is_empty() {
            return Err(foreign("manifest"));
        }
        if recorded.scenario.is_none() {
            return Err(foreign("scenario"));
        }
        // A version that knew fewer topics would have said less.
        if !recorded.filtered
            && !topics.is_empty()
            && let Some(topic) = ipc_types::topics::NAMES
                .iter()
                .find(|name| !topics.contains(**name))
        {
            return Err(recorded.layout(log, topic, "none"));
        }
        Ok(recorded)
    }

    /// Whether a channel of ours is that of this version.
    fn check_layout(&self, log: &Path, channel: &Channel) -> Result<(), LogsError> {
        let Some(found) = channel.metadata.get("schema_hash") else {
            return Ok(());
        };
        match known::find(&channel.topic) {
            Some(known) if known.hash == *found => Ok(()),
            _ => Err(self.layout(log, &channel.topic, found)),
        }
    }

    fn layout(&self, log: &Path, topic: &str, found: &str) -> LogsError {
        let expected = known::find(topic).map_or("no such topic", |known| &known.hash);
        LogsError::Layout {
            path: log.to_owned(),
            version: self.manifest.get("version").cloned().unwrap_or_default(),
            topic: topic.to_owned(),
            found: found.to_owned(),
            expected: expected.to_owned(),
        }
    }

    /// The scenario as it was run.
    fn scenario(&self, log: &Path, options: RerunOptions) -> Result<ResolvedScenario, LogsError> {
        let refuse = |reason: String| {
            Err(LogsError::NotRepeatable {
                path: log.to_owned(),
                reason,
            })
        };
        let text = self.scenario.as_deref().unwrap_or_default();
        if let Some(expected) = self.manifest.get("scenario_blake3")
            && *expected != blake3::hash(text).to_hex().as_str()
        {
            return refuse("the scenario in it is not the one that was run".to_owned());
        }
        let Ok(text) = str::from_utf8(text) else {
            return refuse("the scenario in it is not text".to_owned());
        };
        let loaded = Loader::default().load_text("scenario.toml", text, &Base::Nothing, &[], None);
        let mut scenario = match loaded {
            Ok(scenario) => scenario,
            Err(problems) => {
                return refuse(format!(
                    "the scenario in it is not one for this version of protean{}:\n{problems}",
                    match self.manifest.get("version") {
                        Some(version) => format!(" (it is of {version})"),
                        None => String::new(),
                    }
                ));
            }
        };
        if scenario.run.mode == Mode::RealTime {
            return refuse(
                "it was recorded in real time: what the processes heard depended on the clock, so \
                 that it cannot be done again the same; runs in lock-step can"
                    .to_owned(),
            );
        }
        let external: Vec<String> = scenario
            .external_commands()
            .map(|process| match &process.program {
                Program::Command(words) => format!("\n    {}: {}", process.name, words.join(" ")),
                Program::Kind(_) => String::new(),
            })
            .collect();
        if !external.is_empty() && !options.allow_external {
            return refuse(format!(
                "its scenario starts programs that are not Protean's own; look at them and add \
                 --allow-external:{}",
                external.concat()
            ));
        }
        // Nobody looks at it.
        scenario.log.viewer_rate_hz = 0.0;
        Ok(scenario)
    }
}
