//! The recording of robots in a bag of ROS 2, as the log of a run whose processes can be tested.
//!
//! [`import()`] runs a scenario on the map of the bag. Its robots do not obey their planners: at each tick they are where the bag has
//! them, with the scans of the bag. All processes step as in any run, so that the log has their answers, too.

mod bag;
mod frames;

#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::iter::StepBy;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use geometry::grid::{Grid, GridFrame};
use geometry::map::{CellMap, MapSpec};
use geometry::math::wrap_angle;
use geometry::pose::Twist2;
use mcap_log::{LogReadError, Origin, ReadProgress};
use mission::MissionReport;
use mission::in_process::{self, InProcessOptions, Track};
use robot::spec::{RobotSpec, ScanSpec};
use ros_messages::messages::{LaserScan, OccupancyGrid, Odometry};
use ros_messages::upright_pose;
use scenario::files::Base;
use scenario::kind::Kind;
use scenario::{Loader, ResolvedScenario};
use serde::Serialize;

use self::bag::{Bag, MessageType, Samples, namespace};
use self::frames::Frames;
use crate::ReplayError;
pub use crate::bag_fault::BagFault;

/// Least value of an occupied cell of a map; a negative value is an unknown cell.
const OCCUPIED: i8 = 50;

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

/// Summary of an import.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ImportReport {
    /// Time of the first tick, in the headers of the bag (s).
    pub start_s: f64,
    /// Last tick with messages of all topics; the rules of the scenario may end the run earlier.
    pub last_tick: u64,
    /// Topics of the bag and their numbers of messages, by what they are: `ROBOT/odom`, `ROBOT/scan`, `map`.
    pub topics: BTreeMap<String, (String, usize)>,
    /// Names of the robots that are simulated: the bag does not have them.
    pub simulated: Vec<String>,
    /// Remarks about frames.
    pub remarks: Vec<String>,
    /// Faults of the files.
    pub faults: Vec<String>,
}

/// Returns the topics that a scenario may have in a bag, with what they are.
fn wanted(
    robots: &[RobotSpec],
    given: &[String],
) -> Result<BTreeMap<String, (String, MessageType)>, LogReadError> {
    let mut names = vec![("map".to_owned(), MessageType::Map)];
    for robot in robots {
        names.push((format!("{}/odom", robot.name), MessageType::Odometry));
        names.push((format!("{}/scan", robot.name), MessageType::Scan));
    }
    let mut topics = BTreeMap::new();
    for name in &names {
        topics.insert(format!("/{}", name.0), name.clone());
        if let ([_], Some((_, last))) = (robots, name.0.split_once('/')) {
            topics.insert(format!("/{last}"), name.clone());
        }
    }
    for text in given {
        let (wanted, topic) = text.split_once('=').unwrap_or_default();
        let name = names.iter().find(|(name, _)| name == wanted);
        let name = name.ok_or_else(|| {
            let known: Vec<&str> = names.iter().map(|(name, _)| &**name).collect();
            LogReadError::Argument(format!(
                "--topic {text}: expected NAME=TOPIC with NAME one of {}",
                known.join(", ")
            ))
        })?;
        topics.retain(|_, known| known != name);
        topics.insert(topic.to_owned(), name.clone());
    }
    Ok(topics)
}

/// A robot with its messages in the bag.
struct Recorded<'b> {
    robot: usize,
    odometry: &'b Samples<Odometry>,
    scans: Option<&'b Samples<LaserScan>>,
}

