//! Events and output of processes as log lines.

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::event_names::EventNames;
use ipc_types::messages::process::{LogHeader, ProcessEvent};
use ipc_types::messages::world::WorldEvent;
use ipc_types::topics::{ProcessEvents, ProcessLog, TopicId};
use recorder::{ProcessInfo, RunInfo};

use super::channel::ViewerChannel;
use super::picture::Picture;
use super::primitives::time;
use ros_messages::messages::Log;

/// Levels of log lines.
const DEBUG: u8 = 10;
const INFO: u8 = 20;
const WARN: u8 = 30;
const ERROR: u8 = 40;

/// `/rosout`.
pub(super) struct LogTopic {
    channel: ViewerChannel<Log>,
    names: EventNames,
    processes: Vec<ProcessInfo>,
}

impl LogTopic {
    pub(super) fn new(run: &RunInfo, picture: &mut Picture) -> Self {
        Self {
            channel: picture.add_channel("/rosout"),
            names: run.event_names(),
            processes: run.processes.clone(),
        }
    }
}

impl Consumer<Picture> for LogTopic {
    fn topics(&self) -> &[TopicId] {
        &[
            TopicId::WorldEvents,
            TopicId::RobotEvents,
            TopicId::ProcessEvents,
            TopicId::ProcessLog,
        ]
    }

    fn message(&mut self, logged: &LoggedMessage<'_>, picture: &mut Picture) {
        let (time_ns, names, processes) = (logged.time_ns, &self.names, &self.processes);
        let mut lines = Vec::new();
        let events = logged.events();
        lines.extend(events.map(|event| message(&event, names, time_ns)));
        if let Some((_, events)) = logged.view::<ProcessEvents>() {
            lines.extend(events.map(|event| process_event(&event, processes, time_ns)));
        }
        if let Some((header, text)) = logged.view::<ProcessLog>() {
            let text: Vec<u8> = text.collect();
            lines.push(process_log(&header, &text, processes, time_ns));
        }
        for line in &lines {
            self.channel.write(&mut picture.ready, time_ns, line);
        }
    }
}

/// Returns an event as a log line.
fn message(event: &WorldEvent, names: &EventNames, time_ns: u64) -> Log {
    let level = match WorldEvent::name_of(event.kind) {
        "invalid_command" | "missing_command" | "stands" => WARN,
        "contact_begin" | "contact_end" => DEBUG,
        _ => INFO,
    };
    Log {
        stamp: time(time_ns),
        level,
        msg: names.words(event),
        name: "world".to_owned(),
        ..Log::default()
    }
}

/// Returns a process event as a log line.
fn process_event(event: &ProcessEvent, processes: &[ProcessInfo], time_ns: u64) -> Log {
    let name = process_name(event.process, processes);
    let tick = event.tick;
    let (level, message) = match event.kind {
        ProcessEvent::LEFT => (
            ERROR,
            format!("{name} failed at tick {tick}: it {}", event.reason_text()),
        ),
        ProcessEvent::BACK => (INFO, format!("{name} is back at tick {tick}")),
        _ => (
            ERROR,
            format!("{name} is not restarted: {}", event.reason_text()),
        ),
    };
    Log {
        stamp: time(time_ns),
        level,
        msg: message,
        name: "supervisor".to_owned(),
        ..Log::default()
    }
}

/// Returns a line of output of a process as a log line.
fn process_log(header: &LogHeader, text: &[u8], processes: &[ProcessInfo], time_ns: u64) -> Log {
    Log {
        stamp: time(time_ns),
        // The message has 1 for debug to 4 for errors, and 0 for unknown.
        level: match header.level {
            1 => DEBUG,
            3 => WARN,
            4.. => ERROR,
            _ => INFO,
        },
        msg: String::from_utf8_lossy(text).into_owned(),
        name: process_name(header.process, processes),
        ..Log::default()
    }
}

fn process_name(index: u32, processes: &[ProcessInfo]) -> String {
    let mut known = processes.iter();
    match known.find(|process| process.index == index) {
        Some(process) => process.name.clone(),
        None => format!("process {index}"),
    }
}
