//! Single predictors on known paths.

use geometry::math;
use geometry::pose::Pose2;
use nalgebra::Point2;
use observer::predictors::kalman::Kalman;
use observer::predictors::similar_stretch::SimilarStretch;

use crate::support::{DT, NoisyObserver, Robot};

fn straight(tick: u64) -> Pose2 {
    let t = tick as f64 * DT;
    Pose2::new(0.6 * t, 1.0 - 0.8 * t, -0.927_295_218_001_612_2)
}

#[test]
fn a_straight_way_at_constant_speed_is_predicted_without_error_through_gaps() {
    let mut kalman = Kalman::new(1.0, 2.0);
    let mut noisy = NoisyObserver::new(0.0, 0.0, 1);
    assert_eq!(noisy.predict(&kalman, 1.0), None);
    for tick in 0..100 {
        noisy.look(straight(tick), true, &mut kalman);
    }
    for tick in 100..200 {
        noisy.look(straight(tick), false, &mut kalman);
    }
    for (horizon, ticks) in [(0.5, 10), (5.0, 100)] {
        let at = noisy.predict(&kalman, horizon).unwrap();
        let error = (at - straight(199 + ticks).position()).norm();
        assert!(error < 1e-6, "{horizon} {error}");
    }
}

#[test]
fn noise_is_smoothed() {
    let mut kalman = Kalman::new(0.01, 2.0);
    let mut noisy = NoisyObserver::new(0.05, 0.0, 2);
    let mut squares = 0.0;
    for tick in 0..1000 {
        noisy.look(straight(tick), true, &mut kalman);
        if tick >= 100 {
            let at = noisy.predict(&kalman, 1.0).unwrap();
            squares += (at - straight(tick + 20).position()).norm_squared();
        }
    }
    let rms = (squares / 900.0_f64).sqrt();
    // Two noisy positions a tick apart would be wrong by 0.05 √2 · 20 · √2 = 2 m.
    assert!(rms < 0.15 && rms > 0.005, "{rms}");
}

#[test]
fn a_way_that_repeats_is_predicted_by_its_past_and_a_first_lap_is_not() {
    let lap = 12.0;
    let pose = |tick: u64| {
        let angle = core::f64::consts::TAU * tick as f64 * DT / lap;
        let (sin, cos) = math::sincos(angle);
        Pose2::new(3.0 * cos, 2.0 * math::sin(2.0 * angle) + sin, 0.0)
    };
    let mut similar = SimilarStretch::new(2.0, 0.25);
    let mut noisy = NoisyObserver::new(0.0, 0.0, 3);
    for tick in 0..600 {
        noisy.look(pose(tick), true, &mut similar);
    }
    // The noisy's moments for predictions are out of sight: so is the robot.
    assert_eq!(noisy.predict(&similar, 1.0), None);
    let at = noisy.predict_seen(&similar, pose(599), 2.0).unwrap();
    let error = (at - pose(639).position()).norm();
    assert!(error < 0.3, "{error}");
}

#[test]
fn goals_are_made_out_from_noisy_poses_to_half_a_tick() {
    let corners = [[0.0, 0.0], [2.0, 0.5], [2.5, 3.0], [-1.0, 2.0]].map(Point2::from);
    let ring = (1..).map(|k: usize| corners[k % 4]);
    let mut robot = Robot::new(corners[0], ring);
    let mut kalman = Kalman::new(1.0, 1.0);
    let mut noisy = NoisyObserver::new(0.005, 0.005, 4);
    let mut made_out = Vec::new();
    while robot.reached.len() < 40 {
        robot.tick();
        made_out.extend(noisy.look(robot.pose, true, &mut kalman));
    }
    assert!(made_out.len() >= 39, "{}", made_out.len());
    // No goal is invented, few are overlooked.
    let mut next = robot.reached.iter();
    for goal in &made_out {
        let found = next.find(|real| (goal.point - **real).norm() < 0.05);
        assert!(found.is_some(), "{goal:?}");
    }
}
