//! Interception, guards and cuts in the paper's city.

use std::collections::VecDeque;

use crate::police::{CATCH, V_POLICE, exact, police, view};
use crate::support::{CITY, DT, EXIT, Kinematic, RADIUS, street_starts};
use geometry::pose::{Pose2, Twist2};
use nalgebra::Point2;
use navigation::routes::{NavGrid, RouteFinder};
use planner_view::limits::Limits;
use planner_view::view::{BeliefView, ParticleView, RobotView, View};
use pursuer::cut_off::{CutSearch, EvaderState, ExitBlocker};
use pursuer::exit_guard::ExitGuards;
use pursuer::params::{AssignmentMethod, GoalMethod, Knowledge, RoleParams};
use pursuer::{Pursuer, PursuerParams};
use sim_backend::team::Team;

const EXIT_RADIUS: f64 = 0.5;

fn evader(index: usize, pose: Pose2, v_max: f64) -> RobotView {
    RobotView {
        team: Team::Evader,
        twist: Twist2 {
            v: v_max,
            omega: 0.0,
        },
        v_max,
        ..police(index, pose)
    }
}

fn intercepting() -> PursuerParams {
    let mut params = exact();
    params.goals.method = GoalMethod::Interception;
    params
}

fn guarding() -> PursuerParams {
    let mut params = exact();
    params.roles.exit_guard = 1;
    params
}

fn pursuer(params: &PursuerParams) -> Pursuer {
    let limits = Limits::new(V_POLICE, V_POLICE, 2.84).unwrap();
    Pursuer::new(*params, limits, 5).unwrap()
}

/// Runner on its shortest path to the exit that ignores all other robots.
struct Runner {
    way: Vec<(Point2<f64>, f64)>,
    speed: f64,
}

impl Runner {
    fn new(from: Point2<f64>, speed: f64) -> Self {
        let map = &CITY.1;
        let mut finder = RouteFinder::default();
        finder.prepare(map, RADIUS);
        let mut way = Vec::new();
        let routes = finder.lengths(map, 0, from, [EXIT]).unwrap();
        routes.way_to(EXIT, &mut way);
        Self { way, speed }
    }

    fn at(&self, time: f64) -> Pose2 {
        let run = time * self.speed;
        let next = self.way.partition_point(|&(_, length)| length <= run);
        let next = next.clamp(1, self.way.len() - 1);
        let ((a, from), (b, to)) = (self.way[next - 1], self.way[next]);
        let share = ((run - from) / (to - from)).min(1.0);
        let at = a + (b - a) * share;
        let theta = geometry::math::atan2(b.y - a.y, b.x - a.x);
        Pose2::new(at.x, at.y, theta)
    }
}

/// Returns the time at which one pursuer from `start` catches a runner before it is out, if it
/// does.
fn hunt(params: &PursuerParams, start: Pose2, runner: &Runner) -> Option<f64> {
    let (arena, map) = &*CITY;
    let mut pursuer = pursuer(params);
    let mut body = Kinematic::new(start.x, start.y, start.theta);
    let mut time = 0.0;
    loop {
        let target = runner.at(time);
        if (target.position() - EXIT).norm() < EXIT_RADIUS {
            return None;
        }
        if (target.position() - body.pose.position()).norm() < CATCH {
            return Some(time);
        }
        let robots = [police(0, body.pose), evader(1, target, runner.speed)];
        // The clock is past the delay from the start.
        let steering = pursuer.command(map, &view(time + 1.0, 0, &robots, &[]));
        body.step(arena, steering.command, DT);
        time += DT;
    }
}

#[test]
fn interception_catches_no_fewer_runners_than_looking_ahead() {
    let starts: Vec<_> = street_starts().into_iter().step_by(3).collect();
    let (mut more, mut fewer) = (0, 0);
    for (from, to) in starts.iter().zip(starts.iter().rev().skip(4)) {
        let runner = Runner::new(from.position(), 0.4);
        let ahead = hunt(&exact(), *to, &runner);
        let met = hunt(&intercepting(), *to, &runner);
        more += u32::from(met.is_some());
        fewer += u32::from(ahead.is_some());
    }
    assert!(more >= fewer && fewer > 0, "{more} {fewer}");
}

