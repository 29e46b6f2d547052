//! Selection of the nodes that a tree keeps: while it grows, and after the robot has moved.

use geometry::pose::Pose2;
use nalgebra::Point2;

use super::join::ParentChoice;
use super::{Scene, Search};
use crate::bound::Bound;
use crate::motion::Motion;
use crate::tree::{NONE, Node, ROOT, Tree};

/// Growth of the tree, and gain of the best path, after which nodes are pruned.
const GROWTH: usize = 2;
const GAIN: f64 = 0.98;

/// Minimum number of nodes for pruning.
const MIN_NODES: usize = 512;

/// Maximum number of nodes reused from the last tree (besides those on its best path).
const MAX_KEPT: usize = 1500;

impl<M: Motion> Search<M> {
    /// Removes the nodes over which no path can become cheaper than the best, from time to time.
    pub(super) fn prune(&mut self) {
        let (size, cost) = self.pruned;
        let nodes = self.tree.len();
        let is_due =
            nodes >= size.saturating_mul(GROWTH).max(MIN_NODES) || self.best.0 < GAIN * cost;
        if !self.best.0.is_finite() || !is_due || nodes < MIN_NODES {
            return;
        }
        let best = self.best.0;
        let is_useful: Vec<bool> = self
            .tree
            .nodes()
            .iter()
            .map(|node| node.cost + self.bound.to_goal(node.position()) < best)
            .collect();
        let useless = is_useful.iter().filter(|&&useful| !useful).count();
        if useless * 4 > nodes {
            self.compact(&is_useful);
        }
        self.pruned = (self.tree.len(), best);
    }

    /// Keeps root, goals, the best path, and the marked nodes together with all nodes on the paths
    /// to them.
    fn compact(&mut self, marked: &[bool]) {
        let old = core::mem::take(&mut self.tree);
        let way = core::mem::take(&mut self.way);
        let is_kept =
            |node: u32| marked.get(node as usize).copied().unwrap_or(false) || way.contains(&node);
        self.tree.plant(old.node(ROOT).pose);
        self.index.clear();
        self.index.insert(old.node(ROOT).position());
        let mut numbers = vec![NONE; old.len()];
        if let Some(root) = numbers.first_mut() {
            *root = ROOT;
        }
        for goal in 1..=self.goals {
            self.tree.push(old.node(goal).pose);
            self.index.insert(Point2::new(f64::NAN, f64::NAN));
        }
        for node in forward(&old) {
            let values = *old.node(node);
            let is_goal = node <= self.goals;
            let parent = numbers.get(values.parent as usize).copied();
            // A node is removed with its parent.
            let Some(parent) = parent.filter(|&p| p != NONE && (is_goal || is_kept(node))) else {
                continue;
            };
            let number = if is_goal {
                node
            } else {
                self.index.insert(values.position());
                self.tree.push(values.pose)
            };
            self.take_over(number, parent, &values);
            if let Some(slot) = numbers.get_mut(node as usize) {
                *slot = number;
            }
        }
        let goal = self.best.1;
        self.tree.way_to(goal, &mut self.way);
    }

    fn take_over(&mut self, number: u32, parent: u32, values: &Node) {
        self.tree.attach(number, parent);
        let node = self.tree.node_mut(number);
        node.pose = values.pose;
        node.edge = values.edge;
        node.cost = values.cost;
        node.length = values.length;
    }

    /// Begins again from another pose, with the reusable part of the last tree: the point of its
    /// best path that the robot reaches next, and all its descendants. Costs are computed again;
    /// paths are checked again if `recheck` is set because obstacles have changed.
    ///
    /// Nothing is kept without a path, when no point of it can be reached, and in the published
    /// search.
    pub fn replant(
        &mut self,
        scene: &Scene<'_>,
        root: Pose2,
        goals: &[Point2<f64>],
        bound: Bound,
        recheck: bool,
    ) {
        let old = core::mem::take(&mut self.tree);
        let way = core::mem::take(&mut self.way);
        let same_goals = goals.len() == self.goals as usize
            && (1..=self.goals)
                .zip(goals)
                .all(|(number, goal)| old.node(number).position() == *goal);
        self.begin(scene, root, goals, bound);
        if !same_goals || !self.is_improved() {
            return;
        }
        let Some((next, chosen)) = self.next_of(scene, &old, &way) else {
            return;
        };
        let mut numbers = vec![NONE; old.len()];
        self.keep(next, &old, &chosen, &mut numbers);
        for node in behind(&old, next) {
            if self.tree.len() >= MAX_KEPT && !way.contains(&node) {
                continue;
            }
            let at = old.node(node).position();
            let parent = numbers.get(old.node(node).parent as usize).copied();
            let Some(parent) = parent.filter(|&parent| parent != NONE) else {
                continue;
            };
            let Some(link) = self.link(parent, at) else {
                continue;
            };
            let from = self.tree.node(parent).position();
            let must_check = recheck || M::HAS_HEADING;
            if must_check && !scene.is_free(&link, from, at) {
                continue;
            }
            let edge = self.edge(scene, parent, at, &link);
            let cost = self.tree.node(parent).cost + edge;
            let chosen = ParentChoice {
                parent,
                link,
                edge,
                cost,
            };
            self.keep(node, &old, &chosen, &mut numbers);
        }
        self.note_best(scene);
    }

    fn keep(&mut self, node: u32, old: &Tree, chosen: &ParentChoice, numbers: &mut [u32]) {
        let number = if node <= self.goals {
            // The root may already see it.
            if chosen.cost >= self.tree.node(node).cost {
                return;
            }
            self.hang(node, chosen);
            node
        } else {
            self.add(old.node(node).position(), chosen)
        };
        if let Some(slot) = numbers.get_mut(node as usize) {
            *slot = number;
        }
    }

    /// Returns the point of the old path over which the goal is nearest from the new root, and the
    /// link to it.
    fn next_of(&self, scene: &Scene<'_>, old: &Tree, way: &[u32]) -> Option<(u32, ParentChoice)> {
        let root = self.tree.node(ROOT).position();
        let total = way.last().map(|&goal| old.node(goal).length)?;
        let mut points: Vec<(f64, u32)> = way
            .iter()
            .skip(1)
            .map(|&node| {
                let rest = total - old.node(node).length;
                (rest + (old.node(node).position() - root).norm(), node)
            })
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points.into_iter().find_map(|(_, node)| {
            let at = old.node(node).position();
            let link = self.link(ROOT, at)?;
            scene.is_free(&link, root, at).then(|| {
                let edge = self.edge(scene, ROOT, at, &link);
                let chosen = ParentChoice {
                    parent: ROOT,
                    link,
                    edge,
                    cost: edge,
                };
                (node, chosen)
            })
        })
    }
}

/// Returns all nodes but the root, parents before their children.
fn forward(tree: &Tree) -> Vec<u32> {
    behind(tree, ROOT)
}

/// Returns the descendants of a node, parents before their children.
fn behind(tree: &Tree, node: u32) -> Vec<u32> {
    let mut order: Vec<u32> = tree.children(node).collect();
    let mut next = 0;
    while let Some(&node) = order.get(next) {
        order.extend(tree.children(node));
        next += 1;
    }
    order
}