/// Runs a scenario with its robots where a bag has them; returns the scenario of the run, too. Libraries that it names are
/// loaded.
///
/// # Errors
/// [`ReplayError`]: the bag is unreadable, lacks the robots, or does not fit the scenario; or the run fails.
pub fn import(
    path: &Path,
    scenario: &ResolvedScenario,
    kinds: &[Kind],
    options: &ImportOptions,
    watch: &mut ReadProgress,
) -> Result<(ResolvedScenario, ImportReport, MissionReport), ReplayError> {
    let refuse = |fault| ReplayError::Bag {
        path: path.to_owned(),
        fault,
    };
    let mut changed = scenario.clone();
    let wanted = wanted(&changed.world.robots, &options.topics)?;
    let bag = Bag::read(path, &wanted, watch)?;
    let (mut recorded, mut simulated) = (Vec::new(), Vec::new());
    for (robot, spec) in changed.world.robots.iter().enumerate() {
        let scans = bag.scans.get(&format!("{}/scan", spec.name));
        match bag.odometry.get(&format!("{}/odom", spec.name)) {
            Some(odometry) => recorded.push(Recorded {
                robot,
                odometry,
                scans,
            }),
            None => simulated.push(spec.name.clone()),
        }
    }
    let mut given = options
        .topics
        .iter()
        .filter_map(|text| text.split_once('='));
    let unread = given.find(|(name, _)| !bag.topics.contains_key(*name));
    if recorded.is_empty() || unread.is_some() {
        let odometry = wanted
            .iter()
            .filter(|(_, (_, of))| *of == MessageType::Odometry);
        let odometry: Vec<&str> = odometry.map(|(topic, _)| &**topic).collect();
        return Err(refuse(BagFault::Missing {
            wanted: unread.map_or_else(|| odometry.join(", "), |(_, topic)| topic.to_owned()),
            known: bag.known.join(", "),
        }));
    }
    // All topics have messages from the first tick to the last.
    let spans = recorded
        .iter()
        .flat_map(|it| [Some(it.odometry.span()), it.scans.map(Samples::span)]);
    let (start, end) = spans.flatten().fold((i64::MIN, i64::MAX), |all, span| {
        (all.0.max(span.0), all.1.min(span.1))
    });
    if end < start {
        return Err(refuse(BagFault::Apart));
    }
    let period = ((scenario.run.dt * 1e9).round() as i64).max(1);
    let mut map = "map";
    if let Some(maps) = bag.maps.get("map")
        && let Some((at, message)) = maps.list.last()
    {
        let expected = "an origin without rotation, and width × height cells";
        let cells = cells(message).ok_or_else(|| refuse(maps.unusable(*at, expected)))?;
        changed.world.map = MapSpec::Cells(cells);
        map = &message.header.frame_id;
    }
    let mut following = Following {
        frames: &bag.frames,
        map,
        ticks: (start..=end).step_by(period as usize),
        max_age_s: options.max_age_s,
        remarks: Vec::new(),
    };
    let mut tracks = Vec::new();
    for recorded in &recorded {
        if let Some(spec) = changed.world.robots.get_mut(recorded.robot) {
            tracks.push(following.follow(recorded, spec).map_err(refuse)?);
        }
    }
    let report = ImportReport {
        start_s: start as f64 / 1e9,
        last_tick: ((end - start) / period) as u64,
        simulated,
        remarks: following.remarks,
        topics: bag.topics,
        faults: bag.faults,
    };
    let text = changed.to_toml();
    let fitted = Loader::new(kinds).load_text("scenario.toml", &text, &Base::Nothing, &[], None);
    let fitted = fitted.map_err(|problems| refuse(BagFault::Scenario(problems)))?;
    let options = InProcessOptions {
        out: Some(options.out.clone()),
        force: options.force,
        show: !watch.quiet,
        last_tick: Some(report.last_tick),
        interrupted: Arc::clone(&watch.interrupted),
        external: true,
        tracks,
        source: Some((Origin::IMPORTED, path.display().to_string())),
        ..InProcessOptions::default()
    };
    let run = in_process::run(&fitted, &options)?;
    Ok((fitted, report, run))
}

/// Returns a map; `None` if it is turned or lacks cells.
fn cells(map: &OccupancyGrid) -> Option<CellMap> {
    let info = &map.info;
    let origin = &info.origin.position;
    let origin = upright_pose(origin.x, origin.y, &info.origin.orientation)?;
    let (width, height) = (info.width as usize, info.height as usize);
    let cells = map.data.iter();
    let cells = cells.map(|cell| !(0..OCCUPIED).contains(cell));
    let grid = Grid {
        frame: GridFrame {
            width,
            height,
            // The number that the map file had, such as 0.05.
            resolution: info.resolution.to_string().parse().ok()?,
            origin: origin.position(),
        },
        cells: cells.collect(),
    };
    let is_whole = origin.theta.abs() < 1e-6 && width.checked_mul(height) == Some(map.data.len());
    is_whole.then(|| CellMap::from_grid(&grid))
}

