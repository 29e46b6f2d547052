//! Frames of a bag, and their places in each other.

use std::collections::BTreeMap;

use geometry::pose::Pose2;
use ros_messages::messages::TransformStamped;
use ros_messages::{is_upright, pose2};

use super::samples::nanoseconds;

/// Maximum number of frames between two others.
const MAX_DEPTH: usize = 64;

/// A transform: its time (ns), the parent, and the place in it; `None` if that is tilted.
type Link = (i64, String, Option<Pose2>);

/// The transforms of a bag, by namespace of their topic and child frame.
#[derive(Debug, Default)]
pub struct Frames(BTreeMap<(String, String), Vec<Link>>);

/// Returns the name of a frame without the slash that ROS 1 permitted.
pub fn name(frame: &str) -> &str {
    frame.trim_start_matches('/')
}

impl Frames {
    /// Adds a transform of a topic in a namespace; a static one holds at all times.
    pub fn add(&mut self, namespace: &str, is_static: bool, found: &TransformStamped) {
        let at = if is_static {
            i64::MIN
        } else {
            nanoseconds(&found.header.stamp)
        };
        let (translation, rotation) = (&found.transform.translation, &found.transform.rotation);
        let pose = pose2(translation.x, translation.y, rotation);
        let pose = Some(pose).filter(|pose| is_upright(rotation) && pose.is_finite());
        let key = (namespace.to_owned(), name(&found.child_frame_id).to_owned());
        let parent = name(&found.header.frame_id).to_owned();
        self.0.entry(key).or_default().push((at, parent, pose));
    }

    /// Sorts the transforms by time, after the last one was added.
    pub fn sort(&mut self) {
        self.0
            .values_mut()
            .for_each(|links| links.sort_by_key(|link| link.0));
    }

    /// Returns the pose of a frame within another one, which is above it, at a time (ns), by the newest transforms before that;
    /// `None` if they are not connected. Transforms of `namespace` come before those of none.
    ///
    /// # Errors
    /// The name of a frame that is tilted.
    pub fn place(
        &self,
        namespace: &str,
        frame: &str,
        within: &str,
        at: i64,
    ) -> Result<Option<Pose2>, String> {
        let (mut frame, mut pose) = (frame, Pose2::default());
        for _ in 0..MAX_DEPTH {
            if frame == within {
                return Ok(Some(pose));
            }
            let links = |namespace: &str| self.0.get(&(namespace.to_owned(), frame.to_owned()));
            let Some(links) = links(namespace).or_else(|| links("")) else {
                break;
            };
            let newest = links.partition_point(|link| link.0 <= at).saturating_sub(1);
            let Some((_, parent, link)) = links.get(newest) else {
                break;
            };
            pose = link.as_ref().ok_or_else(|| frame.to_owned())?.placed(&pose);
            frame = parent;
        }
        Ok(None)
    }
}
