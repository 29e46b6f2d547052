//! Calibration of "escape possible": `calibration [LAYOUTS [FIRST_SEED]]`.
//!
//! Random layouts of the city with four Police that know all poses and two evaders of this kind. A
//! referee judges every second of the first twenty; the game goes on until every evader that was told
//! "escape possible" has escaped, is caught, or is out of time. Per speed and tactic of the Police, one
//! line: the evaders that were told so at the start and at all, how many of these escaped, and the 95 %
//! interval. Each that did not escape has a line of its own.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use evader_reach_avoid::ReachAvoidParams;
use evader_reach_avoid::process::ReachAvoidPlanner;
use geometry::blur::BlurredMap;
use geometry::map::{MapSpec, UnknownCells};
use geometry::pose::Pose2;
use nalgebra::Point2;
use planner::Planner as _;
use planner_view::free_space::FreeSpace;
use planner_view::map::PlannerMap;
use planner_view::view::{RobotView, View};
use pursuer::process::PursuerPlanner;
use pursuit_evasion::pursuit::PursuerParams;
use referee::{Game, Referee, RefereeParams};
use robot::spec::RobotSpec;
use robot::team::Role;
use runtime::config::RobotInfo;
use sim_backend::random::Stream;
use sim_backend::robot::RobotStatus;
use sim_backend::spec::{CaptureSpec, RulesSpec, WorldSpec};
use sim_backend::world::World;
use statistics::wilson;

const DT: f64 = 0.05;
const POLICE: usize = 4;
const EVADERS: usize = 2;
const POLICE_SPEED: f64 = 0.3;
const CAPTURE: f64 = 0.3;
const TIME_LIMIT_S: f64 = 120.0;

/// Least distance between two robots at the start (m).
const APART: f64 = 2.0;

/// Ticks between two verdicts.
const VERDICT_TICKS: u64 = 20;

/// Tick of the last verdict.
const LAST_VERDICT: u64 = 400;

/// Tactics of the Police, as parameters of `pursuer`.
const TACTICS: [(&str, &str); 2] = [
    (
        "follow the nearest",
        "knowledge = 'exact'\nassignment.knowledge = 'exact'",
    ),
    (
        "cut off",
        "knowledge = 'exact'\nassignment = { method = 'cut_off', knowledge = 'exact' }",
    ),
];

/// Numbers of evaders.
#[derive(Default)]
struct Counts {
    evaders: u64,
    told_at_start: u64,
    told: u64,
    escaped_of_told: u64,
}

fn city() -> MapSpec {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/maps/city.toml");
    let file = MapSpec::File {
        path,
        unknown: UnknownCells::default(),
    };
    file.load(Path::new(""))
        .expect("the city is part of the repository")
}

/// A random layout: robots anywhere within the walls where they fit, and apart.
fn world(map: &MapSpec, seed: u64, relative_speed: f64) -> World {
    let mut random = Stream::new(seed, 0, 0);
    let mut poses: Vec<Pose2> = Vec::new();
    loop {
        let robots = poses.iter().enumerate().map(|(i, &pose)| {
            let (role, v_max) = if i < POLICE {
                (Role::Pursuer, POLICE_SPEED)
            } else {
                (Role::Evader, POLICE_SPEED * relative_speed)
            };
            let mut robot = RobotSpec::new(&format!("robot_{i}"), role, pose);
            robot.limits.v_max = Some(v_max);
            robot.limits.v_reverse_max = Some(v_max);
            robot
        });
        let spec = WorldSpec {
            map: map.clone(),
            robots: robots.collect(),
            rules: RulesSpec {
                capture: Some(CaptureSpec {
                    radius: CAPTURE,
                    ..CaptureSpec::default()
                }),
                time_limit: Some(TIME_LIMIT_S),
                ..RulesSpec::default()
            },
            seed,
        };
        // A place in a wall is drawn again.
        let world = World::new(spec);
        if poses.len() == POLICE + EVADERS
            && let Ok(world) = world
        {
            return world;
        }
        if world.is_err() {
            poses.pop();
        }
        let mut uniform = |half: f64| (2.0 * random.uniform() - 1.0) * half;
        let pose = Pose2::new(uniform(8.0), uniform(8.0), uniform(core::f64::consts::PI));
        if poses
            .iter()
            .all(|other| (other.position() - pose.position()).norm() >= APART)
        {
            poses.push(pose);
        }
    }
}

fn planner_map(world: &World) -> PlannerMap {
    let map = world.map();
    let mut free = map.occupancy().clone();
    free.cells.iter_mut().for_each(|cell| *cell = !*cell);
    let blurred = BlurredMap::new(&free, 0.19).expect("a sane map");
    let space = FreeSpace::new(map.parts().to_vec(), *map.bounds(), map.frame().resolution);
    PlannerMap::new(blurred, map.clearance().clone(), 1)
        .expect("a sane map")
        .with_space(Arc::new(space.expect("a sane map")))
        .shared()
}

fn views(world: &World, views: &mut Vec<RobotView>) {
    views.clear();
    views.extend(
        world
            .robots()
            .iter()
            .enumerate()
            .map(|(index, robot)| RobotView {
                index,
                team: robot.team,
                active: robot.status == RobotStatus::Active,
                present: world.is_present(index),
                pose: robot.pose,
                twist: robot.twist,
                radius: robot.model.radius,
                v_max: robot.model.v_max,
            }),
    );
}

