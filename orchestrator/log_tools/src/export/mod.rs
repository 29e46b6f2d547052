//! Export of a log: the messages as tables, one file for each topic, or the whole as a ROS 2 bag.

mod folder;
mod ros2bag;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use mcap_log::Condition;
use mcap_log::ReadProgress;
use mcap_log::Topics;
use mcap_log::derived;
use mcap_log::output::MANIFEST;
use mcap_log::reader::{Channel, Item, Reader};
use mcap_log::{DerivedError, LogReadError};
use platform::atomic_file::{AtomicFile, Readers};
use serde::Serialize;
use tables::{self, Format, Rows};

use self::folder::Folder;
pub use self::ros2bag::{Ros2Bag, ros2bag};
use crate::layout::Layout;
use crate::measured::Measured;
use crate::measurement::Measurement;
use crate::topic_table::{RobotNames, TopicTable, layout};

/// Maximum number of tables; each is an open file.
const MAX_TABLES: usize = 500;

/// Options of an export.
#[derive(Debug, Clone)]
pub struct ExportOptions {
    /// Format of the tables.
    pub format: Format,
    /// Exported topics.
    pub topics: Topics,
    /// `true` if existing tables may be overwritten.
    pub force: bool,
}

impl ExportOptions {
    /// Returns the end of the names of the files.
    fn extension(&self) -> &'static str {
        match self.format {
            Format::Csv => "csv",
            Format::Parquet => "parquet",
        }
    }
}

/// One table.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Table {
    /// Path of the file.
    pub file: PathBuf,
    /// Number of messages in it.
    pub messages: u64,
    /// Number of rows.
    pub rows: u64,
    /// Number of messages that do not fit their schema and were omitted.
    pub undecodable: u64,
    /// Reason of the first of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fault: Option<String>,
}

impl Table {
    /// Returns a table without rows.
    fn empty(file: PathBuf) -> Self {
        Self {
            file,
            messages: 0,
            rows: 0,
            undecodable: 0,
            fault: None,
        }
    }
}

/// Result of an export.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ExportReport {
    /// The tables, by topic; those of measurements by their names.
    pub tables: BTreeMap<String, Table>,
    /// Topics that have messages but no table, with the reason.
    pub skipped: BTreeMap<String, String>,
    /// Condition of the log.
    pub source: Condition,
}

/// Reason why a viewer topic has no table.
const REPEATS: &str = "for viewers, repeats other topics; --topics selects it";

/// Treatment of a channel.
enum Fate {
    /// The topic is not selected.
    Ignored,
    /// The topic has no table; contains topic and reason until the first message.
    Skipped(Option<(String, String)>),
    /// The topic has a table, perhaps with its first message.
    Table(Box<OpenTable>),
}

/// A table that is being written.
struct OpenTable {
    topic: String,
    layout: Layout,
    /// Path of the file.
    file: PathBuf,
    /// The table, from the first message on.
    table: Option<TopicTable<AtomicFile>>,
}

/// Writes a table for every topic of ROS 2 messages into a directory. Each element of each message is a row, with the
/// fields of the message before those of the element.
///
/// # Errors
/// [`DerivedError`]; then no table is written.
pub fn export(
    log: &Path,
    out: &Path,
    options: &ExportOptions,
    watch: &mut ReadProgress,
) -> Result<ExportReport, DerivedError> {
    let mut reader = Reader::open(log, Some(watch))?;
    let folder = Folder::make(out, options.force)?;
    let mut export = Export {
        log,
        out,
        options,
        channels: BTreeMap::new(),
        skipped: BTreeMap::new(),
        names: Measured::ALL
            .map(|table| (table.name().to_owned(), 0))
            .into(),
        tables: 0,
        is_run: false,
        robots: RobotNames::default(),
        measured: Vec::new(),
    };
    for table in Measured::ALL {
        if options.topics.take(table.name()) {
            export.measured.push((table.name(), table.begin(), None));
        }
    }
    while let Some(item) = reader.next()? {
        export.measure(&item)?;
        match item {
            Item::Message(header, data) => export.message(&header, data)?,
            Item::Channel(channel) => {
                let schema = reader.schema(channel.schema_id);
                export.channel(&channel, schema.as_deref())?;
            }
            Item::Metadata(record) => export.is_run |= record.name == MANIFEST,
            _ => {}
        }
    }
    let topics = reader.channels().map(|channel| channel.topic.as_str());
    let measured = export.measured.iter();
    let measured = measured.filter_map(|(name, _, table)| table.as_ref().map(|_| *name));
    let topics = topics.chain(measured);
    options.topics.check(&topics)?;
    let exported = export.finish(reader.condition().clone())?;
    folder.keep();
    Ok(exported)
}