/// Returns the ranges of a scan as REP-117 has them; older drivers send 0 or NaN for beams that hit nothing.
fn ranges(scan: &LaserScan) -> Arc<[f32]> {
    let ranges = scan.ranges.iter().map(|range| match *range {
        0.0 => f32::INFINITY,
        range if range < scan.range_min => f32::NEG_INFINITY,
        range if range <= scan.range_max => range,
        _ => f32::INFINITY,
    });
    ranges.collect()
}

/// Makes robots follow their messages.
struct Following<'a> {
    frames: &'a Frames,
    /// Frame of the map.
    map: &'a str,
    /// Times of the ticks (ns).
    ticks: StepBy<RangeInclusive<i64>>,
    max_age_s: f64,
    remarks: Vec<String>,
}

impl Following<'_> {
    /// Returns what a robot does; gives it its start and its scanner.
    fn follow(&mut self, recorded: &Recorded<'_>, spec: &mut RobotSpec) -> Result<Track, BagFault> {
        let Recorded {
            robot,
            odometry,
            scans,
        } = *recorded;
        let namespace = namespace(&odometry.topic);
        let scanner = scans.and_then(|scans| Some((scans, &scans.list.first()?.1)));
        let mut track = Track {
            robot,
            ..Track::default()
        };
        let mut disconnected = None;
        let mut base = "";
        for tick in self.ticks.clone() {
            let (at, message) = odometry.nearest(tick, self.max_age_s)?;
            base = &message.child_frame_id;
            let frame = &message.header.frame_id;
            let place = self.frames.place(namespace, frame, self.map, *at);
            disconnected = disconnected.or(place.is_none().then_some(frame));
            let (pose, twist) = (&message.pose.pose, &message.twist.twist);
            let pose = upright_pose(pose.position.x, pose.position.y, &pose.orientation);
            let twist = Twist2::new(twist.linear.x, twist.angular.z);
            let Some(pose) = pose.filter(|_| twist.is_finite()) else {
                let expected = "finite numbers, and a rotation about the vertical axis";
                return Err(odometry.unusable(*at, expected));
            };
            let pose = place.unwrap_or_default().placed(&pose);
            track.poses.push((pose, twist));
            if let Some((scans, first)) = scanner {
                let (at, scan) = scans.nearest(tick, self.max_age_s)?;
                if scan.ranges.len() != first.ranges.len() || scan.angle_min != first.angle_min {
                    return Err(scans.unusable(*at, "the beams of the first message"));
                }
                track.scans.push(ranges(scan));
            }
        }
        if let Some(frame) = disconnected {
            self.take_as_same(&spec.name, frame, self.map);
        }
        if let Some((start, _)) = track.poses.first() {
            spec.start = *start;
        }
        if let Some((scans, scan)) = scanner {
            let frame = &scan.header.frame_id;
            let mount = self.frames.place(namespace, frame, base, scans.span().0);
            if mount.is_none() {
                self.take_as_same(&spec.name, frame, base);
            }
            let mount = mount.unwrap_or_default();
            let offset = mount.position().coords.norm();
            if offset > 0.0 {
                self.remarks.push(format!(
                    "{}: its scanner is {offset:.3} m off its centre, from where scans are taken here",
                    spec.name
                ));
            }
            spec.scan = Some(ScanSpec {
                beams: scan.ranges.len(),
                angle_min: wrap_angle(f64::from(scan.angle_min) + mount.theta),
                angle_increment: f64::from(scan.angle_increment),
                range_min: f64::from(scan.range_min),
                range_max: f64::from(scan.range_max),
                noise: 0.0,
            });
        }
        Ok(track)
    }

    fn take_as_same(&mut self, robot: &str, frame: &str, within: &str) {
        self.remarks.push(format!(
            "{robot}: no upright transform from {frame} to {within} in the bag: taken as the same"
        ));
    }
}
