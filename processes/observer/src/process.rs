//! Connects an observer to its topics: state and map in, predictions out.

use geometry::pose::Pose2;
use geometry::visibility::polygon::SightLimits;
use ipc_types::bus::{Bus, Publisher, PublisherOptions};
use ipc_types::messages::observer::Prediction;
use ipc_types::stamp::PlainHeader;
use ipc_types::topics::Predictions;
use metrics::prediction::View;
use nalgebra::Point2;
use rand_chacha::ChaCha8Rng;
use robot::spec::RobotSpec;
use runtime::declaration::{Declaration, Input, Output};
use runtime::grids::{blurred_map, map_grids};
use runtime::inputs::{MapInput, ShapesInput, StateInput, reply_stamp};
use runtime::kind::ViewSpec;
use runtime::maps::Maps;
use runtime::{Clock, Process, ProcessConfig, ProcessError, ProcessKind, RobotInfo};
use std::sync::Arc;
use tracking::particle_filter::MotionLimits;
use tracking::space::Space;

use crate::knowledge::{ChebyshevKnowledge, MapFault};
use crate::layout::Layout;
use crate::moment::Look;
use crate::params::{Method, ObserverParams};
use crate::pose_sensor::PoseSensor;
use crate::predictors::kalman::Kalman;
use crate::predictors::key::KeyHunter;
use crate::predictors::particles::Particles;
use crate::predictors::similar_goal::SimilarGoal;
use crate::predictors::similar_stretch::SimilarStretch;
use crate::watched::{MethodPrediction, WatchedRobot};

/// Maximum error of detected goals (m).
const GOAL_ERROR: f64 = 0.03;
/// Length of the compared stretches (s).
const STRETCH_S: f64 = 2.0;
/// Time between the compared poses of a stretch (s).
const STRETCH_STEP_S: f64 = 0.25;

/// Watched robot.
struct Target {
    robot: usize,
    watched: WatchedRobot,
    noise: ChaCha8Rng,
    visible: bool,
}

/// Process of an observer.
pub struct ObserverProcess {
    config: ProcessConfig,
    params: ObserverParams,
    /// Watched robots, and viewpoints.
    robots: Vec<usize>,
    from_robots: Vec<usize>,
    sensor: PoseSensor,
    space: Option<Space>,
    targets: Vec<Target>,
    state: StateInput,
    map: MapInput,
    /// The exact obstacles, if it divides the map.
    shapes: Option<ShapesInput>,
    predictions: Publisher<Predictions>,
    /// Ticks between two reports.
    every: u64,
    reported: Option<u64>,
    last_tick: Option<u64>,
    report: Vec<Prediction>,
}

impl ProcessKind for ObserverProcess {
    const NAME: &'static str = "observer";
    const SUMMARY: &'static str =
        "observes robots, predicts their positions, and measures the errors";

    type Params = ObserverParams;

    fn declare(params: &ObserverParams) -> Declaration {
        Declaration::default()
            .reads(Input::STATE)
            .reads(Input::MAP)
            .reads_if(divides_the_map(params), Input::SHAPES.optional())
            .writes(Output::new::<Predictions>(0))
    }

    /// Its viewpoints are its robots and places; without any it receives the true poses.
    fn lookout(params: &ObserverParams, _: &[usize], robots: &[RobotSpec]) -> Option<ViewSpec> {
        let looks = |&robot: &usize| params.from_robots.contains(&robots[robot].name);
        Some(ViewSpec {
            robots: (0..robots.len()).filter(looks).collect(),
            points: params.from_points.clone(),
            limits: SightLimits {
                range: params.viewpoint.range,
                field_of_view: None,
            },
        })
    }

    fn open(
        config: &ProcessConfig,
        params: &ObserverParams,
        bus: &Bus,
    ) -> Result<Self, ProcessError> {
        let refuse = |reason: String| ProcessError::Params {
            process: config.name.clone(),
            kind: config.kind.clone(),
            reason,
        };
        let run = &config.run;
        let indices = |field: &str, names: &[String]| {
            names
                .iter()
                .map(|name| {
                    run.robots
                        .iter()
                        .position(|robot| robot.name == *name)
                        .ok_or_else(|| {
                            refuse(format!(
                                "`{field}` names `{name}`: expected robots of the scenario"
                            ))
                        })
                })
                .collect::<Result<Vec<usize>, _>>()
        };
        let from_robots = indices("from_robots", &params.from_robots)?;
        let mut robots = indices("watch", &params.watch)?;
        if robots.is_empty() {
            robots = (0..run.robots.len())
                .filter(|robot| !from_robots.contains(robot))
                .collect();
        }
        robots.sort_unstable();
        robots.dedup();
        let knowledge = usize::from(params.cat.is_some()) + usize::from(params.chebyshev.is_some());
        let methods = params.methods.len() + knowledge;
        let capacity = robots.len() * methods * params.horizons_s.len();
        let limited = !(params.from_points.is_empty() && from_robots.is_empty());
        Ok(Self {
            sensor: PoseSensor::new(&params.viewpoint, limited),
            every: ticks(params.period_s, run.tick_period()),
            state: StateInput::open(bus, run.robots.len())?,
            map: MapInput::open(bus)?,
            shapes: divides_the_map(params)
                .then(|| ShapesInput::open(bus))
                .transpose()?,
            predictions: bus.publisher(PublisherOptions::new(config.index, capacity))?,
            config: config.clone(),
            params: params.clone(),
            robots,
            from_robots,
            space: None,
            targets: Vec::new(),
            reported: None,
            last_tick: None,
            report: Vec::with_capacity(capacity),
        })
    }
}

