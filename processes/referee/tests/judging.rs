//! The referee in the paper's city.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use geometry::pose::Pose2;
use geometry::region::Region;
use navigation::dominance::Owner;
use planner_view::view::RobotView;
use proptest::prelude::*;
use referee::{Game, Referee, RefereeParams};
use robot::spec::{Preset, RobotModel};
use robot::team::{Role, Team};
use testing::{Arena, EXIT};

fn robot(index: usize, role: Role, x: f64, y: f64) -> RobotView {
    let v_max = if role == Role::Evader { 0.45 } else { 0.3 };
    testing::robot(index, role, Pose2::new(x, y, 0.0), v_max)
}

fn game() -> Game {
    let exit = Region::Circle {
        center: [EXIT.x, EXIT.y],
        radius: 0.5,
    };
    let model = RobotModel {
        v_max: 0.45,
        ..Preset::Turtlebot3Burger.model()
    };
    Game {
        exits: vec![exit],
        capture: 0.3,
        models: vec![model; 10],
        dt: testing::DT,
    }
}

fn referee() -> Referee {
    Referee::new(RefereeParams::default(), game())
}

#[test]
fn only_evaders_that_play_are_judged_and_only_police_that_play_count() {
    let map = Arena::city().map();
    let mut robots = [
        robot(0, Role::Pursuer, 8.5, 0.0),
        robot(1, Role::Evader, 4.5, 0.0),
        robot(2, Role::Evader, 4.5, 4.5),
    ];
    robots[2].active = false;
    let mut referee = referee();
    let judged = referee.judge(&map, &robots).to_vec();
    assert_eq!(judged.len(), 1);
    assert_eq!(judged[0].robot, 1);
    assert!(!judged[0].verdict.escape_possible);
    let (arena, cells) = referee.cells(&map).unwrap();
    let at_exit = arena.lattice().frame().index_at(EXIT).unwrap();
    assert_eq!(
        (cells[at_exit].owner, cells[at_exit].first),
        (Owner::Police, 0)
    );
    let at_evader = arena
        .lattice()
        .frame()
        .index_at(robots[1].pose.position())
        .unwrap();
    assert_eq!(
        (cells[at_evader].owner, cells[at_evader].first),
        (Owner::Evader, 1)
    );
    robots[0].active = false;
    assert!(referee.judge(&map, &robots)[0].verdict.escape_possible);
}

/// The pursuer catches from afar, and without catching is too far from the way to the exit to be in it.
#[test]
fn an_evader_is_judged_against_the_pursuers_of_hostile_teams() {
    let map = Arena::city().map();
    let mut robots = [
        robot(0, Role::Pursuer, 7.5, 4.5),
        robot(1, Role::Evader, 4.5, 0.0),
        robot(2, Role::Evader, 4.5, 0.5),
    ];
    let possible = |robots: &[RobotView]| {
        let game = Game {
            capture: 2.0,
            ..game()
        };
        let mut referee = Referee::new(RefereeParams::default(), game);
        let judged = referee.judge(&map, robots).to_vec();
        assert!(referee.cells(&map).is_some());
        judged
            .iter()
            .map(|judgement| (judgement.robot, judgement.verdict.escape_possible))
            .collect::<Vec<_>>()
    };
    assert_eq!(possible(&robots), [(1, false), (2, false)]);
    // Three teams; the pursuer is hostile to robot 2.
    let roles = robots.map(|robot| robot.team.role);
    let is_hostile = |i: usize, j: usize| (i.min(j), i.max(j)) == (0, 2);
    let teams = Team::of_robots(3, |i| roles[i], |i, j| i == j, is_hostile);
    for (robot, team) in robots.iter_mut().zip(teams) {
        robot.team = team;
    }
    assert_eq!(possible(&robots), [(1, true), (2, false)]);
}

/// Half a turn at 0.2 rad/s takes 16 s: enough for a pursuer to come to the exit.
#[test]
fn a_robot_that_turns_slowly_is_not_told_that_it_escapes() {
    let map = Arena::city().map();
    let robots = [
        robot(0, Role::Pursuer, 7.5, 6.0),
        robot(1, Role::Evader, 4.5, 0.0),
    ];
    assert!(referee().judge(&map, &robots)[0].verdict.escape_possible);
    let mut game = game();
    game.models[1].omega_max = 0.2;
    let mut referee = Referee::new(RefereeParams::default(), game);
    let verdict = referee.judge(&map, &robots)[0].verdict;
    assert!(
        !verdict.escape_possible && verdict.time == f64::INFINITY,
        "{verdict:?}"
    );
}

/// A caught robot stays where it is, and 0.21 m from it is contact.
#[test]
fn a_body_that_fills_the_way_out_lets_nothing_through() {
    let mut city = Arena::city();
    city.rectangles
        .extend([(8.0, 9.0, 0.25, 1.25), (8.0, 9.0, -1.25, -0.25)]);
    let map = city.map();
    let mut robots = [
        robot(0, Role::Evader, 8.5, 0.0),
        robot(1, Role::Evader, 7.5, 0.0),
    ];
    robots[0].active = false;
    assert!(!referee().judge(&map, &robots)[0].verdict.escape_possible);
    robots[0].present = false;
    assert!(referee().judge(&map, &robots)[0].verdict.escape_possible);
}

#[test]
fn a_new_map_changes_the_verdict() {
    let mut arena = Arena::city();
    let map = arena.map();
    let robots = [
        robot(0, Role::Pursuer, 7.5, 6.0),
        robot(1, Role::Evader, 4.5, 0.0),
    ];
    let mut referee = referee();
    assert!(referee.judge(&map, &robots)[0].verdict.escape_possible);
    arena.rectangles.push((8.0, 9.0, -1.25, 1.25));
    let blocked = arena.map();
    let blocked = planner_view::map::PlannerMap::new(
        blocked.blurred().clone(),
        blocked.clearance_grid().clone(),
        map.revision() + 1,
    )
    .unwrap();
    let verdict = referee.judge(&blocked, &robots)[0].verdict;
    assert!(
        !verdict.escape_possible && verdict.margin == f64::NEG_INFINITY,
        "{verdict:?}"
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn finite_or_not_inputs_give_finite_numbers(numbers in prop::collection::vec(prop::num::f64::ANY, 20)) {
        let map = Arena::city().map();
        let robots: Vec<RobotView> = (0..4)
            .map(|i| RobotView {
                radius: numbers[5 * i + 3],
                v_max: numbers[5 * i + 4],
                ..robot(i, [Role::Pursuer, Role::Evader][i % 2], numbers[5 * i], numbers[5 * i + 1])
            })
            .chain([robot(9, Role::Evader, 1.5, 1.5)])
            .collect();
        let mut referee = referee();
        let judged = referee.judge(&map, &robots).to_vec();
        prop_assert!(judged.iter().any(|judgement| judgement.robot == 9));
        for judgement in judged {
            prop_assert!(!judgement.verdict.margin.is_nan());
            prop_assert!((0.0..=1.0).contains(&judgement.verdict.area_share));
        }
    }
}
