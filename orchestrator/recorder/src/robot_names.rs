//! The topic `world/robots`: the names of the robots, which all other messages state by index.

use mcap_log::output::ROBOTS_TOPIC;
use mcap_log::ros2::{Cdr, Number, Schema};
use mcap_log::states::latched_entry;
use mcap_log::{ChannelSpec, LogWriteError, LogWriter};

/// Definition of its message.
const SCHEMA: &str = "\
protean/RobotName[] robots
================================================================================
MSG: protean/RobotName
uint32 robot
string name
";

/// Adds the topic to a log, with its only message.
pub(super) fn write(names: &[String], log: &mut LogWriter) -> Result<(), LogWriteError> {
    let channel = log.add_channel(&ChannelSpec {
        topic: ROBOTS_TOPIC,
        schema_name: "protean/msg/RobotNames",
        schema_encoding: "ros2msg",
        schema: SCHEMA.as_bytes(),
        message_encoding: "cdr",
        metadata: &[latched_entry()].into(),
    })?;
    log.write(channel, 0, 0, 0, &encode(names))
}

/// Returns the message in little-endian CDR.
fn encode(names: &[String]) -> Vec<u8> {
    const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];
    let mut out = ENCAPSULATION.to_vec();
    // A run has at most 64 robots, and a name some dozen characters.
    let number = |out: &mut Vec<u8>, number: usize| {
        out.resize(out.len().next_multiple_of(4), 0);
        out.extend_from_slice(&(number as u32).to_le_bytes());
    };
    number(&mut out, names.len());
    for (index, name) in names.iter().enumerate() {
        number(&mut out, index);
        // The length includes the closing zero.
        number(&mut out, name.len() + 1);
        out.extend_from_slice(name.as_bytes());
        out.push(0);
    }
    out
}

/// Returns the names in a message of [`ROBOTS_TOPIC`], by index; `None` if it is invalid.
pub fn robot_names(message: &[u8]) -> Option<Vec<String>> {
    let schema = Schema::parse(SCHEMA.as_bytes()).ok()?;
    let mut cdr = Cdr::new(message).ok()?;
    let count = cdr.count(schema.fields.first()?).ok()?;
    let mut names = Vec::new();
    for _ in 0..count {
        cdr.number(Number::U32, "robot").ok()?;
        names.push(cdr.text("name").ok()?.to_string());
    }
    Some(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_any_length_are_decoded() {
        for names in [vec![], vec!["a"], vec!["police_1", "", "é", "evader_10"]] {
            let names: Vec<String> = names.into_iter().map(str::to_owned).collect();
            let bytes = encode(&names);
            assert_eq!(robot_names(&bytes), Some(names));
            for length in 4..bytes.len() {
                assert_eq!(robot_names(&bytes[..length]), None);
            }
        }
    }
}
