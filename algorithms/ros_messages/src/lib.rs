//! Messages of ROS 2: their definitions and their CDR form, for viewers, and for nodes over DDS.

mod decoding;
mod encoding;
pub mod messages;
mod values;

pub use decoding::{CdrError, decode};
pub use encoding::{CdrWriter, Definitions, RosType, add_definition, definition, encode};
pub use values::{pose, pose2, time, upright_pose, yaw};
