//! Pursuers in the paper's city, in a kinematic mini-simulation.

use crate::police::{CATCH, V_POLICE, exact, view};
use geometry::pose::{Pose2, Twist2};
use nalgebra::Point2;
use navigation::bearing::GoalField;
use planner_view::limits::Limits;
use planner_view::view::{BeliefView, ParticleView, RobotView};
use proptest::prelude::*;
use pursuit_evasion::pursuit::params::{AssignmentMethod, BeliefGoals, Knowledge};
use pursuit_evasion::pursuit::{Pursuer, PursuerParams};
use robot::team::Role;
use testing::{CITY, DT, Kinematic, RADIUS, street_starts};

fn robot(index: usize, role: Role, pose: Pose2) -> RobotView {
    testing::robot(index, role, pose, V_POLICE)
}

fn limits() -> Limits {
    Limits::new(V_POLICE, V_POLICE, 2.84).unwrap()
}

/// Chases a target that stands still; returns the time of capture, if any within `seconds`.
fn chase(params: &PursuerParams, body: &mut Kinematic, target: Pose2, seconds: f64) -> Option<f64> {
    let (arena, map) = &*CITY;
    let mut pursuer = Pursuer::new(*params, limits(), 5).unwrap();
    let mut time = 0.0;
    while time < seconds {
        let robots = [
            robot(0, Role::Pursuer, body.pose),
            robot(1, Role::Evader, target),
        ];
        let steering = pursuer.command(map, &view(time, 0, &robots, &[]));
        body.step(arena, steering.command, DT);
        time += DT;
        if (body.pose.position() - target.position()).norm() < CATCH {
            return Some(time);
        }
    }
    None
}

#[test]
fn a_pursuer_reaches_a_fixed_target_from_everywhere_without_touching_a_wall() {
    let target = Pose2::new(-1.5, 3.0, 0.7);
    for start in street_starts() {
        let mut body = Kinematic::new(start.x, start.y, start.theta);
        let time = chase(&exact(), &mut body, target, 120.0);
        assert!(time.is_some(), "from {start:?}, now {:?}", body.pose);
        assert_eq!(body.contacts, 0, "from {start:?}");
    }
}

#[test]
fn the_papers_straight_field_is_stopped_by_blocks() {
    let target = Pose2::new(-1.5, 3.0, 0.7);
    let starts = street_starts();
    let caught = |params: &PursuerParams| {
        starts
            .iter()
            .filter(|start| {
                let mut body = Kinematic::new(start.x, start.y, start.theta);
                chase(params, &mut body, target, 120.0).is_some()
            })
            .count()
    };
    let paper = caught(&PursuerParams::paper());
    let straight = caught(&PursuerParams {
        goal_field: GoalField::Straight,
        ..exact()
    });
    println!("of {}: paper {paper}, straight {straight}", starts.len());
    assert!(paper < starts.len() && straight < starts.len());
}

#[test]
fn no_robot_moves_before_the_delay_or_without_a_target() {
    let (_, map) = &*CITY;
    let mut pursuer = Pursuer::new(exact(), limits(), 5).unwrap();
    let mut robots = [
        robot(0, Role::Pursuer, Pose2::new(7.5, 1.5, 0.0)),
        robot(1, Role::Evader, Pose2::new(1.5, 1.5, 0.0)),
    ];
    let early = pursuer.command(map, &view(0.95, 0, &robots, &[]));
    assert_eq!((early.command, early.target), (Twist2::STOP, None));
    let later = pursuer.command(map, &view(1.0, 0, &robots, &[]));
    assert_eq!(later.target, Some(1));
    assert_ne!(later.command, Twist2::STOP);
    robots[1].active = false;
    let over = pursuer.command(map, &view(1.05, 0, &robots, &[]));
    assert_eq!((over.command, over.target), (Twist2::STOP, None));
}

#[test]
fn the_nearest_target_is_kept_until_it_leaves_the_game() {
    let (_, map) = &*CITY;
    let mut pursuer = Pursuer::new(exact(), limits(), 5).unwrap();
    let mut robots = [
        robot(0, Role::Pursuer, Pose2::new(0.0, 1.5, 0.0)),
        robot(1, Role::Evader, Pose2::new(3.0, 1.5, 0.0)),
        robot(2, Role::Evader, Pose2::new(-4.0, 1.5, 0.0)),
    ];
    assert_eq!(
        pursuer.command(map, &view(1.0, 0, &robots, &[])).target,
        Some(1)
    );
    robots[2].pose.x = -1.0;
    assert_eq!(
        pursuer.command(map, &view(2.0, 0, &robots, &[])).target,
        Some(1)
    );
    robots[1].active = false;
    assert_eq!(
        pursuer.command(map, &view(3.0, 0, &robots, &[])).target,
        Some(2)
    );
}

