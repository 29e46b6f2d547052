//! What people see: the run in the standard schemas of the viewers (Foxglove, Lichtblick, Rerun),
//! beside the lossless topics.
//!
//! Everything of one tick is gathered and drawn when the tick is complete, at most
//! `rate_hz` times per simulated second; the first and the last state and every tick at which
//! something happened are always drawn. Every message is a whole picture of its topic, so that a
//! viewer that jumps in time shows the right thing from the one message before. What seldom changes
//! is drawn again now and then (see `again`).

mod again;
mod channel;
mod dominance;
mod grid;
mod messages;
mod palette;
mod points;
mod robot_lines;
mod scene;
mod shapes;
mod sight;
mod visibility;
mod walls;
mod words;

use foxglove::messages::{
    FrameTransforms, Grid, LaserScan, Log as LogMessage, PointCloud, PosesInFrame, SceneUpdate,
};
use ipc_types::messages::perception::{Particle, Sighting};
use ipc_types::messages::process::{LogHeader, ProcessEvent};
use ipc_types::messages::referee::{DominanceCell, DominanceHeader};
use ipc_types::messages::robot::{PlanPoint, ScanHeader, TreeEdge};
use ipc_types::messages::world::{
    MapCell, MapHeader, ObstacleEvent, RobotState, WorldEvent, WorldHeader,
};

use self::again::Again;
use self::channel::ViewerChannel;
use self::robot_lines::RobotLines;
use self::shapes::Obstacles;
use self::sight::Sight;
use self::visibility::Visibility;
use super::error::LogError;
use super::log_writer::LogWriter;
use super::options::{ProcessInfo, RecorderOptions, RobotInfo};

/// Frame in which everything stands.
const MAP_FRAME: &str = "map";
/// Frame in the middle of the map, for viewers to look at: no robot is called so.
const CENTRE_FRAME: &str = "map/centre";

/// What viewers get to see.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewerOptions {
    /// Pictures per simulated second; 0 for no viewer topics at all.
    pub rate_hz: f64,
    /// How long a robot's trail stays visible [simulated s]; 0 for none.
    pub trail_s: f64,
}

impl Default for ViewerOptions {
    fn default() -> Self {
        Self {
            rate_hz: 10.0,
            trail_s: 5.0,
        }
    }
}

/// Draws a run.
pub(super) struct Viewer {
    robots: Vec<RobotInfo>,
    processes: Vec<ProcessInfo>,
    period_ns: u64,
    trail_s: f64,
    channels: Channels,
    /// Time from which the next picture is due [ns].
    due_ns: u64,
    state: Option<State>,
    map: Option<Grid>,
    map_again: Again,
    obstacles_again: Again,
    /// Middle of the map [m].
    centre: Option<[f64; 2]>,
    trail: scene::Trail,
    plans: RobotLines,
    trees: RobotLines,
    obstacles: Obstacles,
    sight: Sight,
    visibility: Visibility,
    buffer: Vec<u8>,
}

struct Channels {
    scene: ViewerChannel<SceneUpdate>,
    transforms: ViewerChannel<FrameTransforms>,
    poses: ViewerChannel<PosesInFrame>,
    map: ViewerChannel<Grid>,
    walls: ViewerChannel<PointCloud>,
    sight: ViewerChannel<SceneUpdate>,
    visibility: ViewerChannel<SceneUpdate>,
    dominance: ViewerChannel<Grid>,
    obstacles: ViewerChannel<SceneUpdate>,
    plans: ViewerChannel<SceneUpdate>,
    trees: ViewerChannel<SceneUpdate>,
    log: ViewerChannel<LogMessage>,
    particles: Vec<ViewerChannel<PointCloud>>,
    scans: Vec<ViewerChannel<LaserScan>>,
}

struct State {
    time_ns: u64,
    robots: Vec<RobotState>,
    /// Whether this state must be drawn even if no picture is due.
    wanted: bool,
    drawn: bool,
}

