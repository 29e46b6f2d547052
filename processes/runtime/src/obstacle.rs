//! Conversion of obstacle changes to messages and back.

use geometry::map::{ObstacleChange, ObstacleId};
use geometry::shape::Shape;
use ipc_types::messages::world::ObstacleEvent;

/// Maximum number of corners of a polygon in a message.
pub const MAX_VERTICES: usize = 16;

const APPEAR: u8 = 0;
const DISAPPEAR: u8 = 1;
const MOVE: u8 = 2;
const CIRCLE: u8 = 0;
const RECTANGLE: u8 = 1;
const POLYGON: u8 = 2;

/// Faults of an obstacle change that does not fit its message, or of a message that describes no
/// change.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ObstacleMessageError {
    /// The polygon has too many corners.
    #[error("obstacle {id}: polygon with {vertices} corners: expected 3 to {MAX_VERTICES}")]
    Vertices {
        /// Number of the obstacle.
        id: u32,
        /// Corners of its polygon.
        vertices: usize,
    },
    /// Code that this version does not support.
    #[error("obstacle {id}: unknown {what} {code}")]
    Code {
        /// Number of the obstacle.
        id: u32,
        /// `action` or `shape`.
        what: &'static str,
        /// The code.
        code: u8,
    },
    /// A non-finite number.
    #[error("obstacle {id}: a coordinate is not finite")]
    NotFinite {
        /// Number of the obstacle.
        id: u32,
    },
}

/// Returns the message of an obstacle change.
///
/// # Errors
/// [`ObstacleMessageError::Vertices`] if its polygon has too many corners.
pub fn to_message(change: &ObstacleChange) -> Result<ObstacleEvent, ObstacleMessageError> {
    let (id, action, shape) = match change {
        ObstacleChange::Appear { id, shape } => (id.0, APPEAR, Some(shape)),
        ObstacleChange::Disappear { id } => (id.0, DISAPPEAR, None),
        ObstacleChange::Move { id, shape } => (id.0, MOVE, Some(shape)),
    };
    let mut message = ObstacleEvent {
        id,
        action,
        ..ObstacleEvent::default()
    };
    match shape {
        None => {}
        Some(Shape::Circle { center, radius }) => {
            message.shape = CIRCLE;
            [message.x, message.y] = *center;
            message.radius = *radius;
        }
        Some(Shape::Rectangle {
            center,
            half_extents,
            angle,
        }) => {
            message.shape = RECTANGLE;
            [message.x, message.y] = *center;
            [message.half_x, message.half_y] = *half_extents;
            message.theta = *angle;
        }
        Some(Shape::Polygon { vertices }) => {
            if vertices.len() > MAX_VERTICES {
                return Err(ObstacleMessageError::Vertices {
                    id,
                    vertices: vertices.len(),
                });
            }
            message.shape = POLYGON;
            message.vertex_count = vertices.len() as u32;
            for (pair, vertex) in message.vertices.chunks_exact_mut(2).zip(vertices) {
                pair.copy_from_slice(vertex);
            }
            if let Some(first) = vertices.first() {
                [message.x, message.y] = *first;
            }
        }
    }
    Ok(message)
}

/// Returns the obstacle change of a message.
///
/// # Errors
/// [`ObstacleMessageError`] if the message describes no change. It does not check that the change
/// fits the map.
pub fn from_message(message: &ObstacleEvent) -> Result<ObstacleChange, ObstacleMessageError> {
    let id = message.id;
    let numbers = [
        message.x,
        message.y,
        message.theta,
        message.radius,
        message.half_x,
        message.half_y,
    ];
    if !numbers
        .iter()
        .chain(&message.vertices)
        .all(|n| n.is_finite())
    {
        return Err(ObstacleMessageError::NotFinite { id });
    }
    if message.action == DISAPPEAR {
        return Ok(ObstacleChange::Disappear { id: ObstacleId(id) });
    }
    let center = [message.x, message.y];
    let shape = match message.shape {
        CIRCLE => Shape::Circle {
            center,
            radius: message.radius,
        },
        RECTANGLE => Shape::Rectangle {
            center,
            half_extents: [message.half_x, message.half_y],
            angle: message.theta,
        },
        POLYGON => {
            let vertices = message.vertex_count as usize;
            if !(3..=MAX_VERTICES).contains(&vertices) {
                return Err(ObstacleMessageError::Vertices { id, vertices });
            }
            let corners = message.vertices.chunks_exact(2).take(vertices);
            Shape::Polygon {
                vertices: corners.map(|pair| [pair[0], pair[1]]).collect(),
            }
        }
        code => {
            return Err(ObstacleMessageError::Code {
                id,
                what: "shape",
                code,
            });
        }
    };
    let id = ObstacleId(id);
    match message.action {
        APPEAR => Ok(ObstacleChange::Appear { id, shape }),
        MOVE => Ok(ObstacleChange::Move { id, shape }),
        code => Err(ObstacleMessageError::Code {
            id: message.id,
            what: "action",
            code,
        }),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn shapes() -> impl Strategy<Value = Shape> {
        let n = || -1e3..1e3_f64;
        prop_oneof![
            (n(), n(), 0.1..9.0).prop_map(|(x, y, radius)| Shape::Circle {
                center: [x, y],
                radius
            }),
            (n(), n(), 0.1..9.0, 0.1..9.0, n()).prop_map(|(x, y, a, b, angle)| {
                Shape::Rectangle {
                    center: [x, y],
                    half_extents: [a, b],
                    angle,
                }
            }),
            prop::collection::vec((n(), n()).prop_map(|(x, y)| [x, y]), 3..=MAX_VERTICES)
                .prop_map(|vertices| Shape::Polygon { vertices }),
        ]
    }

    proptest! {
        #[test]
        fn changes_survive_the_message(shape in shapes(), id in 0_u32..1000, action in 0..3) {
            let id = ObstacleId(id);
            let change = match action {
                0 => ObstacleChange::Appear { id, shape },
                1 => ObstacleChange::Disappear { id },
                _ => ObstacleChange::Move { id, shape },
            };
            prop_assert_eq!(from_message(&to_message(&change).unwrap()).unwrap(), change);
        }

        #[test]
        fn invalid_messages_do_no_harm(bytes in prop::array::uniform32(any::<u8>()), n in 0_usize..10) {
            use zerocopy::FromBytes as _;
            let mut raw = vec![0_u8; size_of::<ObstacleEvent>()];
            for (i, byte) in raw.iter_mut().enumerate() {
                *byte = bytes[(i * (n + 1)) % 32];
            }
            let _ = from_message(&ObstacleEvent::read_from_bytes(&raw).unwrap());
        }
    }

    #[test]
    fn invalid_values_are_named() {
        let nan = ObstacleEvent {
            id: 7,
            x: f64::NAN,
            ..ObstacleEvent::default()
        };
        assert!(
            from_message(&nan)
                .unwrap_err()
                .to_string()
                .contains("obstacle 7")
        );
        let odd = ObstacleEvent {
            action: 9,
            ..ObstacleEvent::default()
        };
        assert!(
            from_message(&odd)
                .unwrap_err()
                .to_string()
                .contains("unknown action 9")
        );
        let few = ObstacleEvent {
            shape: POLYGON,
            vertex_count: 2,
            ..ObstacleEvent::default()
        };
        assert!(
            from_message(&few)
                .unwrap_err()
                .to_string()
                .contains("2 corners")
        );
    }
}