#[test]
fn a_pursuer_ahead_of_a_runner_aims_at_its_way_and_one_that_is_late_looks_ahead() {
    let map = &CITY.1;
    // The target runs east in a street that the pursuer is not in.
    let target = evader(1, Pose2::new(-3.0, 1.5, 0.0), 0.45);
    let aim = |params: &PursuerParams, from: Pose2| {
        let robots = [police(0, from), target];
        let steering = pursuer(params).command(map, &view(1.0, 0, &robots, &[]));
        steering.aim.unwrap()
    };
    let from = Pose2::new(4.5, -1.5, 1.6);
    let met = aim(&intercepting(), from);
    assert!((met.y - 1.5).abs() < 0.5 && met.x > 1.0, "{met}");
    // No pursuer drives round the block behind it in time.
    let behind = Pose2::new(-7.5, -7.5, 0.0);
    assert_eq!(aim(&intercepting(), behind), aim(&exact(), behind));
}

#[test]
fn hypotheses_are_met_each_on_its_own_way() {
    let map = &CITY.1;
    let mut params = intercepting();
    params.knowledge = Knowledge::Belief;
    let robots = [
        police(0, Pose2::new(7.5, 0.0, 3.0)),
        evader(1, Pose2::new(-4.5, 7.5, 0.0), 0.45),
    ];
    let aim = |heavy: f32| {
        let particles =
            [(-4.5, 7.5, heavy), (-4.5, -7.5, 1.0)].map(|(x, y, weight)| ParticleView {
                x,
                y,
                theta: 0.0,
                weight,
            });
        let beliefs = [BeliefView {
            robot: 1,
            particles: &particles,
            mean: Pose2::new(-4.5, 0.0, 0.0),
            position_std: 7.5,
            seen: false,
        }];
        let steering = pursuer(&params).command(map, &view(1.0, 0, &robots, &beliefs));
        steering.aim.unwrap()
    };
    // The two paths are mirror images: the one with the higher weight attracts.
    assert!(aim(5.0).y > 0.5, "{}", aim(5.0));
    assert!(aim(0.2).y < -0.5, "{}", aim(0.2));
}

#[test]
fn a_guard_is_the_pursuer_nearest_to_the_exit_and_stays_one() {
    let map = &CITY.1;
    let mut robots: Vec<_> = [4.5, 1.4, -1.5, -4.5]
        .iter()
        .enumerate()
        .map(|(i, &y)| police(i, Pose2::new(7.5, y, 3.0)))
        .collect();
    robots.push(evader(4, Pose2::new(-4.5, 7.5, 0.0), 0.45));
    let mut finder = RouteFinder::default();
    finder.prepare(map, RADIUS);
    let mut guards = ExitGuards::new(RoleParams {
        exit_guard: 2,
        ..RoleParams::default()
    });
    guards.choose(map, &mut finder, &view(1.0, 0, &robots, &[]));
    assert_eq!(guards.guards(), [(1, 0), (2, 0)]);
    // Another comes nearer: no change. One drops out: the nearest of the rest replaces it.
    robots[0].pose.y = 0.2;
    guards.choose(map, &mut finder, &view(2.0, 0, &robots, &[]));
    assert_eq!(guards.guards(), [(1, 0), (2, 0)]);
    robots[1].active = false;
    guards.choose(map, &mut finder, &view(3.0, 0, &robots, &[]));
    assert_eq!(guards.guards(), [(0, 0), (2, 0)]);
}