impl Viewer {
    /// Adds the viewer channels to the log; `None` if none are wanted.
    pub(super) fn new(
        recorder: &RecorderOptions,
        log: &mut LogWriter,
    ) -> Result<Option<Self>, LogError> {
        let (options, robots) = (&recorder.viewer, &recorder.robots);
        if options.rate_hz.is_nan() || options.rate_hz <= 0.0 {
            return Ok(None);
        }
        let per_robot = |prefix: &str| -> Vec<String> {
            robots
                .iter()
                .map(|robot| format!("/viewer/{prefix}/{}", robot.name))
                .collect()
        };
        let channels = Channels {
            scene: ViewerChannel::add(log, "/viewer/scene")?,
            transforms: ViewerChannel::add(log, "/viewer/tf")?,
            poses: ViewerChannel::add(log, "/viewer/poses")?,
            map: ViewerChannel::add(log, "/viewer/map")?,
            walls: ViewerChannel::add(log, "/viewer/walls")?,
            sight: ViewerChannel::add(log, "/viewer/sight")?,
            visibility: ViewerChannel::add(log, "/viewer/visibility")?,
            dominance: ViewerChannel::add(log, "/viewer/dominance")?,
            obstacles: ViewerChannel::add(log, "/viewer/obstacles")?,
            plans: ViewerChannel::add(log, "/viewer/plan")?,
            trees: ViewerChannel::add(log, "/viewer/tree")?,
            log: ViewerChannel::add(log, "/viewer/log")?,
            particles: per_robot("particles")
                .iter()
                .map(|topic| ViewerChannel::add(log, topic))
                .collect::<Result<_, _>>()?,
            scans: per_robot("scan")
                .iter()
                .map(|topic| ViewerChannel::add(log, topic))
                .collect::<Result<_, _>>()?,
        };
        let mut viewer = Self {
            robots: robots.clone(),
            processes: recorder.processes.clone(),
            // At least 1 ns: a rate beyond 1 GHz draws every tick.
            period_ns: ((1e9 / options.rate_hz) as u64).max(1),
            trail_s: if options.trail_s.is_finite() {
                options.trail_s.max(0.0)
            } else {
                0.0
            },
            channels,
            due_ns: 0,
            state: None,
            map: None,
            map_again: Again::default(),
            obstacles_again: Again::default(),
            centre: None,
            trail: scene::Trail::default(),
            plans: RobotLines::plans(robots.len()),
            trees: RobotLines::trees(robots.len()),
            obstacles: Obstacles::default(),
            sight: Sight::default(),
            visibility: Visibility::new(recorder.eyes.clone()),
            buffer: Vec::new(),
        };
        if !recorder.obstacles.is_empty() {
            for obstacle in &recorder.obstacles {
                viewer.obstacles.stands(obstacle);
            }
            viewer.draw_obstacles(0, log)?;
        }
        Ok(Some(viewer))
    }

    /// A new tick begins with this state.
    fn state(
        &mut self,
        header: &WorldHeader,
        time_ns: u64,
        robots: impl Iterator<Item = RobotState>,
    ) {
        let first = self.state.is_none();
        let last = header.phase == WorldHeader::OVER;
        let mut kept = self
            .state
            .take()
            .map(|state| state.robots)
            .unwrap_or_default();
        kept.clear();
        kept.extend(robots);
        self.state = Some(State {
            time_ns,
            robots: kept,
            wanted: first || last,
            drawn: false,
        });
    }

    /// Draws the map, at every revision.
    fn map(
        &mut self,
        header: &MapHeader,
        time_ns: u64,
        cells: impl ExactSizeIterator<Item = MapCell> + Clone,
        log: &mut LogWriter,
    ) -> Result<(), LogError> {
        let Some(grid) = grid::draw(header, time_ns, cells.clone()) else {
            return Ok(());
        };
        let middle = |origin: f64, cells: u32| origin + 0.5 * f64::from(cells) * header.resolution;
        self.centre = Some([
            middle(header.origin_x, header.width),
            middle(header.origin_y, header.height),
        ]);
        self.visibility.map(header, cells.clone());
        self.map = Some(grid);
        self.draw_map(time_ns, log)?;
        let walls = walls::draw(header, time_ns, cells);
        self.channels
            .walls
            .write(log, time_ns, &walls, &mut self.buffer)
    }

