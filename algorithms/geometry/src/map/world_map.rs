//! The static parts of a world: obstacles, their exact geometry, and the grids derived from them.

use std::path::Path;
use std::sync::Arc;

use super::{CellMap, MapError, MapSpec, ShapeMap, VectorMap, cells};
use crate::grid::{Grid, GridFrame};
use crate::region::Region;
use crate::shape::{Aabb, Convex, Shape, ShapeError};
use parameters::ParamsError;

/// Number of an obstacle, unique within its map for as long as the obstacle exists.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize,
)]
#[serde(transparent)]
pub struct ObstacleId(pub u32);

/// An existing obstacle of the map.
#[derive(Debug, Clone, PartialEq)]
pub struct Obstacle {
    /// Number.
    pub id: ObstacleId,
    /// Name in the scenario; may be empty.
    pub name: String,
    /// Shape and position.
    pub shape: Shape,
    parts: Vec<Convex>,
}

/// A change of the obstacles at run time.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ObstacleChange {
    /// A new obstacle appears.
    Appear {
        /// Number, not yet in use.
        id: ObstacleId,
        /// Shape and position.
        shape: Shape,
    },
    /// An obstacle disappears.
    Disappear {
        /// Number.
        id: ObstacleId,
    },
    /// An obstacle changes its position or shape at once.
    Move {
        /// Number.
        id: ObstacleId,
        /// New shape and position ([`Shape::moved`] computes one from the old).
        shape: Shape,
    },
}

impl ObstacleChange {
    /// The number of the obstacle that changes.
    pub const fn id(&self) -> ObstacleId {
        match self {
            Self::Appear { id, .. } | Self::Disappear { id } | Self::Move { id, .. } => *id,
        }
    }
}

/// Reason why an obstacle change is rejected; the map stays unchanged.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ObstacleError {
    /// An obstacle with this number exists already.
    #[error("obstacle {} appears: expected a number that is not in use", .0.0)]
    InUse(ObstacleId),
    /// No obstacle has this number.
    #[error("obstacle {} moves or disappears: expected the number of an existing obstacle", .0.0)]
    Unknown(ObstacleId),
    /// The new shape is invalid.
    #[error("obstacle {}: {source}", id.0)]
    Shape {
        /// The obstacle's number.
        id: ObstacleId,
        /// Error of the shape.
        source: ShapeError,
    },
}

/// The static parts of a world.
///
/// Exact geometry (see the queries: [`distance`](Self::distance), [`cast_ray`](Self::cast_ray) …)
/// and grids describe the same obstacles at every [`revision`](Self::revision). The edge of the
/// map is a wall: everything beyond the bounds is solid.
///
/// ```
/// use geometry::map::{ObstacleChange, ObstacleId, ObstacleSpec, VectorMap, WorldMap};
/// use geometry::shape::Shape;
/// use nalgebra::{Point2, Vector2};
///
/// let mut room = VectorMap::empty([0.0, 0.0], [10.0, 10.0], 0.1);
/// room.obstacles.push(ObstacleSpec {
///     name: "pillar".to_owned(),
///     shape: Shape::Circle { center: [5.0, 5.0], radius: 1.0 },
/// });
/// let mut map = WorldMap::from_vectors(&room)?;
/// let robot = Point2::new(2.0, 5.0);
/// assert_eq!(map.cast_ray(robot, Vector2::x(), 3.5), Some(2.0));
/// assert!(!map.line_of_sight(robot, Point2::new(8.0, 5.0)));
/// map.apply(&ObstacleChange::Disappear { id: ObstacleId(0) })?;
/// assert_eq!(map.cast_ray(robot, Vector2::x(), 3.5), None);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
///
/// Clones share their contents until they change.
#[derive(Debug, Clone)]
pub struct WorldMap {
    exits: Arc<[Region]>,
    /// Rectangles of an occupancy grid; they never change.
    static_parts: Arc<[Convex]>,
    obstacles: Arc<Vec<Obstacle>>,
    revision: u64,
    /// The pieces of static parts and obstacles, in this order.
    shapes: Arc<ShapeMap>,
}

impl WorldMap {
    /// Builds the static parts of a specification; a file is read relative to the working directory (use
    /// [`MapSpec::load`] before for another directory).
    ///
    /// # Errors
    /// The error names the file, field or obstacle, and the expected value.
    pub fn new(spec: &MapSpec) -> Result<Self, MapError> {
        match spec.load(Path::new(""))? {
            MapSpec::Vector(map) => Self::from_vectors(&map).map_err(|e| MapError::vector(None, e)),
            MapSpec::Cells(map) => {
                Self::from_cells(&map).map_err(|e| MapError::vector(None, e.into()))
            }
            MapSpec::File { path, .. } => Err(MapError::UnknownKind { path }),
        }
    }

