//! The topic `world/robots`: the names and teams of the robots, which all other messages state by index.

use mcap_log::output::ROBOTS_TOPIC;
use mcap_log::ros2::{Cdr, Schema};
use mcap_log::states::latched_entry;
use mcap_log::{ChannelSpec, LogWriteError, LogWriter};

use super::run_info::RobotInfo;

/// Name of its message.
const MESSAGE: &str = "protean/msg/RobotNames";
/// Definition of its message.
const SCHEMA: &str = "\
protean/RobotName[] robots
================================================================================
MSG: protean/RobotName
uint32 robot
string name
string team
";

/// Adds the topic to a log, with its only message.
pub(super) fn write(robots: &[RobotInfo], log: &mut LogWriter) -> Result<(), LogWriteError> {
    let channel = log.add_channel(&ChannelSpec {
        topic: ROBOTS_TOPIC,
        schema_name: MESSAGE,
        schema_encoding: "ros2msg",
        schema: SCHEMA.as_bytes(),
        message_encoding: "cdr",
        metadata: &[latched_entry()].into(),
    })?;
    log.write(channel, 0, 0, 0, &encode(robots))
}

/// Returns the message in little-endian CDR.
fn encode(robots: &[RobotInfo]) -> Vec<u8> {
    const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];
    let mut out = ENCAPSULATION.to_vec();
    // A run has at most 64 robots, and a name at most 48 bytes.
    let number = |out: &mut Vec<u8>, number: usize| {
        out.resize(out.len().next_multiple_of(4), 0);
        out.extend_from_slice(&(number as u32).to_le_bytes());
    };
    number(&mut out, robots.len());
    for (index, robot) in robots.iter().enumerate() {
        number(&mut out, index);
        for text in [&robot.name, &robot.team] {
            // The length includes the closing zero.
            number(&mut out, text.len() + 1);
            out.extend_from_slice(text.as_bytes());
            out.push(0);
        }
    }
    out
}

/// Returns the names in a message of [`ROBOTS_TOPIC`], by index; `None` if it is invalid. `schema` is that of its channel:
/// older logs do not state the teams.
pub fn robot_names(schema: &[u8], message: &[u8]) -> Option<Vec<String>> {
    let schema = Schema::parse(MESSAGE, schema).ok()?;
    let robots = schema.fields().first()?;
    let mut names = Vec::new();
    let mut cdr = Cdr::new(&schema, message).ok()?;
    let read = cdr.field(robots, &robots.name, &mut |field, value, _| {
        if field.ends_with("].name") {
            names.push(value.to_string());
        }
    });
    read.is_ok().then_some(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Definition of the message in logs without teams.
    const OLD_SCHEMA: &str = "\
protean/RobotName[] robots
================================================================================
MSG: protean/RobotName
uint32 robot
string name
";

    #[test]
    fn names_of_any_length_are_decoded() {
        let schema = SCHEMA.as_bytes();
        for names in [vec![], vec!["a"], vec!["police_1", "", "é", "evader_10"]] {
            let robots: Vec<RobotInfo> = names
                .iter()
                .map(|name| RobotInfo {
                    name: (*name).to_owned(),
                    team: "guards".to_owned(),
                    radius: 0.1,
                    visits_waypoints: false,
                    lap_limit_s: None,
                })
                .collect();
            let names: Vec<String> = names.into_iter().map(str::to_owned).collect();
            let bytes = encode(&robots);
            assert_eq!(robot_names(schema, &bytes), Some(names));
            for length in 4..bytes.len() {
                assert_eq!(robot_names(schema, &bytes[..length]), None);
            }
        }
    }

    #[test]
    fn names_are_decoded_without_teams() {
        let message = b"\0\x01\0\0\x02\0\0\0\0\0\0\0\x02\0\0\0a\0\0\0\x01\0\0\0\x03\0\0\0bc\0";
        let names = robot_names(OLD_SCHEMA.as_bytes(), message);
        assert_eq!(names, Some(vec!["a".to_owned(), "bc".to_owned()]));
    }
}
