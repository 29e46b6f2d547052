//! Vector maps.

use std::collections::BTreeMap;

use nalgebra::Point2;
use parameters::{Parameters, ParamsError, between, check, each, require};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::extent::{coordinate, positive};
use crate::grid::GridFrame;
use crate::region::Region;
use crate::shape::{Aabb, Shape, ShapeError};

/// Maximum number of cells of a map's grid, unless the map itself sets a lower limit.
pub const MAX_CELLS: usize = 1 << 26;
/// Maximum number of obstacles of a map.
pub const MAX_OBSTACLES: usize = 1 << 16;
/// Maximum number of pairs of edges within the polygons of a map: four polygons of 4096 corners, or
/// 65 536 of 32.
const MAX_PAIRS: usize = 1 << 26;
/// Maximum sum of the cubes of the numbers of corners, over the non-convex polygons of a map: four
/// polygons of 512 corners, or 1072 of 80.
const MAX_CUTS: usize = 1 << 29;
/// Maximum number of exits of a map.
pub const MAX_EXITS: usize = 1024;

/// A vector map. The space within the bounds is free except for the obstacles; the edge of the
/// bounds is a wall.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VectorMap {
    /// Name of the map, for display.
    #[serde(default)]
    pub name: String,
    /// The rectangle of the world.
    pub bounds: Bounds,
    /// Side of the grid's cells.
    #[schemars(transform = positive("m"))]
    #[serde(default = "default_resolution")]
    pub resolution: f64,
    /// Maximum number of cells of the grid; more is an error.
    #[schemars(transform = between(1, MAX_CELLS))]
    #[serde(default = "default_max_cells")]
    pub max_cells: usize,
    /// Obstacles.
    #[serde(default)]
    #[schemars(length(max = MAX_OBSTACLES))]
    pub obstacles: Vec<ObstacleSpec>,
    /// Exits for evaders.
    #[serde(default)]
    #[schemars(length(max = MAX_EXITS))]
    pub exits: Vec<Region>,
}

const fn default_resolution() -> f64 {
    0.05
}

const fn default_max_cells() -> usize {
    16_000_000
}

/// An axis-aligned rectangle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bounds {
    /// Smallest x and y.
    #[schemars(transform = each(coordinate()))]
    pub min: [f64; 2],
    /// Largest x and y.
    #[schemars(transform = each(coordinate()))]
    pub max: [f64; 2],
}

/// An obstacle as the scenario specifies it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ObstacleSpec {
    /// Name of the obstacle, to which events refer. May be empty.
    #[serde(default)]
    pub name: String,
    /// Shape and position.
    pub shape: Shape,
}

/// Reason why a vector map is invalid.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum VectorMapError {
    /// A value out of its range.
    #[error(transparent)]
    Field(#[from] ParamsError),
    /// The shape of an obstacle is invalid.
    #[error("obstacles[{index}]{}: {source}", quoted(name))]
    Obstacle {
        /// Index of the obstacle in the list.
        index: usize,
        /// Its name, if it has one.
        name: String,
        /// Error of the shape.
        source: ShapeError,
    },
    /// Two obstacles with the same name.
    #[error(
        "obstacles[{second}] is called \"{name}\" like obstacles[{first}]: expected unique names"
    )]
    DuplicateName {
        /// The name.
        name: String,
        /// Index of the first obstacle with this name.
        first: usize,
        /// Index of the second obstacle with this name.
        second: usize,
    },
}

fn quoted(name: &str) -> String {
    if name.is_empty() {
        String::new()
    } else {
        format!(" \"{name}\"")
    }
}

impl Parameters for VectorMap {}

impl VectorMap {
    /// An empty map within bounds (m) with cells of this side (m).
    pub fn empty(min: [f64; 2], max: [f64; 2], resolution: f64) -> Self {
        Self {
            name: String::new(),
            bounds: Bounds { min, max },
            resolution,
            max_cells: default_max_cells(),
            obstacles: Vec::new(),
            exits: Vec::new(),
        }
    }

