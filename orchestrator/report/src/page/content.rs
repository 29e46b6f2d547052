//! Reading of a log for the page, in memory that does not grow with the log.

use std::collections::BTreeMap;
use std::path::Path;

use geometry::map::ObstacleChange;
use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::world::{RobotState, WorldEvent};
use ipc_types::topics::TopicId;
use mcap_log::reader::Reader;
use mcap_log::{Condition, LogReadError, ReadProgress};
use recorder::PatrolMeasurement;

use super::events::EventLists;
use super::layers::Layers;
use super::marks::Marks;
use super::series::Series;
use super::thinning::{Sample, ThinnedSeries};
use super::timing::Timing;
use crate::run_model::Facts;
use crate::run_model::LoggedScenario;
use crate::run_model::StaticScene;
use crate::run_model::{LoggedRun, Purpose};

/// Maximum number of robot states that are stored.
const MAX_STATES: usize = 400_000;
/// Minimum time between two states of a continuation (ns).
const MOTION_INTERVAL: u64 = 100_000_000;
/// Kinds of events that the map shows (`drawMarks` in `page/layers.js`).
const ON_MAP: [&str; 3] = ["captured", "escaped", "goal_reached"];

/// The state of the world at a tick.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Frame {
    pub(super) tick: u64,
    pub(super) robots: Vec<RobotState>,
}

/// Content of the page of a run.
#[derive(Debug)]
pub struct PageContent {
    pub(super) facts: Facts,
    pub(super) scenario: LoggedScenario,
    pub(super) frames: Vec<Sample<Frame>>,
    /// `true` if the log reaches the end of the game.
    pub(super) over: bool,
    pub(super) tick_period_ns: u64,
    /// Time of the last state, or of the last message if there is none (ns).
    pub(super) end_ns: u64,
    /// The static scene at the beginning.
    pub(super) static_scene: StaticScene,
    /// Its changes, by time (ns).
    pub(super) changes: Vec<(u64, ObstacleChange)>,
    /// The patrols at the end.
    pub(super) patrols: Vec<PatrolMeasurement>,
    pub(super) layers: Layers,
    pub(super) marks: Marks,
    pub(super) event_lists: EventLists,
    pub(super) series: Series,
    pub(super) timing: Timing,
    /// Messages by topic, of the lossless topics.
    pub(super) counts: BTreeMap<String, u64>,
    pub(super) notes: Vec<String>,
    pub(super) condition: Condition,
}

/// A thinned-out series of world states.
#[derive(Debug, Clone)]
struct Frames(ThinnedSeries<Frame>);

impl Consumer<LoggedRun> for Frames {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::WorldState]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, run: &mut LoggedRun) {
        let frame = Frame {
            tick: message.stamp.tick,
            robots: run.states.clone(),
        };
        self.0.push(message.time_ns, 0, frame);
    }
}

/// Content of a log for the page, up to the part that has been read.
#[derive(Debug, Clone)]
pub struct PageParts {
    run: LoggedRun,
    frames: Frames,
    layers: Layers,
    marks: Marks,
    event_lists: EventLists,
    series: Series,
    timing: Timing,
}

fn weigh(frame: &Frame) -> usize {
    frame.robots.len()
}

impl PageParts {
    /// Creates the parts before the first record.
    pub(super) fn new(marks: Marks) -> Self {
        Self {
            run: LoggedRun::new(Purpose::Page),
            frames: Frames(ThinnedSeries::new(0, MAX_STATES, weigh)),
            layers: Layers::default(),
            marks,
            event_lists: EventLists::default(),
            series: Series::default(),
            timing: Timing::default(),
        }
    }

