//! The ground of a world: obstacles, their exact geometry, and the grids made from them.

use std::path::Path;

use super::index::ShapeIndex;
use super::{CellMap, MapError, MapSpec, VectorMap, cells, field};
use crate::grid::{Grid, GridFrame};
use crate::shape::{Aabb, Convex, Shape, ShapeError};
use crate::spec::{FieldError, Region};

/// Number of an obstacle, unique within its map for as long as the obstacle exists.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize,
)]
#[serde(transparent)]
pub struct ObstacleId(pub u32);

/// An obstacle that stands on the map now.
#[derive(Debug, Clone, PartialEq)]
pub struct Obstacle {
    /// Its number.
    pub id: ObstacleId,
    /// Its name in the scenario; may be empty.
    pub name: String,
    /// Its shape and place.
    pub shape: Shape,
    parts: Vec<Convex>,
}

/// A change of the obstacles at run time.
#[derive(Debug, Clone, PartialEq)]
pub enum ObstacleChange {
    /// A new obstacle appears.
    Appear {
        /// Its number, not in use yet.
        id: ObstacleId,
        /// Its shape and place.
        shape: Shape,
    },
    /// An obstacle disappears.
    Disappear {
        /// Its number.
        id: ObstacleId,
    },
    /// An obstacle takes another place, or another shape, at once.
    Move {
        /// Its number.
        id: ObstacleId,
        /// Its new shape and place ([`Shape::moved`] makes one from the old).
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

/// Why an obstacle change is refused; the map stays as it was.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ObstacleError {
    /// An obstacle with this number stands already.
    #[error("obstacle {} appears: expected a number that is not in use", .0.0)]
    InUse(ObstacleId),
    /// No obstacle with this number stands.
    #[error("obstacle {} moves or disappears: expected the number of an obstacle that stands", .0.0)]
    Unknown(ObstacleId),
    /// The new shape is wrong.
    #[error("obstacle {}: {source}", id.0)]
    Shape {
        /// The obstacle's number.
        id: ObstacleId,
        /// What is wrong.
        source: ShapeError,
    },
}

/// The ground of a world.
///
/// Exact geometry (see the queries: [`distance`](Self::distance), [`cast_ray`](Self::cast_ray) …)
/// and grids describe the same obstacles at every [`revision`](Self::revision). The edge of the
/// map is a wall: everything beyond the bounds is solid.
#[derive(Debug, Clone)]
pub struct WorldMap {
    pub(super) bounds: Aabb,
    exits: Vec<Region>,
    /// Rectangles of an occupancy grid; they never change.
    ground: Vec<Convex>,
    obstacles: Vec<Obstacle>,
    revision: u64,
    /// The pieces of ground and obstacles, in this order.
    pub(super) parts: Vec<Convex>,
    pub(super) index: ShapeIndex,
    occupancy: Grid<bool>,
    pub(super) clearance: Grid<f32>,
    pub(super) inverse_resolution: f64,
    /// How much nearer [m] an obstacle may be to a point than the clearance of its cell says.
    pub(super) clearance_error: f64,
}

impl WorldMap {
    /// The ground that a specification describes; a file is read relative to the working directory
    /// (load it before with [`MapSpec::load`] to say otherwise).
    ///
    /// # Errors
    /// Names the file, field or obstacle, and what was expected.
    pub fn new(spec: &MapSpec) -> Result<Self, MapError> {
        match spec.load(Path::new(""))? {
            MapSpec::Vector(map) => Self::from_vectors(&map).map_err(|e| MapError::vector(None, e)),
            MapSpec::Cells(map) => {
                Self::from_cells(&map).map_err(|e| MapError::vector(None, e.into()))
            }
            MapSpec::File { path, .. } => Err(MapError::UnknownKind { path }),
        }
    }

    /// The ground that vectors describe; its obstacles are numbered from 0 in their order.
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

