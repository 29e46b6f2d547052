//! Joining of nodes: the choice of a parent, and rewiring with its changes of descendants.

use geometry::pose::Pose2;
use nalgebra::Point2;

use super::{Scene, Search};
use crate::motion::{Link, Motion};
use crate::tree::{NONE, ROOT};

/// Maximum number of descendants of a node that primitives with a heading rewire: every path behind
/// it is computed and checked again.
const MAX_MOVED: usize = 64;

/// A possible parent.
#[derive(Debug, Clone, Copy)]
pub struct Candidate {
    node: u32,
    link: Link,
    edge: f64,
    /// Cost of the child by this parent.
    cost: f64,
}

/// New values of a node behind a rewired one.
#[derive(Debug, Clone, Copy)]
pub struct NodeUpdate {
    node: u32,
    heading: f64,
    edge: f64,
    cost: f64,
    length: f64,
}

/// Chosen parent.
#[derive(Debug, Clone, Copy)]
pub struct ParentChoice {
    pub parent: u32,
    pub link: Link,
    pub edge: f64,
    pub cost: f64,
}

impl<M: Motion> Search<M> {
    /// Link from a node to a point.
    pub(super) fn link(&self, from: u32, to: Point2<f64>) -> Option<Link> {
        let node = self.tree.node(from);
        self.link_at(from, to, (to - node.position()).norm())
    }

    fn link_at(&self, from: u32, to: Point2<f64>, distance: f64) -> Option<Link> {
        let pose = &self.tree.node(from).pose;
        if from == ROOT {
            self.motion.link_from_start(pose, to, distance)
        } else {
            self.motion.link(pose, to, distance)
        }
    }

    /// Returns the cost of the edge from a node by a link.
    pub(super) fn edge(&self, scene: &Scene<'_>, from: u32, to: Point2<f64>, link: &Link) -> f64 {
        let node = self.tree.node(from);
        scene.cost.edge(node.position(), to, link, node.length)
    }

    fn consider(
        &mut self,
        scene: &Scene<'_>,
        node: u32,
        to: Point2<f64>,
        distance: f64,
        most: f64,
    ) {
        let from = self.tree.node(node);
        // Too expensive even without a threat.
        if distance <= self.params.algorithm.min_edge() || from.cost + distance >= most {
            return;
        }
        let Some(link) = self.link_at(node, to, distance) else {
            return;
        };
        let edge = self.edge(scene, node, to, &link);
        let cost = from.cost + edge;
        if cost < most {
            self.candidates.push(Candidate {
                node,
                link,
                edge,
                cost,
            });
        }
    }

    /// Returns the cheapest parent for a point among `self.near` (and their ancestors) from which
    /// the path to it is free, if it costs less than `most`. The published search considers no
    /// ancestors, and only the cheapest parent: where the path from there is blocked, there is
    /// none.
    pub(super) fn choose_parent(
        &mut self,
        scene: &Scene<'_>,
        to: Point2<f64>,
        most: f64,
    ) -> Option<ParentChoice> {
        self.candidates.clear();
        let near = core::mem::take(&mut self.near);
        for near in &near {
            self.consider(scene, near.node, to, near.distance, most);
        }
        if self.is_improved() {
            self.consider_ancestors(scene, &near, to, most);
        }
        self.near = near;
        // The cheapest first; a collision check costs more than a search of the list.
        loop {
            let (place, best) = self
                .candidates
                .iter()
                .enumerate()
                .min_by(|a, b| a.1.cost.total_cmp(&b.1.cost))
                .map(|(place, best)| (place, *best))?;
            let from = self.tree.node(best.node).position();
            if scene.is_free(&best.link, from, to) {
                return Some(ParentChoice {
                    parent: best.node,
                    link: best.link,
                    edge: best.edge,
                    cost: best.cost,
                });
            }
            if !self.is_improved() {
                return None;
            }
            self.candidates.swap_remove(place);
        }
    }

    /// Considers the parents of near nodes (Quick-RRT* with one generation of ancestors: more
    /// seldom find a better path).
    fn consider_ancestors(
        &mut self,
        scene: &Scene<'_>,
        near: &[crate::index::Neighbour],
        to: Point2<f64>,
        most: f64,
    ) {
        // Siblings share their parent: each is considered once.
        let mut seen = core::mem::take(&mut self.seen);
        seen.clear();
        for near in near {
            let parent = self.tree.node(near.node).parent;
            if parent != NONE && !seen.contains(&parent) {
                seen.push(parent);
                let distance = (to - self.tree.node(parent).position()).norm();
                self.consider(scene, parent, to, distance, most);
            }
        }
        self.seen = seen;
    }

    /// Adds a node under a parent; returns its number.
    pub(super) fn add(&mut self, at: Point2<f64>, chosen: &ParentChoice) -> u32 {
        let node = self.tree.push(Pose2::new(at.x, at.y, chosen.link.heading));
        self.index.insert(at);
        self.hang(node, chosen);
        node
    }

    pub(super) fn hang(&mut self, node: u32, chosen: &ParentChoice) {
        let length = self.tree.node(chosen.parent).length + chosen.link.length;
        self.tree.attach(node, chosen.parent);
        let values = self.tree.node_mut(node);
        values.pose.theta = chosen.link.heading;
        values.edge = chosen.edge;
        values.cost = chosen.cost;
        values.length = length;
    }

