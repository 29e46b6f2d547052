//! Reading of a log for a picture.

use std::collections::BTreeMap;
use std::path::Path;

use geometry::pose::Pose2;
use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::perception::{BeliefHeader, Particle};
use ipc_types::messages::world::{RobotState, WorldEvent};
use ipc_types::topics::{
    Belief, Coverage, Dominance, Plan, TopicId, Tree, Verdicts, Waypoints, WorldEvents,
};
use mcap_log::{Condition, LogReadError, ReadProgress};

use super::layers::Layers;
use super::trace::{BeliefTrace, Mark, MarkKind, RobotTrace, RunTrace};
use super::trail::{Trail, TrailPoint};
use crate::run_model::{LoggedRun, Purpose, is_near};
use crate::run_model::{PlaceTrace, TaskTrace};
use scenario::spec::MAX_ROBOTS;

/// Maximum number of events that are marked.
const MAX_MARKS: usize = 64;
/// Maximum number of particles that are stored of a belief.
const MAX_PARTICLES: usize = 1000;

impl RunTrace {
    /// Reads the content of a picture of the run at simulated time `at` (s), or at its end if `at`
    /// is `None`.
    ///
    /// Reads the log up to its end or the first damaged record, in memory that does not grow with
    /// its length.
    ///
    /// # Errors
    /// [`LogReadError`]: the file is missing, is not a Protean log of this version, or ends before
    /// `at`.
    pub fn read(
        log: &Path,
        at: Option<f64>,
        watch: &mut ReadProgress,
    ) -> Result<(Self, Condition), LogReadError> {
        // Times of ticks are rounded to nanoseconds: the margin of 0.5 us includes the tick at
        // `at`.
        let until_ns = at.map_or(u64::MAX, |at| (at * 1e9 + 500.0) as u64);
        let (mut trails, mut marks) = (Trails::default(), Marks::default());
        let mut ended = TaskTrace::default();
        let mut moment = Moment {
            is_shown: at.is_some(),
            ..Moment::default()
        };
        let run = LoggedRun::read(
            log,
            Purpose::Picture { until_ns },
            vec![
                Box::new(&mut trails),
                Box::new(&mut marks),
                Box::new(&mut moment),
                Box::new(&mut ended),
            ],
            watch,
        )?;
        let (mut trace, condition) = finish(log, at, run, trails, moment)?;
        ended.finish();
        (trace.task.waypoints, trace.task.swept) = (ended.waypoints, ended.swept);
        trace.marks = marks.0;
        Ok((trace, condition))
    }
}

/// Poses of the robots over time.
#[derive(Default)]
struct Trails(Vec<RobotRecord>);

/// Events with a position.
#[derive(Default)]
struct Marks(Vec<Mark>);

/// Beliefs, plans, verdicts and dominance regions at a moment.
#[derive(Default)]
struct Moment {
    /// `true` for a picture of a moment; a picture of the end shows none of them.
    is_shown: bool,
    /// Beliefs with their times (ns), by robot.
    beliefs: BTreeMap<usize, (u64, BeliefTrace)>,
    layers: Layers,
}

/// The state of a robot, from the messages read so far.
#[derive(Debug, Clone, Default)]
struct RobotRecord {
    trail: Trail,
    pose: Pose2,
    active: bool,
    present: bool,
}

impl Consumer<LoggedRun> for Trails {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::WorldState]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, run: &mut LoggedRun) {
        for state in &run.states {
            self.state(message.time_s(), state);
        }
    }
}

impl Trails {
    fn state(&mut self, time_s: f64, state: &RobotState) {
        let robot = state.robot as usize;
        if robot >= self.0.len() {
            self.0.resize_with(robot + 1, RobotRecord::default);
        }
        let Some(seen) = self.0.get_mut(robot) else {
            return;
        };
        seen.present = true;
        seen.active = state.status == 0;
        seen.pose = Pose2::new(state.x, state.y, state.theta);
        seen.trail.push(TrailPoint {
            x: state.x,
            y: state.y,
            time_s,
        });
    }
}

impl Consumer<LoggedRun> for Marks {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::WorldEvents]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, run: &mut LoggedRun) {
        if let Some((_, events)) = run.decode::<WorldEvents>(message) {
            for event in &events {
                self.event(message.time_s(), event);
            }
        }
    }
}

impl Marks {
    fn event(&mut self, time_s: f64, event: &WorldEvent) {
        let kind = match WorldEvent::name_of(event.kind) {
            "captured" => MarkKind::Captured,
            "escaped" => MarkKind::Escaped,
            "goal_reached" => MarkKind::GoalReached,
            _ => return,
        };
        if self.0.len() < MAX_MARKS && is_near([event.x, event.y]) {
            self.0.push(Mark {
                kind,
                robot: event.robot as usize,
                at: [event.x, event.y],
                time_s,
            });
        }
    }
}

impl Consumer<LoggedRun> for Moment {
    fn topics(&self) -> &[TopicId] {
        if self.is_shown {
            &[
                TopicId::Belief,
                TopicId::Plan,
                TopicId::Tree,
                TopicId::Dominance,
                TopicId::Verdicts,
            ]
        } else {
            &[]
        }
    }

