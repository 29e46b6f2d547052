//! Checks of messages. Messages that fail are logged, but not used.

use ipc_types::message::{Descriptor, FieldKind};
use ipc_types::topics::{Arity, PerTopic, TopicFacts, TopicId};

/// Check for numbers that are not finite in the bytes of a topic's messages.
#[derive(Debug)]
pub(super) struct Finite {
    header: Vec<Float>,
    element: Elements,
    /// Size of an element (bytes).
    element_bytes: usize,
}

/// A floating-point field: its position and the bits that show whether it is finite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Float {
    offset: usize,
    double: bool,
    may_be_infinite: bool,
}

#[derive(Debug)]
enum Elements {
    /// Elements of `float32` only, such as particles, most of the traffic: checked in one pass over the
    /// bytes.
    Floats { may_be_infinite: bool },
    /// Other elements, checked field by field.
    Fields(Vec<Float>),
}

/// Returns `true` if readers can decode the CDR form of a message with this many elements.
pub(super) fn is_decodable(topic: TopicId, elements: usize) -> bool {
    topic.facts().arity == Arity::Many || elements == 1
}

impl Finite {
    /// Returns the check for the messages of a topic.
    pub(super) fn for_topic(topic: TopicId) -> &'static Self {
        static ALL: PerTopic<Finite> = PerTopic::new(|topic| Finite::new(topic.facts()));
        ALL.get(topic)
    }

    fn new(topic: &TopicFacts) -> Self {
        let mut header = Vec::new();
        collect(topic, &topic.header, 0, &mut header);
        let mut floats = Vec::new();
        collect(topic, &topic.element, 0, &mut floats);
        let may_be_infinite = floats.iter().any(|float| float.may_be_infinite);
        let element = if floats.len() * 4 == topic.element.size
            && floats
                .iter()
                .all(|f| !f.double && f.may_be_infinite == may_be_infinite)
        {
            Elements::Floats { may_be_infinite }
        } else {
            Elements::Fields(floats)
        };
        Self {
            header,
            element,
            element_bytes: topic.element.size.max(1),
        }
    }

    /// Returns `true` if all numbers are valid.
    pub(super) fn is_valid(&self, header: &[u8], elements: &[u8]) -> bool {
        let fields_hold =
            |fields: &[Float], bytes: &[u8]| fields.iter().all(|float| float.is_valid(bytes));
        fields_hold(&self.header, header)
            && match &self.element {
                Elements::Floats { may_be_infinite } => {
                    floats_are_valid(elements, *may_be_infinite)
                }
                Elements::Fields(fields) => {
                    fields.is_empty()
                        || elements
                            .chunks_exact(self.element_bytes)
                            .all(|bytes| fields_hold(fields, bytes))
                }
            }
    }
}

fn collect(topic: &TopicFacts, descriptor: &Descriptor, base: usize, floats: &mut Vec<Float>) {
    // Elements that are plain numbers have no fields.
    if descriptor.fields.is_empty() && descriptor.name.starts_with("float") {
        floats.push(Float {
            offset: base,
            double: descriptor.size == 8,
            may_be_infinite: topic.may_be_infinite.contains(&topic.elements),
        });
    }
    for field in descriptor.fields {
        let may_be_infinite = topic.may_be_infinite.contains(&field.name);
        let (ros, count) = match field.kind {
            FieldKind::Number(ros) => (ros, 1),
            FieldKind::Array(ros, count) => (ros, count),
            FieldKind::Nested(inner) => {
                collect(topic, inner, base + field.offset, floats);
                continue;
            }
        };
        let (size, double) = match ros {
            "float32" => (4, false),
            "float64" => (8, true),
            _ => continue,
        };
        floats.extend((0..count).map(|i| Float {
            offset: base + field.offset + i * size,
            double,
            may_be_infinite,
        }));
    }
}

impl Float {
    fn is_valid(self, bytes: &[u8]) -> bool {
        let number = if self.double {
            bytes
                .get(self.offset..self.offset + 8)
                .and_then(|b| b.try_into().ok())
                .map(f64::from_le_bytes)
        } else {
            bytes
                .get(self.offset..self.offset + 4)
                .and_then(|b| b.try_into().ok())
                .map(|b| f64::from(f32::from_le_bytes(b)))
        };
        number.is_none_or(|x| x.is_finite() || (self.may_be_infinite && !x.is_nan()))
    }
}

/// Returns `true` if a sequence of little-endian `float32` contains no invalid value; without branches, so
/// that the compiler vectorises it.
fn floats_are_valid(bytes: &[u8], may_be_infinite: bool) -> bool {
    const MAGNITUDE: u32 = 0x7fff_ffff;
    const INFINITY: u32 = 0x7f80_0000;
    let limit = if may_be_infinite {
        INFINITY
    } else {
        INFINITY - 1
    };
    let (floats, _) = bytes.as_chunks::<4>();
    let largest = floats.iter().fold(0, |largest, b| {
        largest.max(u32::from_le_bytes(*b) & MAGNITUDE)
    });
    largest <= limit
}

#[cfg(test)]
mod tests {
    use ipc_types::messages::perception::{BeliefHeader, Particle, Sighting};
    use ipc_types::messages::robot::{Command, ScanHeader};
    use ipc_types::stamp::PlainHeader;
    use ipc_types::topics::{Belief, Commands, Scan, Sightings, Topic};
    use zerocopy::IntoBytes;

    use super::Finite;

    fn is_valid<T: Topic>(header: &T::Header, elements: &[T::Element]) -> bool {
        Finite::for_topic(T::id()).is_valid(header.as_bytes(), elements.as_bytes())
    }

    #[test]
    fn a_number_that_is_not_finite_is_found_at_every_position() {
        let header = PlainHeader::default();
        assert!(is_valid::<Commands>(&header, &[Command::default()]));
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(!is_valid::<Commands>(
                &header,
                &[Command {
                    omega: bad,
                    ..Command::default()
                }]
            ));
        }
        let belief = BeliefHeader::default();
        let mut particles = [Particle {
            x: 1e30,
            y: -1.0,
            theta: 3.0,
            weight: 0.1,
        }; 50];
        assert!(is_valid::<Belief>(&belief, &particles));
        particles[37].theta = f32::NAN;
        assert!(!is_valid::<Belief>(&belief, &particles));
        particles[37].theta = f32::NEG_INFINITY;
        assert!(!is_valid::<Belief>(&belief, &particles));
        let bad = BeliefHeader {
            covariance_yy: f64::NAN,
            ..belief
        };
        assert!(!is_valid::<Belief>(&bad, &[]));
    }

    #[test]
    fn infinity_is_allowed_in_some_fields_and_nan_in_none() {
        let header = PlainHeader::default();
        assert!(is_valid::<Sightings>(
            &header,
            &[Sighting {
                sigma: f64::INFINITY,
                ..Sighting::default()
            }]
        ));
        assert!(!is_valid::<Sightings>(
            &header,
            &[Sighting {
                sigma: f64::NAN,
                ..Sighting::default()
            }]
        ));
        assert!(is_valid::<Scan>(
            &ScanHeader::default(),
            &[1.0, f32::INFINITY]
        ));
        assert!(!is_valid::<Scan>(&ScanHeader::default(), &[1.0, f32::NAN]));
        let unlimited = ScanHeader {
            range_max: f64::INFINITY,
            ..ScanHeader::default()
        };
        assert!(!is_valid::<Scan>(&unlimited, &[]));
    }
}
