//! Forms of elements in pictures: which of their fields are a place, a direction or a radius.

use core::fmt;

/// Form of the elements of a topic in pictures, by the names of fields of the element or of the header: points; arrows, if
/// they have an angle; circles, if they have a radius.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Drawing {
    /// Field with the first coordinate (m).
    pub x: &'static str,
    /// Field with the second coordinate (m).
    pub y: &'static str,
    /// Field with the direction of an arrow (rad).
    pub angle: Option<&'static str>,
    /// Field with the radius of a circle, or the length of an arrow (m).
    pub radius: Option<&'static str>,
}

impl Drawing {
    /// Points with these coordinates.
    pub const fn points(x: &'static str, y: &'static str) -> Self {
        Self {
            x,
            y,
            angle: None,
            radius: None,
        }
    }

    /// Arrows from the points in this direction.
    #[must_use]
    pub const fn towards(self, angle: &'static str) -> Self {
        Self {
            angle: Some(angle),
            ..self
        }
    }

    /// Circles about the points with this radius, or arrows of this length.
    #[must_use]
    pub const fn with_radius(self, radius: &'static str) -> Self {
        Self {
            radius: Some(radius),
            ..self
        }
    }
}

/// Writes it as in the metadata of a log: `x=x y=y angle=bearing`.
impl fmt::Display for Drawing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "x={} y={}", self.x, self.y)?;
        for (key, field) in [("angle", self.angle), ("radius", self.radius)] {
            if let Some(field) = field {
                write!(f, " {key}={field}")?;
            }
        }
        Ok(())
    }
}