    /// The ground that an occupancy grid describes: its occupied cells, merged into rectangles.
    ///
    /// # Errors
    /// As [`CellMap::validate`].
    pub fn from_cells(map: &CellMap) -> Result<Self, FieldError> {
        let grid = map.to_grid()?;
        let ground = cells::rectangles(&grid)
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
            ground,
            Vec::new(),
        ))
    }

    fn build(
        frame: GridFrame,
        bounds: Aabb,
        exits: Vec<Region>,
        ground: Vec<Convex>,
        obstacles: Vec<Obstacle>,
    ) -> Self {
        let mut map = Self {
            bounds,
            exits,
            ground,
            obstacles,
            revision: 0,
            parts: Vec::new(),
            index: ShapeIndex::new(frame, bounds, &[]),
            occupancy: Grid::filled(frame, false),
            clearance: Grid::filled(frame, 0.0),
            inverse_resolution: 1.0 / frame.resolution,
            clearance_error: 0.0,
        };
        map.rebuild();
        map
    }

    /// Recomputes everything that follows from ground and obstacles.
    fn rebuild(&mut self) {
        let frame = self.occupancy.frame;
        self.parts.clear();
        self.parts.extend_from_slice(&self.ground);
        for obstacle in &self.obstacles {
            self.parts.extend_from_slice(&obstacle.parts);
        }
        self.index = ShapeIndex::new(frame, self.bounds, &self.parts);
        (self.occupancy, self.clearance) =
            field::grids(frame, self.bounds, &self.parts, &self.index);
        // A point is at most half a diagonal from its cell's centre and distance changes by at
        // most the way moved; to that comes the rounding of f32, relative to the largest value.
        let largest = self.clearance.cells.iter().copied().fold(0.0, f32::max);
        self.clearance_error = frame.resolution * core::f64::consts::FRAC_1_SQRT_2 * (1.0 + 1e-9)
            + f64::from(largest * f32::EPSILON)
            + 1e-9;
    }

    /// Applies a change; grids, exact geometry and revision follow at once.
    ///
    /// # Errors
    /// If the obstacle's number or shape is wrong; the map is unchanged then.
    pub fn apply(&mut self, change: &ObstacleChange) -> Result<(), ObstacleError> {
        let id = change.id();
        let position = self.obstacles.iter().position(|o| o.id == id);
        let parts_of = |shape: &Shape| {
            shape
                .parts()
                .map_err(|source| ObstacleError::Shape { id, source })
        };
        match (change, position) {
            (ObstacleChange::Appear { .. }, Some(_)) => return Err(ObstacleError::InUse(id)),
            (ObstacleChange::Appear { shape, .. }, None) => {
                let parts = parts_of(shape)?;
                let shape = shape.clone();
                self.obstacles.push(Obstacle {
                    id,
                    name: String::new(),
                    shape,
                    parts,
                });
            }
            (_, None) => return Err(ObstacleError::Unknown(id)),
            (ObstacleChange::Disappear { .. }, Some(i)) => {
                self.obstacles.remove(i);
            }
            (ObstacleChange::Move { shape, .. }, Some(i)) => {
                let parts = parts_of(shape)?;
                self.obstacles[i].shape = shape.clone();
                self.obstacles[i].parts = parts;
            }
        }
        self.revision += 1;
        self.rebuild();
        Ok(())
    }

    /// Where the grids' cells lie.
    pub fn frame(&self) -> &GridFrame {
        &self.occupancy.frame
    }

    /// Per cell whether its centre lies in an obstacle.
    pub fn occupancy(&self) -> &Grid<bool> {
        &self.occupancy
    }

    /// Per cell the distance [m] from its centre to the nearest obstacle; 0 inside one.
    pub fn clearance(&self) -> &Grid<f32> {
        &self.clearance
    }

    /// Number of changes applied so far.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// The rectangle that the world occupies.
    pub fn bounds(&self) -> &Aabb {
        &self.bounds
    }

    /// Where evaders escape, as the map says (the rules may add more).
    pub fn exits(&self) -> &[Region] {
        &self.exits
    }

    /// The obstacles that stand now (an occupancy grid's cells are not among them).
    pub fn obstacles(&self) -> &[Obstacle] {
        &self.obstacles
    }

    /// The number of the obstacle with this name.
    pub fn obstacle_named(&self, name: &str) -> Option<ObstacleId> {
        self.obstacles
            .iter()
            .find(|o| o.name == name && !name.is_empty())
            .map(|o| o.id)
    }

    /// The convex pieces of everything that stands on the map.
    pub fn parts(&self) -> &[Convex] {
        &self.parts
    }
}

impl Obstacle {
    /// The convex pieces of the obstacle.
    pub fn parts(&self) -> &[Convex] {
        &self.parts
    }
}
