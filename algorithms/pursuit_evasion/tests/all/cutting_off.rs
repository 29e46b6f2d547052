//! Police that cut evaders off in the paper's city.

use std::collections::VecDeque;

use crate::police::{CATCH, V_POLICE, exact, police, view};
use geometry::pose::{Pose2, Twist2};
use nalgebra::Point2;
use navigation::routes::{NavGrid, RouteFinder};
use planner_view::limits::Limits;
use planner_view::view::{RobotView, View};
use pursuit_evasion::pursuit::cut_off::{CutSearch, EvaderState, ExitBlocker};
use pursuit_evasion::pursuit::params::AssignmentMethod;
use pursuit_evasion::pursuit::{Pursuer, PursuerParams};
use robot::team::Role;
use testing::{CITY, DT, EXIT, Kinematic, RADIUS, street_starts};

fn evader(index: usize, pose: Pose2, v_max: f64) -> RobotView {
    RobotView {
        team: Role::Evader.into(),
        twist: Twist2 {
            v: v_max,
            omega: 0.0,
        },
        v_max,
        ..police(index, pose)
    }
}

fn cutting_off() -> PursuerParams {
    let mut params = exact();
    params.assignment.method = AssignmentMethod::CutOff;
    params
}

fn pursuer(params: &PursuerParams) -> Pursuer {
    let limits = Limits::new(V_POLICE, V_POLICE, 2.84).unwrap();
    Pursuer::new(*params, limits, 5).unwrap()
}

#[test]
fn every_pursuer_comes_to_the_same_targets_and_places() {
    let map = &CITY.1;
    let starts = street_starts();
    for game in 0..12 {
        let pose = |i: usize| starts[(game * 7 + i * 11) % starts.len()];
        let mut robots: Vec<_> = (0..4).map(|i| police(i, pose(i))).collect();
        robots.push(evader(4, pose(5), 0.45));
        robots.push(evader(5, pose(6), 0.45));
        let decided: Vec<_> = (0..4)
            .map(|me| pursuer(&cutting_off()).command(map, &view(1.0, me, &robots, &[])))
            .map(|steering| (steering.target.unwrap(), steering.aim.unwrap()))
            .collect();
        for evader in [4, 5] {
            let aims: Vec<_> = decided.iter().filter(|d| d.0 == evader).collect();
            assert_eq!(aims.len(), 2, "fair shares: {decided:?}");
            assert!((aims[0].1 - aims[1].1).norm() > 0.1, "{decided:?}");
        }
    }
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
    }
    println!("cuts by size: {sizes:?}");
    assert!(sizes[1] < starts.len(), "some cuts are away from the exit");
}

#[test]
fn a_target_that_does_not_move_is_caught_by_pursuers_that_cut_it_off() {
    let (arena, map) = &*CITY;
    let params = cutting_off();
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
fn without_exits_there_is_nothing_to_cut() {
    let map = &CITY.1;
    let params = cutting_off();
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
