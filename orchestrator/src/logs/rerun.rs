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
use super::failures::{Failure, Left, failures};
use super::known::{self, ENCAPSULATION};
use super::origin::{Origin, refuse_external};
use super::output::{FILTERED, MANIFEST, RESULT, RUN_DIGEST};
use super::reader::{Item, Reader};
use super::watch::Watch;
use crate::in_process::{self, InProcessOptions};
use crate::mission::annex::Annex;
use crate::mission::{self, Absence, MissionError, MissionOptions};
use crate::scenario::kinds::{KINDS, Need, Product, find};
use crate::scenario::spec::MAX_PROCESSES;
use crate::scenario::{ProcessSpec, Program, ResolvedScenario};

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
    /// Failures of processes in the log that were repeated at their ticks.
    pub repeated: usize,
    /// The first process that failed in a way that cannot be repeated, if the run went on after that:
    /// from then on the run in the log depends on when that was, and is not compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left: Option<Left>,
    /// Whether the log holds the whole run, and all of it can be done again.
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
    let folder = Annex::for_files().map_err(MissionError::Space)?;
    let again = folder.path().join("again.mcap");
    let interrupted = Arc::clone(&watch.interrupted);
    let failed = failures(log, watch)?;
    let (absences, left) = if options.in_process {
        // There nobody can be replaced.
        (Vec::new(), failed.into_iter().next().map(|f| f.left))
    } else {
        recorded.repeatable(&scenario, failed)
    };
    let repeated = absences.len();
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
                absences,
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
        repeated,
        left,
        whole: ended || recorded.filtered && digest_logged.is_some(),
        same,
        ticks: report.summary.ticks,
        wall_time_s: report.wall_time_s,
        comparison,
    })
}

impl Recorded {
    /// Which failures can be repeated, and the first that cannot. Between two ticks a process can be
    /// taken away; in the middle of one it cannot.
    fn repeatable(
        &self,
        scenario: &ResolvedScenario,
        failed: Vec<Failure>,
    ) -> (Vec<Absence>, Option<Left>) {
        // Time is held by a seat of its own. What a cut or damaged log lacks of the words of a
        // process nobody knows.
        let any = scenario.processes.len() < MAX_PROCESSES && !self.filtered && self.whole;
        let mut absences = Vec::new();
        for failure in failed {
            let process = (failure.index as usize)
                .checked_sub(1)
                .and_then(|position| scenario.processes.get(position));
            let can_be = process.is_some_and(|process| !has_to_do_with_plans(process));
            // One that ended the run is not settled, unless the run was over meanwhile.
            let went_on = failure.is_settled || self.over;
            let is_tick = failure.left.tick < u64::from(u32::MAX);
            if !(any && can_be && went_on && is_tick) || failure.had_spoken {
                return (absences, Some(failure.left));
            }
            absences.push(Absence {
                tick: failure.left.tick,
                process: failure.index as usize,
            });
        }
        (absences, None)
    }

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

/// Whether a process asks for plans or makes them: that is in no log, nor how far it was with them.
pub(super) fn has_to_do_with_plans(process: &ProcessSpec) -> bool {
    let Program::Kind(kind) = &process.program else {
        return false;
    };
    find(KINDS, kind).is_some_and(|kind| {
        kind.makes(Product::Plans) || (kind.needs)(&process.params).contains(&Need::Plans)
    })
}
