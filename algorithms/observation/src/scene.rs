//! All robots of a tick, relative to each other.

use geometry::map::ShapeMap;
use nalgebra::Point2;
use planner_view::view::RobotView;

use crate::facts::RobotFacts;
use crate::relative::{self, Heading, Offset};

/// A robot of a tick.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct RobotSnapshot {
    /// `true` if it has a body and its numbers are finite. The other fields of an absent robot have no meaning.
    pub present: bool,
    pub active: bool,
    /// Position in the map: −1 and 1 are the sides of the smallest square about its bounds.
    pub place: [f32; 2],
    pub position: Point2<f64>,
    pub heading: Heading,
    /// Forward speed and turning rate, divided by their limits.
    pub speed: f32,
    pub turn: f32,
}

/// Two robots, the one with the lower index first.
#[derive(Debug, Clone, Copy)]
struct Pair {
    robots: [u32; 2],
    is_hostile: bool,
    offset: Offset,
    is_visible: bool,
}

/// Index of the ordered pair of a robot with itself, or of robots without an observation.
const NO_PAIR: u32 = u32::MAX;

/// Obstacles that hid robots from each other when their lines of sight were last computed. They make the next
/// computation quicker, and have no effect on its result: any [`Scene`] of the same robots may use them.
#[derive(Debug, Clone, Default)]
pub struct OcclusionCache(Vec<Option<u32>>);

/// Distances, bearings and lines of sight between the robots of a tick. Observations of several robots share them.
///
/// Lines of sight are those between robots of hostile teams, both in the game; other robots do not hide.
#[derive(Debug, Clone)]
pub struct Scene {
    limits: Vec<[f32; 2]>,
    robots: Vec<RobotSnapshot>,
    pairs: Vec<Pair>,
    /// Index of a pair, by the indices of its robots; robots² entries.
    indices: Vec<u32>,
    per_diagonal: f32,
}

impl Scene {
    /// Creates the memory for these robots. `observers` are the indices of the robots with observations; pairs without
    /// any of them are left out.
    pub fn new(robots: &[RobotFacts], observers: &[usize]) -> Self {
        let count = robots.len();
        let mut pairs = Vec::new();
        let mut indices = vec![NO_PAIR; count * count];
        for (i, a) in robots.iter().enumerate() {
            for (j, b) in robots.iter().enumerate().skip(i + 1) {
                if !(observers.contains(&i) || observers.contains(&j)) {
                    continue;
                }
                indices[i * count + j] = pairs.len() as u32;
                indices[j * count + i] = pairs.len() as u32;
                pairs.push(Pair {
                    robots: [i as u32, j as u32],
                    is_hostile: a.team.is_hostile_to(b.team),
                    offset: Offset::default(),
                    is_visible: false,
                });
            }
        }
        let per = |limit: f64| {
            if limit > 0.0 {
                (1.0 / limit) as f32
            } else {
                0.0
            }
        };
        let limits = robots.iter();
        Self {
            limits: limits
                .map(|robot| [per(robot.model.v_max), per(robot.model.omega_max)])
                .collect(),
            robots: vec![RobotSnapshot::default(); count],
            pairs,
            indices,
            per_diagonal: 0.0,
        }
    }

    /// Takes the robots of a tick, on the current map. Robots without a body, and those with numbers that are not
    /// finite, count as absent.
    pub fn update(&mut self, robots: &[RobotView], shapes: &ShapeMap, hiding: &mut OcclusionCache) {
        let bounds = shapes.bounds();
        let size = bounds.max - bounds.min;
        self.per_diagonal = (1.0 / size.norm()) as f32;
        let half = 0.5 * size.x.max(size.y);
        let centre = bounds.min + 0.5 * size;
        for robot in &mut self.robots {
            robot.present = false;
        }
        for robot in robots {
            let (Some(slot), Some(&[per_speed, per_turn])) = (
                self.robots.get_mut(robot.index),
                self.limits.get(robot.index),
            ) else {
                continue;
            };
            if slot.present || !(robot.active || robot.present) || !robot.is_sane() {
                continue;
            }
            *slot = RobotSnapshot {
                present: true,
                active: robot.active,
                place: [
                    ((robot.pose.x - centre.x) / half) as f32,
                    ((robot.pose.y - centre.y) / half) as f32,
                ],
                position: robot.pose.position(),
                heading: Heading::new(robot.pose.theta),
                speed: robot.twist.v as f32 * per_speed,
                turn: robot.twist.omega as f32 * per_turn,
            };
        }
        hiding.0.resize(self.pairs.len(), None);
        for (pair, hidden_by) in self.pairs.iter_mut().zip(&mut hiding.0) {
            let [a, b] = pair.robots.map(|i| &self.robots[i as usize]);
            pair.offset = Offset::new(a.position, b.position, self.per_diagonal);
            pair.is_visible = pair.is_hostile
                && a.active
                && b.active
                && a.present
                && b.present
                && shapes.line_of_sight_near(a.position, b.position, hidden_by);
        }
    }

    /// Returns a robot; `None` if it is absent.
    pub(crate) fn robot(&self, index: usize) -> Option<&RobotSnapshot> {
        self.robots.get(index).filter(|robot| robot.present)
    }

    /// Returns a robot, its relative position to the robot `from` with this heading, and whether that one sees it;
    /// `None` if it is absent.
    pub(crate) fn other(
        &self,
        from: usize,
        heading: Heading,
        to: usize,
    ) -> Option<(&RobotSnapshot, [f32; relative::LENGTH], bool)> {
        let other = self.robot(to)?;
        let index = *self.indices.get(from * self.robots.len() + to)?;
        let pair = self.pairs.get(index as usize)?;
        // The offset in the other direction, seen along a heading, is this one, seen along the opposite heading.
        let heading = if from < to {
            heading
        } else {
            heading.opposite()
        };
        Some((other, pair.offset.entries(heading), pair.is_visible))
    }

    /// Returns 1 / the diagonal of the map (1/m).
    pub(crate) fn per_diagonal(&self) -> f32 {
        self.per_diagonal
    }
}