#[test]
fn every_pursuer_comes_to_the_same_guards_targets_and_places() {
    let map = &CITY.1;
    let starts = street_starts();
    for game in 0..12 {
        let pose = |i: usize| starts[(game * 7 + i * 11) % starts.len()];
        let mut robots: Vec<_> = (0..5).map(|i| police(i, pose(i))).collect();
        robots.push(evader(5, pose(5), 0.45));
        robots.push(evader(6, pose(6), 0.45));
        let mut params = guarding();
        params.assignment.method = AssignmentMethod::CutOff;
        let choices: Vec<_> = (0..5)
            .map(|me| {
                let mut finder = RouteFinder::default();
                finder.prepare(map, RADIUS);
                let mut guards = ExitGuards::new(params.roles);
                guards.choose(map, &mut finder, &view(1.0, me, &robots, &[]));
                guards.guards().to_vec()
            })
            .collect();
        assert!(choices.windows(2).all(|pair| pair[0] == pair[1]));
        let guard = choices[0][0].0;
        let decided: Vec<_> = (0..5)
            .filter(|&me| me != guard)
            .map(|me| pursuer(&params).command(map, &view(1.0, me, &robots, &[])))
            .map(|steering| (steering.target.unwrap(), steering.aim.unwrap()))
            .collect();
        for evader in [5, 6] {
            let aims: Vec<_> = decided.iter().filter(|d| d.0 == evader).collect();
            assert_eq!(aims.len(), 2, "fair shares: {decided:?}");
            assert!((aims[0].1 - aims[1].1).norm() > 0.1, "{decided:?}");
        }
    }
}

#[test]
fn a_guard_stands_between_a_threat_and_the_exit() {
    let map = &CITY.1;
    for threat in [
        Point2::new(7.5, 1.5),
        Point2::new(7.5, -2.0),
        Point2::new(7.2, 0.1),
    ] {
        let robots = [
            police(0, Pose2::new(8.7, 0.0, 3.0)),
            evader(1, Pose2::new(threat.x, threat.y, 3.0), 0.6),
        ];
        let steering = pursuer(&guarding()).command(map, &view(1.0, 0, &robots, &[]));
        let guard_pose = steering.aim.unwrap();
        let (to_post, to_threat) = (guard_pose - EXIT, threat - EXIT);
        assert!(to_post.dot(&to_threat) > 0.0, "{guard_pose} for {threat}");
        assert!(to_post.norm() < to_threat.norm());
        assert_eq!(steering.target, None);
    }
}

#[test]
fn a_guard_leaves_only_for_a_certain_capture() {
    let map = &CITY.1;
    let comes = evader(1, Pose2::new(3.0, 1.5, 0.0), 0.3);
    let guard = police(0, Pose2::new(8.6, 0.0, 3.0));
    let target = |robots: &[RobotView]| {
        pursuer(&guarding())
            .command(map, &view(1.0, 0, robots, &[]))
            .target
    };
    assert_eq!(target(&[guard, comes]), Some(1));
    // Another target could be out before the guard is back.
    let lurks = evader(2, Pose2::new(7.5, 4.5, 0.0), 0.9);
    assert_eq!(target(&[guard, comes, lurks]), None);
    // The guard is itself too far from the exit.
    let away = police(0, Pose2::new(7.5, 7.5, 3.0));
    assert_eq!(target(&[away, comes]), None);
    // A capture by belief is not certain.
    let mut params = guarding();
    params.knowledge = Knowledge::Belief;
    let particles = [ParticleView {
        x: 3.0,
        y: 1.5,
        theta: 0.0,
        weight: 1.0,
    }];
    let mut belief = BeliefView {
        robot: 1,
        particles: &particles,
        mean: Pose2::new(3.0, 1.5, 0.0),
        position_std: 0.1,
        seen: false,
    };
    let robots = [guard, comes];
    let decide = |belief: BeliefView<'_>| {
        pursuer(&params)
            .command(map, &view(1.0, 0, &robots, &[belief]))
            .target
    };
    assert_eq!(decide(belief), None);
    belief.seen = true;
    assert_eq!(decide(belief), Some(1));
}

