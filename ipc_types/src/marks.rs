//! The drawn elements of messages.

use crate::cdr;
use crate::message::{Descriptor, FieldKind};
use crate::topics::TopicFacts;

/// One drawn element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mark {
    /// Place (m).
    pub at: [f64; 2],
    /// Direction of an arrow (rad).
    pub angle: Option<f64>,
    /// Radius of a circle, or length of an arrow (m).
    pub radius: Option<f64>,
}

impl Mark {
    /// Returns `true` if it is drawn as a point.
    pub const fn is_point(&self) -> bool {
        self.angle.is_none() && self.radius.is_none()
    }

    /// Returns the lines of its arrow or circle, both ends of each; none of a point. `sincos` is the function of that name.
    pub fn lines(&self, sincos: fn(f64) -> (f64, f64)) -> impl Iterator<Item = [[f64; 2]; 2]> {
        let [x, y] = self.at;
        let radius = self.radius.unwrap_or(ARROW_LENGTH);
        let at = move |angle: f64, radius: f64| {
            let (sin, cos) = sincos(angle);
            [x + radius * cos, y + radius * sin]
        };
        let arrow = self.angle.map(|angle| [self.at, at(angle, radius)]);
        let corners = if arrow.is_none() && self.radius.is_some() {
            CORNERS
        } else {
            0
        };
        let corner = move |n: u32| {
            at(
                core::f64::consts::TAU * f64::from(n) / f64::from(CORNERS),
                radius,
            )
        };
        let circle = (0..corners).map(move |n| [corner(n), corner(n + 1)]);
        arrow.into_iter().chain(circle)
    }
}

/// Length of an arrow without one (m).
const ARROW_LENGTH: f64 = 1.0;
/// Number of corners of a drawn circle.
const CORNERS: u32 = 24;

/// The drawn fields of a topic.
#[derive(Debug, Clone, Copy)]
pub struct DrawnFields {
    facts: &'static TopicFacts,
    x: Place,
    y: Place,
    angle: Option<Place>,
    radius: Option<Place>,
}

/// A number in a message.
#[derive(Debug, Clone, Copy)]
struct Place {
    is_in_header: bool,
    offset: usize,
    double: bool,
}

impl DrawnFields {
    /// Returns the drawn fields of a topic; `None` if it is not drawn.
    ///
    /// # Errors
    /// The name of a field that is no floating-point number of the topic.
    pub fn from_facts(facts: &'static TopicFacts) -> Result<Option<Self>, &'static str> {
        let Some(drawing) = facts.drawing else {
            return Ok(None);
        };
        let place = |name: &'static str| {
            let found = find(&facts.element, name).map(|found| (false, found));
            let found = found.or_else(|| find(&facts.header, name).map(|found| (true, found)));
            let (is_in_header, (offset, double)) = found.ok_or(name)?;
            Ok(Place {
                is_in_header,
                offset,
                double,
            })
        };
        Ok(Some(Self {
            facts,
            x: place(drawing.x)?,
            y: place(drawing.y)?,
            angle: drawing.angle.map(place).transpose()?,
            radius: drawing.radius.map(place).transpose()?,
        }))
    }

    /// Returns the drawn elements of a message in its CDR form; those with a number that is not finite are left out.
    pub fn marks<'m>(&'m self, bytes: &'m [u8]) -> impl Iterator<Item = Mark> + 'm {
        let body = bytes.get(cdr::ENCAPSULATION.len()..).unwrap_or_default();
        let (header, rest) = body
            .split_at_checked(self.facts.header.size)
            .unwrap_or_default();
        let head = cdr::head_len(self.facts, 1);
        let elements = rest.get(head..).unwrap_or_default();
        let elements = elements.chunks_exact(self.facts.element.size.max(1));
        elements.filter_map(move |element| {
            let number = |place: Place| {
                let bytes = if place.is_in_header { header } else { element };
                place.read(bytes).filter(|number| number.is_finite())
            };
            let optional = |place: Option<Place>| match place {
                Some(place) => number(place).map(Some),
                None => Some(None),
            };
            Some(Mark {
                at: [number(self.x)?, number(self.y)?],
                angle: optional(self.angle)?,
                radius: optional(self.radius)?,
            })
        })
    }
}

impl Place {
    fn read(self, bytes: &[u8]) -> Option<f64> {
        let bytes = bytes.get(self.offset..)?;
        Some(if self.double {
            f64::from_le_bytes(*bytes.first_chunk()?)
        } else {
            f64::from(f32::from_le_bytes(*bytes.first_chunk()?))
        })
    }
}

/// Returns the offset of a floating-point number, and `true` if it has 64 bits.
fn find(message: &Descriptor, name: &str) -> Option<(usize, bool)> {
    let mut fields = message.fields.iter();
    let field = fields.find(|field| field.name == name)?;
    match field.kind {
        FieldKind::Number("float64") => Some((field.offset, true)),
        FieldKind::Number("float32") => Some((field.offset, false)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use zerocopy::IntoBytes as _;

    use super::*;
    use crate::layout::TopicLayout;
    use crate::stamp::PlainHeader;

    #[test]
    fn marks_are_the_named_fields_of_all_elements_with_finite_numbers() {
        let entries = |all: &[(&str, &str)]| {
            let all = all
                .iter()
                .map(|(key, field)| ((*key).to_owned(), (*field).to_owned()));
            all.collect()
        };
        let layout = TopicLayout {
            name: "drawn/arrow".to_owned(),
            message: "float64 x\nfloat64 y\nfloat32 angle\nfloat32 size".to_owned(),
            drawing: entries(&[
                ("x", "x"),
                ("y", "y"),
                ("angle", "angle"),
                ("radius", "size"),
            ]),
            ..TopicLayout::default()
        };
        let topic = layout.register().unwrap();
        let again = TopicLayout::for_topic(topic);
        assert_eq!(again.drawing, layout.drawing);
        let of_log = TopicLayout::from_entries(
            "drawn/arrow",
            &again
                .entries()
                .into_iter()
                .chain([
                    ("element_type".to_owned(), again.element.clone()),
                    ("header_type".to_owned(), again.header.clone()),
                ])
                .collect(),
        );
        assert_eq!(of_log, Some(again));
        let drawn = DrawnFields::from_facts(topic.facts()).unwrap().unwrap();
        let element = |x: f64, angle: f32| {
            let mut bytes = [x, 2.0].as_bytes().to_vec();
            bytes.extend_from_slice([angle, 3.0].as_bytes());
            bytes
        };
        let elements = [
            element(1.0, 0.0),
            element(f64::NAN, 0.0),
            element(4.0, f32::NAN),
        ]
        .concat();
        let mut bytes = Vec::new();
        let head = cdr::SequenceHead::for_topic(topic.facts(), 3);
        cdr::encode_bytes(
            PlainHeader::default().as_bytes(),
            &head,
            &elements,
            &mut bytes,
        );
        let east = |_| (0.0, 1.0);
        let marks: Vec<Mark> = drawn.marks(&bytes).collect();
        assert_eq!(marks.len(), 1);
        assert_eq!(
            marks[0].lines(east).collect::<Vec<_>>(),
            [[[1.0, 2.0], [4.0, 2.0]]]
        );
        let circle = Mark {
            angle: None,
            ..marks[0]
        };
        assert_eq!(circle.lines(east).count(), CORNERS as usize);
        let point = Mark {
            radius: None,
            ..circle
        };
        assert!(point.is_point() && point.lines(east).next().is_none());
        // A cut-off message has no marks beyond its end.
        assert_eq!(drawn.marks(&bytes[..bytes.len() / 2]).count(), 0);
    }
}