    /// Builds the static parts of a vector map; its obstacles are numbered from 0 in their order.
    ///
    /// # Errors
    /// As [`VectorMap::validate`].
    pub fn from_vectors(map: &VectorMap) -> Result<Self, super::VectorMapError> {
        map.validate()?;
        let frame = map.frame()?;
        let mut obstacles = Vec::with_capacity(map.obstacles.len());
        for (index, spec) in map.obstacles.iter().enumerate() {
            let parts = spec
                .shape
                .parts()
                .map_err(|source| super::VectorMapError::Obstacle {
                    index,
                    name: spec.name.clone(),
                    source,
                })?;
            obstacles.push(Obstacle {
                id: ObstacleId(index as u32),
                name: spec.name.clone(),
                shape: spec.shape.clone(),
                parts,
            });
        }
        Ok(Self::build(
            frame,
            map.aabb(),
            map.exits.clone(),
            Vec::new(),
            obstacles,
        ))
    }

    /// Builds the static parts of an occupancy grid: its occupied cells, merged into rectangles.
    ///
    /// # Errors
    /// As [`CellMap::validate`].
    pub fn from_cells(map: &CellMap) -> Result<Self, ParamsError> {
        let grid = map.to_grid()?;
        let static_parts = cells::rectangles(&grid)
            .into_iter()
            .map(Convex::Box)
            .collect();
        let frame = grid.frame;
        let size = nalgebra::Vector2::new(frame.width as f64, frame.height as f64);
        let bounds = Aabb {
            min: frame.origin,
            max: frame.origin + size * frame.resolution,
        };
        Ok(Self::build(
            frame,
            bounds,
            map.exits.clone(),
            static_parts,
            Vec::new(),
        ))
    }

    fn build(
        frame: GridFrame,
        bounds: Aabb,
        exits: Vec<Region>,
        static_parts: Vec<Convex>,
        obstacles: Vec<Obstacle>,
    ) -> Self {
        let mut map = Self {
            exits: exits.into(),
            static_parts: static_parts.into(),
            obstacles: Arc::new(obstacles),
            revision: 0,
            shapes: Arc::new(ShapeMap::new(
                Vec::new(),
                bounds,
                GridFrame {
                    width: 1,
                    height: 1,
                    ..frame
                },
            )),
        };
        map.rebuild(bounds, frame);
        map
    }

    /// Recomputes all data that depend on static parts and obstacles.
    fn rebuild(&mut self, bounds: Aabb, frame: GridFrame) {
        let mut parts = self.static_parts.to_vec();
        for obstacle in &*self.obstacles {
            parts.extend_from_slice(&obstacle.parts);
        }
        self.shapes = Arc::new(ShapeMap::new(parts, bounds, frame));
    }

    /// Applies a change; grids, exact geometry and revision are updated at once.
    ///
    /// # Errors
    /// If the obstacle's number or shape is invalid; the map is then unchanged.
    pub fn apply(&mut self, change: &ObstacleChange) -> Result<(), ObstacleError> {
        let id = change.id();
        let position = self.obstacles.iter().position(|o| o.id == id);
        let parts_of = |shape: &Shape| {
            shape
                .parts()
                .map_err(|source| ObstacleError::Shape { id, source })
        };
        // A copy, if other clones hold them.
        let obstacles = Arc::make_mut(&mut self.obstacles);
        match (change, position) {
            (ObstacleChange::Appear { .. }, Some(_)) => return Err(ObstacleError::InUse(id)),
            (ObstacleChange::Appear { shape, .. }, None) => {
                let parts = parts_of(shape)?;
                let shape = shape.clone();
                obstacles.push(Obstacle {
                    id,
                    name: String::new(),
                    shape,
                    parts,
                });
            }
            (_, None) => return Err(ObstacleError::Unknown(id)),
            (ObstacleChange::Disappear { .. }, Some(i)) => {
                obstacles.remove(i);
            }
            (ObstacleChange::Move { shape, .. }, Some(i)) => {
                let parts = parts_of(shape)?;
                obstacles[i].shape = shape.clone();
                obstacles[i].parts = parts;
            }
        }
        self.revision += 1;
        self.rebuild(*self.bounds(), *self.frame());
        Ok(())
    }

    /// Frame of the grids' cells.
    pub fn frame(&self) -> &GridFrame {
        self.shapes.frame()
    }

    /// Per cell, `true` if its centre lies in an obstacle.
    pub fn occupancy(&self) -> &Grid<bool> {
        self.shapes.occupancy()
    }

    /// Per cell, the distance (m) from its centre to the nearest obstacle; 0 inside one.
    pub fn clearance(&self) -> &Grid<f32> {
        self.shapes.clearance()
    }

    /// Number of changes applied so far.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// The rectangle of the world.
    pub fn bounds(&self) -> &Aabb {
        self.shapes.bounds()
    }

    /// Exits of the map (the rules may add more).
    pub fn exits(&self) -> &[Region] {
        &self.exits
    }

    /// The current obstacles (without the cells of an occupancy grid).
    pub fn obstacles(&self) -> &[Obstacle] {
        &self.obstacles
    }

    /// The convex pieces of all static parts and obstacles.
    pub fn parts(&self) -> &[Convex] {
        self.shapes.parts()
    }

    /// The pieces, with further queries.
    pub fn shapes(&self) -> &ShapeMap {
        &self.shapes
    }
}

impl Obstacle {
    /// The convex pieces of the obstacle.
    pub fn parts(&self) -> &[Convex] {
        &self.parts
    }
}
