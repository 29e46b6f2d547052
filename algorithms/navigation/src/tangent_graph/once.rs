//! A single query for a space: a graph of only the sites that its path can touch.

use std::sync::Arc as Shared;

use nalgebra::Point2;

use super::graph::Graph;
use super::near::Near;
use super::sites::{self, Site};
use super::{GraphError, Inner, MAX_SITES, MIN_RADIUS, ShortestPath, TangentGraph};
use planner_view::free_space::FreeSpace;

/// Successive upper bounds on the length of the path, as multiples of the straight distance.
const LENGTH_BOUNDS: [f64; 4] = [1.01, 1.05, 1.2, 1.6];

/// Maximum number of arcs for a single query. The border of a union of n discs has at most 6 n − 12 arcs, so this
/// many suffice for as many discs as a graph has sites.
const MAX_ONCE: usize = 6 * MAX_SITES;

/// The shortest path of a disc of this radius (m) between two points (m); as
/// [`TangentGraph::shortest`], but without the preparations that only pay for many queries.
///
/// A path that touches a site is at least as long as the path over the nearest point of its circle.
/// So the sites within an ellipse about the two points suffice, as long as the path found is no
/// longer than the ellipse allows. If it is longer, or if there is none, the ellipse grows, in the
/// end to the whole space.
///
/// # Errors
/// As [`TangentGraph::new`].
pub fn shortest_once(
    space: &FreeSpace,
    radius: f64,
    from: Point2<f64>,
    to: Point2<f64>,
) -> Result<Option<ShortestPath>, GraphError> {
    growing(space, radius, from, to, f64::INFINITY, |graph, limit| {
        let path = graph.shortest(from, to);
        let complete = path.as_ref().is_some_and(|path| path.length <= limit);
        (path, complete)
    })
}

/// The result of a query for paths that are not longer than a limit (m) in a graph of the sites that
/// such paths can touch. The limit grows, up to `most`, until the query is complete.
///
/// # Errors
/// As [`TangentGraph::new`].
pub fn growing<T>(
    space: &FreeSpace,
    radius: f64,
    from: Point2<f64>,
    to: Point2<f64>,
    most: f64,
    query: impl Fn(&TangentGraph, f64) -> (T, bool),
) -> Result<T, GraphError> {
    if !(radius >= MIN_RADIUS && radius.is_finite()) {
        return Err(GraphError::Radius(radius));
    }
    let direct = (to - from).norm();
    let all = sites::find(space, radius, MAX_ONCE);
    if all.len() > MAX_ONCE {
        return Err(GraphError::TooManySites(MAX_ONCE));
    }
    let detour = |site: &Site| {
        let [a, b] = [from, to].map(|end| ((end - site.center).norm() - site.radius).max(0.0));
        a + b
    };
    let bounds = LENGTH_BOUNDS.map(|part| part * direct);
    let mut bounds = bounds.into_iter().filter(|bound| *bound < most);
    loop {
        let bound = bounds.next().unwrap_or(most);
        let near: Vec<Site> = all
            .iter()
            .copied()
            .filter(|site| detour(site) <= bound)
            .collect();
        let whole = near.len() == all.len();
        let graph = Graph::new(space, radius, near)?;
        let inner = Inner {
            near: Near::new(space.bounds()),
            space: space.clone(),
            radius,
            graph,
        };
        let graph = TangentGraph {
            inner: Shared::new(inner),
        };
        let limit = if whole { most } else { bound };
        let (found, complete) = query(&graph, limit);
        if complete || whole || bound >= most {
            return Ok(found);
        }
    }
}
