//! The tree: nodes with their parents, children and costs.

use geometry::pose::Pose2;
use nalgebra::Point2;

/// No node.
pub const NONE: u32 = u32::MAX;

/// The root's number.
pub const ROOT: u32 = 0;

/// A node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Position, and the robot's heading there (0 for primitives without one).
    pub pose: Pose2,
    /// Cost from the root (m); infinite for a node that is not joined to it.
    pub cost: f64,
    /// Length of the path from the root (m).
    pub length: f64,
    /// Cost of the edge to it (m).
    pub edge: f64,
    /// Its parent, or [`NONE`].
    pub parent: u32,
    first_child: u32,
    next: u32,
    previous: u32,
}

impl Node {
    /// Returns a node that is not joined to the tree.
    pub const fn loose(pose: Pose2) -> Self {
        Self {
            pose,
            cost: f64::INFINITY,
            length: f64::INFINITY,
            edge: f64::INFINITY,
            parent: NONE,
            first_child: NONE,
            next: NONE,
            previous: NONE,
        }
    }

    /// Returns the position (m).
    pub fn position(&self) -> Point2<f64> {
        self.pose.position()
    }
}

/// Returns the nodes by number; number 0 is the root.
#[derive(Debug, Clone, Default)]
pub struct Tree {
    nodes: Vec<Node>,
}

impl Tree {
    /// Resets the tree to a root alone; keeps the memory.
    pub fn plant(&mut self, pose: Pose2) {
        self.nodes.clear();
        self.nodes.push(Node {
            cost: 0.0,
            length: 0.0,
            edge: 0.0,
            ..Node::loose(pose)
        });
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Returns `true` if there is no root.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// All nodes by their numbers.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Returns a node. Its number must be a result of [`push`](Self::push).
    pub fn node(&self, node: u32) -> &Node {
        &self.nodes[node as usize]
    }

    /// Returns a node for changes of its values, but not of its relations.
    pub fn node_mut(&mut self, node: u32) -> &mut Node {
        &mut self.nodes[node as usize]
    }

    /// Adds a node without a parent.
    pub fn push(&mut self, pose: Pose2) -> u32 {
        self.nodes.push(Node::loose(pose));
        self.nodes.len() as u32 - 1
    }

    /// Attaches a node to a parent; the caller sets its costs.
    pub fn attach(&mut self, child: u32, parent: u32) {
        self.detach(child);
        let first = self.nodes[parent as usize].first_child;
        if first != NONE {
            self.nodes[first as usize].previous = child;
        }
        let node = &mut self.nodes[child as usize];
        node.parent = parent;
        node.next = first;
        node.previous = NONE;
        self.nodes[parent as usize].first_child = child;
    }

    /// Removes a node from its parent.
    fn detach(&mut self, child: u32) {
        let Node {
            parent,
            next,
            previous,
            ..
        } = self.nodes[child as usize];
        if parent == NONE {
            return;
        }
        if next != NONE {
            self.nodes[next as usize].previous = previous;
        }
        if previous == NONE {
            self.nodes[parent as usize].first_child = next;
        } else {
            self.nodes[previous as usize].next = next;
        }
        let node = &mut self.nodes[child as usize];
        (node.parent, node.next, node.previous) = (NONE, NONE, NONE);
    }

    /// The children of a node.
    pub fn children(&self, node: u32) -> impl Iterator<Item = u32> + '_ {
        let mut child = self.nodes[node as usize].first_child;
        core::iter::from_fn(move || {
            let found = (child != NONE).then_some(child)?;
            child = self.nodes[found as usize].next;
            Some(found)
        })
    }

    /// Returns the path from the root to a node, both included, root first; empty for a node that
    /// is not joined to the tree.
    pub fn way_to(&self, node: u32, way: &mut Vec<u32>) {
        way.clear();
        if !self.node(node).cost.is_finite() {
            return;
        }
        let mut next = node;
        while next != NONE {
            way.push(next);
            next = self.nodes[next as usize].parent;
        }
        way.reverse();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn children(tree: &Tree, node: u32) -> Vec<u32> {
        let mut children: Vec<u32> = tree.children(node).collect();
        children.sort_unstable();
        children
    }

    #[test]
    fn children_move_from_parent_to_parent() {
        let mut tree = Tree::default();
        tree.plant(Pose2::new(0.0, 0.0, 0.0));
        let nodes: Vec<u32> = (1..=4)
            .map(|i| {
                let node = tree.push(Pose2::new(f64::from(i), 0.0, 0.0));
                tree.attach(node, ROOT);
                node
            })
            .collect();
        assert_eq!(children(&tree, ROOT), nodes);
        // From the middle, from an end, and the last one.
        tree.attach(2, 1);
        assert_eq!(children(&tree, ROOT), [1, 3, 4]);
        tree.attach(4, 1);
        tree.attach(3, 1);
        assert_eq!(children(&tree, ROOT), [1]);
        assert_eq!(children(&tree, 1), [2, 3, 4]);
        tree.attach(3, 2);
        assert_eq!(children(&tree, 1), [2, 4]);
        assert_eq!(children(&tree, 2), [3]);
        assert_eq!(children(&tree, 3), [0; 0]);
    }

    #[test]
    fn a_loose_node_has_no_way() {
        let mut tree = Tree::default();
        tree.plant(Pose2::new(0.0, 0.0, 0.0));
        let node = tree.push(Pose2::new(1.0, 0.0, 0.0));
        let mut way = vec![7];
        tree.way_to(node, &mut way);
        assert!(way.is_empty());
        tree.attach(node, ROOT);
        tree.node_mut(node).cost = 1.0;
        tree.way_to(node, &mut way);
        assert_eq!(way, [ROOT, node]);
    }
}
