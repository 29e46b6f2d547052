//! What the public knows of a robot's goals: everything but the key.

use generators::recovery::cat::{CatModulus, CatRecovery};
use generators::recovery::chebyshev::ChebyshevRecovery;
use generators::{AnySource, Emission};
use guidance::params::{ParamsError, positive, require};
use nalgebra::{Point2, Vector2};
use patrol::awg::{Awg, AwgParams, Preset};
use patrol::contour::Contour;
use patrol::danger::DangerZones;
use serde::{Deserialize, Serialize};
use sim_backend::math;

use crate::layout::{Frame, Layout, Slot};
use crate::predictors::key::Finder;

/// Which cat map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
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

/// What is known of a patrol that puts in waypoints by a cat map (cat-map patrol paper).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CatKnowledge {
    /// The route [m], at least two points.
    pub contour: Vec<[f64; 2]>,
    /// Whether it ends where it began.
    pub closed: bool,
    /// Time in which a lap is to be done [s], > 0.
    pub t_max: f64,
    /// Width of the zig-zag [m], > 0.
    pub alpha: f64,
    /// The formulas' variant.
    pub preset: Preset,
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
            generator: CatKind::default(),
        }
    }
}

impl CatKnowledge {
    /// Checks every field.
    ///
    /// # Errors
    /// [`ParamsError`] naming the first field that cannot be used.
    pub fn validate(&self) -> Result<(), ParamsError> {
        self.layout().map(|_| ())
    }

    /// The goals of a lap; of an open route, of a lap there and one back.
    ///
    /// # Errors
    /// [`ParamsError`] naming the first field that cannot be used.
    pub fn layout(&self) -> Result<Layout, ParamsError> {
        positive("t_max", self.t_max)?;
        positive("alpha", self.alpha)?;
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
        let awg = Awg::new(&contour, &DangerZones::default(), params)
            .map_err(|e| ParamsError::new("t_max", &e, "a time that makes a zig-zag"))?;
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

    /// A search for the state of the map.
    pub fn finder(&self) -> CatFinder {
        CatFinder {
            recovery: CatRecovery::new(match self.generator {
                CatKind::CatP => CatModulus::Prime,
                CatKind::Cat64 => CatModulus::Wrapping64,
                CatKind::CatF64 => CatModulus::F64,
            }),
            last: None,
            missed: 0,
        }
    }
}

/// Most outputs in a row that can be restored from those around them.
const MOST_RESTORED: u32 = 2;

/// Finds the state of a cat map.
#[derive(Debug, Clone)]
pub struct CatFinder {
    recovery: CatRecovery,
    last: Option<[f64; 2]>,
    /// Outputs passed over since.
    missed: u32,
}

impl CatFinder {
    /// Restores the outputs that were passed over between two: along the direction in which the map
    /// expands from the later one, along that in which it contracts from the earlier one. Both
    /// shrink the noise.
    fn restore(&mut self, output: [f64; 2]) {
        let Some(last) = self.last else { return };
        let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
        let expanding = Vector2::new(1.0, golden).normalize();
        let mut ahead = last;
        for nth in 1..=self.missed {
            ahead = step(ahead);
            let mut back = output;
            for _ in nth..=self.missed {
                back = [2.0 * back[0] - back[1], back[1] - back[0]].map(|c| c - c.floor());
            }
            let apart = Vector2::new(back[0] - ahead[0], back[1] - ahead[1]).map(|c| c - c.round());
            let restored = Vector2::from(ahead) + expanding * expanding.dot(&apart);
            self.recovery
                .observe([restored.x, restored.y].map(|c| c - c.floor()));
        }
    }
}

/// The cat map on the torus.
fn step([x, y]: [f64; 2]) -> [f64; 2] {
    [x + y, x + 2.0 * y].map(|c| c - c.floor())
}

impl Finder for CatFinder {
    fn observe(&mut self, output: [f64; 2]) {
        if self.missed > 0 {
            if self.recovery.state().is_some() || self.missed > MOST_RESTORED {
                for _ in 0..self.missed {
                    self.recovery.gap();
                }
            } else {
                self.restore(output);
            }
        }
        self.missed = 0;
        self.last = Some(output);
        self.recovery.observe(output);
    }