/// Returns `true` if it divides the map into the rectangles of a Chebyshev coverage.
fn divides_the_map(params: &ObserverParams) -> bool {
    let chebyshev = params.chebyshev.as_ref();
    chebyshev.is_some_and(|chebyshev| chebyshev.rectangle.is_none())
}

impl Process for ObserverProcess {
    fn share_maps(&mut self, maps: &Arc<Maps>) {
        self.map.share(maps);
    }

    fn connect(&mut self) -> Result<(), ProcessError> {
        self.state.connect()?;
        self.map.connect()?;
        if let Some(shapes) = &self.shapes {
            shapes.connect()?;
        }
        self.predictions.update_connections()?;
        Ok(())
    }

    fn prepare(&mut self) -> Result<(), ProcessError> {
        if let Some(shapes) = &mut self.shapes {
            shapes.update()?;
        }
        if self.map.update()? {
            let grids = map_grids(&self.map.header, self.map.cells());
            let space = Space::new(&blurred_map(grids.blurred, grids.occupied)?);
            if self.targets.is_empty() {
                self.targets = self
                    .robots
                    .iter()
                    .map(|&robot| self.target(robot, &space))
                    .collect::<Result<_, _>>()?;
            }
            self.space = Some(space);
        }
        Ok(())
    }

    fn step(&mut self, tick: u64) -> Result<(), ProcessError> {
        let clock = self.config.run.clock;
        self.state.take_turn(tick, clock)?;
        let newest = self.state.header.stamp.tick;
        self.prepare()?;
        let Some(space) = &self.space else {
            if clock == Clock::LockStep {
                let text = "it is the turn of a tick, but no sound world/map has come";
                return Err(ProcessError::Protocol(text.into()));
            }
            return Ok(());
        };
        // In real time ticks may have been missed, or there may be no new state.
        let passed = match self.last_tick {
            Some(last) if newest <= last => return Ok(()),
            Some(last) => newest - last,
            None => 1,
        };
        self.last_tick = Some(newest);
        let period = self.config.run.tick_period();
        let robots = &self.state.robots;
        let active = |robot: usize| robots.get(robot).filter(|state| state.status == 0);
        let from_robots = self.from_robots.iter().filter_map(|&robot| active(robot));
        self.sensor.set(
            space,
            self.params
                .from_points
                .iter()
                .map(|&point| Point2::from(point))
                .chain(from_robots.map(|state| Point2::new(state.x, state.y))),
        );
        for target in &mut self.targets {
            let Some(state) = active(target.robot) else {
                continue;
            };
            let truth = Pose2::new(state.x, state.y, state.theta);
            let (visibility, seen) = self.sensor.look(space, truth, &mut target.noise);
            target.visible = seen.is_some();
            let look = Look {
                time: newest as f64 * period,
                dt: passed as f64 * period,
                seen,
                visibility,
            };
            let scene = (space, self.sensor.watch());
            target
                .watched
                .observe(newest, look, truth.position(), scene);
        }
        let turn = newest / self.every;
        if self.reported == Some(turn) {
            return Ok(());
        }
        self.reported = Some(turn);
        let report = &mut self.report;
        report.clear();
        for target in &mut self.targets {
            if active(target.robot).is_none() {
                continue;
            }
            let (robot, visible) = (target.robot, target.visible);
            let scene = (space, self.sensor.watch());
            target.watched.report(newest, scene, |predicted| {
                report.push(prediction(robot, visible, &predicted));
            });
        }
        if !report.is_empty() {
            let stamp = reply_stamp(&self.state.header, self.state.received_ns);
            self.predictions
                .send_with(PlainHeader { stamp }, report.len(), |i| {
                    report.get(i).copied().unwrap_or_default()
                })?;
        }
        Ok(())
    }