    /// Gives a goal a better parent, if there is one in reach.
    pub(super) fn join_goal(&mut self, scene: &Scene<'_>, goal: u32) {
        let at = self.tree.node(goal).position();
        let mut near = core::mem::take(&mut self.near);
        self.index.near(at, self.radius(), &mut near);
        self.near = near;
        let most = self.tree.node(goal).cost;
        if let Some(chosen) = self.choose_parent(scene, at, most) {
            self.hang(goal, &chosen);
        }
    }

    /// Offers a new node to the goals within the longest edge.
    pub(super) fn offer_to_goals(&mut self, scene: &Scene<'_>, parent: u32) {
        for goal in 1..=self.goals {
            let distance =
                (self.tree.node(goal).position() - self.tree.node(parent).position()).norm();
            if distance <= self.params.max_edge {
                self.offer(scene, goal, parent, distance);
            }
        }
    }

    /// Gives the nodes of `self.near` the new node as their parent where that is cheaper.
    pub(super) fn rewire(&mut self, scene: &Scene<'_>, parent: u32) {
        let near = core::mem::take(&mut self.near);
        for near in &near {
            if near.distance > self.params.algorithm.min_edge() {
                self.offer(scene, near.node, parent, near.distance);
            }
        }
        self.near = near;
    }

    /// Moves `child` to `parent` if that makes it cheaper and the link is free.
    pub(super) fn offer(
        &mut self,
        scene: &Scene<'_>,
        child: u32,
        parent: u32,
        distance: f64,
    ) -> bool {
        let (from, to) = (*self.tree.node(parent), *self.tree.node(child));
        if child == ROOT || from.cost + distance >= to.cost {
            return false;
        }
        let Some(link) = self.link_at(parent, to.position(), distance) else {
            return false;
        };
        let edge = self.edge(scene, parent, to.position(), &link);
        let cost = from.cost + edge;
        if cost >= to.cost || !scene.is_free(&link, from.position(), to.position()) {
            return false;
        }
        let chosen = ParentChoice {
            parent,
            link,
            edge,
            cost,
        };
        self.relink(scene, child, &chosen)
    }

    /// Moves a node to another parent, with all changes for its descendants. Returns `false`,
    /// without changes, if one of them could not follow.
    pub(super) fn relink(&mut self, scene: &Scene<'_>, child: u32, chosen: &ParentChoice) -> bool {
        if !self.follow_up(scene, child, chosen) {
            return false;
        }
        self.hang(child, chosen);
        for moved in &self.moved {
            let node = self.tree.node_mut(moved.node);
            node.pose.theta = moved.heading;
            node.edge = moved.edge;
            node.cost = moved.cost;
            node.length = moved.length;
        }
        true
    }

    /// Computes the changes of all descendants of a node with a new parent into `self.moved`;
    /// returns `false` if a path behind it would become invalid.
    fn follow_up(&mut self, scene: &Scene<'_>, child: u32, chosen: &ParentChoice) -> bool {
        let mut moved = core::mem::take(&mut self.moved);
        moved.clear();
        moved.push(NodeUpdate {
            node: child,
            heading: chosen.link.heading,
            edge: chosen.edge,
            cost: chosen.cost,
            length: self.tree.node(chosen.parent).length + chosen.link.length,
        });
        let mut next = 0;
        let mut sound = true;
        while let Some(&above) = moved.get(next).filter(|_| sound) {
            next += 1;
            for node in self.tree.children(above.node) {
                let Some(values) = self.moved_child(scene, &above, node) else {
                    sound = false;
                    break;
                };
                moved.push(values);
                if M::HAS_HEADING && moved.len() > MAX_MOVED {
                    sound = false;
                    break;
                }
            }
        }
        self.moved = moved;
        sound
    }

    fn moved_child(&self, scene: &Scene<'_>, above: &NodeUpdate, node: u32) -> Option<NodeUpdate> {
        let (parent, child) = (self.tree.node(above.node), self.tree.node(node));
        if !M::HAS_HEADING {
            let length = above.length + (child.length - parent.length);
            let edge = if scene.cost.is_static() {
                child.edge
            } else {
                let link = Link::line(child.length - parent.length);
                scene
                    .cost
                    .edge(parent.position(), child.position(), &link, above.length)
            };
            return Some(NodeUpdate {
                node,
                heading: child.pose.theta,
                edge,
                cost: above.cost + edge,
                length,
            });
        }
        let from = Pose2::new(parent.pose.x, parent.pose.y, above.heading);
        let to = child.position();
        let link = self
            .motion
            .link(&from, to, (to - parent.position()).norm())?;
        if !scene.is_free(&link, parent.position(), to) {
            return None;
        }
        let edge = scene.cost.edge(parent.position(), to, &link, above.length);
        let cost = above.cost + edge;
        // Descendants must gain as well.
        (cost <= child.cost).then_some(NodeUpdate {
            node,
            heading: link.heading,
            edge,
            cost,
            length: above.length + link.length,
        })
    }
}
