//! A policy that steers one robot.

use geometry::map::ShapeMap;
use geometry::pose::Twist2;
use network::{EvaluationError, Network};
use observation::action::{ACTION_LENGTH, ActionKind, command};
use observation::error::{LayoutError, WriteError};
use observation::facts::RobotFacts;
use observation::field_evader::FieldEvader;
use observation::layout::Layout;
use observation::parts::Parts;
use observation::route_entries::RouteEntries;
use observation::scene::{OcclusionCache, Scene};
use planner_view::map::PlannerMap;
use planner_view::view::View;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use robot::spec::RobotModel;
use thiserror::Error;
use tracking::sighting::gaussian_pair;

/// Reason why a policy does not fit its robot.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PolicyError {
    /// The robot has no such observation.
    #[error(transparent)]
    Layout(#[from] LayoutError),
    /// The network has another input.
    #[error(
        "`model`: its input has {input} numbers, but the observation `{observation}` of robot {robot} has {length}"
    )]
    Input {
        /// Length of the network's input.
        input: usize,
        /// Contents of the observation.
        observation: Parts,
        /// Name of the robot.
        robot: String,
        /// Length of the observation.
        length: usize,
    },
}

/// Reason why a policy cannot continue.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SteeringError {
    /// The map has too many pieces for lines of sight.
    #[error("a policy needs the exact pieces of the map, but it has too many")]
    Pieces,
    /// The observation cannot be written.
    #[error(transparent)]
    Observation(#[from] WriteError),
    /// The network has no result.
    #[error("the policy of robot {robot}: {error}")]
    Evaluation {
        /// Name of the robot.
        robot: String,
        /// Description of the result.
        error: EvaluationError,
    },
}

/// Policy of one robot.
#[derive(Debug, Clone)]
pub struct Policy {
    network: Network,
    layout: Layout,
    scene: Scene,
    hiding: OcclusionCache,
    ways: Option<RouteEntries>,
    robot: String,
    model: RobotModel,
    /// The controller, if actions change it.
    evader: Option<FieldEvader>,
    ticks_per_action: u64,
    observation: Vec<f32>,
    held: Option<[f32; ACTION_LENGTH]>,
    /// Standard deviation and seed of what is added to actions.
    exploration: (f64, u64),
}

impl Policy {
    /// Creates the policy of the robot with index `me`, in a world with this many exits.
    ///
    /// # Errors
    /// [`PolicyError`] if robot, observation and network do not fit.
    pub fn new(
        network: Network,
        parts: Parts,
        action: ActionKind,
        ticks_per_action: u32,
        robots: &[RobotFacts],
        me: usize,
        exits: usize,
    ) -> Result<Self, PolicyError> {
        let layout = Layout::new(parts, robots, me, exits)?;
        let own = robots.get(me).ok_or(LayoutError::Robot {
            robot: me,
            robots: robots.len(),
        })?;
        let length = layout.length();
        if network.input_length() != length {
            return Err(PolicyError::Input {
                input: network.input_length(),
                observation: parts,
                robot: own.name.clone(),
                length,
            });
        }
        let evader = match action {
            ActionKind::Twist => None,
            ActionKind::Tune | ActionKind::Residual => Some(FieldEvader::new(action, own, me)?),
        };
        Ok(Self {
            evader,
            network,
            scene: Scene::new(robots, &[me]),
            hiding: OcclusionCache::default(),
            ways: layout.ways(),
            robot: own.name.clone(),
            model: own.model,
            ticks_per_action: u64::from(ticks_per_action.max(1)),
            observation: vec![0.0; length],
            held: None,
            exploration: (0.0, 0),
            layout,
        })
    }

    /// Adds random numbers with this standard deviation to the numbers of each action, of the streams of `seed`.
    #[must_use]
    pub fn exploring(self, deviation: f64, seed: u64) -> Self {
        Self {
            exploration: (deviation, seed),
            ..self
        }
    }

    /// Returns the command of this tick. A robot that no longer takes part stands still.
    ///
    /// # Errors
    /// [`SteeringError`] if the map lacks its exact pieces, or the network has no finite action.
    pub fn command(&mut self, map: &PlannerMap, view: &View<'_>) -> Result<Twist2, SteeringError> {
        let space = map.space().ok_or(SteeringError::Pieces)?;
        if view.own().is_none_or(|own| !own.active) {
            return Ok(Twist2::STOP);
        }
        // By the time and not by a count: a restarted process continues in step.
        let tick = (view.time_s / view.dt).round() as u64;
        let action = match self.held {
            Some(held) if !tick.is_multiple_of(self.ticks_per_action) => held,
            _ => {
                let action = self.action(map, space.shapes(), view)?;
                let action = self.explored(action, tick);
                if let Some(evader) = &mut self.evader {
                    evader.act(action);
                }
                action
            }
        };
        self.held = Some(action);
        Ok(match &mut self.evader {
            Some(evader) => evader.steering(map, view).command,
            None => command(action, &self.model),
        })
    }

    /// Returns an action with what exploration adds in this tick.
    fn explored(&self, action: [f32; ACTION_LENGTH], tick: u64) -> [f32; ACTION_LENGTH] {
        let (deviation, seed) = self.exploration;
        if deviation <= 0.0 {
            return action;
        }
        // A stream per tick: a restarted process continues in step.
        let mut stream = ChaCha8Rng::seed_from_u64(seed);
        stream.set_stream(tick);
        let (first, second) = gaussian_pair(&mut stream);
        let [a, b] = action;
        let explored = |own: f32, noise: f64| (f64::from(own) + deviation * noise).clamp(-1.0, 1.0);
        [explored(a, first) as f32, explored(b, second) as f32]
    }

    /// Returns the action of the network.
    fn action(
        &mut self,
        map: &PlannerMap,
        shapes: &ShapeMap,
        view: &View<'_>,
    ) -> Result<[f32; ACTION_LENGTH], SteeringError> {
        self.scene.update(view.robots, shapes, &mut self.hiding);
        self.layout
            .write(&self.scene, view, &mut self.observation)?;
        if let Some(ways) = &mut self.ways {
            ways.write(map, view, &mut self.observation);
        }
        let output = self.network.evaluate(&self.observation);
        let output = output.map_err(|error| SteeringError::Evaluation {
            robot: self.robot.clone(),
            error,
        })?;
        let mut action = [0.0; ACTION_LENGTH];
        for (own, &number) in action.iter_mut().zip(output) {
            *own = number;
        }
        Ok(action)
    }
}
