//! Public knowledge of a robot's goals: everything but the key.

use crate::recovery::cat::{CatModulus, CatRecovery};
use crate::recovery::chebyshev::ChebyshevRecovery;
use chaotic_maps::{AnySource, Emission};
use coverage::plan::{PlanSpec, frames};
use coverage::sub_goals::params::FollowParams;
use coverage::sub_goals::site::{Site, SiteError};
use coverage::tour::{Iterations, Route, Tour, TourError};
use geometry::shape::{Aabb, Convex};
use nalgebra::{Point2, Vector2};
use parameters::{Parameters, ParamsError, above, at_least, each, require, unit};
use patrol::awg::{Awg, AwgParams, Preset};
use patrol::contour::Contour;
use patrol::danger::DangerZones;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::layout::{Frame, Layout, Slot};
use crate::predictors::key::Finder;

/// Form of the cat map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum CatKind {
    /// Modulo a prime near 2⁶³.
    #[default]
    CatP,
    /// Modulo 2⁶⁴.
    Cat64,
    /// In floating point, as in the paper.
    CatF64,
}

parameters::table! {
    /// Public knowledge of a patrol with waypoints from a cat map (cat-map patrol paper).
    pub struct CatKnowledge {
        /// The route, at least two points.
        #[schemars(transform = each(each(unit("m"))), length(min = 2))]
        pub contour: Vec<[f64; 2]>,
        /// `true` if it ends at its start.
        pub closed: bool = true,
        /// Maximum duration of a lap.
        pub t_max: f64 [above(0).unit("s")] = 120.0,
        /// Width of the zig-zag.
        pub alpha: f64 [above(0).unit("m")] = 1.0,
        /// The formulas' variant.
        pub preset: Preset,
        /// Zones of the route in which waypoints are inserted; empty: everywhere.
        pub danger_zones: DangerZones,
        /// The map.
        pub generator: CatKind,
    }
}

impl Parameters for CatKnowledge {
    fn check_relations(&self) -> Result<(), ParamsError> {
        self.layout().map(|_| ())
    }
}

impl CatKnowledge {
    /// Returns the goals of a lap; of an open route, of a lap there and one back.
    ///
    /// # Errors
    /// [`ParamsError`] naming the first invalid field.
    pub fn layout(&self) -> Result<Layout, ParamsError> {
        let points: Vec<Point2<f64>> = self.contour.iter().map(|&p| Point2::from(p)).collect();
        let contour = if self.closed {
            Contour::closed(&points)
        } else {
            Contour::open(&points)
        }
        .map_err(|e| ParamsError::new("contour", &e, "different points that make a route"))?;
        let params = AwgParams {
            t_max: self.t_max,
            alpha: self.alpha,
            mode: self.preset.mode(),
        };
        let awg = Awg::new(&contour, &self.danger_zones, params)
            .map_err(|e| ParamsError::new("t_max", &e, "a time and zones that make a zig-zag"))?;
        let laps = if self.closed { 1 } else { 2 };
        let mut slots = Vec::new();
        for leg in (0..laps).flat_map(|lap| awg.legs(lap)) {
            let segment = &leg.stretch.segment;
            let (first, second) = (
                leg.facing * self.alpha,
                Vector2::new(-leg.facing.y, leg.facing.x) * self.alpha,
            );
            slots.extend((1..=leg.inserted).map(|j| {
                let nominal = segment.from + segment.along * (awg.v() * f64::from(j));
                Slot::Drawn(Frame {
                    origin: nominal - second * 0.5,
                    first,
                    second,
                })
            }));
            slots.push(Slot::Fixed(segment.to));
        }
        Layout::new(slots).ok_or_else(|| {
            ParamsError::new("contour", &"empty", "different points that make a route")
        })
    }

    /// Returns a search for the state of the map.
    pub fn finder(&self) -> CatRecovery {
        CatRecovery::new(match self.generator {
            CatKind::CatP => CatModulus::Prime,
            CatKind::Cat64 => CatModulus::Wrapping64,
            CatKind::CatF64 => CatModulus::F64,
        })
    }
}

impl Finder for CatRecovery {
    fn observe(&mut self, output: [f64; 2], [x, y]: [f64; 2]) -> bool {
        self.observe_with(output, x.max(y))
    }

    fn gap(&mut self) {
        self.gap();
    }

    fn cost(&self) -> f64 {
        self.cost()
    }

    fn source(&self) -> Option<AnySource> {
        self.state().cloned()
    }
}

/// Function of a Chebyshev map's state that is output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ChebyshevForm {
    /// Its arcsine: uniform.
    #[default]
    Arcsine,
    /// The state itself.
    Raw,
}

