//! Valid trajectories are accepted.

use nalgebra::Point2;
use proptest::prelude::*;
use trajectory_check::{Contract, Obstacle, Sample, WheelLimit, check};

use crate::drive::{OMEGA_MAX, Stretch, V_MAX, contract_of, drive, s_curve, s_curve_contract};

#[track_caller]
fn assert_valid(contract: &Contract, samples: &[Sample]) {
    let report = check(contract, samples);
    assert!(report.is_valid(), "{report}");
}

#[test]
fn a_straight_line_at_full_speed() {
    let samples = drive([0.0; 3], &[Stretch(5.0, [V_MAX; 2], [0.0; 2])]);
    let report = check(&contract_of(&samples), &samples);
    assert!(report.is_valid(), "{report}");
    assert!((report.duration - 5.0).abs() < 1e-12 && (report.length - 1.0).abs() < 1e-9);
    assert!((report.top_speed - V_MAX).abs() < 1e-6 && report.top_turn_rate < 1e-9);
    assert!(report.drift < 1e-9 && report.min_clearance == f64::INFINITY && report.deepest == 0.0);
}

#[test]
fn a_turn_on_the_spot_and_then_an_arc() {
    // More than a full turn, so that the heading matches that of the goal modulo a turn only.
    let turn = Stretch(4.0, [0.0; 2], [OMEGA_MAX; 2]);
    let arc = Stretch(3.0, [V_MAX; 2], [-1.5; 2]);
    let samples = drive([1.0, 2.0, -3.0], &[turn, arc]);
    let mut contract = contract_of(&samples);
    assert_valid(&contract, &samples);
    contract.goal_heading = contract
        .goal_heading
        .map(|heading| heading - core::f64::consts::TAU);
    assert_valid(&contract, &samples);
}

#[test]
fn an_s_curve_with_ramps_within_limited_accelerations() {
    assert_valid(&s_curve_contract(), &s_curve());
}

#[test]
fn turning_and_driving_within_the_limit_of_the_wheels() {
    let samples = drive([0.0; 3], &[Stretch(2.0, [0.1; 2], [1.0; 2])]);
    let wheel = WheelLimit {
        speed: 0.15,
        separation: 0.1,
    };
    let contract = Contract {
        wheel: Some(wheel),
        ..contract_of(&samples)
    };
    assert_valid(&contract, &samples);
}

#[test]
fn reversing_out_of_a_corner() {
    let back = Stretch(1.0, [-V_MAX; 2], [0.5; 2]);
    let change = Stretch(2.0, [-V_MAX, V_MAX], [0.5, -0.5]);
    let samples = drive([0.0; 3], &[back, change]);
    assert_valid(&contract_of(&samples), &samples);
}

#[test]
fn a_robot_that_is_there_already_needs_one_sample_only() {
    let samples = drive([1.0, 2.0, 0.5], &[Stretch(0.0, [0.0; 2], [0.0; 2])]);
    let contract = contract_of(&samples);
    assert_valid(&contract, &samples);
    assert_valid(&contract, &samples[..1]);
    assert_eq!(check(&contract, &samples[..1]).duration, 0.0);
}

#[test]
fn an_arc_that_hugs_a_disc() {
    // Counter-clockwise around the origin at 0.25 m: a disc of 0.15 m and 0.1 m of clearance.
    let radius = 0.25;
    let arc = Stretch(6.0, [V_MAX; 2], [V_MAX / radius; 2]);
    let samples = drive([radius, 0.0, core::f64::consts::FRAC_PI_2], &[arc]);
    let mut contract = contract_of(&samples);
    contract.clearance = 0.1;
    contract.obstacles = vec![Obstacle::Disc {
        center: Point2::origin(),
        radius: 0.15,
    }];
    let report = check(&contract, &samples);
    assert!(report.is_valid(), "{report}");
    assert!(
        report.min_clearance.abs() < 1.2e-5,
        "{}",
        report.min_clearance
    );
}

#[test]
fn a_line_along_a_wall_and_the_bounds() {
    let samples = drive([0.5, 0.3, 0.0], &[Stretch(5.0, [V_MAX; 2], [0.0; 2])]);
    let mut contract = contract_of(&samples);
    contract.clearance = 0.1;
    contract.bounds = Some([0.0, 0.3, 2.0, 1.0]);
    let wall = [[0.0, 0.0], [2.0, 0.0], [2.0, 0.2], [0.0, 0.2]].map(Point2::from);
    contract.obstacles = vec![Obstacle::Polygon {
        vertices: wall.to_vec(),
    }];
    let report = check(&contract, &samples);
    assert!(report.is_valid(), "{report}");
    assert!(report.min_clearance.abs() < 1e-9);
}

prop_compose! {
    /// A drive of a few stretches whose controls may step between them.
    pub fn any_drive()(
        start in prop::array::uniform3(-3.0..3.0_f64),
        stretches in prop::collection::vec(
            (0.05..2.0_f64, prop::array::uniform2(-V_MAX..V_MAX),
             prop::array::uniform2(-OMEGA_MAX..OMEGA_MAX)),
            1..6,
        ),
    ) -> Vec<Sample> {
        let stretches: Vec<_> = stretches.iter().map(|&(t, v, w)| Stretch(t, v, w)).collect();
        drive(start, &stretches)
    }
}

proptest! {
    #[test]
    fn any_drive_is_valid(samples in any_drive()) {
        let report = check(&contract_of(&samples), &samples);
        prop_assert!(report.is_valid(), "{report}");
        prop_assert!(report.drift < 1e-6);
    }

    #[test]
    fn the_clearance_of_any_drive_is_that_of_its_nearest_point(
        samples in any_drive(),
        center in prop::array::uniform2(-3.0..3.0_f64),
        radius in 0.0..0.5_f64,
    ) {
        let center = Point2::from(center);
        let mut contract = contract_of(&samples);
        contract.obstacles = vec![Obstacle::Disc { center, radius }];
        let report = check(&contract, &samples);
        let nearest = samples
            .iter()
            .map(|s| (Point2::new(s.x, s.y) - center).norm() - radius)
            .fold(f64::INFINITY, f64::min);
        // The nearest point lies at most half a spacing from a sample.
        prop_assert!(report.min_clearance <= nearest + 1e-9);
        prop_assert!(report.min_clearance >= nearest - 0.0051);
    }
}