#[test]
fn the_papers_start_gives_the_papers_targets() {
    let (_, map) = &*CITY;
    let police = [4.5, 1.5, -1.5, -4.5].map(|y| Pose2::new(7.5, y, core::f64::consts::PI));
    let mut robots: Vec<_> = police
        .iter()
        .enumerate()
        .map(|(i, &pose)| robot(i, Role::Pursuer, pose))
        .collect();
    robots.push(robot(4, Role::Evader, Pose2::new(-4.5, 7.5, 0.0)));
    robots.push(robot(5, Role::Evader, Pose2::new(-4.5, -7.5, 0.0)));
    for (me, expected) in [(0, 4), (1, 4), (2, 5), (3, 5)] {
        let mut pursuer = Pursuer::new(PursuerParams::paper(), limits(), 5).unwrap();
        let steering = pursuer.command(map, &view(1.0, me, &robots, &[]));
        assert_eq!(steering.target, Some(expected));
    }
}

#[test]
fn all_pursuers_agree_on_a_balanced_matching() {
    let (_, map) = &*CITY;
    let mut params = exact();
    params.assignment.method = AssignmentMethod::CutOff;
    let mut team: Vec<_> = (0..4)
        .map(|me| Pursuer::new(params, limits(), me).unwrap())
        .collect();
    // All Police are nearest to robot 4.
    let mut robots: Vec<_> = [4.5, 1.5, -1.5, -4.5]
        .iter()
        .enumerate()
        .map(|(i, &y)| robot(i, Role::Pursuer, Pose2::new(7.5, y, 0.0)))
        .collect();
    robots.push(robot(4, Role::Evader, Pose2::new(1.5, 1.5, 0.0)));
    robots.push(robot(5, Role::Evader, Pose2::new(-7.5, -7.5, 0.0)));
    for tick in 0..60 {
        let time = 1.0 + f64::from(tick) * DT;
        robots[4].pose.x -= 0.02;
        let targets: Vec<_> = team
            .iter_mut()
            .enumerate()
            .map(|(me, pursuer)| pursuer.command(map, &view(time, me, &robots, &[])).target)
            .collect();
        for evader in [4, 5] {
            assert_eq!(
                targets.iter().filter(|t| **t == Some(evader)).count(),
                2,
                "{targets:?}"
            );
        }
    }
    robots[4].active = false;
    for (me, pursuer) in team.iter_mut().enumerate() {
        assert_eq!(
            pursuer.command(map, &view(4.1, me, &robots, &[])).target,
            Some(5)
        );
    }
}

#[test]
fn a_pursuer_without_information_stands_still_and_one_with_a_belief_follows_it() {
    let (_, map) = &*CITY;
    let mut params = PursuerParams {
        belief_goals: BeliefGoals::Particles,
        ..exact()
    };
    params.knowledge = Knowledge::Belief;
    let robots = [
        robot(0, Role::Pursuer, Pose2::new(0.0, 1.5, 0.0)),
        // The truth is to the east, the belief to the west.
        robot(1, Role::Evader, Pose2::new(6.0, 1.5, 0.0)),
    ];
    let mut pursuer = Pursuer::new(params, limits(), 5).unwrap();
    let blind = pursuer.command(map, &view(1.0, 0, &robots, &[]));
    assert_eq!((blind.command, blind.target), (Twist2::STOP, Some(1)));
    let particles: Vec<_> = (0..30)
        .map(|i| ParticleView {
            x: -6.0 - 0.02 * i as f32,
            y: 1.5,
            theta: 0.0,
            weight: 1.0,
        })
        .collect();
    let beliefs = [BeliefView {
        robot: 1,
        particles: &particles,
        mean: Pose2::new(-6.3, 1.5, 0.0),
        position_std: 0.2,
        seen: false,
    }];
    for belief_goals in [BeliefGoals::Particles, BeliefGoals::Mean, BeliefGoals::Mode] {
        let mut pursuer = Pursuer::new(
            PursuerParams {
                belief_goals,
                ..params
            },
            limits(),
            5,
        )
        .unwrap();
        let steering = pursuer.command(map, &view(1.0, 0, &robots, &beliefs));
        assert!(steering.field.x < -1.0, "{belief_goals:?}: {steering:?}");
        assert!(steering.aim.unwrap().x < -1.0);
        assert!(steering.command.omega.abs() > 1.0, "turns round");
    }
}

