//! Teams on a contour: distances between the robots, idleness of its places, and robots that fail.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use core::time::Duration;

use chaotic_maps::Key;
use geometry::map::{MapSpec, VectorMap};
use geometry::pose::Pose2;
use metrics::idleness::{Idleness, Ring};
use nalgebra::Point2;
use patrol::mission::Drive;
use patrol_planners::{PatrolAwg, PatrolAwgParams, PatrolFto, PatrolFtoParams};
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::{RobotView, ScanView, View};
use robot::spec::RobotSpec;
use robot::team::Role;
use sim_backend::spec::{RulesSpec, WorldSpec};
use sim_backend::world::World;

const TICK: Duration = Duration::from_millis(100);

/// Three contours that are driven in 120 s, all within (0, 0) and (20, 20).
const CONTOURS: [(&str, &[[f64; 2]]); 3] = [
    (
        "octagon",
        &[
            [7.0, 2.0],
            [2.0, 7.0],
            [2.0, 12.0],
            [7.0, 17.0],
            [12.0, 17.0],
            [17.0, 12.0],
            [17.0, 7.0],
            [12.0, 2.0],
        ],
    ),
    (
        "square",
        &[[3.0, 3.0], [3.0, 15.0], [15.0, 15.0], [15.0, 3.0]],
    ),
    (
        "angle",
        &[
            [2.0, 2.0],
            [18.0, 2.0],
            [18.0, 8.0],
            [8.0, 8.0],
            [8.0, 16.0],
            [2.0, 16.0],
        ],
    ),
];

enum Guard {
    Awg(Box<PatrolAwg>),
    Fto(Box<PatrolFto>),
}

impl Guard {
    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        match self {
            Self::Awg(guard) => guard.steer(map, view),
            Self::Fto(guard) => guard.steer(map, view),
        }
    }
}

/// A team in an empty world.
struct Team {
    world: World,
    map: PlannerMap,
    guards: Vec<Guard>,
    ring: Ring,
    /// `true` if the robots see each other.
    has_scans: bool,
    /// Robots that get no commands.
    failed: Vec<usize>,
}

/// Start of a robot: on a line within the contours.
fn pose(index: usize) -> Pose2 {
    Pose2::new(4.0 + 0.1 * index as f64, 4.0 + index as f64, 0.5)
}

fn spec(index: usize) -> RobotSpec {
    let mut spec = support::robot(pose(index));
    spec.name = format!("guard_{index}");
    spec
}

impl Team {
    fn new(contour: &[[f64; 2]], count: usize, more: &str, is_fto: bool) -> Self {
        let text = format!("mission = {{ contour = {contour:?}, t_max = 120.0, {more} }}");
        let companions: Vec<u32> = (0..count as u32).collect();
        let guard = |index: usize| {
            let (model, seed) = (spec(index).model(), index as u64);
            if is_fto {
                let params: PatrolFtoParams = toml::from_str(&text).unwrap();
                let drive = Drive::from_model(&model).unwrap();
                let guard = PatrolFto::new(&params, &drive, &model, seed).unwrap();
                Guard::Fto(Box::new(guard.in_team(&companions)))
            } else {
                let params: PatrolAwgParams = toml::from_str(&text).unwrap();
                let guard = PatrolAwg::new(&params, &model, seed).unwrap();
                Guard::Awg(Box::new(guard.in_team(&companions)))
            }
        };
        let world = World::new(WorldSpec {
            map: MapSpec::Vector(VectorMap::empty([0.0, 0.0], [20.0, 20.0], 0.1)),
            robots: (0..count).map(spec).collect(),
            rules: RulesSpec::default(),
            seed: 1,
        })
        .unwrap();
        let mut corners: Vec<Point2<f64>> = contour.iter().map(|&p| Point2::from(p)).collect();
        corners.push(corners[0]);
        Self {
            map: support::planner_map(&world),
            guards: (0..count).map(guard).collect(),
            ring: Ring::new(&corners).unwrap(),
            has_scans: false,
            failed: Vec::new(),
            world,
        }
    }

    fn positions(&self) -> Vec<Point2<f64>> {
        let robots = self.world.robots().iter();
        robots.map(|robot| robot.pose.position()).collect()
    }

