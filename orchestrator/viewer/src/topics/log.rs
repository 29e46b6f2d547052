//! Events and stderr of processes as log lines.

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::process::{LogHeader, ProcessEvent};
use ipc_types::messages::world::WorldEvent;
use ipc_types::topics::{ProcessEvents, ProcessLog, TopicId, WorldEvents};
use recorder::{ProcessInfo, RobotInfo};

use super::channel::ViewerChannel;
use super::picture::Picture;
use super::primitives::time;
use crate::ros::messages::Log;

/// Levels of log lines.
const DEBUG: u8 = 10;
const INFO: u8 = 20;
const WARN: u8 = 30;
const ERROR: u8 = 40;

/// `/rosout`.
pub(super) struct LogTopic {
    channel: ViewerChannel<Log>,
    processes: Vec<ProcessInfo>,
}

impl LogTopic {
    pub(super) fn new(processes: &[ProcessInfo], picture: &mut Picture) -> Self {
        Self {
            channel: picture.add_channel("/rosout"),
            processes: processes.to_vec(),
        }
    }
}

impl Consumer<Picture> for LogTopic {
    fn topics(&self) -> &[TopicId] {
        &[
            TopicId::WorldEvents,
            TopicId::ProcessEvents,
            TopicId::ProcessLog,
        ]
    }

    fn message(&mut self, logged: &LoggedMessage<'_>, picture: &mut Picture) {
        let (time_ns, processes) = (logged.time_ns, &self.processes);
        let mut lines = Vec::new();
        if let Some((_, events)) = logged.view::<WorldEvents>() {
            lines.extend(events.map(|event| message(&event, &picture.robots, time_ns)));
        }
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
fn message(event: &WorldEvent, robots: &[RobotInfo], time_ns: u64) -> Log {
    let level = match WorldEvent::name_of(event.kind) {
        "invalid_command" | "missing_command" | "stands" => WARN,
        "contact_begin" | "contact_end" => DEBUG,
        _ => INFO,
    };
    Log {
        stamp: time(time_ns),
        level,
        msg: sentence(event, robots),
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

/// Returns a line of stderr of a process as a log line.
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

/// Returns an event as a sentence.
fn sentence(event: &WorldEvent, robots: &[RobotInfo]) -> String {
    let name = |index: u32| match robots.get(index as usize) {
        Some(robot) => robot.name.clone(),
        None if index == WorldEvent::NONE => "an obstacle".to_owned(),
        None => format!("robot {index}"),
    };
    let (robot, other) = (name(event.robot), name(event.other));
    let has_robot = event.robot != WorldEvent::NONE;
    match WorldEvent::name_of(event.kind) {
        "captured" if event.other == WorldEvent::NONE => format!("{robot} was caught"),
        "captured" => format!("{robot} was caught by {other}"),
        "escaped" => format!("{robot} escaped"),
        "timed_out" if has_robot => format!("{robot} reached the time limit"),
        "timed_out" => "the time limit is reached".to_owned(),
        "goal_reached" => format!("{robot} reached its goal"),
        "contact_begin" => format!("{robot} touches {other}"),
        "contact_end" => format!("{robot} no longer touches {other}"),
        "invalid_command" => format!("{robot} received an invalid command and stops"),
        "missing_command" => format!("{robot} received no command and stops"),
        "obstacle" => format!("obstacle {} changed", event.other),
        "game_over" => "the game is over".to_owned(),
        "stands" => format!("{robot} stands: no progress for {:.0} s", event.value),
        other if has_robot => format!("{robot}: {}", other.replace('_', " ")),
        other => format!("{} event (code {})", other.replace('_', " "), event.kind),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sentences_name_the_robots() {
        let robots = ["police_1", "baddie_1"]
            .map(|name| RobotInfo {
                name: name.to_owned(),
                radius: 0.1,
                visits_waypoints: false,
                lap_limit_s: None,
            })
            .to_vec();
        let say = |kind, robot, other| {
            sentence(
                &WorldEvent {
                    kind,
                    robot,
                    other,
                    ..WorldEvent::default()
                },
                &robots,
            )
        };
        let none = WorldEvent::NONE;
        assert_eq!(say(0, 1, 0), "baddie_1 was caught by police_1");
        assert_eq!(say(1, 1, 0), "baddie_1 escaped");
        assert_eq!(say(4, 0, none), "police_1 touches an obstacle");
        assert_eq!(say(4, 0, 1), "police_1 touches baddie_1");
        assert_eq!(say(8, none, 12), "obstacle 12 changed");
        assert_eq!(say(77, none, none), "unknown event (code 77)");
        assert!(
            WorldEvent::NAMES
                .iter()
                .enumerate()
                .all(|(kind, _)| { !say(kind as u32, 1, 0).contains("unknown") })
        );
    }
}