    fn draw_map(&mut self, time_ns: u64, log: &mut LogWriter) -> Result<(), LogError> {
        let Some(grid) = &mut self.map else {
            return Ok(());
        };
        grid.timestamp = Some(timestamp(time_ns));
        self.channels
            .map
            .write(log, time_ns, grid, &mut self.buffer)?;
        self.map_again.drawn(time_ns, self.buffer.len());
        Ok(())
    }

    /// Draws who reaches what first, whenever a referee says it.
    fn dominance(
        &mut self,
        header: &DominanceHeader,
        time_ns: u64,
        cells: impl ExactSizeIterator<Item = DominanceCell>,
        log: &mut LogWriter,
    ) -> Result<(), LogError> {
        match dominance::draw(header, time_ns, cells) {
            Some(grid) => self
                .channels
                .dominance
                .write(log, time_ns, &grid, &mut self.buffer),
            None => Ok(()),
        }
    }

    /// Says what happened, and sees to it that the tick is drawn.
    fn event(
        &mut self,
        event: &WorldEvent,
        time_ns: u64,
        log: &mut LogWriter,
    ) -> Result<(), LogError> {
        if let Some(state) = &mut self.state {
            state.wanted = true;
        }
        let message = words::message(event, &self.robots, time_ns);
        self.channels
            .log
            .write(log, time_ns, &message, &mut self.buffer)
    }

    /// Says that a process left or came back.
    fn process_event(
        &mut self,
        event: &ProcessEvent,
        time_ns: u64,
        log: &mut LogWriter,
    ) -> Result<(), LogError> {
        let message = words::process_event(event, &self.processes, time_ns);
        self.channels
            .log
            .write(log, time_ns, &message, &mut self.buffer)
    }

    /// Shows what a process wrote to stderr.
    fn process_log(
        &mut self,
        header: &LogHeader,
        text: &[u8],
        time_ns: u64,
        log: &mut LogWriter,
    ) -> Result<(), LogError> {
        let message = words::process_log(header, text, &self.processes, time_ns);
        self.channels
            .log
            .write(log, time_ns, &message, &mut self.buffer)
    }

    /// Draws the obstacles that come and go.
    fn obstacle(
        &mut self,
        event: &ObstacleEvent,
        time_ns: u64,
        log: &mut LogWriter,
    ) -> Result<(), LogError> {
        self.obstacles.apply(event);
        self.draw_obstacles(time_ns, log)
    }

    fn draw_obstacles(&mut self, time_ns: u64, log: &mut LogWriter) -> Result<(), LogError> {
        let update = self.obstacles.draw(time_ns);
        self.channels
            .obstacles
            .write(log, time_ns, &update, &mut self.buffer)?;
        self.obstacles_again.drawn(time_ns, self.buffer.len());
        Ok(())
    }

    /// Whether the present tick will be drawn, so that what belongs to it is worth decoding.
    fn is_drawing(&self, time_ns: u64) -> bool {
        time_ns >= self.due_ns || self.state.as_ref().is_some_and(|state| state.wanted)
    }

    /// Keeps a robot's plan for the picture.
    fn plan(&mut self, robot: u32, points: impl Iterator<Item = PlanPoint>) {
        self.plans.set_plan(robot as usize, points);
    }

    /// Keeps a robot's tree for the picture.
    fn tree(&mut self, robot: u32, edges: impl Iterator<Item = TreeEdge>) {
        self.trees.set_tree(robot as usize, edges);
    }

    /// Keeps who sees whom for the picture.
    fn sightings(&mut self, sightings: impl Iterator<Item = Sighting>) {
        self.sight.set(sightings);
    }

    /// Draws a belief about a robot from the bytes of its particles.
    fn belief(
        &mut self,
        robot: u32,
        time_ns: u64,
        particles: &[u8],
        log: &mut LogWriter,
    ) -> Result<(), LogError> {
        if !self.is_drawing(time_ns) {
            return Ok(());
        }
        const { assert!(size_of::<Particle>() == 16) };
        match self.channels.particles.get_mut(robot as usize) {
            Some(channel) => channel.write(
                log,
                time_ns,
                &points::cloud(time_ns, particles),
                &mut self.buffer,
            ),
            None => Ok(()),
        }
    }