/// Export in progress, while the log is read.
struct Export<'a> {
    log: &'a Path,
    out: &'a Path,
    options: &'a ExportOptions,
    channels: BTreeMap<u16, Fate>,
    /// Topics with messages but no table, with the reasons.
    skipped: BTreeMap<String, String>,
    names: BTreeMap<String, u16>,
    /// Number of tables begun.
    tables: usize,
    /// `true` for the log of a run.
    is_run: bool,
    /// Names of the robots.
    robots: RobotNames,
    /// Names of the tables of measurements, with their rows from the first one on.
    measured: Vec<(&'static str, Box<dyn Measurement>, Option<MeasuredTable>)>,
}

type MeasuredTable = (Table, Box<dyn Rows<AtomicFile>>);

impl Export<'_> {
    /// Selects the treatment of a channel.
    fn channel(
        &mut self,
        channel: &Channel,
        schema: Option<&mcap_log::reader::Schema>,
    ) -> Result<(), LogReadError> {
        self.robots.channel(channel, schema);
        let topics = &self.options.topics;
        let repeats = self.is_run && channel.topic.starts_with('/');
        let fate = if repeats && topics.is_unlimited() {
            Fate::Skipped(Some((channel.topic.clone(), REPEATS.to_owned())))
        } else if topics.take(&channel.topic) {
            match layout(channel, schema) {
                Ok(layout) => {
                    let extension = self.options.extension();
                    let name = file_name(channel, extension, &mut self.names);
                    Fate::Table(Box::new(OpenTable {
                        topic: channel.topic.clone(),
                        layout,
                        file: self.out.join(name),
                        table: None,
                    }))
                }
                Err(why) if topics.names(&channel.topic) => {
                    return Err(LogReadError::Argument(format!(
                        "--topics {}: {why}",
                        channel.topic
                    )));
                }
                Err(why) => Fate::Skipped(Some((channel.topic.clone(), why.to_string()))),
            }
        } else {
            Fate::Ignored
        };
        self.channels.insert(channel.id, fate);
        Ok(())
    }

    /// Adds the rows of the measurements; the first one creates the table.
    fn measure(&mut self, item: &Item<'_>) -> Result<(), DerivedError> {
        let Self { log, options, .. } = *self;
        for (name, measured, table) in &mut self.measured {
            for row in measured.take(item) {
                let (table, rows) = if let Some(table) = table {
                    table
                } else {
                    let file = self.out.join(*name).with_extension(options.extension());
                    let open = derived::create(&file, log, options.force, Readers::All)?;
                    let rows = tables::begin(options.format, open, &measured.columns());
                    let rows = rows.map_err(derived::failed(&file))?;
                    table.insert((Table::empty(file), rows))
                };
                rows.row(&row).map_err(derived::failed(&table.file))?;
                table.rows += 1;
            }
        }
        Ok(())
    }

    /// Adds a message to the table of its channel; the first message creates the table.
    fn message(
        &mut self,
        header: &mcap_log::MessageHeader,
        data: &[u8],
    ) -> Result<(), DerivedError> {
        self.robots.message(header, data);
        match self.channels.get_mut(&header.channel_id) {
            None | Some(Fate::Ignored) => Ok(()),
            Some(Fate::Skipped(reason)) => {
                self.skipped.extend(reason.take());
                Ok(())
            }
            Some(Fate::Table(open)) => {
                if open.table.is_none() {
                    self.tables += 1;
                    if self.tables > MAX_TABLES {
                        return Err(LogReadError::Argument(format!(
                            "--topics: the log has more than {MAX_TABLES} topics; choose some"
                        ))
                        .into());
                    }
                    open.begin(self.log, self.options, &self.robots.names)?;
                }
                let taken = open.table.as_mut().map(|table| table.take(header, data));
                taken.unwrap_or(Ok(())).map_err(derived::failed(&open.file))
            }
        }
    }

    /// Completes all tables and moves them to their final paths.
    fn finish(self, source: Condition) -> Result<ExportReport, DerivedError> {
        let mut tables = BTreeMap::new();
        let mut finished = Vec::new();
        for fate in self.channels.into_values() {
            if let Fate::Table(open) = fate
                && let Some(table) = open.table
            {
                let written = Table {
                    file: open.file.clone(),
                    messages: table.messages,
                    rows: table.row_count,
                    undecodable: table.undecodable,
                    fault: table.fault.clone(),
                };
                let file = table.finish().map_err(derived::failed(&open.file))?;
                let name = if tables.contains_key(&open.topic) {
                    format!("{} ({})", open.topic, open.file.display())
                } else {
                    open.topic
                };
                finished.push((open.file, file));
                tables.insert(name, written);
            }
        }
        for (name, measured, table) in self.measured {
            let Some((mut table, rows)) = table else {
                continue;
            };
            table.messages = measured.messages();
            let file = rows.finish().map_err(derived::failed(&table.file))?;
            finished.push((table.file.clone(), file));
            tables.insert(name.to_owned(), table);
        }
        // Tables move to their final paths only when all are complete.
        for (path, file) in finished {
            file.commit().map_err(derived::failed(&path))?;
        }
        Ok(ExportReport {
            tables,
            skipped: self.skipped,
            source,
        })
    }
}

