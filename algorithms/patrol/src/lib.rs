//! Patrols along a contour: the cat-map zig-zag, fictive obstacles, danger zones.
//!
//! - [`contour`]: the given route;
//! - [`danger`]: the threatened parts of it;
//! - [`awg`]: additional waypoints that make it a zig-zag, lap after lap;
//! - [`alpha`]: the maximum width of the zig-zag for a lap in time;
//! - [`room`]: the places of waypoints where the robot fits;
//! - [`forecast`]: the robot's future positions, for an ally that has the key;
//! - [`fto`]: fictive obstacles that the robot avoids as if they were real;
//! - [`mission`]: a patrol as a scenario specifies it, with open parameters chosen;
//! - [`pursuits`]: guards that leave the round of their team and pursue intruders;
//! - [`remarks`]: what a user should know about a patrol before it starts;
//! - [`team`]: the places of the robots of a team on one contour;
//! - [`attack`]: adversaries that attack places of a patrol;
//! - [`mixed`]: additional waypoints where obstacles are small, fictive obstacles along large ones.
//!
//! ```
//! use nalgebra::Point2;
//! use patrol::contour::Contour;
//!
//! let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]].map(Point2::from);
//! let contour = Contour::closed(&corners)?;
//! assert_eq!(contour.length(), 12.0);
//! assert_eq!(contour.at(0.5), Some(Point2::new(4.0, 2.0)));
//! # Ok::<(), patrol::contour::ContourError>(())
//! ```

pub mod alpha;
pub mod attack;
pub mod awg;
pub mod contour;
pub mod danger;
pub mod forecast;
pub mod fto;
pub mod mission;
pub mod mixed;
pub mod pursuits;
pub mod remarks;
pub mod room;
pub mod team;
