//! One iteration: a sample, its parent, and its new children.

use nalgebra::{Point2, Vector2};

use super::{Scene, Search};
use crate::motion::Motion;
use crate::params::REFINE_SHARE;
use crate::sampler::uniform;
use crate::tree::NONE;

/// Maximum number of draws for a sample that can shorten the path.
const MAX_DRAWS: u32 = 24;

/// Weight of a draw in the running share of useful samples.
const MEMORY: f64 = 1.0 / 256.0;

/// Minimum share of free space in the radius.
const MIN_USEFUL: f64 = 1e-4;

impl<M: Motion> Search<M> {
    pub(super) fn iterate(&mut self, scene: &Scene<'_>) {
        let dice = uniform(&mut self.rng);
        let refines = self.is_improved() && self.best.1 != NONE;
        if dice < self.params.goal_bias {
            self.strive(scene);
        } else if refines && dice < self.params.goal_bias + REFINE_SHARE {
            self.refine(scene);
        } else if let Some(sample) = self.sample(scene) {
            self.extend(scene, sample);
        } else if refines {
            self.refine(scene);
        }
        if self.is_improved() {
            self.prune();
        }
    }

    /// Returns a place over which a path can still become cheaper than the best; `None` if none was
    /// drawn. In the published search, any place.
    fn sample(&mut self, scene: &Scene<'_>) -> Option<Point2<f64>> {
        if !self.is_improved() || !self.best.0.is_finite() {
            return scene.sampler.draw(scene.space, &mut self.rng);
        }
        for _ in 0..MAX_DRAWS {
            let p = scene.sampler.draw(scene.space, &mut self.rng)?;
            let is_useful = self.bound.can_improve(p, self.best.0);
            let hit = f64::from(u8::from(is_useful));
            self.useful = (self.useful + (hit - self.useful) * MEMORY).max(MIN_USEFUL);
            if is_useful {
                return Some(p);
            }
        }
        None
    }

    /// Tries to reach a goal: from the nodes near it or, while it is out of reach, by a step
    /// towards it from the nearest node.
    fn strive(&mut self, scene: &Scene<'_>) {
        if self.goals == 0 {
            return;
        }
        let goal = 1 + (uniform(&mut self.rng) * f64::from(self.goals)) as u32;
        let goal = goal.min(self.goals);
        self.join_goal(scene, goal);
        self.note_best(scene);
        if self.is_improved() && !self.tree.node(goal).cost.is_finite() {
            let at = self.tree.node(goal).position();
            self.extend(scene, at);
        }
    }

    /// Adds a node at a sample or, without a near node, towards it. The published search drops
    /// samples without a near node, and reaches a goal by samples at the goal or within its
    /// shortest edge of it only.
    fn extend(&mut self, scene: &Scene<'_>, sample: Point2<f64>) {
        if !self.is_improved()
            && let Some(goal) = self.goal_at(sample)
        {
            self.join_goal(scene, goal);
            self.note_best(scene);
            return;
        }
        let mut at = sample;
        let mut near = core::mem::take(&mut self.near);
        self.index.near(at, self.radius(), &mut near);
        if near.is_empty()
            && self.is_improved()
            && let Some(nearest) = self.index.nearest(at)
        {
            let from = self.tree.node(nearest.node).position();
            let step: Vector2<f64> = at - from;
            if nearest.distance > self.params.max_edge {
                at = from + step * (self.params.max_edge / nearest.distance);
            }
            near.push(crate::index::Neighbour {
                node: nearest.node,
                distance: (at - from).norm(),
            });
        }
        self.near = near;
        let most = if self.is_improved() {
            self.best.0 - self.bound.to_goal(at)
        } else {
            f64::INFINITY
        };
        let Some(chosen) = self.choose_parent(scene, at, most) else {
            return;
        };
        let node = self.add(at, &chosen);
        if self.is_improved() {
            self.rewire(scene, node);
            self.offer_to_goals(scene, node);
            self.note_best(scene);
        }
    }

    /// Returns the goal within the shortest edge of a point.
    fn goal_at(&self, p: Point2<f64>) -> Option<u32> {
        (1..=self.goals).find(|&goal| {
            (self.tree.node(goal).position() - p).norm() < self.params.algorithm.min_edge()
        })
    }
}
