//! The recording of robots in a bag of ROS 2, as the log of a run whose processes can be tested.
//!
//! [`import()`] runs a scenario on the map of the bag. Its robots do not obey their planners: at each tick they are where the bag has
//! them, with the scans of the bag. All processes step as in any run, so that the log has their answers, too.

mod bag;
mod error;
mod frames;
mod samples;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use geometry::math::wrap_angle;
use geometry::pose::{Pose2, Twist2};
use mcap_log::{Origin, ReadProgress};
use mission::in_process::{self, InProcessOptions, Track};
use mission::{MissionError, MissionReport};
use scenario::files::Base;
use scenario::kind::Kind;
use scenario::{Loader, ResolvedScenario};
use serde::Serialize;

use self::bag::{Bag, MessageType};
pub use self::error::{ImportError, MessageFault};
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

/// Runs a scenario with its robots where a bag has them; returns the scenario of the run, too. Libraries that it names are
/// loaded.
///
/// # Errors
/// [`ImportError`]: the bag is unreadable, lacks the robots, or does not fit the scenario; or the run fails.
pub fn import(
    bag_path: &Path,
    scenario: &ResolvedScenario,
    kinds: &[Kind],
    options: &ImportOptions,
    watch: &mut ReadProgress,
) -> Result<(ResolvedScenario, ImportReport, MissionReport), ImportError> {
    let names = Names::new(scenario, &options.topics)?;
    let robots = &scenario.world.robots;
    let mut wanted = BTreeMap::new();
    let mut want =
        |name: &str, of| wanted.extend(names.of(name).into_iter().map(|name| (name, of)));
    want("map", MessageType::Map);
    for robot in robots {
        want(&format!("{}/odom", robot.name), MessageType::Odometry);
        want(&format!("{}/scan", robot.name), MessageType::Scan);
    }
    let bag = Bag::read(bag_path, &wanted, watch)?;
    let mut recorded = Vec::new();
    for (index, robot) in robots.iter().enumerate() {
        let odometry = bag.first(&bag.odometry, &names.of(&format!("{}/odom", robot.name)));
        let scan = bag.first(&bag.scans, &names.of(&format!("{}/scan", robot.name)));
        recorded.extend(odometry.map(|odometry| Recorded {
            robot: index,
            odometry,
            scan,
        }));
    }
    let missing = names.given.values().find(|topic| !bag.has_messages(topic));
    if recorded.is_empty() || missing.is_some() {
        let odometry = || {
            robots
                .iter()
                .flat_map(|robot| names.of(&format!("{}/odom", robot.name)))
        };
        return Err(ImportError::Missing {
            bag: bag_path.to_owned(),
            wanted: missing.map_or_else(
                || odometry().collect::<Vec<_>>().join(", "),
                |topic| (*topic).to_owned(),
            ),
            known: bag.known(),
        });
    }
    let map = bag.first(&bag.maps, &names.of("map"));
    let in_map = map.map_or("map", |(_, (frame, _))| frame);

    // All topics have messages from the first tick to the last.
    let spans = recorded.iter().flat_map(|it| {
        [
            Some(it.odometry.1.span()),
            it.scan.map(|(_, scan)| scan.span()),
        ]
    });
    let (start, end) = spans.flatten().fold((i64::MIN, i64::MAX), |all, span| {
        (all.0.max(span.0), all.1.min(span.1))
    });
    let period = ((scenario.run.dt * 1e9).round() as i64).max(1);
    if end < start {
        return Err(ImportError::Apart {
            bag: bag_path.to_owned(),
        });
    }
    let ticks = || (start..=end).step_by(period as usize);

    let mut changed = scenario.clone();
    if let Some((_, (_, cells))) = map {
        changed.world.map = geometry::map::MapSpec::Cells(cells.clone());
    }
    let (mut remarks, mut tracks, mut imported) = (Vec::new(), Vec::new(), Vec::new());
    for Recorded {
        robot,
        odometry: (topic, odometry),
        scan,
    } in recorded
    {
        let Some(spec) = changed.world.robots.get_mut(robot) else {
            continue;
        };
        let namespace = bag::namespace(topic);
        let place = |frame: &str, within: &str, at: i64| {
            let found = bag.frames.place(namespace, frame, within, at);
            found.map_err(|frame| ImportError::Tilted {
                bag: bag_path.to_owned(),
                frame,
            })
        };
        let mut topics = BTreeMap::new();
        let mut at_ticks = Vec::new();
        let sampled =
            odometry.at_ticks(ticks(), options.max_age_s, (bag_path, topic), &mut at_ticks)?;
        topics.insert("odom", sampled);
        let mut track = Track {
            robot,
            ..Track::default()
        };
        let mut is_placed = true;
        for (at, (pose, twist)) in at_ticks {
            let frame = place(&odometry.frame, in_map, *at)?;
            is_placed &= frame.is_some();
            track
                .poses
                .push((frame.unwrap_or_default().placed(pose), *twist));
        }
        let mut unplaced = |frame: &str, within: &str| {
            remarks.push(format!(
                "{}: no transform from {frame} to {within} in the bag: taken as the same",
                spec.name
            ));
        };
        if !is_placed {
            unplaced(&odometry.frame, in_map);
        }
        if let Some((topic, scan)) = scan {
            let mut at_ticks = Vec::new();
            topics.insert(
                "scan",
                scan.at_ticks(ticks(), options.max_age_s, (bag_path, topic), &mut at_ticks)?,
            );
            track.scans = at_ticks
                .into_iter()
                .map(|(_, ranges)| Arc::clone(ranges))
                .collect();
            let mount = place(&scan.frame, &odometry.child, start)?;
            if mount.is_none() {
                unplaced(&scan.frame, &odometry.child);
            }
            let mount = mount.unwrap_or_default();
            let offset = mount.position().coords.norm();
            if offset > 0.0 {
                remarks.push(format!(
                    "{}: its scanner is {offset:.3} m off its centre, where scans of a run are taken", spec.name
                ));
            }
            spec.scan = scan.scanner.map(|mut scanner| {
                if mount.theta != 0.0 {
                    scanner.angle_min = wrap_angle(scanner.angle_min + mount.theta);
                }
                scanner
            });
        }
        if let Some((pose, _)) = track.poses.first() {
            spec.start = *pose;
        }
        imported.push(ImportedRobot {
            robot: spec.name.clone(),
            topics,
        });
        tracks.push(track);
    }
    let fitted = Loader::new(kinds).load_text(
        "scenario.toml",
        &changed.to_toml(),
        &Base::Nothing,
        &[],
        None,
    );
    let fitted = fitted.map_err(|problems| ImportError::Scenario {
        bag: bag_path.to_owned(),
        problems,
    })?;
    let report = ImportReport {
        bag: bag_path.to_owned(),
        start_s: start as f64 / 1e9,
        last_tick: ((end - start) / period) as u64,
        map: map.map(|(topic, _)| topic.clone()),
        simulated: robots
            .iter()
            .map(|robot| robot.name.clone())
            .filter(|name| imported.iter().all(|it| it.robot != *name))
            .collect(),
        robots: imported,
        remarks,
        faults: bag.faults,
    };
    let run = in_process::run(
        &fitted,
        &InProcessOptions {
            out: Some(options.out.clone()),
            force: options.force,
            show: !watch.quiet,
            last_tick: Some(report.last_tick),
            interrupted: Arc::clone(&watch.interrupted),
            libraries: true,
            tracks,
            source: Some((Origin::IMPORTED, bag_path.display().to_string())),
            ..InProcessOptions::default()
        },
    );
    let run = run.map_err(|error: MissionError| ImportError::Run(error.into()))?;
    Ok((fitted, report, run))
}
