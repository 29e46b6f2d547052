//! Distances to walls, computed from the text of the map alone: nothing of the product's own
//! geometry is used.

use serde::Deserialize;

/// An obstacle as vectors.
#[derive(Debug, Clone)]
pub enum Obstacle {
    Rectangle {
        center: [f64; 2],
        half: [f64; 2],
        angle: f64,
    },
    Polygon(Vec<[f64; 2]>),
    Circle {
        center: [f64; 2],
        radius: f64,
    },
}

/// A map of vectors.
#[derive(Debug, Clone)]
pub struct Walls {
    pub min: [f64; 2],
    pub max: [f64; 2],
    pub obstacles: Vec<Obstacle>,
}

#[derive(Deserialize)]
struct MapFile {
    bounds: Bounds,
    #[serde(default)]
    obstacles: Vec<Entry>,
}

#[derive(Deserialize)]
struct Bounds {
    min: [f64; 2],
    max: [f64; 2],
}

#[derive(Deserialize)]
struct Entry {
    shape: ShapeEntry,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum ShapeEntry {
    Rectangle {
        center: [f64; 2],
        half_extents: [f64; 2],
        #[serde(default)]
        angle: f64,
    },
    Polygon {
        vertices: Vec<[f64; 2]>,
    },
    Circle {
        center: [f64; 2],
        radius: f64,
    },
}

impl Walls {
    /// Reads a map file.
    pub fn parse(text: &str) -> Self {
        let file: MapFile = toml::from_str(text).unwrap();
        Self {
            min: file.bounds.min,
            max: file.bounds.max,
            obstacles: file
                .obstacles
                .into_iter()
                .map(|entry| match entry.shape {
                    ShapeEntry::Rectangle {
                        center,
                        half_extents,
                        angle,
                    } => Obstacle::Rectangle {
                        center,
                        half: half_extents,
                        angle,
                    },
                    ShapeEntry::Polygon { vertices } => Obstacle::Polygon(vertices),
                    ShapeEntry::Circle { center, radius } => Obstacle::Circle { center, radius },
                })
                .collect(),
        }
    }

    /// The map that is written out in a scenario.
    pub fn of_scenario(scenario: &toml::Table) -> Self {
        let map = scenario["world"]["map"]["vector"].as_table().unwrap();
        Self::parse(&map.to_string())
    }

    /// The city of the built-in scenarios.
    pub fn city() -> Self {
        Self::parse(include_str!("../../scenarios/maps/city.toml"))
    }

    /// The room of the built-in scenario `hello`.
    pub fn hello() -> Self {
        Self::parse(include_str!("../../scenarios/maps/hello.toml"))
    }

    /// Distance from a point to the nearest wall or edge of the map (m); negative inside one.
    pub fn clearance(&self, p: [f64; 2]) -> f64 {
        let edge = (p[0] - self.min[0])
            .min(self.max[0] - p[0])
            .min(p[1] - self.min[1])
            .min(self.max[1] - p[1]);
        self.obstacles
            .iter()
            .map(|o| o.distance(p))
            .fold(edge, f64::min)
    }
}

impl Obstacle {
    /// Distance from a point to its boundary (m); negative inside.
    pub fn distance(&self, p: [f64; 2]) -> f64 {
        match self {
            Self::Rectangle {
                center,
                half,
                angle,
            } => {
                let (sin, cos) = (libm::sin(*angle), libm::cos(*angle));
                let (dx, dy) = (p[0] - center[0], p[1] - center[1]);
                let qx = (cos * dx + sin * dy).abs() - half[0];
                let qy = (cos * dy - sin * dx).abs() - half[1];
                let outside = (qx.max(0.0).powi(2) + qy.max(0.0).powi(2)).sqrt();
                outside + qx.max(qy).min(0.0)
            }
            Self::Polygon(vertices) => {
                let mut least = f64::INFINITY;
                let mut inside = false;
                for (i, a) in vertices.iter().enumerate() {
                    let b = vertices[(i + 1) % vertices.len()];
                    least = least.min(to_segment(p, *a, b));
                    if (a[1] > p[1]) != (b[1] > p[1])
                        && p[0] < (b[0] - a[0]) * (p[1] - a[1]) / (b[1] - a[1]) + a[0]
                    {
                        inside = !inside;
                    }
                }
                if inside { -least } else { least }
            }
            Self::Circle { center, radius } => between(p, *center) - radius,
        }
    }
}

/// Distance from a point to a segment (m).
pub fn to_segment(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (ex, ey) = (b[0] - a[0], b[1] - a[1]);
    let square = ex * ex + ey * ey;
    let along = ((p[0] - a[0]) * ex + (p[1] - a[1]) * ey) / square;
    let along = if square > 0.0 {
        along.clamp(0.0, 1.0)
    } else {
        0.0
    };
    let (dx, dy) = (p[0] - a[0] - along * ex, p[1] - a[1] - along * ey);
    (dx * dx + dy * dy).sqrt()
}

/// Distance between two points (m).
pub fn between(a: [f64; 2], b: [f64; 2]) -> f64 {
    ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)).sqrt()
}
