//! Deviation of two messages of a topic, field by field.

use std::collections::BTreeMap;

use mcap_log::known::CLOCKS;
use mcap_log::ros2::{Cdr, Count, DecodeError, Field, Kind, Primitive, Schema};
use serde::Serialize;
use tables::Cell;

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

/// Adds the differences between two messages in CDR form, except for clocks; ignores elements that only one message
/// has.
///
/// # Errors
/// [`DecodeError`] if one of them does not fit the schema.
pub(super) fn add_deviations(
    schema: &Schema,
    tick: u64,
    a: &[u8],
    b: &[u8],
    fields: &mut BTreeMap<String, Deviation>,
) -> Result<(), DecodeError> {
    let (a, b) = (Cdr::new(schema, a)?, Cdr::new(schema, b)?);
    let mut pair = Pair { tick, a, b, fields };
    pair.walk(schema.fields(), "")
}

/// Two messages read side by side.
struct Pair<'a> {
    tick: u64,
    a: Cdr<'a>,
    b: Cdr<'a>,
    fields: &'a mut BTreeMap<String, Deviation>,
}

impl Pair<'_> {
    fn walk(&mut self, fields: &[Field], within: &str) -> Result<(), DecodeError> {
        for field in fields {
            let mut name = match within {
                "" => field.name.clone(),
                within => format!("{within}.{}", field.name),
            };
            if field.count != Count::One {
                name += "[]";
            }
            let (a, b) = (self.a.count(field)?, self.b.count(field)?);
            for _ in 0..a.min(b) {
                self.element(&field.kind, &name)?;
            }
            for _ in b..a {
                self.a.skip(&field.kind, &name)?;
            }
            for _ in a..b {
                self.b.skip(&field.kind, &name)?;
            }
        }
        Ok(())
    }

    fn element(&mut self, kind: &Kind, name: &str) -> Result<(), DecodeError> {
        match kind {
            Kind::Message(fields) => return self.walk(fields, name),
            Kind::Primitive(Primitive::Text | Primitive::WideText) | Kind::Nothing => {
                self.a.skip(kind, name)?;
                self.b.skip(kind, name)?;
            }
            Kind::Primitive(number) => {
                let a = self.a.primitive(*number, name)?;
                let b = self.b.primitive(*number, name)?;
                let is_clock = CLOCKS.contains(&(self.a.end() - 1));
                if !is_clock && !a.is_same(&b) {
                    let (a, b) = (number_of(&a), number_of(&b));
                    let field = self.fields.entry(name.to_owned()).or_default();
                    field.add(self.tick, a, b);
                }
            }
        }
        Ok(())
    }
}

fn number_of(cell: &Cell) -> f64 {
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
    use ipc_types::schema;
    use ipc_types::topics::{Belief, TopicId};

    use super::*;

    fn belief(mean_x: f64, clock: u64, xs: &[f32]) -> Vec<u8> {
        let mut header = BeliefHeader {
            mean_x,
            ..BeliefHeader::default()
        };
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
        bytes
    }

    #[test]
    fn differences_are_summed_by_field_without_clocks() {
        let definition = schema::ros2msg(TopicId::Belief);
        let name = schema::message_name(TopicId::Belief);
        let schema = Schema::parse(&name, definition.as_bytes()).unwrap();
        let mut fields = BTreeMap::new();
        let mut compare = |tick, a: &[u8], b: &[u8]| {
            add_deviations(&schema, tick, a, b, &mut fields).unwrap();
        };
        compare(
            1,
            &belief(1.0, 5, &[1.0, 2.0]),
            &belief(1.0, 6, &[1.0, 2.0]),
        );
        compare(
            2,
            &belief(1.0, 5, &[1.0, 2.0]),
            &belief(3.0, 6, &[1.5, 1.0]),
        );
        compare(
            3,
            &belief(f64::NAN, 5, &[0.0]),
            &belief(3.0, 6, &[0.0, 7.0]),
        );
        let mean_x = &fields["mean_x"];
        assert_eq!((mean_x.values, mean_x.first_tick), (2, 2));
        assert_eq!((mean_x.max, mean_x.mean), (2.0, 2.0));
        let x = &fields["particles[].x"];
        assert_eq!((x.values, x.first_tick, x.max, x.mean), (2, 2, 1.0, 0.75));
        assert_eq!(fields.len(), 2);
    }
}
