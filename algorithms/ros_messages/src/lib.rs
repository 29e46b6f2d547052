//! Messages of ROS 2: their definitions and their CDR form, for viewers, and for nodes over DDS.

mod encoding;
pub mod messages;
mod values;

pub use encoding::{CdrWriter, Definitions, RosType, add_definition, definition, encode};
pub use values::{pose, time, yaw};