    /// Checks every field and shape.
    ///
    /// # Errors
    /// The error names the field or obstacle, the value, and the expected one.
    pub fn validate(&self) -> Result<(), VectorMapError> {
        self.frame()?;
        self.check_counts()?;
        let mut names = BTreeMap::new();
        for (index, obstacle) in self.obstacles.iter().enumerate() {
            obstacle
                .shape
                .parts()
                .map_err(|source| VectorMapError::Obstacle {
                    index,
                    name: obstacle.name.clone(),
                    source,
                })?;
            if obstacle.name.is_empty() {
                continue;
            }
            if let Some(first) = names.insert(obstacle.name.as_str(), index) {
                let name = obstacle.name.clone();
                return Err(VectorMapError::DuplicateName {
                    name,
                    first,
                    second: index,
                });
            }
        }
        Ok(())
    }

    /// Rejects excessive numbers of elements before any computation.
    fn check_counts(&self) -> Result<(), ParamsError> {
        require(
            self.obstacles.len() <= MAX_OBSTACLES,
            "obstacles",
            &format!("{} obstacles", self.obstacles.len()),
            format!("at most {MAX_OBSTACLES}"),
        )?;
        let (mut pairs, mut cuts) = (0usize, 0usize);
        for obstacle in &self.obstacles {
            let effort = obstacle.shape.effort();
            pairs = pairs.saturating_add(effort.pairs);
            cuts = cuts.saturating_add(effort.cuts);
        }
        for (what, count, most) in [
            (
                "squares of the corners of all polygons, added up",
                pairs,
                MAX_PAIRS,
            ),
            (
                "cubes of the corners of all polygons that are not convex, added up",
                cuts,
                MAX_CUTS,
            ),
        ] {
            require(
                count <= most,
                "obstacles",
                &format!("{count} ({what})"),
                format!("at most {most}; divide large polygons"),
            )?;
        }
        Ok(())
    }

    /// The bounds as a rectangle.
    pub(super) fn aabb(&self) -> Aabb {
        let [min, max] = [self.bounds.min, self.bounds.max].map(|p| Point2::new(p[0], p[1]));
        Aabb { min, max }
    }

    /// The grid that covers the bounds.
    ///
    /// # Errors
    /// The error names the field that is out of its range, or the limit on the number of cells.
    pub fn frame(&self) -> Result<GridFrame, ParamsError> {
        // Each obstacle is checked separately, because its error has its index and name.
        check(&Self {
            name: String::new(),
            obstacles: Vec::new(),
            exits: self.exits.clone(),
            ..*self
        })?;
        let Bounds { min, max } = self.bounds;
        for axis in 0..2 {
            require(
                max[axis] > min[axis],
                &format!("bounds.max[{axis}]"),
                &max[axis],
                format!("more than bounds.min[{axis}] = {} (m)", min[axis]),
            )?;
        }
        // A side that is an integer number of cells except for rounding gets exactly that number.
        let count = |axis: usize| {
            let cells = (max[axis] - min[axis]) / self.resolution;
            (cells - 1e-6).ceil().max(1.0)
        };
        let (width, height) = (count(0), count(1));
        require(
            width * height <= self.max_cells as f64,
            "resolution",
            &self.resolution,
            format!(
                "cells large enough that the map has at most max_cells = {} of them; it would have \
                 {width} × {height}",
                self.max_cells
            ),
        )?;
        Ok(GridFrame {
            width: width as usize,
            height: height as usize,
            resolution: self.resolution,
            origin: self.aabb().min,
        })
    }
}

#[cfg(test)]
mod tests {
    use expect_test::expect;

    use super::*;