    /// Reads on to the first message after a time (ns), or to the end; returns the time of the last message (ns).
    pub(super) fn read_on(
        &mut self,
        reader: &mut Reader<'_>,
        until_ns: u64,
    ) -> Result<u64, LogReadError> {
        let consumers: Vec<Box<dyn Consumer<LoggedRun> + '_>> = vec![
            Box::new(&mut self.frames),
            Box::new(&mut self.layers),
            Box::new(&mut self.marks),
            Box::new(&mut self.event_lists),
            Box::new(&mut self.series),
            Box::new(&mut self.timing),
        ];
        self.run.read_on(reader, until_ns, consumers)?;
        Ok(self.run.last_ns)
    }

    /// Returns the content.
    pub(super) fn content(mut self, reader: &Reader<'_>) -> Result<PageContent, LogReadError> {
        self.run.end(reader);
        let mut run = self.run;
        let scenario = run.facts.take_scenario(reader.path())?;
        let static_scene = run.facts.take_static_scene(&scenario);
        let tick_period_ns = if run.tick_period_ns == 0 {
            let period = run.facts.origin.manifest.get("tick_period_ns");
            period.and_then(|p| p.parse().ok()).unwrap_or(0)
        } else {
            run.tick_period_ns
        };
        Ok(PageContent {
            facts: run.facts,
            scenario,
            frames: self.frames.0.finish(),
            over: run.over,
            tick_period_ns,
            end_ns: if run.end_ns == 0 {
                run.last_ns
            } else {
                run.end_ns
            },
            static_scene,
            changes: run.changes,
            patrols: run.patrols,
            layers: self.layers,
            marks: self.marks,
            event_lists: self.event_lists,
            series: self.series,
            timing: self.timing,
            counts: run.counts,
            notes: run.notes,
            condition: run.condition,
        })
    }
}

impl PageContent {
    /// Reads a log up to its end or the first damaged record.
    pub(super) fn read(log: &Path, watch: &mut ReadProgress) -> Result<Self, LogReadError> {
        let mut reader = Reader::open(log, Some(watch))?;
        let (marks, _) = Marks::from_log(log);
        let mut parts = PageParts::new(marks);
        parts.read_on(&mut reader, u64::MAX)?;
        reader.check_all()?;
        parts.content(&reader)
    }

    /// Reads the motion in a log from a time on (ns), and what the map shows of its events; keeps at most `most` states of robots.
    pub(super) fn read_motion(
        log: &Path,
        from_ns: u64,
        most: usize,
        watch: &mut ReadProgress,
    ) -> Result<Self, LogReadError> {
        let mut reader = Reader::open(log, Some(watch))?;
        let (marks, _) = Marks::from_log(log);
        let mut parts = PageParts::new(marks);
        let consumers: Vec<Box<dyn Consumer<LoggedRun> + '_>> = vec![
            Box::new(&mut parts.frames),
            Box::new(&mut parts.event_lists),
        ];
        parts.run.read_on(&mut reader, u64::MAX, consumers)?;
        let mut content = parts.content(&reader)?;
        let mut frames = ThinnedSeries::new(MOTION_INTERVAL, most, weigh);
        for Sample { time_ns, key, item } in content.frames {
            if time_ns >= from_ns {
                frames.push(time_ns, key, item);
            }
        }
        content.frames = frames.finish();
        let events = &mut content.event_lists.events;
        events.retain(|(_, event)| ON_MAP.contains(&WorldEvent::name_of(event.kind)));
        Ok(content)
    }

    /// Name of a figure of a patrol, with its robots if there are several patrols.
    pub(super) fn patrol_figure(&self, patrol: usize, name: &str) -> String {
        match self.patrols.get(patrol) {
            Some(measurement) if self.patrols.len() > 1 => {
                format!("{}: {name}", measurement.names().join(", "))
            }
            _ => name.to_owned(),
        }
    }

    /// Name of a robot.
    pub(super) fn name(&self, robot: u32) -> String {
        let robots = &self.scenario.robots;
        let name = robots.get(robot as usize).map(|r| r.name.clone());
        name.unwrap_or_else(|| format!("robot {robot}"))
    }
}
