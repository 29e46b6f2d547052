//! Names of robots and obstacles, and events in words.

use std::collections::BTreeMap;

use crate::messages::world::WorldEvent;

/// Names for the events of a run.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct EventNames {
    /// Names of the robots, by index.
    pub robots: Vec<String>,
    /// Names of the obstacles that have one, by id.
    pub obstacles: BTreeMap<u32, String>,
}

impl EventNames {
    /// Returns an event in words.
    ///
    /// ```
    /// use ipc_types::event_names::EventNames;
    /// use ipc_types::messages::world::WorldEvent;
    ///
    /// let names = EventNames {
    ///     obstacles: [(3, "lorry".to_owned())].into(),
    ///     ..EventNames::default()
    /// };
    /// let event = WorldEvent { kind: 8, other: 3, value: 1.0, ..WorldEvent::default() };
    /// assert_eq!(names.words(&event), "lorry disappeared");
    /// ```
    pub fn words(&self, event: &WorldEvent) -> String {
        let (robot, other) = (self.robot(event.robot), self.robot(event.other));
        let has_robot = event.robot != WorldEvent::NONE;
        match WorldEvent::name_of(event.kind) {
            "captured" if event.other == WorldEvent::NONE => format!("{robot} caught"),
            "captured" => format!("{robot} caught by {other}"),
            "escaped" => format!("{robot} escaped"),
            "timed_out" if has_robot => format!("{robot} ran out of time"),
            "timed_out" => "the time limit is reached".to_owned(),
            "goal_reached" => format!("{robot} reached its goal"),
            "contact_begin" => format!("{robot} touches {other}"),
            "contact_end" => format!("{robot} no longer touches {other}"),
            "invalid_command" => format!("{robot} stopped: invalid command"),
            "missing_command" => format!("{robot} stopped: no command"),
            "obstacle" => self.obstacle(event),
            "game_over" => "the game is over".to_owned(),
            "pushed_out" => format!("{robot} pushed aside by an obstacle"),
            "trapped" => format!("{robot} trapped by an obstacle"),
            "released" => format!("{robot} free again"),
            "stands" => format!("{robot} stands: no progress for {:.0} s", event.value),
            "sighted" => format!("{robot} sighted {other} and pursues it"),
            "lost" => format!("{robot} lost {other}"),
            "returned" => format!("{robot} is back on patrol"),
            kind if has_robot => format!("{robot}: {}", kind.replace('_', " ")),
            kind => format!("{} event (code {})", kind.replace('_', " "), event.kind),
        }
    }

    fn robot(&self, index: u32) -> String {
        match self.robots.get(index as usize) {
            Some(robot) => robot.clone(),
            None if index == WorldEvent::NONE => "an obstacle".to_owned(),
            None => format!("robot {index}"),
        }
    }

    /// The value of the event is the action.
    fn obstacle(&self, event: &WorldEvent) -> String {
        let name = match self.obstacles.get(&event.other) {
            Some(name) => name.clone(),
            None => format!("obstacle {}", event.other),
        };
        let action = match event.value {
            0.0 => "appeared",
            1.0 => "disappeared",
            _ => "moved",
        };
        format!("{name} {action}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_name_robots_and_obstacles() {
        let names = EventNames {
            robots: ["police_1", "baddie_1"].map(str::to_owned).to_vec(),
            obstacles: [(12, "lorry".to_owned())].into(),
        };
        let none = WorldEvent::NONE;
        let say = |kind, robot, other| {
            names.words(&WorldEvent {
                kind,
                robot,
                other,
                ..WorldEvent::default()
            })
        };
        assert_eq!(say(0, 1, 0), "baddie_1 caught by police_1");
        assert_eq!(say(1, 1, 0), "baddie_1 escaped");
        assert_eq!(say(4, 0, none), "police_1 touches an obstacle");
        assert_eq!(say(4, 0, 1), "police_1 touches baddie_1");
        assert_eq!(say(8, none, 12), "lorry appeared");
        assert_eq!(say(8, none, 3), "obstacle 3 appeared");
        assert_eq!(say(77, none, none), "unknown event (code 77)");
        let all = 0..WorldEvent::NAMES.len();
        assert!(
            all.into_iter()
                .all(|kind| !say(kind as u32, 1, 0).contains("unknown"))
        );
    }
}
