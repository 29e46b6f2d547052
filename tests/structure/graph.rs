//! Cycles of a directed graph.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// Edges from each node, each with its label.
pub type Arrows<T> = BTreeMap<String, BTreeMap<String, T>>;

/// A shortest cycle through each node that is on one and on none of the cycles before; the first node is
/// not repeated at the end.
pub fn cycles<T>(arrows: &Arrows<T>) -> Vec<Vec<String>> {
    let mut found: Vec<Vec<String>> = Vec::new();
    let mut seen = BTreeSet::new();
    for node in arrows.keys() {
        if !seen.contains(node)
            && let Some(cycle) = through(node, arrows)
        {
            seen.extend(cycle.iter().cloned());
            found.push(cycle);
        }
    }
    found
}

/// A shortest cycle through a node, which is its first.
fn through<T>(start: &str, arrows: &Arrows<T>) -> Option<Vec<String>> {
    let mut before: BTreeMap<&str, &str> = BTreeMap::new();
    let mut queue = VecDeque::from([start]);
    while let Some(node) = queue.pop_front() {
        for next in arrows.get(node).into_iter().flat_map(BTreeMap::keys) {
            if next == start {
                let mut cycle = vec![node.to_owned()];
                let mut at = node;
                while let Some(previous) = before.get(at) {
                    cycle.push((*previous).to_owned());
                    at = previous;
                }
                cycle.reverse();
                return Some(cycle);
            }
            if !before.contains_key(next.as_str()) {
                before.insert(next, node);
                queue.push_back(next);
            }
        }
    }
    None
}