#[test]
fn a_guard_comes_to_rest_at_its_guard_pose() {
    let (arena, map) = &*CITY;
    let mut pursuer = pursuer(&guarding());
    let mut body = Kinematic::new(7.5, 1.5, 3.0);
    // Too fast to be met in time.
    let far = evader(1, Pose2::new(-7.5, 7.5, 0.0), 4.0);
    let mut last = 0.0;
    for tick in 0..300 {
        let time = 1.0 + f64::from(tick) * DT;
        let robots = [police(0, body.pose), far];
        let steering = pursuer.command(map, &view(time, 0, &robots, &[]));
        body.step(arena, steering.command, DT);
        last = (body.pose.position() - steering.aim.unwrap()).norm();
    }
    assert!(last < 0.08, "{last} m off");
    assert!(body.twist.v.abs() < 0.02, "{:?}", body.twist);
    assert_eq!(body.contacts, 0);
}

#[test]
fn no_evader_that_is_no_faster_gets_past_a_guard_and_few_who_are_twice_as_fast() {
    let mut past = Vec::new();
    let mut runners = 0;
    for start in street_starts().iter().step_by(4) {
        if (start.position() - EXIT).norm() < 4.0 {
            continue;
        }
        for speed in [0.3, 0.6, 0.9] {
            let runner = Runner::new(start.position(), speed);
            let caught = hunt(&guarding(), Pose2::new(8.6, 0.0, 3.0), &runner);
            runners += 1;
            if caught.is_none() {
                past.push((speed, start.position()));
            }
        }
    }
    println!("{} of {runners} got past: {past:?}", past.len());
    let twice_as_fast = past.iter().filter(|(speed, _)| *speed == 0.6).count();
    assert!(twice_as_fast * 2 < runners / 3, "{past:?}");
    // Only evaders that are faster than the guard.
    assert!(past.iter().all(|(speed, _)| *speed > V_POLICE), "{past:?}");
}

/// Returns `true` if a path leads from a place to the exit past the discs around these places.
fn gets_out(grid: &NavGrid, from: Point2<f64>, places: &[Point2<f64>], radius: f64) -> bool {
    let start = grid.node_at(from).unwrap();
    let exit = grid.node_at(EXIT).unwrap();
    let free = |node: usize| {
        let point = grid.point(node).unwrap();
        places.iter().all(|place| (point - place).norm() > radius)
    };
    let mut seen = vec![false; grid.len()];
    let mut queue = VecDeque::from([start]);
    while let Some(node) = queue.pop_front() {
        if node == exit {
            return true;
        }
        for edge in grid.edges(node) {
            let to = edge.to as usize;
            if !seen[to] && free(to) {
                seen[to] = true;
                queue.push_back(to);
            }
        }
    }
    false
}

#[test]
fn the_places_of_a_cut_separate_the_target_from_the_exit() {
    let map = &CITY.1;
    let mut finder = RouteFinder::default();
    finder.prepare(map, RADIUS);
    let mut search = CutSearch::default();
    let starts = street_starts();
    let mut sizes = [0; 4];
    for (i, start) in starts.iter().enumerate() {
        let blockers: Vec<_> = (0..4)
            .map(|b| ExitBlocker {
                at: starts[(i + 13 * b + 5) % starts.len()].position(),
                v_max: V_POLICE,
                slot: 20 + b,
            })
            .collect();
        let from = start.position();
        let runs = EvaderState {
            at: from,
            v_max: 0.45,
            guarded: false,
        };
        let cut = search.cut(map, &mut finder, [EXIT], &runs, &blockers, 0.75);
        assert!(cut.complete, "one place at the exit would do");
        assert!((1..=3).contains(&cut.places.len()), "one stays free");
        sizes[cut.places.len()] += 1;
        let grid = finder.grid().unwrap();
        assert!(gets_out(grid, from, &[], 0.75));
        assert!(
            !gets_out(grid, from, &cut.places, 0.75),
            "{from}: {:?}",
            cut.places
        );
        let again = search.cut(map, &mut finder, [EXIT], &runs, &blockers, 0.75);
        assert_eq!(again, cut);
        let guarded = EvaderState {
            guarded: true,
            ..runs
        };
        let cut = search.cut(map, &mut finder, [EXIT], &guarded, &blockers, 0.75);
        assert!((1..=3).contains(&cut.places.len()));
        let grid = finder.grid().unwrap();
        assert_eq!(cut.complete, !gets_out(grid, from, &cut.places, 0.75));
    }
    println!("cuts by size: {sizes:?}");
    assert!(sizes[1] < starts.len(), "some cuts are away from the exit");
}