impl OpenTable {
    /// Creates the table.
    fn begin(
        &mut self,
        log: &Path,
        options: &ExportOptions,
        robots: &[String],
    ) -> Result<(), DerivedError> {
        let path = &self.file;
        let file = derived::create(path, log, options.force, Readers::All)?;
        let begin = |columns: &[tables::Column]| tables::begin(options.format, file, columns);
        let table = TopicTable::begin(&self.topic, self.layout.clone(), robots, begin);
        self.table = Some(table.map_err(derived::failed(path))?);
        Ok(())
    }
}

/// Returns the file name: `world/state` becomes `world.state.csv`; a name in use gets the channel's number.
fn file_name(channel: &Channel, extension: &str, names: &mut BTreeMap<String, u16>) -> String {
    let safe = |c: char| match c {
        '/' => '.',
        c if c.is_ascii_alphanumeric() || "._-".contains(c) => c,
        _ => '_',
    };
    let name: String = channel
        .topic
        .trim_matches('/')
        .chars()
        .map(safe)
        .take(200)
        .collect();
    // Neither hidden nor an option of a command.
    let name = name.trim_start_matches(['.', '-']);
    let name = if name.is_empty() { "topic" } else { name };
    let mut name = name.to_owned();
    while names.contains_key(&name) {
        name = format!("{name}-{}", channel.id);
    }
    names.insert(name.clone(), channel.id);
    format!("{name}.{extension}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_tables_are_no_options_no_paths_and_differ() {
        let mut names = BTreeMap::new();
        let mut name = |id: u16, topic: &str| {
            let channel = Channel {
                id,
                schema_id: 0,
                topic: topic.to_owned(),
                message_encoding: "cdr".to_owned(),
                metadata: BTreeMap::new(),
            };
            file_name(&channel, "csv", &mut names)
        };
        assert_eq!(name(1, "-rf"), "rf.csv");
        assert_eq!(name(2, "../x"), "x.csv");
        assert_eq!(name(3, "a/b"), "a.b.csv");
        assert_eq!(name(4, "/a.b"), "a.b-4.csv");
        assert_eq!(name(5, "c-7"), "c-7.csv");
        assert_eq!(name(6, "c"), "c.csv");
        assert_eq!(name(7, "c"), "c-7-7.csv");
    }
}