    /// Drives until a time (s); `each` gets the positions after each tick.
    fn drive(&mut self, until_s: f64, mut each: impl FnMut(f64, &[Point2<f64>], &Ring)) {
        while self.world.time().as_secs_f64() < until_s {
            let robots: Vec<RobotView> = self
                .world
                .robots()
                .iter()
                .enumerate()
                .map(|(index, state)| RobotView {
                    index,
                    team: Role::Neutral.into(),
                    active: true,
                    present: true,
                    pose: state.pose,
                    twist: state.twist,
                    radius: state.radius(),
                    v_max: 1.0,
                })
                .collect();
            let (world, failed, has_scans) = (&self.world, &self.failed, self.has_scans);
            let mut ranges = Vec::new();
            let commands: Vec<_> = self
                .guards
                .iter_mut()
                .enumerate()
                .map(|(me, guard)| {
                    let scan = has_scans.then(|| *world.scan(me, &mut ranges).unwrap());
                    let view = View {
                        time_s: world.time().as_secs_f64(),
                        dt: TICK.as_secs_f64(),
                        me,
                        robots: &robots,
                        beliefs: &[],
                        exits: &[],
                        scan: scan.map(|scan| ScanView {
                            angle_min: scan.angle_min,
                            angle_increment: scan.angle_increment,
                            range_min: scan.range_min,
                            range_max: scan.range_max,
                            ranges: &ranges,
                        }),
                    };
                    let command = guard.steer(&self.map, &view).command;
                    (!failed.contains(&me)).then_some(command)
                })
                .collect();
            self.world.step(&commands, TICK);
            each(
                self.world.time().as_secs_f64(),
                &self.positions(),
                &self.ring,
            );
        }
    }
}

/// Drives to the end of a lap, and then for the rest of the time; returns the worst idleness (s) and the least distance
/// of two robots (m) in it.
fn measure(team: &mut Team, settled_s: f64, until_s: f64) -> (f64, f64) {
    team.drive(settled_s, |_, _, _| {});
    let count = team.guards.len();
    let failed = team.failed.clone();
    let mut idleness = Idleness::new(team.ring.clone(), count);
    team.drive(until_s, |time_s, positions, _| {
        let seen = |robot| (!failed.contains(&robot)).then(|| positions[robot]);
        idleness.add(time_s, (0..count).map(seen));
    });
    let figures = idleness.figures().unwrap();
    (figures.worst_s, figures.nearest_m.unwrap_or(f64::INFINITY))
}

#[test]
fn spread_guards_keep_their_distances_and_visit_every_place_in_time() {
    for (name, contour) in CONTOURS {
        for count in 2..=7 {
            let mut team = Team::new(contour, count, "", false);
            let length = team.ring.length();
            let (worst, least) = measure(&mut team, 150.0, 400.0);
            let part_s = 118.0 / count as f64;
            println!(
                "{name} {count}: {:.3} {:.3}",
                worst / part_s,
                least / length
            );
            assert!(worst <= 1.1 * part_s, "{name} {count}: {worst} s");
            assert!(least >= length / 8.0, "{name} {count}: {least} m");
        }
    }
}

#[test]
fn guards_past_fictive_obstacles_keep_their_distances_on_the_clock_of_the_team() {
    for count in [2, 5, 7] {
        let mut team = Team::new(CONTOURS[0].1, count, "", true);
        let length = team.ring.length();
        let (worst, least) = measure(&mut team, 150.0, 400.0);
        println!("{count}: {worst:.2} s, {:.3}", least / length);
        assert!(worst <= 1.1 * 118.0 / count as f64, "{count}: {worst} s");
        assert!(least >= length / 8.0, "{count}: {least} m");
    }
}

#[test]
fn guards_spread_from_where_they_stand() {
    let mut team = Team::new(CONTOURS[1].1, 4, "start = \"nearest\"", false);
    let length = team.ring.length();
    let (worst, least) = measure(&mut team, 200.0, 400.0);
    assert!(worst <= 1.1 * 118.0 / 4.0, "{worst} s");
    assert!(least >= length / 8.0, "{least} m");
    // From a waypoint of the contour, they drive in a convoy.
    let mut team = Team::new(CONTOURS[1].1, 4, "start = 2", false);
    let mut farthest = 0.0_f64;
    team.drive(100.0, |time_s, positions, ring| {
        if time_s > 50.0 {
            farthest = farthest.max(ring.between(positions[0], positions[3]));
        }
    });
    assert!(farthest < 0.1 * length, "{farthest} m");
}

