//! Refinement of the best path's own points.
//!
//! Far from a corner the tree needs ever more samples to come nearer to it; a few random changes of
//! the path's points get there at once. A change is accepted only if the path becomes cheaper and
//! stays free, so that no change makes it worse.

use geometry::math;
use nalgebra::{Point2, Vector2};

use super::join::ParentChoice;
use super::{Scene, Search};
use crate::motion::{Link, Motion};
use crate::sampler::uniform;
use crate::tree::ROOT;

/// Minimum gain of a change as a share of the cost; smaller gains would only add nodes.
const MIN_GAIN: f64 = 2e-6;

/// Range of the size of changes: from an edge down by this many factors of e.
const DEPTH: f64 = 7.0;

/// Piece of a changed path.
#[derive(Clone, Copy)]
struct Piece {
    from: Point2<f64>,
    to: Point2<f64>,
    link: Link,
    edge: f64,
    /// Cost of the path up to its end (m).
    cost: f64,
}

/// Changed part of the path: two or three pieces.
type PathPieces = [Option<Piece>; 3];

impl<M: Motion> Search<M> {
    /// Tries one random change of the best path.
    pub(super) fn refine(&mut self, scene: &Scene<'_>) {
        let inner = self.way.len().saturating_sub(2);
        let (pick, kind, size) = (
            uniform(&mut self.rng),
            uniform(&mut self.rng),
            math::exp(-DEPTH * uniform(&mut self.rng)),
        );
        // Drawn even if not needed: later draws do not depend on the kind.
        let turn = core::f64::consts::TAU * uniform(&mut self.rng);
        let place = (pick * inner as f64) as usize;
        let (Some(&a), Some(&v), Some(&b)) = (
            self.way.get(place),
            self.way.get(place + 1),
            self.way.get(place + 2),
        ) else {
            return;
        };
        let [pa, pv, pb] = [a, v, b].map(|node| self.tree.node(node).position());
        let (back, on): (Vector2<f64>, Vector2<f64>) = (pa - pv, pb - pv);
        let changed = if kind < 0.4 && !M::HAS_HEADING {
            // The corner cut off.
            let most = back.norm().min(on.norm());
            let cut = 0.95 * size * most;
            let (first, second) = (back.normalize() * cut, on.normalize() * cut);
            self.detour(scene, [a, v, b], &[pv + first, pv + second])
        } else if kind < 0.7 && !M::HAS_HEADING {
            // Straightened.
            let chord: Vector2<f64> = pb - pa;
            let t = (-back.dot(&chord) / chord.norm_squared()).clamp(0.0, 1.0);
            let to = pa + chord * t;
            self.detour(scene, [a, v, b], &[pv + (to - pv) * size])
        } else {
            let (sin, cos) = math::sincos(turn);
            let far = 0.5 * size * back.norm().min(on.norm());
            self.detour(scene, [a, v, b], &[pv + Vector2::new(cos, sin) * far])
        };
        if changed {
            self.note_best(scene);
        }
    }

    /// Replaces the path from `a` over `v` to `b` by these points, if that is cheaper and free.
    fn detour(&mut self, scene: &Scene<'_>, [a, v, b]: [u32; 3], over: &[Point2<f64>]) -> bool {
        let most = self.tree.node(b).cost - MIN_GAIN * self.best.0;
        let from = *self.tree.node(a);
        let (mut pose, mut cost, mut length) = (from.pose, from.cost, from.length);
        let end = self.tree.node(b).position();
        let mut links: PathPieces = [None; 3];
        for (i, &to) in over.iter().chain([&end]).enumerate() {
            let at = pose.position();
            let distance = (to - at).norm();
            let link = if a == ROOT && i == 0 {
                self.motion.link_from_start(&pose, to, distance)
            } else {
                self.motion.link(&pose, to, distance)
            };
            // False for NaN, too: two points in one place.
            let Some(link) = link.filter(|_| distance > self.params.algorithm.min_edge()) else {
                return false;
            };
            let edge = scene.cost.edge(at, to, &link, length);
            cost += edge;
            length += link.length;
            if cost >= most {
                return false;
            }
            pose = geometry::pose::Pose2::new(to.x, to.y, link.heading);
            if let Some(slot) = links.get_mut(i) {
                *slot = Some(Piece {
                    from: at,
                    to,
                    link,
                    edge,
                    cost,
                });
            }
        }
        let is_free = links
            .iter()
            .flatten()
            .all(|piece| scene.is_free(&piece.link, piece.from, piece.to));
        if !is_free {
            return false;
        }
        self.rehang(scene, [a, v, b], over.len(), &links)
    }

    /// Builds the path from `a` to `b` along these links, over `v` (moved to the last of the points
    /// between) if it has no other children, and over new nodes otherwise.
    fn rehang(
        &mut self,
        scene: &Scene<'_>,
        [a, v, b]: [u32; 3],
        over: usize,
        laid: &PathPieces,
    ) -> bool {
        let can_move = self.tree.children(v).all(|child| child == b);
        let old = *self.tree.node(v);
        let mut parent = a;
        for (i, piece) in laid.iter().flatten().enumerate() {
            let chosen = ParentChoice {
                parent,
                link: piece.link,
                edge: piece.edge,
                cost: piece.cost,
            };
            parent = if i == over {
                if self.relink(scene, b, &chosen) {
                    return true;
                }
                break;
            } else if can_move && i + 1 == over {
                self.index.relocate(v, piece.to);
                let node = self.tree.node_mut(v);
                (node.pose.x, node.pose.y) = (piece.to.x, piece.to.y);
                self.hang(v, &chosen);
                v
            } else {
                self.add(piece.to, &chosen)
            };
        }
        if can_move {
            // The descendants could not follow.
            self.index.relocate(v, old.position());
            self.tree.attach(v, a);
            let node = self.tree.node_mut(v);
            node.pose = old.pose;
            (node.edge, node.cost, node.length) = (old.edge, old.cost, old.length);
        }
        false
    }

    /// Removes points of the best path where the next can be reached from the one before.
    pub(super) fn straighten(&mut self, scene: &Scene<'_>) {
        let mut place = self.way.len().saturating_sub(1);
        let mut is_changed = false;
        while place >= 2 {
            let (Some(&node), Some(&over)) = (self.way.get(place), self.way.get(place - 2)) else {
                break;
            };
            let distance =
                (self.tree.node(node).position() - self.tree.node(over).position()).norm();
            if self.offer(scene, node, over, distance) {
                self.way.remove(place - 1);
                is_changed = true;
            }
            place -= 1;
        }
        if is_changed {
            let goal = self.best.1;
            self.best.0 = self.tree.node(goal).cost;
            self.tree.way_to(goal, &mut self.way);
        }
    }
}
