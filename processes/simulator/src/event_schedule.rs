//! Changes of the obstacles that depend on a robot's progress or on each other.
//!
//! A change is *due* from the tick at which its condition first holds, or some ticks later; the
//! condition need not hold any longer after that. Changes of one obstacle happen in their order:
//! one that is due before its predecessor has happened is held until then. No obstacle therefore
//! disappears before it has appeared.

use std::collections::BTreeMap;

use geometry::map::{ObstacleChange, ObstacleId};
use nalgebra::Point2;
use robot::spec::RobotSpec;
use serde::{Deserialize, Serialize};
use sim_backend::robot::Robot;
use sim_backend::spec::Condition;

/// Condition at which a change is due.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum DueCondition {
    /// From a tick on.
    Tick(u64),
    /// From the first tick at which a condition on a robot is true.
    When {
        /// Index of the robot.
        robot: usize,
        /// Condition on it.
        condition: Condition,
        /// Ticks between that and the change.
        after: u64,
    },
}

/// A change of the obstacles and its due time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlannedChange {
    /// Name of the obstacle, for messages.
    pub obstacle: String,
    /// The change.
    pub change: ObstacleChange,
    /// Condition at which it is due.
    pub due: DueCondition,
}

/// A change that depends on an unknown robot.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("obstacle `{obstacle}` depends on robot {robot}: expected one of the {robots} robots")]
pub struct UnknownRobot {
    /// Name of the obstacle.
    pub obstacle: String,
    /// Index of the robot.
    pub robot: usize,
    /// Number of robots.
    pub robots: usize,
}

/// Changes that have not happened yet.
#[derive(Debug, Clone, Default)]
pub struct EventSchedule {
    items: Vec<Item>,
    /// Start positions of the robots (m).
    starts: Vec<Point2<f64>>,
    /// Index of the first item that has not happened; those before it are skipped.
    first: usize,
}

#[derive(Debug, Clone)]
struct Item {
    planned: PlannedChange,
    /// Previous item for the same obstacle.
    predecessor: Option<usize>,
    /// First tick at which it is due, once known.
    due: Option<u64>,
    /// `true` if it has been reported as held.
    held: bool,
    done: bool,
}

impl EventSchedule {
    /// Returns an event schedule for these robots; changes due at one tick happen in the order of
    /// the list.
    ///
    /// # Errors
    /// [`UnknownRobot`] if a change depends on a robot that is not in the list.
    pub fn new(changes: Vec<PlannedChange>, robots: &[RobotSpec]) -> Result<Self, UnknownRobot> {
        let mut last: BTreeMap<ObstacleId, usize> = BTreeMap::new();
        let mut items = Vec::with_capacity(changes.len());
        for (index, planned) in changes.into_iter().enumerate() {
            let due = match planned.due {
                DueCondition::Tick(tick) => Some(tick),
                DueCondition::When { robot, .. } if robot >= robots.len() => {
                    return Err(UnknownRobot {
                        obstacle: planned.obstacle,
                        robot,
                        robots: robots.len(),
                    });
                }
                DueCondition::When { .. } => None,
            };
            items.push(Item {
                predecessor: last.insert(planned.change.id(), index),
                planned,
                due,
                held: false,
                done: false,
            });
        }
        Ok(Self {
            items,
            starts: robots.iter().map(|r| r.start.position()).collect(),
            first: 0,
        })
    }

    /// Returns `true` if no change is left.
    pub fn is_empty(&self) -> bool {
        self.first >= self.items.len()
    }

    /// Updates the conditions with the robots' state at a tick.
    pub fn observe(&mut self, tick: u64, robots: &[Robot]) {
        for item in self.items.iter_mut().skip(self.first) {
            let DueCondition::When {
                robot,
                condition,
                after,
            } = item.planned.due
            else {
                continue;
            };
            if item.due.is_none()
                && let (Some(state), Some(&start)) = (robots.get(robot), self.starts.get(robot))
                && state.meets(&condition, start)
            {
                item.due = Some(tick.saturating_add(after));
            }
        }
    }

