//! Frames of a bag, and their places in each other.

use std::collections::BTreeMap;

use geometry::pose::Pose2;
use ros_messages::messages::{Time, TransformStamped};
use ros_messages::upright_pose;

/// Maximum number of frames between two others.
const MAX_DEPTH: usize = 64;

/// The transforms of a bag by the namespace of their topic and the child frame.
#[derive(Debug, Default)]
pub struct Frames(BTreeMap<(String, String), Vec<Link>>);

/// Time of a transform (ns), parent, and place in it.
type Link = (i64, String, Pose2);

/// Returns a time of ROS 2 in nanoseconds.
pub fn nanoseconds(time: &Time) -> i64 {
    i64::from(time.sec) * 1_000_000_000 + i64::from(time.nanosec)
}

/// Returns the name of a frame without the slash of ROS 1.
fn name(frame: &str) -> &str {
    frame.trim_start_matches('/')
}

impl Frames {
    /// Adds a transform of a topic in a namespace, unless it is tilted; a static one holds at all times.
    pub fn add(&mut self, namespace: &str, is_static: bool, found: &TransformStamped) {
        let at = nanoseconds(&found.header.stamp);
        let (place, rotation) = (&found.transform.translation, &found.transform.rotation);
        if let Some(pose) = upright_pose(place.x, place.y, rotation) {
            let key = (namespace.to_owned(), name(&found.child_frame_id).to_owned());
            let parent = name(&found.header.frame_id).to_owned();
            let at = if is_static { i64::MIN } else { at };
            self.0.entry(key).or_default().push((at, parent, pose));
        }
    }

    /// Sorts the transforms by time.
    pub fn sort(&mut self) {
        self.0
            .values_mut()
            .for_each(|links| links.sort_by_key(|link| link.0));
    }

    /// Returns the pose of a frame within another one above it at a time (ns), by the newest transforms until then; `None` if none
    /// connect them. Transforms of `namespace` come before those of none.
    pub fn place(&self, namespace: &str, frame: &str, within: &str, at: i64) -> Option<Pose2> {
        let (mut frame, mut pose) = (name(frame), Pose2::default());
        for _ in 0..MAX_DEPTH {
            if frame == name(within) {
                return Some(pose);
            }
            let links = |namespace: &str| self.0.get(&(namespace.to_owned(), frame.to_owned()));
            let links = links(namespace).or_else(|| links(""))?;
            let newest = links.partition_point(|link| link.0 <= at).saturating_sub(1);
            let (_, parent, link) = links.get(newest)?;
            pose = link.placed(&pose);
            frame = parent;
        }
        None
    }
}
