//! The recording of robots in a bag of ROS 2, as the log of a run whose processes can be tested.
//!
//! [`import()`] runs a scenario on the map of the bag. Its robots do not obey their planners: at each tick they are where the bag has
//! them, with the scans of the bag. All processes step as in any run, so that the log has their answers, too.

mod bag;
mod error;
mod frames;
mod samples;

#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::iter::StepBy;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use geometry::map::MapSpec;
use geometry::math::wrap_angle;
use geometry::pose::{Pose2, Twist2};
use mcap_log::{Origin, ReadProgress};
use mission::MissionReport;
use mission::in_process::{self, InProcessOptions, Track};
use robot::spec::{RobotSpec, ScanSpec};
use scenario::files::Base;
use scenario::kind::Kind;
use scenario::{Loader, ResolvedScenario};
use serde::Serialize;

use self::bag::{Bag, MessageType, namespace};
pub use self::error::{ImportError, MessageFault};
use self::frames::Frames;
use self::samples::Samples;

/// Options of an import.
#[derive(Debug, Clone)]
pub struct ImportOptions {
    /// Topics that differ from the default ones: `ROBOT/odom=TOPIC`, `ROBOT/scan=TOPIC`, `map=TOPIC`.
    pub topics: Vec<String>,
    /// Largest time between a tick and the message that is nearest to it (s), ≥ 0.
    pub max_age_s: f64,
    /// Path of the log.
    pub out: PathBuf,
    /// `true` if an existing log may be overwritten.
    pub force: bool,
}

/// What was imported.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ImportReport {
    /// The bag.
    pub bag: PathBuf,
    /// Time of the first tick, in the stamps of the bag (s).
    pub start_s: f64,
    /// Last tick with messages of all topics; the rules of the scenario may end the run earlier.
    pub last_tick: u64,
    /// Topic of the map, if it was recorded.
    pub map: Option<String>,
    /// The robots that follow the bag.
    pub robots: Vec<ImportedRobot>,
    /// Names of the robots that are simulated: the bag does not have them.
    pub simulated: Vec<String>,
    /// Remarks about frames.
    pub remarks: Vec<String>,
    /// Faults of the files.
    pub faults: Vec<String>,
}

/// A robot that follows a bag.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ImportedRobot {
    /// Its name.
    pub robot: String,
    /// Its topics, by what they are: `odom`, `scan`.
    pub topics: BTreeMap<&'static str, ImportedTopic>,
}

/// A topic of a robot.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ImportedTopic {
    /// Its name in the bag.
    pub topic: String,
    /// Number of its messages.
    pub messages: usize,
    /// Largest time between a tick and the nearest message (s).
    pub max_age_s: f64,
}

/// Names that the topics of a scenario may have in a bag.
struct Names<'a> {
    given: BTreeMap<&'a str, &'a str>,
    is_alone: bool,
}

impl<'a> Names<'a> {
    fn new(scenario: &ResolvedScenario, topics: &'a [String]) -> Result<Self, ImportError> {
        let robots = || scenario.world.robots.iter().map(|robot| &robot.name);
        let known = || robots().flat_map(|name| [format!("{name}/odom"), format!("{name}/scan")]);
        let known: Vec<String> = known().chain(["map".to_owned()]).collect();
        let given = topics.iter().map(|text| {
            let parts = text.split_once('=');
            let is_known = |(name, _): &(&str, &str)| known.iter().any(|known| known == name);
            let refused = || ImportError::Option {
                text: text.clone(),
                known: known.join(", "),
            };
            parts.filter(is_known).ok_or_else(refused)
        });
        Ok(Self {
            given: given.collect::<Result<_, _>>()?,
            is_alone: robots().count() == 1,
        })
    }

    /// The names of a topic, the first one that the bag has counts.
    fn of(&self, name: &str) -> Vec<String> {
        if let Some(given) = self.given.get(name) {
            return vec![(*given).to_owned()];
        }
        let root = name.split_once('/').filter(|_| self.is_alone);
        let root = root.map(|(_, last)| format!("/{last}"));
        [format!("/{name}")].into_iter().chain(root).collect()
    }
}