#[test]
fn the_look_ahead_point_stays_in_the_street() {
    let (arena, map) = &*CITY;
    let robots = [
        robot(0, Role::Pursuer, Pose2::new(-7.5, 1.5, 0.0)),
        // Heads for a block 0.5 m ahead.
        robot(
            1,
            Role::Evader,
            Pose2::new(1.5, 1.5, core::f64::consts::FRAC_PI_4),
        ),
    ];
    let aim = |params| {
        let mut pursuer = Pursuer::new(params, limits(), 5).unwrap();
        pursuer
            .command(map, &view(1.0, 0, &robots, &[]))
            .aim
            .unwrap()
    };
    assert!(arena.clearance(aim(exact())) > 0.0);
    assert!((aim(PursuerParams::paper()) - Point2::new(1.5, 1.5)).norm() > 4.9);
}

#[test]
fn two_pursuers_on_one_target_keep_apart() {
    let (arena, map) = &*CITY;
    let target = Pose2::new(-7.5, 1.5, 0.0);
    let least = |scatter_weight| {
        let params = PursuerParams {
            scatter_weight,
            ..exact()
        };
        let mut bodies = [Kinematic::new(3.0, 1.7, 3.1), Kinematic::new(3.0, 1.4, 3.1)];
        let mut team = [0, 1].map(|me| Pursuer::new(params, limits(), me).unwrap());
        let mut least = f64::INFINITY;
        for tick in 0..300 {
            let time = 1.0 + f64::from(tick) * DT;
            let robots = [
                robot(0, Role::Pursuer, bodies[0].pose),
                robot(1, Role::Pursuer, bodies[1].pose),
                robot(2, Role::Evader, target),
            ];
            for (me, pursuer) in team.iter_mut().enumerate() {
                let steering = pursuer.command(map, &view(time, me, &robots, &[]));
                bodies[me].step(arena, steering.command, DT);
            }
            let gap = (bodies[0].pose.position() - bodies[1].pose.position()).norm();
            least = f64::min(least, gap);
        }
        least
    };
    assert!(least(0.5) > 2.0 * RADIUS, "{}", least(0.5));
    assert!(least(0.5) > least(0.0));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn commands_are_finite_and_within_limits_for_any_view(
        numbers in prop::collection::vec(prop::num::f64::ANY, 32),
        tame in prop::collection::vec(-20.0_f64..20.0, 32),
        particles in prop::collection::vec(prop::array::uniform4(prop::num::f32::ANY), 0..20),
        wild in any::<u32>(),
        options in any::<[bool; 4]>(),
    ) {
        let (_, map) = &*CITY;
        let mut params = if options[0] { PursuerParams::paper() } else { PursuerParams::default() };
        params.knowledge = if options[1] { Knowledge::Exact } else { Knowledge::Belief };
        params.assignment.knowledge = params.knowledge;
        if options[2] {
            params.assignment.method = AssignmentMethod::CutOff;
        }
        params.belief_goals = if options[3] { BeliefGoals::Particles } else { BeliefGoals::Mode };
        let mut pursuer = Pursuer::new(params, limits(), 1).unwrap();
        let pick = |i: usize| if wild >> i & 1 == 1 { numbers[i] } else { tame[i] };
        let robots: Vec<_> = (0..5)
            .map(|i| RobotView {
                index: i % 4,
                team: if i % 2 == 0 { Role::Pursuer } else { Role::Evader }.into(),
                active: true,
                present: true,
                pose: Pose2 { x: pick(4 * i), y: pick(4 * i + 1), theta: pick(4 * i + 2) },
                twist: Twist2::STOP,
                radius: RADIUS,
                v_max: pick(4 * i + 3).abs(),
            })
            .collect();
        let particles: Vec<_> = particles
            .into_iter()
            .map(|[x, y, theta, weight]| ParticleView { x, y, theta, weight })
            .collect();
        let mean = Pose2 { x: pick(26), y: pick(27), theta: pick(28) };
        let beliefs: Vec<_> = [1, 3, 9]
            .map(|robot| {
                BeliefView { robot, particles: &particles, mean, position_std: 1.0, seen: true }
            })
            .into();
        for time in [1.0, pick(24), pick(25)] {
            let steering = pursuer.command(map, &view(time, 0, &robots, &beliefs));
            prop_assert!(limits().allow(steering.command), "{:?}", steering);
            prop_assert!(steering.field.norm().is_finite());
        }
    }
}
