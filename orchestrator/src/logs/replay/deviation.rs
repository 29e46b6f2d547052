//! By how much messages differ, field by field.

use std::collections::BTreeMap;

use ipc_types::cdr;
use ipc_types::message::{Descriptor, FieldKind, Message as _};
use ipc_types::topics::{Shape, Topic};
use serde::Serialize;

use super::super::known::ENCAPSULATION;

/// Fields that are clocks: they are never the same.
const CLOCKS: [&str; 5] = [
    "stamp.origin_ns",
    "stamp.begun_ns",
    "stamp.received_ns",
    "stamp.computed_ns",
    "stamp.sent_ns",
];

/// By how much a field differs, in all messages of a topic.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Deviation {
    /// How many values differ.
    pub values: u64,
    /// First tick at which one does.
    pub first_tick: u64,
    /// Greatest difference, of those that are numbers.
    pub max: f64,
    /// Mean of the differences, where there is one.
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

/// A number in the bytes of a message.
#[derive(Debug, Clone)]
struct Number {
    name: String,
    offset: usize,
    size: usize,
    kind: &'static str,
}

impl Number {
    fn bytes<'a>(&self, message: &'a [u8]) -> Option<&'a [u8]> {
        message.get(self.offset..self.offset + self.size)
    }

    fn value(&self, bytes: &[u8]) -> f64 {
        let mut word = [0; 8];
        for (to, from) in word.iter_mut().zip(bytes) {
            *to = *from;
        }
        let bits = u64::from_le_bytes(word);
        match self.kind {
            "float64" => f64::from_bits(bits),
            "float32" => f64::from(f32::from_bits(bits as u32)),
            "int8" => f64::from(bits as u8 as i8),
            "int16" => f64::from(bits as u16 as i16),
            "int32" => f64::from(bits as u32 as i32),
            "int64" => bits as i64 as f64,
            _ => bits as f64,
        }
    }
}

/// The numbers of a topic's messages.
#[derive(Debug, Clone)]
pub(super) struct Numbers {
    header: Vec<Number>,
    element: Vec<Number>,
    /// Where the elements begin in the CDR form.
    elements_at: usize,
    element_bytes: usize,
}

impl Numbers {
    pub(super) fn of<T: Topic>() -> Self {
        let (header, element) = (T::Header::DESCRIPTOR, T::Element::DESCRIPTOR);
        let mut numbers = Self {
            header: Vec::new(),
            element: Vec::new(),
            elements_at: cdr::encoded_len::<T>(0),
            element_bytes: element.size,
        };
        collect(&header, "", ENCAPSULATION, &mut numbers.header);
        numbers
            .header
            .retain(|number| !CLOCKS.contains(&number.name.as_str()));
        let name = match T::SHAPE {
            Shape::One => String::new(),
            Shape::Many => format!("{}[]", T::ELEMENTS),
        };
        collect(&element, &name, 0, &mut numbers.element);
        numbers
    }

    /// Adds the differences between two messages in their CDR form; elements that only one of them
    /// has are left out.
    pub(super) fn compare(
        &self,
        tick: u64,
        a: &[u8],
        b: &[u8],
        fields: &mut BTreeMap<String, Deviation>,
    ) {
        let mut add = |number: &Number, x: &[u8], y: &[u8]| {
            if let (Some(x), Some(y)) = (number.bytes(x), number.bytes(y))
                && x != y
            {
                let (x, y) = (number.value(x), number.value(y));
                match fields.get_mut(&number.name) {
                    Some(field) => field.add(tick, x, y),
                    None => fields
                        .entry(number.name.clone())
                        .or_default()
                        .add(tick, x, y),
                }
            }
        };
        for number in &self.header {
            add(number, a, b);
        }
        let elements = |bytes| -> &[u8] { <[u8]>::get(bytes, self.elements_at..).unwrap_or(&[]) };
        let size = self.element_bytes.max(1);
        for (x, y) in elements(a)
            .chunks_exact(size)
            .zip(elements(b).chunks_exact(size))
        {
            if x != y {
                for number in &self.element {
                    add(number, x, y);
                }
            }
        }
    }
}

fn collect(descriptor: &Descriptor, name: &str, base: usize, numbers: &mut Vec<Number>) {
    let joined = |field: &str| match name {
        "" => field.to_owned(),
        name => format!("{name}.{field}"),
    };
    // A plain number as element has no fields.
    if descriptor.fields.is_empty() {
        numbers.push(Number {
            name: name.to_owned(),
            offset: base,
            size: descriptor.size,
            kind: descriptor.name,
        });
    }
    for field in descriptor.fields {
        let at = base + field.offset;
        match field.kind {
            FieldKind::Nested(inner) => collect(inner, &joined(field.name), at, numbers),
            FieldKind::Number(kind) => numbers.push(Number {
                name: joined(field.name),
                offset: at,
                size: size_of_number(kind),
                kind,
            }),
            FieldKind::Array(kind, count) => {
                let size = size_of_number(kind);
                numbers.extend((0..count).map(|index| Number {
                    name: format!("{}[]", joined(field.name)),
                    offset: at + index * size,
                    size,
                    kind,
                }));
            }
        }
    }
}

fn size_of_number(kind: &str) -> usize {
    match kind {
        "uint8" | "int8" => 1,
        "uint16" | "int16" => 2,
        "uint32" | "int32" | "float32" => 4,
        _ => 8,
    }
}

#[cfg(test)]
mod tests {
    use ipc_types::messages::perception::{BeliefHeader, Particle};
    use ipc_types::topics::Belief;

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
    fn differences_are_summed_up_by_field_and_clocks_are_none() {
        let numbers = Numbers::of::<Belief>();
        let mut fields = BTreeMap::new();
        let mut compare = |tick, a: &[u8], b: &[u8]| numbers.compare(tick, a, b, &mut fields);
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