fn info(world: &World, index: usize) -> RobotInfo {
    let robot = &world.robots()[index];
    RobotInfo {
        name: format!("robot_{index}"),
        team: robot.team_name.clone(),
        role: robot.team.role,
        opponents: (0..)
            .zip(world.robots())
            .filter(|(_, other)| robot.team.is_hostile_to(other.team))
            .map(|(index, _)| index)
            .collect(),
        companions: Vec::new(),
        model: robot.model,
        beams: 0,
        start: robot.pose,
        goal: None,
    }
}

/// Plays a layout and counts its evaders.
fn play(
    mut world: World,
    map: &PlannerMap,
    tactic: &PursuerParams,
    seed: u64,
    counts: &mut Counts,
) {
    let exits = world.exits().to_vec();
    let centres: Vec<Point2<f64>> = exits.iter().map(geometry::region::Region::center).collect();
    let mut police: Vec<PursuerPlanner> = Vec::new();
    let mut evaders: Vec<ReachAvoidPlanner> = Vec::new();
    for index in 0..POLICE + EVADERS {
        let info = info(&world, index);
        if index < POLICE {
            let mut planner = PursuerPlanner::new(tactic, &info, seed).expect("sane limits");
            planner.rules(&exits, CAPTURE);
            planner.prepare(map, &info);
            police.push(planner);
        } else {
            let params = ReachAvoidParams::default();
            let mut planner = ReachAvoidPlanner::new(&params, &info, seed).expect("sane limits");
            planner.rules(&exits, CAPTURE);
            planner.prepare(map, &info);
            evaders.push(planner);
        }
    }
    let game = Game {
        exits: exits.clone(),
        capture: CAPTURE,
        models: world.robots().iter().map(|robot| robot.model).collect(),
        dt: DT,
    };
    let mut referee = Referee::new(RefereeParams::default(), game);
    let mut robots = Vec::new();
    let mut told: [Option<u64>; POLICE + EVADERS] = [None; POLICE + EVADERS];
    for tick in 0.. {
        views(&world, &mut robots);
        let judged = tick <= LAST_VERDICT;
        let open = |robot: &RobotView| {
            robot.active
                && robot.team.role == Role::Evader
                && (judged || told[robot.index].is_some())
        };
        if !robots.iter().any(open) {
            break;
        }
        if judged && tick % VERDICT_TICKS == 0 {
            for judged in referee.judge(map, &robots) {
                if judged.verdict.escape_possible {
                    told[judged.robot].get_or_insert(tick);
                }
            }
        }
        let mut commands = Vec::new();
        for me in 0..robots.len() {
            let view = View {
                time_s: tick as f64 * DT,
                dt: DT,
                me,
                robots: &robots,
                beliefs: &[],
                exits: &centres,
                scan: None,
            };
            let steering = if me < POLICE {
                police[me].steer(map, &view)
            } else {
                evaders[me - POLICE].steer(map, &view)
            };
            commands.push(Some(steering.command));
        }
        world.step(&commands, Duration::from_secs_f64(DT));
    }
    for (index, told) in told.iter().enumerate().skip(POLICE) {
        let escaped = world.robots()[index].status == RobotStatus::Escaped;
        counts.evaders += 1;
        counts.told += u64::from(told.is_some());
        counts.told_at_start += u64::from(*told == Some(0));
        counts.escaped_of_told += u64::from(told.is_some() && escaped);
        if let Some(tick) = told
            && !escaped
        {
            let robot = &world.robots()[index];
            println!(
                "  seed {seed}: robot_{index} told at {:.2} s: {:?} at {:.2} s, ({:.2}, {:.2}), {} contacts",
                *tick as f64 * DT,
                robot.status,
                robot.finished_at.unwrap_or_default().as_secs_f64(),
                robot.pose.x,
                robot.pose.y,
                robot.contacts.robot,
            );
        }
    }
}

fn main() {
    let mut numbers = std::env::args()
        .skip(1)
        .filter_map(|word| word.parse::<u64>().ok());
    let layouts = numbers.next().unwrap_or(1000);
    let first = numbers.next().unwrap_or(1);
    let map = city();
    let shared = planner_map(&world(&map, 1, 1.0));
    for (name, text) in TACTICS {
        let tactic: PursuerParams = toml::from_str(text).expect("parameters of `pursuer`");
        for relative_speed in [1.0, 1.25, 1.5, 2.0] {
            let mut counts = Counts::default();
            for seed in first..first + layouts {
                play(
                    world(&map, seed, relative_speed),
                    &shared,
                    &tactic,
                    seed,
                    &mut counts,
                );
            }
            let Counts {
                evaders,
                told_at_start,
                told,
                escaped_of_told,
            } = counts;
            let interval = wilson(escaped_of_told, told);
            println!(
                "{name}, {relative_speed}x: {evaders} evaders, told possible {told} \
                 ({told_at_start} at the start), escaped of these {escaped_of_told}: {:.4} ({:.4} to {:.4})",
                escaped_of_told as f64 / told.max(1) as f64,
                interval.low,
                interval.high,
            );
        }
    }
}