    fn rejected(&self) -> u64 {
        let shapes = self.shapes.as_ref().map_or(0, |shapes| shapes.rejected);
        self.state.rejected + self.map.rejected + shapes
    }
}

impl ObserverProcess {
    /// Creates the predictors of a robot.
    fn target(&self, robot: usize, space: &Space) -> Result<Target, ProcessError> {
        let (run, params) = (&self.config.run, &self.params);
        let algorithm = |e: parameters::ParamsError| ProcessError::Algorithm(e.to_string());
        let Some(info) = run.robots.get(robot) else {
            return Err(ProcessError::Algorithm(format!(
                "there is no robot {robot}"
            )));
        };
        let stream =
            |purpose: &str| runtime::seed::stream(run.seed, &self.config.name, &info.name, purpose);
        let tick_s = run.tick_period();
        let horizons = params
            .horizons_s
            .iter()
            .map(|&horizon| (horizon, ticks(horizon, tick_s)))
            .collect();
        let mut watched = WatchedRobot::new(params.arrival, horizons);
        for method in &params.methods {
            match method {
                Method::Kalman => {
                    watched.add(
                        Prediction::KALMAN,
                        Kalman::new(params.acceleration, info.model.v_max),
                    );
                }
                Method::Particles => {
                    let limits = MotionLimits {
                        v_max: info.model.v_max,
                        v_reverse_max: info.model.v_reverse_max,
                        omega_max: info.model.omega_max,
                    };
                    let (start, rng) = (params.filter.known_start(info.start), stream("particles"));
                    watched.add(
                        Prediction::PARTICLES,
                        Particles::new(&params.filter, limits, start, space, rng),
                    );
                }
                Method::SimilarStretch => watched.add(
                    Prediction::SIMILAR_STRETCH,
                    SimilarStretch::new(STRETCH_S, STRETCH_STEP_S),
                ),
                Method::SimilarGoal => {
                    watched.add(Prediction::SIMILAR_GOAL, SimilarGoal::new(View::Plane));
                }
                Method::SimilarGoalPerAxis => watched.add(
                    Prediction::SIMILAR_GOAL_PER_AXIS,
                    SimilarGoal::new(View::PerAxis),
                ),
            }
        }
        if let Some(cat) = &params.cat {
            let layout = cat.layout().map_err(|e| algorithm(e.within("cat")))?;
            let finder = cat.finder();
            watched.add(
                Prediction::CAT_KEY,
                KeyHunter::new(layout, finder, params.arrival, GOAL_ERROR),
            );
        }
        if let Some(chebyshev) = &params.chebyshev {
            let layout = self.layout(chebyshev, info)?;
            let finder = chebyshev.finder();
            watched.add(
                Prediction::CHEBYSHEV_KEY,
                KeyHunter::new(layout, finder, params.arrival, GOAL_ERROR),
            );
        }
        Ok(Target {
            robot,
            watched,
            noise: stream("eyes"),
            visible: false,
        })
    }
}

impl ObserverProcess {
    /// Returns the sub-goals of a robot that covers the map.
    fn layout(
        &self,
        knowledge: &ChebyshevKnowledge,
        robot: &RobotInfo,
    ) -> Result<Layout, ProcessError> {
        if let Some(rectangle) = knowledge.rectangle {
            return ChebyshevKnowledge::layout_of_rectangle(rectangle)
                .map_err(|e| ProcessError::Algorithm(e.within("chebyshev").to_string()));
        }
        let pieces = self.shapes.as_ref().and_then(|s| s.pieces.as_ref());
        let layout = match pieces {
            Some((bounds, parts)) => {
                let start = robot.start.position();
                knowledge.layout_of_map(*bounds, parts, robot.model.radius, start)
            }
            None => Err(MapFault::NoPieces),
        };
        layout.map_err(|reason| ProcessError::Algorithm(format!("`chebyshev`: {reason}")))
    }
}

/// Converts a time to whole ticks, at least one.
fn ticks(time_s: f64, tick_s: f64) -> u64 {
    // A cast of a float saturates; NaN becomes 0.
    ((time_s / tick_s).round() as u64).max(1)
}

fn prediction(robot: usize, visible: bool, predicted: &MethodPrediction) -> Prediction {
    let position = predicted
        .position
        .unwrap_or(Point2::new(f64::INFINITY, f64::INFINITY));
    Prediction {
        horizon_s: predicted.horizon,
        x: position.x,
        y: position.y,
        error: predicted.error.unwrap_or(f64::INFINITY),
        robot: robot as u32,
        goals_observed: predicted.goals_observed,
        method: predicted.method,
        due: u8::from(predicted.error.is_some()),
        visible: u8::from(visible),
        key_recovered: u8::from(predicted.key_recovered),
        ..Prediction::default()
    }
}
