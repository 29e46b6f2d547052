//! A goal that becomes visible at every turn and is never reached.

use avoidance::tangent_bug::{Advice, Mode, TangentBug};
use geometry::math;
use geometry::pose::Pose2;
use nalgebra::{Point2, Vector2};
use planner_view::view::ScanView;
use sim_backend::random::Stream;

const BEAMS: usize = 180;

/// A scan with a wall 0.3 m away in those directions (rad).
fn walls(is_there: impl Fn(f64) -> bool) -> Vec<f32> {
    let angle = |beam| beam as f64 * (core::f64::consts::TAU / BEAMS as f64);
    let range = |there| if there { 0.3 } else { f32::INFINITY };
    (0..BEAMS)
        .map(|beam| range(is_there(angle(beam))))
        .collect()
}

#[test]
fn a_goal_visible_now_and_then_is_trusted_a_limited_number_of_times() {
    let mut bug = TangentBug::new(0.15).unwrap();
    let mut advise = |ranges: &[f32]| {
        let scan = ScanView {
            angle_min: 0.0,
            angle_increment: core::f64::consts::TAU / BEAMS as f64,
            range_min: 0.0,
            range_max: 0.5,
            ranges,
        };
        let advice = bug.advise(
            &Pose2::new(0.0, 0.0, 0.0),
            &scan,
            Point2::new(0.25, 0.0),
            0.05,
        );
        match advice {
            Some(Advice::Head { mode, .. }) => mode,
            other => panic!("{other:?}"),
        }
    };
    // All directions except the rear, and only the left of the robot.
    let shut = walls(|angle| !(2.35..3.93).contains(&angle));
    let open = walls(|angle| (0.9..2.2).contains(&angle));
    let mut begun = 0;
    for look in 0..40 {
        assert!(matches!(advise(&shut), Mode::Boundary(_)), "look {look}");
        // To the goal at once, or first to a point that is really nearer.
        begun += u32::from(advise(&open) == Mode::ToGoal);
    }
    assert!((2..10).contains(&begun), "{begun} times of 40");
}

#[test]
fn obstacles_that_come_and_go_do_not_hold_the_robot_forever() {
    // Each beam sees something in half of the scans; a closed wall surrounds the goal.
    let (goal, wall) = (Point2::new(2.0, 0.0), 0.4);
    for seed in 0..4 {
        let mut bug = TangentBug::new(0.15).unwrap();
        let mut noise = Stream::new(seed, 0, 0);
        let mut pose = Pose2::new(0.0, 0.0, 0.0);
        let mut looks = 0;
        loop {
            let ranges: Vec<f32> = (0..BEAMS)
                .map(|beam| {
                    let angle = pose.theta + beam as f64 * (core::f64::consts::TAU / BEAMS as f64);
                    let unit = Vector2::new(math::cos(angle), math::sin(angle));
                    let to = goal - pose.position();
                    let (along, beside) = (to.dot(&unit), to.perp(&unit).abs());
                    let to_wall = if along > 0.0 && beside < wall {
                        along - (wall * wall - beside * beside).sqrt()
                    } else {
                        f64::INFINITY
                    };
                    let passing = if noise.normal() > 0.0 {
                        0.4
                    } else {
                        f64::INFINITY
                    };
                    to_wall.min(passing) as f32
                })
                .collect();
            let scan = ScanView {
                angle_min: 0.0,
                angle_increment: core::f64::consts::TAU / BEAMS as f64,
                range_min: 0.0,
                range_max: 0.5,
                ranges: &ranges,
            };
            match bug.advise(&pose, &scan, goal, 0.05) {
                Some(Advice::Head { towards, .. }) => {
                    let to = towards - pose.position();
                    let step = to * (0.05 / to.norm().max(0.05));
                    let theta = if to.norm() > 0.0 {
                        math::atan2(to.y, to.x)
                    } else {
                        pose.theta
                    };
                    pose = Pose2::new(pose.x + step.x, pose.y + step.y, theta);
                }
                Some(Advice::Unreachable | Advice::Stuck) => break,
                None => panic!("no advice"),
            }
            looks += 1;
            assert!(looks < 50_000, "seed {seed}: at {pose:?}");
        }
    }
}