/// A robot with its messages in the bag.
struct Recorded<'b> {
    robot: usize,
    odometry: (&'b String, &'b Samples<(Pose2, Twist2)>),
    scan: Option<(&'b String, &'b Samples<Arc<[f32]>>)>,
}

impl Recorded<'_> {
    /// The times of the first and last message of its topics (ns).
    fn spans(&self) -> impl Iterator<Item = (i64, i64)> {
        let scan = self.scan.map(|(_, scan)| scan.span());
        [Some(self.odometry.1.span()), scan].into_iter().flatten()
    }
}

/// Runs a scenario with its robots where a bag has them; returns the scenario of the run, too. Libraries that it names are
/// loaded.
///
/// # Errors
/// [`ImportError`]: the bag is unreadable, lacks the robots, or does not fit the scenario; or the run fails.
pub fn import(
    path: &Path,
    scenario: &ResolvedScenario,
    kinds: &[Kind],
    options: &ImportOptions,
    watch: &mut ReadProgress,
) -> Result<(ResolvedScenario, ImportReport, MissionReport), ImportError> {
    let names = Names::new(scenario, &options.topics)?;
    let robots = &scenario.world.robots;
    let of = |robot: &RobotSpec, last: &str| names.of(&format!("{}/{last}", robot.name));
    let mut wanted = BTreeMap::new();
    let mut want = |names: Vec<String>, of| wanted.extend(names.into_iter().map(|name| (name, of)));
    want(names.of("map"), MessageType::Map);
    for robot in robots {
        want(of(robot, "odom"), MessageType::Odometry);
        want(of(robot, "scan"), MessageType::Scan);
    }
    let bag = Bag::read(path, &wanted, watch)?;
    let recorded = robots.iter().enumerate().filter_map(|(index, robot)| {
        Some(Recorded {
            robot: index,
            odometry: first(&bag.odometry, &of(robot, "odom"))?,
            scan: first(&bag.scans, &of(robot, "scan")),
        })
    });
    let recorded: Vec<Recorded<'_>> = recorded.collect();
    let unread = names.given.values().find(|topic| !bag.has_messages(topic));
    if recorded.is_empty() || unread.is_some() {
        let odometry = || robots.iter().flat_map(|robot| of(robot, "odom"));
        let wanted = unread.map_or_else(|| odometry().collect(), |topic| vec![(*topic).to_owned()]);
        return Err(ImportError::Missing {
            bag: path.to_owned(),
            wanted: wanted.join(", "),
            known: bag.known(),
        });
    }
    let spans = recorded.iter().flat_map(Recorded::spans);
    let (start, end) = spans.fold((i64::MIN, i64::MAX), |all, span| {
        (all.0.max(span.0), all.1.min(span.1))
    });
    let period = ((scenario.run.dt * 1e9).round() as i64).max(1);
    if end < start {
        return Err(ImportError::Apart {
            bag: path.to_owned(),
        });
    }
    let mut changed = scenario.clone();
    let map = first(&bag.maps, &names.of("map"));
    if let Some((_, (_, cells))) = map {
        changed.world.map = MapSpec::Cells(cells.clone());
    }
    let mut following = Following {
        path,
        frames: &bag.frames,
        map: map.map_or("map", |(_, (frame, _))| frame),
        ticks: (start..=end).step_by(period as usize),
        max_age_s: options.max_age_s,
        remarks: Vec::new(),
    };
    let (mut tracks, mut imported) = (Vec::new(), Vec::new());
    for recorded in &recorded {
        if let Some(spec) = changed.world.robots.get_mut(recorded.robot) {
            let (track, topics) = following.follow(recorded, spec)?;
            tracks.push(track);
            imported.push(ImportedRobot {
                robot: spec.name.clone(),
                topics,
            });
        }
    }
    let is_imported = |robot: &&RobotSpec| imported.iter().any(|it| it.robot == robot.name);
    let simulated = robots.iter().filter(|robot| !is_imported(robot));
    let report = ImportReport {
        bag: path.to_owned(),
        start_s: start as f64 / 1e9,
        last_tick: ((end - start) / period) as u64,
        map: map.map(|(topic, _)| topic.clone()),
        simulated: simulated.map(|robot| robot.name.clone()).collect(),
        robots: imported,
        remarks: following.remarks,
        faults: bag.faults,
    };
    let text = changed.to_toml();
    let fitted = Loader::new(kinds).load_text("scenario.toml", &text, &Base::Nothing, &[], None);
    let fitted = fitted.map_err(|problems| ImportError::Scenario {
        bag: path.to_owned(),
        problems,
    })?;
    let options = InProcessOptions {
        out: Some(options.out.clone()),
        force: options.force,
        show: !watch.quiet,
        last_tick: Some(report.last_tick),
        interrupted: Arc::clone(&watch.interrupted),
        libraries: true,
        tracks,
        source: Some((Origin::IMPORTED, path.display().to_string())),
        ..InProcessOptions::default()
    };
    let run = in_process::run(&fitted, &options);
    let run = run.map_err(|error| ImportError::Run(Box::new(error)))?;
    Ok((fitted, report, run))
}