    fn message(&mut self, message: &LoggedMessage<'_>, run: &mut LoggedRun) {
        if let Some((header, particles)) = run.decode::<Belief>(message) {
            self.belief(message.time_ns, &header, &particles);
        }
        if let Some((header, points)) = run.decode::<Plan>(message)
            && (header.robot as usize) < MAX_ROBOTS
        {
            let state = run.states.iter().find(|s| s.robot == header.robot);
            let at = state.map(|s| [s.x, s.y]);
            self.layers.plan(header.robot as usize, at, &points);
        }
        if let Some((header, edges)) = run.decode::<Tree>(message)
            && (header.robot as usize) < MAX_ROBOTS
        {
            self.layers.tree(header.robot as usize, &edges);
        }
        if let Some((header, cells)) = run.decode::<Dominance>(message) {
            self.layers.dominance(&header, &cells);
        }
        if let Some((_, verdicts)) = run.decode::<Verdicts>(message) {
            let known = verdicts
                .iter()
                .filter(|verdict| (verdict.robot as usize) < MAX_ROBOTS);
            known.for_each(|verdict| self.layers.verdict(verdict));
        }
    }
}

impl Moment {
    fn belief(&mut self, time_ns: u64, header: &BeliefHeader, particles: &[Particle]) {
        let robot = header.robot as usize;
        if robot >= MAX_ROBOTS || !is_near([header.mean_x, header.mean_y]) {
            return;
        }
        let step = particles.len().div_ceil(MAX_PARTICLES).max(1);
        let belief = BeliefTrace {
            robot,
            mean: [header.mean_x, header.mean_y],
            particles: particles
                .iter()
                .step_by(step)
                .map(|p| [p.x, p.y])
                .filter(|p| is_near(p.map(f64::from)))
                .collect(),
        };
        self.beliefs.insert(robot, (time_ns, belief));
    }
}

impl Consumer<LoggedRun> for TaskTrace {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::Waypoints, TopicId::Coverage]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, run: &mut LoggedRun) {
        if let Some((_, ends)) = run.decode::<Waypoints>(message) {
            for end in ends.iter().filter(|end| is_near([end.x, end.y])) {
                self.waypoint(end);
            }
        }
        if let Some((_, reports)) = run.decode::<Coverage>(message) {
            self.swept = reports.last().map(|report| report.coverable_fraction);
        }
    }
}

fn finish(
    log: &Path,
    at: Option<f64>,
    mut run: LoggedRun,
    trails: Trails,
    moment: Moment,
) -> Result<(RunTrace, Condition), LogReadError> {
    let scenario = run.facts.take_scenario(log)?;
    let end_s = seconds(run.end_ns);
    if let Some(at) = at
        && !(0.0..=end_s + 1e-6).contains(&at)
    {
        return Err(LogReadError::Argument(format!(
            "--at {at}: expected a time from 0 to the end of the run, {end_s} s"
        )));
    }
    let now_ns = run.now_ns.ok_or_else(|| LogReadError::Foreign {
        path: log.to_owned(),
        missing: "message of world/state",
    })?;
    let mut static_scene = run.facts.take_static_scene(&scenario);
    let changes = run.changes.into_iter();
    changes.for_each(|(_, change)| static_scene.apply(change));

    let tasks = run.facts.run.map_or_else(Vec::new, |run| run.tasks);
    let mut task = scenario.task(&tasks);
    task.places = run.patrols.iter().flat_map(PlaceTrace::of_patrol).collect();
    let unseen = std::iter::repeat_with(RobotRecord::default);
    let seen = trails.0.into_iter().chain(unseen);
    let robots = scenario.robots.iter().enumerate().zip(seen);
    let robots = robots.map(|((index, spec), seen)| RobotTrace {
        radius: spec.model().radius,
        sweeps: scenario.sweeps(index, &tasks),
        name: spec.name.clone(),
        team: spec.team.clone(),
        role: spec.role(),
        pose: if seen.present { seen.pose } else { spec.start },
        active: seen.active || !seen.present,
        trail: seen.trail,
    });
    let robots: Vec<RobotTrace> = robots.collect();
    let plays = |robot: usize| robots.get(robot).is_some_and(|r| r.active);
    let mut layers = moment.layers;
    layers.keep(plays);
    let manifest = &run.facts.origin.manifest;
    let entry = |key| manifest.get(key).cloned().unwrap_or_default();
    let trace = RunTrace {
        title: scenario.title,
        description: scenario.description,
        scenario: entry("scenario"),
        seed: entry("seed"),
        time_s: at.unwrap_or_else(|| seconds(now_ns)),
        end_s,
        static_scene,
        robots,
        // The last belief about a robot that has left the game is out of date.
        beliefs: moment
            .beliefs
            .into_values()
            .filter(|(time, _)| time + 2 * run.tick_period_ns >= now_ns)
            .map(|(_, belief)| belief)
            .collect(),
        plans: layers.plans.into_values().collect(),
        trees: layers.trees.into_values().collect(),
        dominance: layers.dominance,
        verdicts: layers.verdicts.into_values().collect(),
        marks: Vec::new(),
        task,
    };
    Ok((trace, run.condition))
}

fn seconds(ns: u64) -> f64 {
    ns as f64 / 1e9
}
