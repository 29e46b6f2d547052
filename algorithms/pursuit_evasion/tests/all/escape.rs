//! The evader in the paper's city, in a kinematic mini-simulation.

use geometry::pose::{Pose2, Twist2};
use nalgebra::Point2;
use planner_view::limits::Limits;
use planner_view::view::RobotView;
use proptest::prelude::*;
use pursuit_evasion::potential_evader::{Evader, EvaderParams};
use robot::team::Role;
use testing::{CITY, DT, EXIT, Kinematic, RADIUS, robot, street_starts, view};

const EXIT_RADIUS: f64 = 0.5;

fn limits(v_max: f64) -> Limits {
    Limits::new(v_max, v_max, 2.84).unwrap()
}

/// Runs for up to `seconds`; returns the time at which the robot reached the exit, if it did.
fn run(params: &EvaderParams, body: &mut Kinematic, police: &[Pose2], seconds: f64) -> Option<f64> {
    let (arena, map) = &*CITY;
    let v_max = 0.6;
    let mut evader = Evader::new(*params, limits(v_max), 7).unwrap();
    let mut time = 0.0;
    while time < seconds {
        let mut robots = vec![robot(0, Role::Evader, body.pose, v_max)];
        robots.extend(
            police
                .iter()
                .enumerate()
                .map(|(i, &pose)| robot(i + 1, Role::Pursuer, pose, 0.3)),
        );
        let steering = evader.command(map, &view(time, &robots, &[EXIT]));
        body.step(arena, steering.command, DT);
        time += DT;
        if (body.pose.position() - EXIT).norm() < EXIT_RADIUS {
            return Some(time);
        }
    }
    None
}

#[test]
fn without_pursuers_it_reaches_the_exit_from_everywhere_without_contact() {
    for start in street_starts() {
        let mut body = Kinematic::new(start.x, start.y, start.theta);
        let time = run(&EvaderParams::default(), &mut body, &[], 90.0);
        assert!(time.is_some(), "from {start:?} to {:?}", body.pose);
        assert_eq!(body.contacts, 0, "from {start:?}");
    }
}

/// The control point is 0.15 m ahead of the axle: it would rest in a smaller exit, the axle before it.
#[test]
fn an_evader_does_not_stop_with_its_axle_before_a_small_exit() {
    let (arena, map) = &*CITY;
    let exit = Point2::new(8.5, 0.4);
    for radius in [0.14, 0.1, 0.05] {
        for theta in [-2.0, 0.0, 1.3, 3.0] {
            let mut evader = Evader::new(EvaderParams::default(), limits(0.3), 7).unwrap();
            let mut body = Kinematic::new(7.5, -0.8, theta);
            let escapes = (0..600).any(|tick| {
                let robots = [robot(0, Role::Evader, body.pose, 0.3)];
                let time = f64::from(tick) * DT;
                let steering = evader.command(map, &view(time, &robots, &[exit]));
                body.step(arena, steering.command, DT);
                (body.pose.position() - exit).norm() < radius
            });
            assert!(escapes, "{radius} {theta}: stands at {:?}", body.pose);
        }
    }
}

#[test]
fn the_papers_straight_field_ends_in_local_minima_from_many_starts() {
    let starts = street_starts();
    let escaped = starts
        .iter()
        .filter(|start| {
            let mut body = Kinematic::new(start.x, start.y, start.theta);
            run(&EvaderParams::paper(), &mut body, &[], 90.0).is_some()
        })
        .count();
    println!("straight: {escaped} of {}", starts.len());
    assert!(escaped < starts.len());
}

#[test]
fn the_evader_avoids_a_pursuer_that_stands_in_the_street() {
    let mut body = Kinematic::new(-4.5, 1.5, 0.0);
    let police = [Pose2::new(0.0, 1.5, 0.0)];
    let time = run(&EvaderParams::default(), &mut body, &police, 90.0);
    assert!(time.is_some(), "{:?}", body.pose);
    assert_eq!(body.contacts, 0);
}

