//! Public knowledge of a robot's goals: everything but the key.

use crate::recovery::cat::{CatModulus, CatRecovery};
use crate::recovery::chebyshev::ChebyshevRecovery;
use chaotic_maps::{AnySource, Emission};
use nalgebra::{Point2, Vector2};
use parameters::{Parameters, ParamsError, above, each, require, unit};
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

/// Public knowledge of a patrol with waypoints from a cat map (cat-map patrol paper).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct CatKnowledge {
    /// The route, at least two points.
    #[schemars(transform = each(each(unit("m"))))]
    pub contour: Vec<[f64; 2]>,
    /// `true` if it ends at its start.
    pub closed: bool,
    /// Maximum duration of a lap.
    #[schemars(transform = above(0).unit("s"))]
    pub t_max: f64,
    /// Width of the zig-zag.
    #[schemars(transform = above(0).unit("m"))]
    pub alpha: f64,
    /// The formulas' variant.
    pub preset: Preset,
    /// Zones of the route in which waypoints are inserted; empty: everywhere.
    pub danger_zones: DangerZones,
    /// The map.
    pub generator: CatKind,
}

impl Default for CatKnowledge {
    fn default() -> Self {
        Self {
            contour: Vec::new(),
            closed: true,
            t_max: 120.0,
            alpha: 1.0,
            preset: Preset::default(),
            danger_zones: DangerZones::default(),
            generator: CatKind::default(),
        }
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
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ChebyshevKnowledge {
    /// Rectangle of the sub-goals: smallest x and y, largest x and y.
    #[schemars(transform = each(unit("m")))]
    pub rectangle: [f64; 4],
    /// Function of the state that is output.
    pub form: ChebyshevForm,
}

impl Default for ChebyshevKnowledge {
    fn default() -> Self {
        Self {
            rectangle: [0.0, 0.0, 10.0, 10.0],
            form: ChebyshevForm::default(),
        }
    }
}

impl Parameters for ChebyshevKnowledge {
    fn check_relations(&self) -> Result<(), ParamsError> {
        self.layout().map(|_| ())
    }
}

impl ChebyshevKnowledge {
    /// Returns the single goal that is drawn repeatedly.
    ///
    /// # Errors
    /// [`ParamsError`] if the rectangle is invalid.
    pub fn layout(&self) -> Result<Layout, ParamsError> {
        const EXPECTED: &str = "[smallest x, smallest y, largest x, largest y], all finite";
        let [left, bottom, right, top] = self.rectangle;
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