#[test]
fn the_gap_of_a_guard_that_fails_is_closed_within_a_lap() {
    for count in [2, 3, 7] {
        let mut team = Team::new(CONTOURS[0].1, count, "", false);
        team.has_scans = true;
        team.drive(200.0, |_, _, _| {});
        team.failed = vec![1];
        let (worst, least) = measure(&mut team, 200.0 + 120.0, 560.0);
        let part_s = 118.0 / (count - 1) as f64;
        println!("{count}: {:.3}", worst / part_s);
        assert!(worst <= 1.1 * part_s, "{count}: {worst} s");
        assert!(least >= team.ring.length() / 8.0, "{count}: {least} m");
        // When it drives again, the team is complete within a lap.
        team.failed.clear();
        let (worst, _) = measure(&mut team, 560.0 + 120.0, 900.0);
        let part_s = 118.0 / count as f64;
        assert!(worst <= 1.1 * part_s, "{count}: {worst} s");
    }
}

#[test]
fn a_guard_that_fails_on_a_waypoint_delays_the_others_no_more_than_elsewhere() {
    for is_fto in [false, true] {
        let corners = CONTOURS[0].1;
        let mut team = Team::new(corners, 4, "", is_fto);
        team.has_scans = true;
        let mut now_s = 200.0;
        team.drive(now_s, |_, _, _| {});
        let is_on_a_corner = |team: &Team| {
            let apart = |corner: &[f64; 2]| (Point2::from(*corner) - team.positions()[1]).norm();
            corners.iter().any(|corner| apart(corner) < 0.15)
        };
        while !is_on_a_corner(&team) {
            now_s += TICK.as_secs_f64();
            assert!(now_s < 320.0, "no corner is passed");
            team.drive(now_s, |_, _, _| {});
        }
        team.failed = vec![1];
        let (worst, least) = measure(&mut team, now_s + 120.0, now_s + 400.0);
        println!("{is_fto}: {worst:.2} s, {:.3}", least / team.ring.length());
        assert!(worst <= 1.1 * 118.0 / 3.0, "{is_fto}: {worst} s");
        assert!(least >= team.ring.length() / 5.0, "{is_fto}: {least} m");
    }
}

#[test]
fn a_guard_alone_begins_at_the_given_waypoint_or_the_nearest_place() {
    for (start, expected) in [("2", [15.0, 15.0]), ("\"nearest\"", [3.0, 4.0])] {
        let mut team = Team::new(CONTOURS[1].1, 1, &format!("start = {start}"), false);
        let mut nearest = f64::INFINITY;
        team.drive(20.0, |_, positions, _| {
            nearest = nearest.min((positions[0] - Point2::from(expected)).norm());
        });
        assert!(nearest < 0.3, "{start}: {nearest}");
        let Guard::Awg(guard) = &team.guards[0] else {
            panic!("a zig-zag");
        };
        assert!(guard.set_out_s().is_some());
    }
    let text = "mission = { contour = [[0, 0], [9, 0]], start = 2 }";
    let params: PatrolAwgParams = toml::from_str(text).unwrap();
    let refused = PatrolAwg::new(&params, &spec(0).model(), 1).unwrap_err();
    let expected = "`start` is 2: expected the index of one of the 2 waypoints of `contour`";
    assert!(refused.to_string().contains(expected), "{refused}");
}

#[test]
fn a_given_key_is_that_of_the_team() {
    let keys = |more: &str| -> Vec<Key> {
        let mut team = Team::new(CONTOURS[1].1, 3, more, false);
        team.drive(0.5, |_, _, _| {});
        let guards = team.guards.iter();
        guards
            .map(|guard| match guard {
                Guard::Awg(guard) => guard.mission().key,
                Guard::Fto(guard) => guard.mission().key,
            })
            .collect()
    };
    let team: Key = "catp:0.4,0.644".parse().unwrap();
    let given = format!("key = \"{team}\"");
    assert_eq!(keys(&given), [0, 1, 2].map(|robot| team.of_robot(robot)));
    // A convoy is no team.
    assert_eq!(keys(&format!("{given}, start = 0")), [team; 3]);
}
