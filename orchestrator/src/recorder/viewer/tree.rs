//! The trees in which planners search for their ways.

use foxglove::messages::{
    Color, LinePrimitive, Point3, SceneEntity, SceneEntityDeletion, SceneUpdate, line_primitive,
    scene_entity_deletion,
};
use ipc_types::messages::robot::TreeEdge;
use ipc_types::messages::world::RobotState;

use super::super::options::RobotInfo;
use super::scene::{entity, pose};
use super::{palette, timestamp};

/// Width of edges [pixels].
const PIXELS: f64 = 1.0;

/// Height at which trees are drawn [m]: above the map, below the plans.
const HEIGHT: f64 = 0.005;

/// The last tree of every robot.
#[derive(Debug)]
pub(super) struct Trees {
    trees: Vec<Tree>,
}

#[derive(Debug, Clone, Default)]
struct Tree {
    /// Both ends of every edge.
    points: Vec<Point3>,
    /// Whether viewers show it.
    shown: bool,
    /// Whether it changed since it was drawn.
    changed: bool,
}

impl Trees {
    pub(super) fn new(robots: usize) -> Self {
        Self {
            trees: vec![Tree::default(); robots],
        }
    }

    /// Replaces the tree of a robot.
    pub(super) fn set(&mut self, robot: usize, edges: impl Iterator<Item = TreeEdge>) {
        let point = |x: f32, y: f32| Point3 {
            x: f64::from(x),
            y: f64::from(y),
            z: HEIGHT,
        };
        if let Some(tree) = self.trees.get_mut(robot) {
            tree.points.clear();
            tree.points
                .extend(edges.flat_map(|e| [point(e.from_x, e.from_y), point(e.to_x, e.to_y)]));
            tree.changed = true;
        }
    }

    /// All trees of robots that still play, if any changed since the last picture.
    pub(super) fn draw(
        &mut self,
        robots: &[RobotInfo],
        states: &[RobotState],
        time_ns: u64,
    ) -> Option<SceneUpdate> {
        let mut update = SceneUpdate::default();
        let mut changed = false;
        for state in states {
            let robot = state.robot as usize;
            let (Some(info), Some(tree)) = (robots.get(robot), self.trees.get_mut(robot)) else {
                continue;
            };
            let wanted = state.status == 0 && !tree.points.is_empty();
            let id = format!("tree {}", info.name);
            if wanted {
                update.entities.push(SceneEntity {
                    lines: vec![LinePrimitive {
                        r#type: line_primitive::Type::LineList as i32,
                        pose: Some(pose(0.0, 0.0, 0.0, 0.0)),
                        thickness: PIXELS,
                        scale_invariant: true,
                        points: tree.points.clone(),
                        color: Some(Color {
                            a: 0.3,
                            ..palette::team(state.team, true)
                        }),
                        ..LinePrimitive::default()
                    }],
                    ..entity(id, time_ns)
                });
            } else if tree.shown {
                update.deletions.push(SceneEntityDeletion {
                    timestamp: Some(timestamp(time_ns)),
                    r#type: scene_entity_deletion::Type::MatchingId as i32,
                    id,
                });
            }
            changed |= tree.changed || wanted != tree.shown;
            tree.shown = wanted;
            tree.changed = false;
        }
        changed.then_some(update)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tree_is_drawn_once_and_goes_with_its_robot() {
        let robots = [RobotInfo {
            name: "thief".to_owned(),
            radius: 0.1,
        }];
        let mut state = RobotState::default();
        let mut trees = Trees::new(1);
        assert!(trees.draw(&robots, &[state], 0).is_none());
        trees.set(0, [TreeEdge::default(); 3].into_iter());
        let update = trees.draw(&robots, &[state], 1).unwrap();
        assert_eq!(update.entities[0].id, "tree thief");
        assert_eq!(update.entities[0].lines[0].points.len(), 6);
        assert!(trees.draw(&robots, &[state], 2).is_none());
        state.status = 1;
        let update = trees.draw(&robots, &[state], 3).unwrap();
        assert_eq!(update.deletions[0].id, "tree thief");
        assert!(trees.draw(&robots, &[state], 4).is_none());
    }
}