#[test]
fn the_evader_flees_from_a_near_pursuer_even_away_from_the_exit() {
    let mut body = Kinematic::new(0.0, 1.5, 0.0);
    let police = [Pose2::new(0.6, 1.5, 0.0)];
    run(&EvaderParams::default(), &mut body, &police, 2.0);
    assert!(body.pose.x < -0.05, "{:?}", body.pose);
}

#[test]
fn equal_inputs_give_equal_bits() {
    let ends: Vec<_> = (0..2)
        .map(|_| {
            let mut body = Kinematic::new(-4.5, 7.5, 0.0);
            run(
                &EvaderParams::default(),
                &mut body,
                &[Pose2::new(7.5, 1.5, 0.0)],
                20.0,
            );
            body.pose
        })
        .collect();
    assert_eq!(ends[0].x.to_bits(), ends[1].x.to_bits());
    assert_eq!(ends[0].theta.to_bits(), ends[1].theta.to_bits());
}

#[test]
fn the_evader_passes_a_body_that_blocks_the_middle_of_the_street() {
    let (arena, map) = &*CITY;
    let wreck = Pose2::new(0.0, 1.5, 0.0);
    let drive = |body_guard| {
        let params = EvaderParams {
            body_guard,
            ..EvaderParams::default()
        };
        let mut evader = Evader::new(params, limits(0.6), 7).unwrap();
        let mut body = Kinematic::new(-1.5, 1.5, 0.0);
        let mut least = f64::INFINITY;
        for tick in 0..400 {
            let mut robots = [
                robot(0, Role::Evader, body.pose, 0.6),
                robot(1, Role::Evader, wreck, 0.6),
            ];
            robots[1].active = false;
            let time = f64::from(tick) * DT;
            let steering = evader.command(map, &view(time, &robots, &[EXIT]));
            body.step(arena, steering.command, DT);
            least = least.min((body.pose.position() - wreck.position()).norm() - 2.0 * RADIUS);
        }
        (body.pose.x, least)
    };
    let (x, least) = drive(EvaderParams::default().body_guard);
    assert!(x > 2.0, "stays at {x}");
    assert!(least > 0.0, "touches: {least}");
}

#[test]
fn a_caught_or_unknown_evader_stands_still() {
    let (_, map) = &*CITY;
    let mut evader = Evader::new(EvaderParams::default(), limits(0.6), 1).unwrap();
    let mut caught = robot(0, Role::Evader, Pose2::new(1.5, 1.5, 0.0), 0.6);
    caught.active = false;
    assert_eq!(
        evader.command(map, &view(0.0, &[caught], &[EXIT])).command,
        Twist2::STOP
    );
    assert_eq!(
        evader.command(map, &view(0.0, &[], &[EXIT])).command,
        Twist2::STOP
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn commands_are_finite_and_within_limits_for_any_scan(
        numbers in prop::collection::vec(prop::num::f64::ANY, 32),
        tame in prop::collection::vec(-20.0_f64..20.0, 32),
        wild in any::<u32>(),
        paper in any::<bool>(),
    ) {
        let (_, map) = &*CITY;
        let params = if paper { EvaderParams::paper() } else { EvaderParams::default() };
        let mut evader = Evader::new(params, limits(0.6), 1).unwrap();
        let pick = |i: usize| if wild >> i & 1 == 1 { numbers[i] } else { tame[i] };
        let robots: Vec<_> = (0..5)
            .map(|i| RobotView {
                index: i % 4,
                team: if i % 2 == 0 { Role::Evader } else { Role::Pursuer }.into(),
                active: true,
                present: true,
                pose: Pose2 { x: pick(4 * i), y: pick(4 * i + 1), theta: pick(4 * i + 2) },
                twist: Twist2::STOP,
                radius: pick(4 * i + 3).abs(),
                v_max: 0.5,
            })
            .collect();
        let exits = [Point2::new(pick(20), pick(21)), Point2::new(pick(22), pick(23))];
        for tick in 0..2 {
            let time = pick(24 + tick);
            let steering = evader.command(map, &view(time, &robots, &exits));
            prop_assert!(limits(0.6).allow(steering.command), "{:?}", steering);
            prop_assert!(steering.field.norm().is_finite());
        }
    }
}