/// Returns the first of these topics that has messages.
fn first<'b, T>(all: &'b BTreeMap<String, T>, topics: &[String]) -> Option<(&'b String, &'b T)> {
    topics.iter().find_map(|topic| all.get_key_value(topic))
}

/// Makes robots follow their messages.
struct Following<'a> {
    path: &'a Path,
    frames: &'a Frames,
    /// Frame of the map.
    map: &'a str,
    /// Times of the ticks (ns).
    ticks: StepBy<RangeInclusive<i64>>,
    max_age_s: f64,
    remarks: Vec<String>,
}

impl Following<'_> {
    /// Returns what a robot does, and its topics; gives it its start and its scanner.
    fn follow(
        &mut self,
        recorded: &Recorded<'_>,
        spec: &mut RobotSpec,
    ) -> Result<(Track, BTreeMap<&'static str, ImportedTopic>), ImportError> {
        let (topic, odometry) = recorded.odometry;
        let namespace = namespace(topic);
        let mut track = Track {
            robot: recorded.robot,
            ..Track::default()
        };
        let (found, used) =
            odometry.at_ticks(self.ticks.clone(), self.max_age_s, (self.path, topic))?;
        let mut topics = BTreeMap::from([("odom", used)]);
        let mut is_placed = true;
        for (at, (pose, twist)) in found {
            let frame = self.place(namespace, &odometry.frame, self.map, *at)?;
            is_placed &= frame.is_some();
            track
                .poses
                .push((frame.unwrap_or_default().placed(pose), *twist));
        }
        if !is_placed {
            self.take_as_same(spec, &odometry.frame, self.map);
        }
        if let Some((start, _)) = track.poses.first() {
            spec.start = *start;
        }
        let Some((topic, scan)) = recorded.scan else {
            return Ok((track, topics));
        };
        let (found, used) =
            scan.at_ticks(self.ticks.clone(), self.max_age_s, (self.path, topic))?;
        topics.insert("scan", used);
        track.scans = found
            .into_iter()
            .map(|(_, ranges)| Arc::clone(ranges))
            .collect();
        let mount = self.place(namespace, &scan.frame, &odometry.child, scan.span().0)?;
        if mount.is_none() {
            self.take_as_same(spec, &scan.frame, &odometry.child);
        }
        let mount = mount.unwrap_or_default();
        let offset = mount.position().coords.norm();
        if offset > 0.0 {
            self.remarks.push(format!(
                "{}: its scanner is {offset:.3} m off its centre, from where scans are taken here",
                spec.name
            ));
        }
        spec.scan = scan.scanner.map(|scanner| ScanSpec {
            angle_min: match mount.theta {
                0.0 => scanner.angle_min,
                turn => wrap_angle(scanner.angle_min + turn),
            },
            ..scanner
        });
        Ok((track, topics))
    }

    fn place(
        &self,
        namespace: &str,
        frame: &str,
        within: &str,
        at: i64,
    ) -> Result<Option<Pose2>, ImportError> {
        let found = self.frames.place(namespace, frame, within, at);
        found.map_err(|frame| ImportError::Tilted {
            bag: self.path.to_owned(),
            frame,
        })
    }

    fn take_as_same(&mut self, robot: &RobotSpec, frame: &str, within: &str) {
        self.remarks.push(format!(
            "{}: no transform from {frame} to {within} in the bag: taken as the same",
            robot.name
        ));
    }
}
