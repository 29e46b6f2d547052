//! Deviation of the fields of a topic over all messages.

use std::collections::BTreeMap;

use serde::Serialize;
use tables::Cell;

use crate::message::{Message, common};

/// Deviation of a field over all messages of a topic.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Deviation {
    /// Number of values that differ.
    pub values: u64,
    /// First tick with a difference.
    pub first_tick: u64,
    /// Maximum difference of numeric values.
    pub max: f64,
    /// Mean of the non-zero differences.
    pub mean: f64,
    #[serde(skip)]
    sum: f64,
    #[serde(skip)]
    finite: u64,
}

impl Deviation {
    fn add(&mut self, tick: u64, a: f64, b: f64) {
        if self.values == 0 {
            self.first_tick = tick;
        }
        self.values += 1;
        let difference = (a - b).abs();
        if difference.is_finite() {
            self.finite += 1;
            self.sum += difference;
            self.max = self.max.max(difference);
            self.mean = self.sum / self.finite as f64;
        }
    }
}

/// Adds the differences of two messages to the deviations by field; ignores elements that only one message has.
pub fn add_deviations(a: &Message, b: &Message, fields: &mut BTreeMap<String, Deviation>) {
    // A message that does not fit its definition has no fields, but still counts as different.
    for (name, x, y) in common(a, b).unwrap_or_default() {
        if !matches!(x, Cell::Text(_)) && !x.is_same(&y) {
            let field = fields.entry(without_indices(&name)).or_default();
            field.add(a.stamp.tick, number(&x), number(&y));
        }
    }
}

/// Returns `robots[].x` for `robots[3].x`.
fn without_indices(name: &str) -> String {
    let mut is_index = false;
    name.chars()
        .filter(|&letter| {
            is_index = letter == '[' || is_index && letter != ']';
            letter == '[' || !is_index
        })
        .collect()
}

fn number(cell: &Cell) -> f64 {
    match cell {
        Cell::Empty | Cell::Text(_) => f64::NAN,
        Cell::Bool(v) => f64::from(u8::from(*v)),
        Cell::Int(v) => *v as f64,
        Cell::UInt(v) => *v as f64,
        Cell::F32(v) => f64::from(*v),
        Cell::F64(v) => *v,
    }
}

#[cfg(test)]
mod tests {
    use ipc_types::cdr;
    use ipc_types::messages::perception::{BeliefHeader, Particle};
    use ipc_types::topics::{Belief, TopicId};

    use super::*;

    fn belief(tick: u64, mean_x: f64, clock: u64, xs: &[f32]) -> Message {
        let mut header = BeliefHeader {
            mean_x,
            ..BeliefHeader::default()
        };
        header.stamp.tick = tick;
        header.stamp.sent_ns = clock;
        let particles: Vec<Particle> = xs
            .iter()
            .map(|&x| Particle {
                x,
                ..Particle::default()
            })
            .collect();
        let mut bytes = Vec::new();
        cdr::encode::<Belief>(&header, &particles, &mut bytes);
        Message::from_cdr(TopicId::Belief, bytes).unwrap()
    }

    #[test]
    fn differences_are_summed_by_field_without_clocks() {
        let mut fields = BTreeMap::new();
        for (tick, mean_x, xs) in [
            (1, [1.0, 1.0], [&[1.0, 2.0][..], &[1.0, 2.0]]),
            (2, [1.0, 3.0], [&[1.0, 2.0], &[1.5, 1.0]]),
            (3, [f64::NAN, 3.0], [&[0.0], &[0.0, 7.0]]),
        ] {
            let [a, b] = [0, 1].map(|at| belief(tick, mean_x[at], at as u64, xs[at]));
            add_deviations(&a, &b, &mut fields);
        }
        let mean_x = &fields["mean_x"];
        assert_eq!((mean_x.values, mean_x.first_tick), (2, 2));
        assert_eq!((mean_x.max, mean_x.mean), (2.0, 2.0));
        let x = &fields["particles[].x"];
        assert_eq!((x.values, x.first_tick, x.max, x.mean), (2, 2, 1.0, 0.75));
        assert_eq!(fields.len(), 2);
    }
}