    #[test]
    fn a_grid_covers_the_bounds() {
        let frame = VectorMap::empty([-9.5, -9.5], [9.5, 9.5], 0.05)
            .frame()
            .unwrap();
        assert_eq!((frame.width, frame.height), (380, 380));
        let frame = VectorMap::empty([0.0, 0.0], [1.0, 0.31], 0.1)
            .frame()
            .unwrap();
        assert_eq!((frame.width, frame.height), (10, 4));
        let frame = VectorMap::empty([-9.5, -9.5], [9.5, 9.5], 19.0 / 300.0)
            .frame()
            .unwrap();
        assert_eq!((frame.width, frame.height), (300, 300));
    }

    #[test]
    fn impossible_maps_name_the_field_or_the_limit() {
        let map = VectorMap::empty([0.0, 0.0], [1.0, 1.0], 0.1);
        let tower = |radius| ObstacleSpec {
            name: "tower".into(),
            shape: Shape::Circle {
                center: [0.5, 0.5],
                radius,
            },
        };
        let obstacles = |obstacles| VectorMap {
            obstacles,
            ..map.clone()
        };
        let errors = [
            VectorMap::empty([0.0, 0.0], [1.0, 0.0], 0.1),
            VectorMap::empty([0.0, 0.0], [1e5, 1e5], 0.001),
            obstacles(vec![tower(-1.0)]),
            obstacles(vec![tower(0.1); 2]),
        ]
        .map(|map| map.validate().unwrap_err().to_string());
        expect![[r#"
            `bounds.max[1]` is 0: expected more than bounds.min[1] = 0 (m)
            `resolution` is 0.001: expected cells large enough that the map has at most max_cells = 16000000 of them; it would have 100000000 × 100000000
            obstacles[0] "tower": `circle.radius` is -1: expected a number above 0 and at most 100000 (m)
            obstacles[1] is called "tower" like obstacles[0]: expected unique names"#]].assert_eq(&errors.join("\n"));
    }

    #[test]
    fn excessive_numbers_are_refused_with_the_limit() {
        let disc = |i: usize| ObstacleSpec {
            name: format!("o{i}"),
            shape: Shape::Circle {
                center: [0.5, 0.5],
                radius: 0.1,
            },
        };
        // A comb: every other corner points inwards.
        let comb = |corners: usize| ObstacleSpec {
            name: String::new(),
            shape: Shape::Polygon {
                vertices: (0..corners - 2)
                    .map(|i| [i as f64 * 1e-3, if i % 2 == 0 { 0.9 } else { 0.2 }])
                    .chain([[1.0, 0.0], [-0.1, 0.0]])
                    .collect(),
            },
        };
        let exit = Region::Circle {
            center: [0.5, 0.5],
            radius: 0.1,
        };
        let empty = VectorMap::empty([0.0, 0.0], [1.0, 1.0], 0.1);
        let with = |obstacles, exits| VectorMap {
            obstacles,
            exits,
            ..empty.clone()
        };
        let many = |count| (0..count).map(disc).collect::<Vec<_>>();
        assert!(with(many(2000), vec![exit; MAX_EXITS]).validate().is_ok());
        let errors = [
            with(many(MAX_OBSTACLES + 1), vec![]),
            with(vec![], vec![exit; MAX_EXITS + 1]),
            with(vec![comb(400); 20], vec![]),
            with(vec![comb(4000); 8], vec![]),
            with(vec![comb(600)], vec![]),
        ]
        .map(|map| map.validate().unwrap_err().to_string());
        expect![[r#"
            `obstacles` is 65537 obstacles: expected at most 65536
            `exits` is a list of 1025: expected at most 1024 values
            `obstacles` is 1280000000 (cubes of the corners of all polygons that are not convex, added up): expected at most 536870912; divide large polygons
            `obstacles` is 128000000 (squares of the corners of all polygons, added up): expected at most 67108864; divide large polygons
            obstacles[0]: `polygon.vertices` is 600 vertices of a polygon that is not convex: expected at most 512; divide it"#]].assert_eq(&errors.join("\n"));
    }
}
