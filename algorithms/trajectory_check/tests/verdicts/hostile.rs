//! Invalid input is rejected, without a panic.

use nalgebra::Point2;
use proptest::prelude::*;
use trajectory_check::{Contract, Obstacle, Sample, Violation, WheelLimit, check};

use crate::drive::{assert_finds, s_curve, s_curve_contract};

#[test]
fn no_samples() {
    assert_finds(&s_curve_contract(), &[], &["Empty"]);
}

#[test]
fn broken_contracts() {
    let broken = |change: &dyn Fn(&mut Contract)| {
        let mut contract = s_curve_contract();
        change(&mut contract);
        assert_finds(&contract, &s_curve(), &["Contract"]);
    };
    let polygon = |corners: &[[f64; 2]]| Obstacle::Polygon {
        vertices: corners.iter().map(|&[x, y]| Point2::new(x, y)).collect(),
    };
    broken(&|contract| contract.v_max = 0.0);
    broken(&|contract| contract.omega_max = f64::NAN);
    broken(&|contract| contract.start[2] = f64::INFINITY);
    broken(&|contract| contract.goal[0] = f64::NAN);
    broken(&|contract| contract.goal_heading = Some(f64::NAN));
    broken(&|contract| contract.clearance = -0.1);
    broken(&|contract| contract.bounds = Some([1.0, 0.0, 0.0, 1.0]));
    broken(&|contract| {
        contract.wheel = Some(WheelLimit {
            speed: 0.2,
            separation: 0.0,
        });
    });
    broken(&|contract| contract.obstacles = vec![polygon(&[])]);
    broken(&|contract| contract.obstacles = vec![polygon(&[[9.0, 9.0], [9.0, 9.5], [9.5, 9.0]])]);
    broken(&|contract| {
        contract.obstacles = vec![Obstacle::Disc {
            center: Point2::new(9.0, 9.0),
            radius: -1.0,
        }];
    });
}

#[test]
fn both_the_contract_and_the_samples_may_be_broken() {
    let contract = Contract::new([f64::NAN; 3], [0.0; 2], 0.2, 2.0);
    assert_finds(&contract, &[], &["Contract", "Empty"]);
}

/// Arbitrary bits, and numbers small enough to pass the first check.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        1 => any::<u64>().prop_map(f64::from_bits),
        6 => -1e9..1e9_f64,
        6 => -2.0..2.0_f64,
        1 => Just(0.0),
        1 => -1e-300..1e-300_f64,
    ]
}

fn sample() -> impl Strategy<Value = Sample> {
    prop::array::uniform6(number()).prop_map(|[t, x, y, theta, v, omega]| Sample {
        t,
        x,
        y,
        theta,
        v,
        omega,
    })
}

fn obstacle() -> impl Strategy<Value = Obstacle> {
    let point = || (number(), number()).prop_map(|(x, y)| Point2::new(x, y));
    prop_oneof![
        (point(), number()).prop_map(|(center, radius)| Obstacle::Disc { center, radius }),
        prop::collection::vec(point(), 0..5).prop_map(|vertices| Obstacle::Polygon { vertices }),
        Just(Obstacle::Polygon {
            vertices: [[0.0, 0.0], [1e-3, 0.0], [1e9, 1e9]]
                .map(Point2::from)
                .to_vec(),
        }),
    ]
}

prop_compose! {
    fn contract()(
        start in prop::array::uniform3(number()), goal in prop::array::uniform2(number()),
        options in prop::array::uniform6(prop::option::of(number())),
        limits in prop::array::uniform3(prop_oneof![number(), 0.1..1e9_f64]),
        wheel in prop::option::of((0.1..2.0_f64, number())),
        bounds in prop::option::of(prop::array::uniform4(number())),
        obstacles in prop::collection::vec(obstacle(), 0..3),
    ) -> Contract {
        Contract {
            start_speed: options[0],
            start_turn_rate: options[1],
            goal_heading: options[2],
            goal_speed: options[3],
            acceleration_max: options[4].map(f64::abs),
            angular_acceleration_max: options[5].map(f64::abs),
            wheel: wheel.map(|(speed, separation)| WheelLimit { speed, separation }),
            bounds,
            obstacles,
            clearance: limits[2],
            ..Contract::new(start, goal, limits[0], limits[1])
        }
    }
}

proptest! {
    #[test]
    fn no_bits_cause_a_panic(
        contract in contract(), mut samples in prop::collection::vec(sample(), 0..6),
        sorted in any::<bool>(),
    ) {
        if sorted {
            samples.sort_by(|a, b| a.t.total_cmp(&b.t));
        }
        let report = check(&contract, &samples);
        // Where samples are valid, so is every figure; every report has a text.
        let unfit = |v: &Violation| {
            matches!(v, Violation::Contract { .. } | Violation::NotFinite { .. } | Violation::Empty)
        };
        if !report.violations.iter().any(unfit) {
            prop_assert!(!report.min_clearance.is_nan() && !report.deepest.is_nan());
            prop_assert!(!report.length.is_nan() && !report.drift.is_nan());
        }
        prop_assert_eq!(report.is_valid(), report.to_string().starts_with("valid"));
    }

    #[test]
    fn junk_in_a_sound_contract_is_never_valid(samples in prop::collection::vec(sample(), 2..6)) {
        prop_assert!(!check(&s_curve_contract(), &samples).is_valid());
    }
}
