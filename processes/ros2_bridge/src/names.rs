//! Names of topics and frames of a robot in ROS 2.

use crate::error::BridgeError;

/// Namespace of a robot; empty for the robot of a run whose names have none.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Namespace(String);

impl Namespace {
    /// Returns that of the robot with this name; `root` is the robot without one.
    ///
    /// # Errors
    /// [`BridgeError::Name`] if ROS 2 does not accept the name.
    pub fn new(name: &str, root: &str) -> Result<Self, BridgeError> {
        let mut letters = name.chars();
        let first = letters
            .next()
            .is_some_and(|c| c.is_ascii_alphabetic() || c == '_');
        if !first || !letters.all(|c| c.is_ascii_alphanumeric() || c == '_') {
            return Err(BridgeError::Name {
                name: name.to_owned(),
            });
        }
        Ok(Self(if name == root {
            String::new()
        } else {
            format!("{name}/")
        }))
    }

    /// Returns a topic, `/guard/odom`.
    pub fn topic(&self, name: &str) -> String {
        format!("/{}{name}", self.0)
    }

    /// Returns a frame, `guard/odom`.
    pub fn frame(&self, name: &str) -> String {
        format!("{}{name}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn topics_and_frames_have_the_name_of_the_robot_unless_it_is_the_root() {
        let guard = Namespace::new("guard", "").unwrap();
        assert_eq!(guard.topic("odom"), "/guard/odom");
        assert_eq!(guard.frame("base_link"), "guard/base_link");
        let root = Namespace::new("guard", "guard").unwrap();
        assert_eq!(root.topic("odom"), "/odom");
        assert_eq!(root.frame("base_link"), "base_link");
        for name in ["1st", "a-b", ""] {
            let error = Namespace::new(name, "").unwrap_err().to_string();
            assert!(error.contains("is not a namespace of ROS 2"), "{error}");
        }
    }
}