/// Public knowledge of a coverage by two Chebyshev maps (Chebyshev coverage paper).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ChebyshevKnowledge {
    /// The only rectangle of the sub-goals: smallest x and y, largest x and y. Absent: the observer
    /// divides the map into rectangles, as the robot does.
    #[schemars(transform = each(unit("m")))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rectangle: Option<[f64; 4]>,
    /// Function of the state that is output.
    pub form: ChebyshevForm,
    /// The robot's clearance from obstacles and walls (`follow.margin`).
    #[schemars(transform = at_least(0).unit("m"))]
    pub margin: f64,
    /// Maximum distance by which rectangles extend beyond obstacles (`follow.tolerance`).
    #[schemars(transform = above(0).unit("m"))]
    pub tolerance: f64,
    /// Order of the rectangles in a large loop.
    pub route: Route,
    /// Sub-goals of a large loop.
    pub iterations: Iterations,
}

impl Default for ChebyshevKnowledge {
    fn default() -> Self {
        let (plan, follow) = (PlanSpec::default(), FollowParams::default());
        Self {
            rectangle: None,
            form: ChebyshevForm::default(),
            margin: follow.margin,
            tolerance: follow.tolerance,
            route: plan.route,
            iterations: plan.iterations,
        }
    }
}

impl Parameters for ChebyshevKnowledge {
    fn check_relations(&self) -> Result<(), ParamsError> {
        self.rectangle.map_or(Ok(()), |rectangle| {
            Self::layout_of_rectangle(rectangle).map(|_| ())
        })
    }
}

/// Reason why a map has no goals of a large loop.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MapFault {
    /// The workplace.
    #[error(transparent)]
    Site(#[from] SiteError),
    /// The start of the robot.
    #[error("the robot starts outside the free space")]
    Outside,
    /// The route.
    #[error(transparent)]
    Tour(#[from] TourError),
    /// The map is not given exactly.
    #[error("the map has more pieces than world/shapes holds: give its `rectangle`")]
    NoPieces,
    /// The iterations.
    #[error("the tour has no sub-goals")]
    NoGoals,
}

impl ChebyshevKnowledge {
    /// Returns the goals of a large loop in a map with these bounds and obstacles, of a robot of this
    /// radius (m) that starts at `start` (m).
    ///
    /// # Errors
    /// [`MapFault`] names the invalid parameter or the fault of the map.
    pub fn layout_of_map(
        &self,
        bounds: Aabb,
        parts: &[Convex],
        radius: f64,
        start: Point2<f64>,
    ) -> Result<Layout, MapFault> {
        let follow = FollowParams {
            margin: self.margin,
            tolerance: self.tolerance,
            ..FollowParams::default()
        };
        let site = Site::new(bounds, parts, radius, &follow, start)?;
        let first = site.decomposition.rectangle_at(site.start);
        let first = first.ok_or(MapFault::Outside)?;
        let tour = Tour::new(&site.decomposition, first, &self.route, &self.iterations)?;
        let slots = frames(&site.decomposition, &tour).into_iter().map(|r| {
            let size = r.max - r.min;
            Slot::Drawn(Frame {
                origin: r.min,
                first: Vector2::new(size.x, 0.0),
                second: Vector2::new(0.0, size.y),
            })
        });
        Layout::new(slots.collect()).ok_or(MapFault::NoGoals)
    }

    /// Returns the single goal that is drawn repeatedly in a rectangle.
    ///
    /// # Errors
    /// [`ParamsError`] if the rectangle is invalid.
    pub fn layout_of_rectangle(rectangle: [f64; 4]) -> Result<Layout, ParamsError> {
        const EXPECTED: &str = "[smallest x, smallest y, largest x, largest y], all finite";
        let [left, bottom, right, top] = rectangle;
        let text = format!("[{left}, {bottom}, {right}, {top}]");
        let (width, height) = (right - left, top - bottom);
        require(
            width > 0.0 && height > 0.0 && width.is_finite() && height.is_finite(),
            "rectangle",
            &text,
            EXPECTED,
        )?;
        let frame = Frame {
            origin: Point2::new(left, bottom),
            first: Vector2::new(width, 0.0),
            second: Vector2::new(0.0, height),
        };
        Layout::new(vec![Slot::Drawn(frame)])
            .ok_or_else(|| ParamsError::new("rectangle", &text, EXPECTED))
    }

    /// Returns a search for the state of the maps.
    pub fn finder(&self) -> ChebyshevRecovery {
        ChebyshevRecovery::new(match self.form {
            ChebyshevForm::Arcsine => Emission::Arcsine,
            ChebyshevForm::Raw => Emission::Raw,
        })
    }
}

impl Finder for ChebyshevRecovery {
    fn observe(&mut self, output: [f64; 2], sd: [f64; 2]) -> bool {
        self.observe_with(output.map(|c| 2.0 * c - 1.0), sd.map(|sd| 2.0 * sd))
    }

    fn gap(&mut self) {
        self.gap();
    }

    fn cost(&self) -> f64 {
        self.cost()
    }

    fn source(&self) -> Option<AnySource> {
        self.state().cloned()
    }
}
