//! ROS 2 messages: their definitions and their CDR form.

mod encoding;
pub(crate) mod messages;

pub(crate) use encoding::{CdrWriter, RosType, definition, encode};
