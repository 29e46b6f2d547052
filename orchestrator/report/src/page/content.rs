//! Reading of a log for the page, in memory that does not grow with the log.

use std::collections::BTreeMap;
use std::path::Path;

use geometry::map::ObstacleChange;
use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::world::RobotState;
use ipc_types::topics::TopicId;
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

/// The state of the world at a tick.
#[derive(Debug, Clone, PartialEq)]
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

impl PageContent {
    /// Reads a log up to its end or the first damaged record.
    pub(super) fn read(log: &Path, watch: &mut ReadProgress) -> Result<Self, LogReadError> {
        let weigh = |frame: &Frame| frame.robots.len();
        let mut frames = Frames(ThinnedSeries::new(0, MAX_STATES, weigh));
        let (mut layers, mut event_lists) = (Layers::default(), EventLists::default());
        let mut marks = Marks::from_log(log);
        let (mut series, mut timing) = (Series::default(), Timing::default());
        let mut run = LoggedRun::read(
            log,
            Purpose::Page,
            vec![
                Box::new(&mut frames),
                Box::new(&mut layers),
                Box::new(&mut marks),
                Box::new(&mut event_lists),
                Box::new(&mut series),
                Box::new(&mut timing),
            ],
            watch,
        )?;
        let scenario = run.facts.take_scenario(log)?;
        let static_scene = run.facts.take_static_scene(&scenario);
        let tick_period_ns = if run.tick_period_ns == 0 {
            let period = run.facts.origin.manifest.get("tick_period_ns");
            period.and_then(|p| p.parse().ok()).unwrap_or(0)
        } else {
            run.tick_period_ns
        };
        Ok(Self {
            facts: run.facts,
            scenario,
            frames: frames.0.finish(),
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
            layers,
            marks,
            event_lists,
            series,
            timing,
            counts: run.counts,
            notes: run.notes,
            condition: run.condition,
        })
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
