//! Repair of a log that is truncated or damaged.

use std::path::{Path, PathBuf};

use mcap_log::Condition;
use mcap_log::DerivedError;
use mcap_log::ReadProgress;
use mcap_log::output::{Output, RECOVERED, mark_incomplete};
use mcap_log::reader::{Item, Reader};
use serde::Serialize;

/// Maximum number of logs in one file that are recovered, each in a new log of its own.
const MAX_LOGS: usize = 64;

/// Result of a repair.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecoveryReport {
    /// The new log.
    pub out: PathBuf,
    /// Number of messages in the new log.
    pub messages: u64,
    /// Number of messages that the old log claims beyond these; absent if it has no such claim.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost: Option<u64>,
    /// Number of attachments in the new log.
    pub attachments: u64,
    /// Number of metadata records in the new log, without the record of the repair.
    pub metadata: u64,
    /// Time of the last message (s).
    pub end_s: f64,
    /// Size of the new log (bytes).
    pub bytes: u64,
    /// Condition of the old log.
    pub source: Condition,
    /// Further logs that followed the end of the first one in the file, each with a new log of its own.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub further: Vec<RecoveryReport>,
}

/// Writes all readable records of a log into a new log, in the same order, with an index and a summary. Of several
/// logs in one file, joined end to end, the second is written to `NAME_2.mcap`, and so on.
///
/// # Errors
/// [`DerivedError`]; then no new log is written.
pub fn recover(
    log: &Path,
    out: &Path,
    force: bool,
    watch: &mut ReadProgress,
) -> Result<RecoveryReport, DerivedError> {
    let mut copies = Vec::new();
    let mut next = Some(0);
    while let Some(start) = next.filter(|_| copies.len() < MAX_LOGS) {
        let mut reader = Reader::open_at(log, start, Some(&mut *watch))?;
        copies.push(copy(&mut reader, &numbered(out, copies.len()), force)?);
        next = reader.following();
    }
    // All are complete before the first appears.
    let finished = copies.into_iter().map(|(mut recovered, output)| {
        recovered.bytes = output.finish()?;
        Ok(recovered)
    });
    let mut logs = finished.collect::<Result<Vec<_>, DerivedError>>()?;
    let mut first = logs.remove(0);
    first.further = logs;
    Ok(first)
}

/// Returns the path of a new log with this index.
fn numbered(out: &Path, index: usize) -> PathBuf {
    if index == 0 {
        return out.to_owned();
    }
    let mut name = out.file_stem().unwrap_or_default().to_owned();
    name.push(format!("_{}", index + 1));
    if let Some(extension) = out.extension() {
        name.push(".");
        name.push(extension);
    }
    out.with_file_name(name)
}

/// Copies all readable records of a log.
fn copy(
    reader: &mut Reader<'_>,
    out: &Path,
    force: bool,
) -> Result<(RecoveryReport, Output), DerivedError> {
    let log = reader.path().to_owned();
    let mut output: Option<Output> = None;
    let (mut messages, mut attachments, mut metadata, mut end_ns) = (0, 0, 0, 0);
    // The result record comes last, when it is known whether messages are missing.
    let mut results = Vec::new();
    while let Some(item) = reader.next()? {
        let output = match (&mut output, &item) {
            (Some(output), _) => output,
            (none, Item::Header { profile, .. }) => {
                *none = Some(Output::create(out, &log, force, profile)?);
                continue;
            }
            (none, _) => none.insert(Output::create(out, &log, force, "")?),
        };
        match item {
            Item::Header { .. } => {}
            Item::Schema(id, schema) => output.schema(id, &schema)?,
            Item::Channel(channel) => output.channel(&channel)?,
            Item::Message(header, data) => {
                messages += 1;
                end_ns = end_ns.max(header.log_time);
                output.message(&header, data)?;
            }
            Item::Attachment(header, data) => {
                attachments += 1;
                output.attachment(&header, data)?;
            }
            Item::Metadata(record) => {
                metadata += 1;
                if record.name == mcap_log::output::RESULT {
                    results.push(record);
                } else {
                    output.metadata(&record)?;
                }
            }
        }
    }
    reader.check_all()?;
    let source = reader.condition().clone();
    let mut output = match output {
        Some(output) => output,
        None => Output::create(out, &log, force, "")?,
    };
    for result in results {
        let result = if source.data {
            result
        } else {
            mark_incomplete(result)
        };
        output.metadata(&result)?;
    }
    let lost = source
        .claimed_messages
        .map(|claimed| claimed.saturating_sub(messages));
    if !source.is_whole() {
        let name = log.file_name().unwrap_or_default().to_string_lossy();
        output.note(
            RECOVERED,
            [
                ("from", name.into_owned()),
                ("messages", messages.to_string()),
                ("faults", source.lines().join("\n")),
            ],
        )?;
    }
    let recovered = RecoveryReport {
        out: out.to_owned(),
        messages,
        lost,
        attachments,
        metadata,
        end_s: mcap_log::seconds(end_ns),
        bytes: 0,
        source,
        further: Vec::new(),
    };
    Ok((recovered, output))
}
