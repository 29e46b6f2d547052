//! ROS 2 bags: a directory with the log and a description of it.

use std::collections::BTreeMap;
use std::fmt::{self, Write as _};
use std::fs::File;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use mcap_log::derived;
use mcap_log::reader::{Item, Reader};
use mcap_log::{DerivedError, LogReadError, ReadProgress};
use platform::atomic_file::Readers;
use serde::Serialize;

use super::Folder;

/// Result of the export of a bag.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Ros2Bag {
    /// The copy of the log.
    pub log: PathBuf,
    /// The description.
    pub metadata: PathBuf,
    /// Number of messages.
    pub messages: u64,
    /// Number of topics.
    pub topics: usize,
}

/// Writes a ROS 2 bag into a directory: a copy of the log, and `metadata.yaml` in version 5 of rosbag2, which all later
/// versions read.
///
/// # Errors
/// [`DerivedError`]; then no file is written. [`LogReadError::Argument`] if the log is incomplete or damaged, or has
/// messages that are not CDR.
pub fn ros2bag(
    log: &Path,
    out: &Path,
    force: bool,
    watch: &mut ReadProgress,
) -> Result<Ros2Bag, DerivedError> {
    let description = Description::from_log(log, watch)?;
    let name = log.file_name().map_or_else(
        || "log.mcap".to_owned(),
        |name| name.to_string_lossy().into_owned(),
    );
    let folder = Folder::make(out, force)?;
    let bag = Ros2Bag {
        log: out.join(&name),
        metadata: out.join("metadata.yaml"),
        messages: description.messages,
        topics: description.topics.len(),
    };
    let copied = |mut file: &mut dyn io::Write| io::copy(&mut File::open(log)?, &mut file);
    let mut data = derived::create(&bag.log, log, force, Readers::All)?;
    copied(&mut data).map_err(derived::failed(&bag.log))?;
    let mut metadata = derived::create(&bag.metadata, log, force, Readers::All)?;
    let yaml = description.yaml(&name);
    let written = yaml.map_err(io::Error::other);
    written
        .and_then(|yaml| metadata.write_all(yaml.as_bytes()))
        .map_err(derived::failed(&bag.metadata))?;
    data.commit().map_err(derived::failed(&bag.log))?;
    metadata.commit().map_err(derived::failed(&bag.metadata))?;
    folder.keep();
    Ok(bag)
}

/// Content of `metadata.yaml`.
#[derive(Default)]
struct Description {
    start_ns: u64,
    end_ns: u64,
    messages: u64,
    topics: BTreeMap<String, Topic>,
}

/// A topic of a bag.
#[derive(Default)]
struct Topic {
    /// `PACKAGE/msg/NAME`.
    message: String,
    /// The quality of service, in YAML; empty for the default.
    quality: String,
    messages: u64,
}

impl Description {
    fn from_log(log: &Path, watch: &mut ReadProgress) -> Result<Self, LogReadError> {
        let refused = |reason: String| {
            LogReadError::Argument(format!("--ros2bag: {}: {reason}", log.display()))
        };
        let mut reader = Reader::open(log, Some(watch))?;
        let mut channels = BTreeMap::new();
        let mut all = Self {
            start_ns: u64::MAX,
            ..Self::default()
        };
        while let Some(item) = reader.next()? {
            match item {
                Item::Message(header, _) => {
                    all.start_ns = all.start_ns.min(header.log_time);
                    all.end_ns = all.end_ns.max(header.log_time);
                    all.messages += 1;
                    let topic = channels.get(&header.channel_id);
                    if let Some(topic) = topic.and_then(|name| all.topics.get_mut(name)) {
                        topic.messages += 1;
                    }
                }
                Item::Channel(channel) => {
                    if channel.message_encoding != "cdr" {
                        return Err(refused(format!(
                            "topic {} has the encoding {:?}, a ROS 2 bag has `cdr`",
                            channel.topic, channel.message_encoding
                        )));
                    }
                    let schema = reader.schema(channel.schema_id);
                    let quality = channel.metadata.get("offered_qos_profiles");
                    let topic = all.topics.entry(channel.topic.clone()).or_default();
                    topic.message = schema.map(|schema| schema.name.clone()).unwrap_or_default();
                    topic.quality = quality.cloned().unwrap_or_default();
                    channels.insert(channel.id, channel.topic.clone());
                }
                _ => {}
            }
        }
        let condition = reader.condition();
        if !condition.is_whole() || !condition.index {
            return Err(refused(
                "it is incomplete; `protean recover` writes a complete one".to_owned(),
            ));
        }
        all.start_ns = all.start_ns.min(all.end_ns);
        Ok(all)
    }

    /// Returns the content of `metadata.yaml`. JSON strings are strings of YAML.
    fn yaml(&self, file: &str) -> Result<String, fmt::Error> {
        let text = |text: &str| serde_json::Value::from(text).to_string();
        let (start, file) = (self.start_ns, text(file));
        let duration = self.end_ns - start;
        let mut out = String::new();
        writeln!(out, "rosbag2_bagfile_information:")?;
        writeln!(out, "  version: 5")?;
        writeln!(out, "  storage_identifier: mcap")?;
        writeln!(out, "  duration: {{nanoseconds: {duration}}}")?;
        writeln!(out, "  starting_time: {{nanoseconds_since_epoch: {start}}}")?;
        writeln!(out, "  message_count: {}", self.messages)?;
        writeln!(out, "  topics_with_message_count:")?;
        for (name, topic) in &self.topics {
            writeln!(out, "    - topic_metadata:")?;
            writeln!(out, "        name: {}", text(name))?;
            writeln!(out, "        type: {}", text(&topic.message))?;
            writeln!(out, "        serialization_format: cdr")?;
            writeln!(
                out,
                "        offered_qos_profiles: {}",
                text(&topic.quality)
            )?;
            writeln!(out, "      message_count: {}", topic.messages)?;
        }
        // The chunks of the log may be compressed; the bag itself is not.
        writeln!(out, "  compression_format: \"\"")?;
        writeln!(out, "  compression_mode: \"\"")?;
        writeln!(out, "  relative_file_paths: [{file}]")?;
        writeln!(out, "  files:")?;
        writeln!(out, "    - path: {file}")?;
        writeln!(
            out,
            "      starting_time: {{nanoseconds_since_epoch: {start}}}"
        )?;
        writeln!(out, "      duration: {{nanoseconds: {duration}}}")?;
        writeln!(out, "      message_count: {}", self.messages)?;
        Ok(out)
    }
}
