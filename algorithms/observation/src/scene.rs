//! All robots of a tick, relative to each other.

use geometry::map::ShapeMap;
use nalgebra::Point2;
use planner_view::view::RobotView;

use crate::facts::RobotFacts;
use crate::relative::{Heading, Offset};

/// A robot of a tick.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Seen {
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
    robots: [usize; 2],
    is_hostile: bool,
    offset: Offset,
    is_visible: bool,
}

/// Distances, bearings and lines of sight between the robots of a tick. Observations of several robots share them.
///
/// Lines of sight are those between robots of hostile teams, both in the game; other robots do not hide.
#[derive(Debug, Clone)]
pub struct Scene {
    limits: Vec<[f32; 2]>,
    robots: Vec<Option<Seen>>,
    pairs: Vec<Pair>,
    /// Index of a pair, by the indices of its robots; robots² entries.
    indices: Vec<Option<u32>>,
    per_diagonal: f32,
}

impl Scene {
    /// Creates the memory for these robots. `observers` are the indices of the robots with observations; pairs without
    /// any of them are left out.
    pub fn new(robots: &[RobotFacts], observers: &[usize]) -> Self {
        let count = robots.len();
        let mut pairs = Vec::new();
        let mut indices = vec![None; count * count];
        for (i, a) in robots.iter().enumerate() {
            for (j, b) in robots.iter().enumerate().skip(i + 1) {
                if !(observers.contains(&i) || observers.contains(&j)) {
                    continue;
                }
                indices[i * count + j] = Some(pairs.len() as u32);
                indices[j * count + i] = Some(pairs.len() as u32);
                pairs.push(Pair {
                    robots: [i, j],
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
            robots: vec![None; count],
            pairs,
            indices,
            per_diagonal: 0.0,
        }
    }

    /// Takes the robots of a tick, on the current map. Robots without a body, and those with numbers that are not
    /// finite, count as absent.
    pub fn update(&mut self, robots: &[RobotView], shapes: &ShapeMap) {
        let bounds = shapes.bounds();
        let size = bounds.max - bounds.min;
        self.per_diagonal = (1.0 / size.norm()) as f32;
        let half = 0.5 * size.x.max(size.y);
        let centre = bounds.min + 0.5 * size;
        self.robots.fill(None);
        for robot in robots {
            let (Some(slot), Some(&[per_speed, per_turn])) = (
                self.robots.get_mut(robot.index),
                self.limits.get(robot.index),
            ) else {
                continue;
            };
            if slot.is_some() || !(robot.active || robot.present) || !robot.is_sane() {
                continue;
            }
            *slot = Some(Seen {
                active: robot.active,
                place: [
                    ((robot.pose.x - centre.x) / half) as f32,
                    ((robot.pose.y - centre.y) / half) as f32,
                ],
                position: robot.pose.position(),
                heading: Heading::new(robot.pose.theta),
                speed: robot.twist.v as f32 * per_speed,
                turn: robot.twist.omega as f32 * per_turn,
            });
        }
        for pair in &mut self.pairs {
            let [a, b] = pair.robots.map(|i| self.robots.get(i).copied().flatten());
            let (Some(a), Some(b)) = (a, b) else {
                pair.is_visible = false;
                continue;
            };
            pair.offset = Offset::new(a.position, b.position, self.per_diagonal);
            pair.is_visible = pair.is_hostile
                && a.active
                && b.active
                && shapes.line_of_sight(a.position, b.position);
        }
    }

    /// Returns a robot; `None` if it is absent.
    pub(crate) fn robot(&self, index: usize) -> Option<&Seen> {
        self.robots.get(index)?.as_ref()
    }

    /// Returns the offset from a robot to another one, and whether it sees it.
    pub(crate) fn pair(&self, from: usize, to: usize) -> Option<(Offset, bool)> {
        let index = self.indices.get(from * self.robots.len() + to)?.as_ref()?;
        let pair = self.pairs.get(*index as usize)?;
        let offset = if from < to {
            pair.offset
        } else {
            pair.offset.reversed()
        };
        Some((offset, pair.is_visible))
    }

    /// Returns 1 / the diagonal of the map (1/m).
    pub(crate) fn per_diagonal(&self) -> f32 {
        self.per_diagonal
    }
}