    /// Returns the next change that happens at a tick and marks it as done.
    pub fn take(&mut self, tick: u64) -> Option<&PlannedChange> {
        let open = |items: &[Item], index: usize| items.get(index).is_some_and(|i| !i.done);
        let index = (self.first..self.items.len()).find(|&index| {
            self.items.get(index).is_some_and(|item| {
                let due = !item.done && item.due.is_some_and(|due| due <= tick);
                due && !item.predecessor.is_some_and(|p| open(&self.items, p))
            })
        })?;
        self.items.get_mut(index)?.done = true;
        while self.items.get(self.first).is_some_and(|item| item.done) {
            self.first += 1;
        }
        self.items.get(index).map(|item| &item.planned)
    }

    /// Returns the changes that are due at a tick and held by one that has not happened, each once.
    /// Call it when [`Self::take`] has no more for the tick.
    pub fn newly_held(&mut self, tick: u64) -> impl Iterator<Item = &PlannedChange> {
        self.items
            .iter_mut()
            .skip(self.first)
            .filter(move |item| !item.done && !item.held && item.due.is_some_and(|due| due <= tick))
            .map(|item| {
                item.held = true;
                &item.planned
            })
    }
}

#[cfg(test)]
mod tests {
    use geometry::map::{MapSpec, VectorMap};
    use geometry::pose::Pose2;
    use geometry::shape::Shape;
    use robot::team::Role;
    use sim_backend::spec::{RulesSpec, WorldSpec};
    use sim_backend::world::World;

    use super::*;

    fn specs() -> Vec<RobotSpec> {
        vec![RobotSpec::new(
            "scout",
            Role::Neutral,
            Pose2::new(1.0, 1.0, 0.0),
        )]
    }

    /// Returns the scout after this distance.
    fn travelled(way: f64) -> Vec<Robot> {
        let world = World::new(WorldSpec {
            map: MapSpec::Vector(VectorMap::empty([0.0, 0.0], [9.0, 2.0], 0.1)),
            robots: specs(),
            rules: RulesSpec::default(),
            seed: 1,
        })
        .unwrap();
        let mut robots = world.robots().to_vec();
        robots[0].distance_travelled = way;
        robots[0].pose.x += way;
        robots
    }

    fn appear(id: u32, due: DueCondition) -> PlannedChange {
        let shape = Shape::Circle {
            center: [5.0, 1.0],
            radius: 0.1,
        };
        PlannedChange {
            obstacle: format!("o{id}"),
            change: ObstacleChange::Appear {
                id: ObstacleId(id),
                shape,
            },
            due,
        }
    }

    fn disappear(id: u32, due: DueCondition) -> PlannedChange {
        PlannedChange {
            obstacle: format!("o{id}"),
            change: ObstacleChange::Disappear { id: ObstacleId(id) },
            due,
        }
    }

    fn after_way(travelled: f64, after: u64) -> DueCondition {
        DueCondition::When {
            robot: 0,
            condition: Condition::Travelled { travelled },
            after,
        }
    }

    /// Returns the events and the held changes at a tick, when the scout has driven this far.
    fn at(event_schedule: &mut EventSchedule, tick: u64, way: f64) -> (Vec<String>, Vec<String>) {
        let words = |planned: &PlannedChange| {
            let sign = match planned.change {
                ObstacleChange::Appear { .. } => '+',
                ObstacleChange::Disappear { .. } => '-',
                ObstacleChange::Move { .. } => '>',
            };
            format!("{sign}{}", planned.obstacle)
        };
        event_schedule.observe(tick, &travelled(way));
        let mut happens = Vec::new();
        while let Some(planned) = event_schedule.take(tick) {
            happens.push(words(planned));
        }
        let held = event_schedule.newly_held(tick).map(words).collect();
        (happens, held)
    }

    fn nothing() -> (Vec<String>, Vec<String>) {
        (Vec::new(), Vec::new())
    }

    fn happens(changes: &[&str]) -> (Vec<String>, Vec<String>) {
        (changes.iter().map(ToString::to_string).collect(), vec![])
    }