    fn gap(&mut self) {
        self.missed += 1;
    }

    fn reset(&mut self) {
        self.recovery.forget();
        self.last = None;
        self.missed = 0;
    }

    fn source(&self) -> Option<AnySource> {
        (self.missed == 0)
            .then(|| self.recovery.state().cloned())
            .flatten()
    }

    fn step(&self, output: [f64; 2]) -> [f64; 2] {
        step(output)
    }

    fn distance(&self, a: [f64; 2], b: [f64; 2]) -> f64 {
        let [x, y] = [a[0] - b[0], a[1] - b[1]].map(|c| c - c.round());
        math::hypot(x, y)
    }

    fn growth(&self) -> f64 {
        2.618_033_988_749_895
    }
}

/// Which function of a Chebyshev map's state is given out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ChebyshevForm {
    /// Its arcsine: uniform.
    #[default]
    Arcsine,
    /// Its arccosine: uniform.
    Arccosine,
    /// The state itself.
    Raw,
}

/// What is known of a coverage by two Chebyshev maps (Chebyshev coverage paper).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ChebyshevKnowledge {
    /// The rectangle in which sub-goals lie: smallest x and y, largest x and y [m].
    pub rectangle: [f64; 4],
    /// What is given out.
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

impl ChebyshevKnowledge {
    /// Checks every field.
    ///
    /// # Errors
    /// [`ParamsError`] naming the first field that cannot be used.
    pub fn validate(&self) -> Result<(), ParamsError> {
        self.layout().map(|_| ())
    }

    /// The one goal that is drawn again and again.
    ///
    /// # Errors
    /// [`ParamsError`] if the rectangle is none.
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

    /// A search for the state of the maps.
    pub fn finder(&self) -> ChebyshevFinder {
        let emission = match self.form {
            ChebyshevForm::Arcsine => Emission::Arcsine,
            ChebyshevForm::Arccosine => Emission::Arccosine,
            ChebyshevForm::Raw => Emission::Raw,
        };
        ChebyshevFinder {
            recovery: ChebyshevRecovery::new(emission),
            form: self.form,
        }
    }
}

/// Finds the state of two Chebyshev maps.
#[derive(Debug, Clone)]
pub struct ChebyshevFinder {
    recovery: ChebyshevRecovery,
    form: ChebyshevForm,
}

impl ChebyshevFinder {
    /// Distance along a circle of length 1 from the point whose cosine an output stands for: what
    /// the map multiplies by 6.
    fn angle(&self, unit: f64) -> f64 {
        let unit = unit.clamp(0.0, 1.0);
        match self.form {
            ChebyshevForm::Arcsine => 0.5 * (1.0 - unit),
            ChebyshevForm::Arccosine => 0.5 * unit,
            ChebyshevForm::Raw => math::acos(2.0 * unit - 1.0) / core::f64::consts::TAU,
        }
    }

    fn unit(&self, angle: f64) -> f64 {
        match self.form {
            ChebyshevForm::Arcsine => 1.0 - 2.0 * angle,
            ChebyshevForm::Arccosine => 2.0 * angle,
            ChebyshevForm::Raw => 0.5 * (math::cos(core::f64::consts::TAU * angle) + 1.0),
        }
    }
}

impl Finder for ChebyshevFinder {
    fn observe(&mut self, output: [f64; 2]) {
        self.recovery.observe(output.map(|c| 2.0 * c - 1.0));
    }

    fn gap(&mut self) {
        self.recovery.gap();
    }

    fn reset(&mut self) {
        self.recovery.forget();
    }

    fn source(&self) -> Option<AnySource> {
        self.recovery.state().cloned()
    }

    fn step(&self, output: [f64; 2]) -> [f64; 2] {
        output.map(|c| {
            let six = 6.0 * self.angle(c);
            let turns = six - six.floor();
            self.unit(turns.min(1.0 - turns))
        })
    }

    fn distance(&self, a: [f64; 2], b: [f64; 2]) -> f64 {
        // Twice the angle, in which the uniform forms are linear and a step grows by 6 everywhere.
        let along = |k: usize| 2.0 * (self.angle(a[k]) - self.angle(b[k])).abs();
        along(0).max(along(1))
    }

    fn growth(&self) -> f64 {
        6.0
    }
}