    /// Draws a range scan.
    fn scan(
        &mut self,
        header: &ScanHeader,
        time_ns: u64,
        ranges: impl ExactSizeIterator<Item = f32>,
        log: &mut LogWriter,
    ) -> Result<(), LogError> {
        if !self.is_drawing(time_ns) {
            return Ok(());
        }
        let robot = header.robot as usize;
        match (self.channels.scans.get_mut(robot), self.robots.get(robot)) {
            (Some(channel), Some(robot)) => {
                let scan = points::scan(header, time_ns, &robot.name, ranges);
                channel.write(log, time_ns, &scan, &mut self.buffer)
            }
            _ => Ok(()),
        }
    }

    /// Every message of the present tick has been seen: draws it if it is due or wanted.
    pub(super) fn end_of_tick(&mut self, log: &mut LogWriter) -> Result<(), LogError> {
        let due = self.due_ns;
        match &self.state {
            Some(state) if !state.drawn && (state.wanted || state.time_ns >= due) => self.draw(log),
            _ => Ok(()),
        }
    }

    /// Draws the last state if it has not been drawn.
    pub(super) fn finish(&mut self, log: &mut LogWriter) -> Result<(), LogError> {
        if let Some(state) = &mut self.state {
            state.wanted = true;
        }
        self.end_of_tick(log)
    }

    fn draw(&mut self, log: &mut LogWriter) -> Result<(), LogError> {
        let Some(state) = &mut self.state else {
            return Ok(());
        };
        state.drawn = true;
        let time_ns = state.time_ns;
        if time_ns >= self.due_ns {
            // On the grid of the rate: pictures of all topics fall on the same ticks.
            self.due_ns = (time_ns / self.period_ns + 1).saturating_mul(self.period_ns);
        }
        let update = scene::draw(
            &self.robots,
            &state.robots,
            time_ns,
            &mut self.trail,
            self.trail_s,
        );
        self.channels
            .scene
            .write(log, time_ns, &update, &mut self.buffer)?;
        let transforms = scene::transforms(&self.robots, &state.robots, self.centre, time_ns);
        self.channels
            .transforms
            .write(log, time_ns, &transforms, &mut self.buffer)?;
        let poses = scene::poses(&state.robots, time_ns);
        self.channels
            .poses
            .write(log, time_ns, &poses, &mut self.buffer)?;
        if let Some(update) = self.sight.draw(&state.robots, time_ns) {
            self.channels
                .sight
                .write(log, time_ns, &update, &mut self.buffer)?;
        }
        if let Some(update) = self.visibility.draw(&state.robots, time_ns, state.wanted) {
            self.channels
                .visibility
                .write(log, time_ns, &update, &mut self.buffer)?;
        }
        if let Some(update) = self.plans.draw(&self.robots, &state.robots, time_ns) {
            self.channels
                .plans
                .write(log, time_ns, &update, &mut self.buffer)?;
            self.plans.drawn(time_ns, self.buffer.len());
        }
        if let Some(update) = self.trees.draw(&self.robots, &state.robots, time_ns) {
            self.channels
                .trees
                .write(log, time_ns, &update, &mut self.buffer)?;
            self.trees.drawn(time_ns, self.buffer.len());
        }
        if self.map_again.is_due(time_ns) {
            self.draw_map(time_ns, log)?;
        }
        if self.obstacles_again.is_due(time_ns) {
            self.draw_obstacles(time_ns, log)?;
        }
        Ok(())
    }
}

/// Simulated time as viewers want it.
fn timestamp(time_ns: u64) -> foxglove::messages::Timestamp {
    // A run of more than 136 years ends at the largest time.
    let seconds = u32::try_from(time_ns / 1_000_000_000).unwrap_or(u32::MAX);
    foxglove::messages::Timestamp::new(seconds, (time_ns % 1_000_000_000) as u32)
}