    #[test]
    fn a_change_happens_once_at_the_first_tick_at_which_its_condition_holds() {
        let mut event_schedule =
            EventSchedule::new(vec![appear(0, after_way(1.5, 0))], &specs()).unwrap();
        assert_eq!(at(&mut event_schedule, 0, 0.0), nothing());
        assert_eq!(at(&mut event_schedule, 1, 1.49), nothing());
        assert_eq!(at(&mut event_schedule, 2, 1.5), happens(&["+o0"]));
        assert!(event_schedule.is_empty());
        assert_eq!(at(&mut event_schedule, 3, 1.6), nothing());
    }

    #[test]
    fn a_delay_counts_from_when_the_condition_held_even_if_it_no_longer_does() {
        let near = DueCondition::When {
            robot: 0,
            condition: Condition::Within {
                within: 0.1,
                of: [2.0, 1.0],
            },
            after: 3,
        };
        let mut event_schedule = EventSchedule::new(vec![appear(0, near)], &specs()).unwrap();
        assert_eq!(at(&mut event_schedule, 5, 1.0), nothing());
        assert_eq!(at(&mut event_schedule, 6, 2.0), nothing());
        assert_eq!(at(&mut event_schedule, 7, 1.0), nothing());
        assert_eq!(at(&mut event_schedule, 8, 3.0), happens(&["+o0"]));
    }

    #[test]
    fn changes_of_one_tick_happen_in_the_order_of_the_list() {
        let changes = vec![
            appear(2, after_way(1.0, 0)),
            appear(1, DueCondition::Tick(4)),
            appear(0, after_way(0.5, 0)),
        ];
        let mut event_schedule = EventSchedule::new(changes, &specs()).unwrap();
        assert_eq!(
            at(&mut event_schedule, 4, 1.0),
            happens(&["+o2", "+o1", "+o0"])
        );
    }

    #[test]
    fn a_change_due_before_its_predecessor_is_held() {
        let changes = vec![
            appear(0, after_way(2.0, 0)),
            disappear(0, after_way(1.0, 0)),
            appear(1, after_way(1.0, 0)),
        ];
        let mut event_schedule = EventSchedule::new(changes, &specs()).unwrap();
        assert_eq!(at(&mut event_schedule, 0, 0.5), nothing());
        let (done, held) = at(&mut event_schedule, 1, 1.0);
        assert_eq!(done, ["+o1"], "another obstacle does not wait");
        assert_eq!(held, ["-o0"]);
        assert_eq!(
            at(&mut event_schedule, 2, 1.5),
            nothing(),
            "named only once"
        );
        assert_eq!(at(&mut event_schedule, 3, 2.0), happens(&["+o0", "-o0"]));
        assert!(event_schedule.is_empty());
    }

    #[test]
    fn times_and_conditions_of_one_obstacle_mix() {
        let changes = vec![
            appear(0, DueCondition::Tick(2)),
            disappear(0, after_way(1.0, 2)),
            appear(0, DueCondition::Tick(3)),
        ];
        let mut event_schedule = EventSchedule::new(changes, &specs()).unwrap();
        assert_eq!(at(&mut event_schedule, 1, 0.0), nothing());
        assert_eq!(at(&mut event_schedule, 2, 0.0), happens(&["+o0"]));
        assert_eq!(at(&mut event_schedule, 3, 1.0).1, ["+o0"]);
        assert_eq!(at(&mut event_schedule, 4, 1.0), nothing());
        assert_eq!(at(&mut event_schedule, 5, 1.0), happens(&["-o0", "+o0"]));
    }

    #[test]
    fn an_unknown_robot_is_named() {
        let due = DueCondition::When {
            robot: 1,
            condition: Condition::Travelled { travelled: 1.0 },
            after: 0,
        };
        let error = EventSchedule::new(vec![appear(7, due)], &specs()).unwrap_err();
        assert_eq!(
            error.to_string(),
            "obstacle `o7` depends on robot 1: expected one of the 1 robots"
        );
    }
}