#[test]
fn a_target_that_does_not_move_is_caught_by_pursuers_that_cut_it_off() {
    let (arena, map) = &*CITY;
    let mut params = exact();
    params.assignment.method = AssignmentMethod::CutOff;
    let target = evader(3, Pose2::new(-4.5, 4.5, 0.0), 0.45);
    let mut bodies = [7.5, 0.0, -7.5].map(|y| Kinematic::new(7.5, y, 3.1));
    let mut team = [(); 3].map(|()| pursuer(&params));
    for tick in 0..4000 {
        let time = 1.0 + f64::from(tick) * DT;
        let mut robots: Vec<_> = bodies
            .iter()
            .enumerate()
            .map(|(i, body)| police(i, body.pose))
            .collect();
        robots.push(target);
        if robots.iter().any(|robot| {
            robot.index != 3 && (robot.pose.position() - target.pose.position()).norm() < CATCH
        }) {
            return;
        }
        for (me, pursuer) in team.iter_mut().enumerate() {
            let steering = pursuer.command(map, &view(time, me, &robots, &[]));
            bodies[me].step(arena, steering.command, DT);
        }
    }
    let places = bodies.map(|body| body.pose);
    panic!("no runner reaches it in 200 s: {places:?}");
}

#[test]
fn without_exits_there_is_nothing_to_guard_or_to_cut() {
    let map = &CITY.1;
    let mut params = guarding();
    params.assignment.method = AssignmentMethod::CutOff;
    params.goals.method = GoalMethod::Interception;
    let robots = [
        police(0, Pose2::new(7.5, 1.5, 3.0)),
        evader(1, Pose2::new(-4.5, 7.5, 0.0), 0.45),
    ];
    let no_exits = View {
        exits: &[],
        ..view(1.0, 0, &robots, &[])
    };
    let steering = pursuer(&params).command(map, &no_exits);
    assert_eq!(steering.target, Some(1));
    let aim = steering.aim.unwrap();
    // Ahead of it in its street.
    assert!((aim.y - 7.5).abs() < 0.1 && aim.x > -4.6, "{aim}");
}

#[test]
fn guards_spread_over_the_exits() {
    let map = &CITY.1;
    let far_exit = Point2::new(-7.5, -7.5);
    let mut robots: Vec<_> = [(7.5, 1.5), (7.5, -1.5), (-4.5, -7.5)]
        .iter()
        .enumerate()
        .map(|(i, &(x, y))| police(i, Pose2::new(x, y, 0.0)))
        .collect();
    robots.push(evader(3, Pose2::new(1.5, 1.5, 0.0), 0.45));
    let two_exits = View {
        exits: &[EXIT, far_exit],
        ..view(1.0, 2, &robots, &[])
    };
    let mut finder = RouteFinder::default();
    finder.prepare(map, RADIUS);
    let mut guards = ExitGuards::new(RoleParams {
        exit_guard: 2,
        ..RoleParams::default()
    });
    guards.choose(map, &mut finder, &two_exits);
    let mut guarded = guards.guards().to_vec();
    guarded.sort_unstable_by_key(|guard| guard.1);
    assert!(guarded[0].0 < 2 && guarded[0].1 == 0, "{guarded:?}");
    assert_eq!(guarded[1], (2, 1));
    let mut params = guarding();
    params.roles.exit_guard = 2;
    let guard_pose = pursuer(&params).command(map, &two_exits).aim.unwrap();
    assert!((guard_pose - far_exit).norm() <= 1.0, "{guard_pose}");
}
