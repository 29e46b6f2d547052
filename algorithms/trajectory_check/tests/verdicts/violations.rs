//! Every kind of violation is found and named.

use nalgebra::Point2;
use trajectory_check::{Contract, Obstacle, Sample, Violation, WheelLimit, check};

use crate::drive::{
    OMEGA_MAX, Stretch, V_MAX, assert_finds, contract_of, drive, s_curve, s_curve_contract,
};

/// One metre along the x axis at full speed.
fn line() -> Vec<Sample> {
    drive([0.0; 3], &[Stretch(5.0, [V_MAX; 2], [0.0; 2])])
}

fn disc(x: f64, y: f64, radius: f64) -> Vec<Obstacle> {
    vec![Obstacle::Disc {
        center: Point2::new(x, y),
        radius,
    }]
}

#[test]
fn one_per_cent_too_fast() {
    let samples = drive([0.0; 3], &[Stretch(5.0, [1.01 * V_MAX; 2], [0.0; 2])]);
    assert_finds(&contract_of(&samples), &samples, &["Speed", "PoseSpeed"]);
}

#[test]
fn one_per_cent_too_fast_with_false_controls() {
    let mut samples = drive([0.0; 3], &[Stretch(5.0, [1.01 * V_MAX; 2], [0.0; 2])]);
    for sample in &mut samples {
        sample.v = V_MAX;
    }
    let kinds = ["PoseSpeed", "Displacement"];
    assert_finds(&contract_of(&samples), &samples, &kinds);
}

#[test]
fn faster_backwards_than_allowed() {
    let cusp = [
        Stretch(2.0, [V_MAX; 2], [0.0; 2]),
        Stretch(2.0, [-0.1; 2], [0.3; 2]),
    ];
    let samples = drive([0.0; 3], &cusp);
    for (v_min, kinds) in [
        (-0.1, [].as_slice()),
        (-0.099, &["ReverseSpeed"]),
        (0.0, &["ReverseSpeed"]),
    ] {
        let contract = Contract {
            v_min,
            ..contract_of(&samples)
        };
        if kinds.is_empty() {
            let report = check(&contract, &samples);
            assert!(report.is_valid(), "{report}");
        } else {
            assert_finds(&contract, &samples, kinds);
        }
    }
}

#[test]
fn turning_one_per_cent_too_fast() {
    let samples = drive([0.0; 3], &[Stretch(2.0, [0.0; 2], [-1.01 * OMEGA_MAX; 2])]);
    assert_finds(
        &contract_of(&samples),
        &samples,
        &["TurnRate", "PoseTurnRate"],
    );
}

#[test]
fn wheels_too_fast_though_speed_and_turning_rate_are_not() {
    let samples = drive([0.0; 3], &[Stretch(2.0, [0.1; 2], [1.0; 2])]);
    let mut contract = contract_of(&samples);
    contract.wheel = Some(WheelLimit {
        speed: 0.149,
        separation: 0.1,
    });
    assert_finds(&contract, &samples, &["WheelSpeed", "PoseWheelSpeed"]);
}

#[test]
fn a_corner_cut_by_two_millimetres_between_samples() {
    // Samples are a centimetre apart; the disc of 7.5 mm lies between two of them.
    let samples = line();
    let mut contract = contract_of(&samples);
    contract.obstacles = disc(0.505, 0.0055, 0.0075);
    let outside = samples
        .iter()
        .all(|s| libm::hypot(s.x - 0.505, s.y - 0.0055) > 0.0074);
    assert!(outside, "no sample may be inside the disc");
    assert_finds(&contract, &samples, &["Penetration"]);
    let report = check(&contract, &samples);
    assert!((report.min_clearance + 0.002).abs() < 1e-6 && (report.deepest - 0.002).abs() < 1e-6);
    let Violation::Penetration { obstacle, excess } = report.violations[0] else {
        panic!("{report}");
    };
    assert!(obstacle == 0 && (excess.time - 0.505 / V_MAX).abs() < 0.05);
    contract.obstacles = disc(0.505, 0.0055, 0.0060);
    assert_finds(&contract, &samples, &[]);
}

#[test]
fn a_corner_of_a_polygon_and_the_clearance_around_it() {
    let samples = line();
    let mut contract = contract_of(&samples);
    let corners = [[0.5, -0.05], [0.4, -0.3], [0.6, -0.3]].map(Point2::from);
    contract.obstacles = vec![Obstacle::Polygon {
        vertices: corners.to_vec(),
    }];
    contract.clearance = 0.0505;
    assert_finds(&contract, &samples, &[]);
    contract.clearance = 0.052;
    assert_finds(&contract, &samples, &["Penetration"]);
}

#[test]
fn two_millimetres_out_of_bounds() {
    let samples = line();
    let mut contract = contract_of(&samples);
    contract.bounds = Some([0.0, 0.0, 0.9995, 1.0]);
    assert_finds(&contract, &samples, &[]);
    contract.bounds = Some([0.0, 0.002, 1.0, 1.0]);
    assert_finds(&contract, &samples, &["Bounds"]);
}

#[test]
fn time_left_out() {
    let mut samples = line();
    for sample in samples.iter_mut().skip(40) {
        sample.t -= 0.01;
    }
    assert_finds(
        &contract_of(&samples),
        &samples,
        &["PoseSpeed", "Displacement"],
    );
}

#[test]
fn time_running_backwards() {
    let mut samples = line();
    for sample in samples.iter_mut().skip(40) {
        sample.t -= 0.06;
    }
    assert_finds(&contract_of(&samples), &samples, &["TimeBackwards"]);
    samples = line();
    for sample in &mut samples {
        sample.t += 0.01;
    }
    assert_finds(&contract_of(&samples), &samples, &["StartTime"]);
}

#[test]
fn a_teleport() {
    let mut samples = line();
    for sample in samples.iter_mut().skip(40) {
        sample.y += 0.1;
    }
    let kinds = ["PoseSpeed", "Displacement", "Spacing"];
    assert_finds(&contract_of(&samples), &samples, &kinds);
    let mut samples = line();
    let mut twin = samples[40];
    twin.y += 0.1;
    samples.insert(41, twin);
    for sample in samples.iter_mut().skip(42) {
        sample.y += 0.1;
    }
    assert_finds(&contract_of(&samples), &samples, &["Jump"]);
}

#[test]
fn a_heading_that_is_not_driven() {
    let mut samples = line();
    samples[40].theta += 0.01;
    let kinds = ["Displacement", "Heading"];
    assert_finds(&contract_of(&samples), &samples, &kinds);
}

#[test]
fn sideways_motion() {
    let mut samples = line();
    for sample in &mut samples {
        (sample.x, sample.y) = (0.0, sample.x);
    }
    let kinds = ["Displacement"];
    assert_finds(&contract_of(&samples), &samples, &kinds);
}

#[test]
fn sideways_motion_by_steps_too_small_to_be_seen_one_by_one() {
    let samples: Vec<_> = (0..20_001)
        .map(|k| Sample {
            t: 5e-7 * f64::from(k),
            x: 0.0,
            y: 5e-8 * f64::from(k),
            theta: 0.0,
            v: 0.0,
            omega: 0.0,
        })
        .collect();
    assert_finds(&contract_of(&samples), &samples, &["TotalDisplacement"]);
}

#[test]
fn turning_on_the_spot_at_speed() {
    let mut samples = drive([0.0; 3], &[Stretch(2.0, [0.0; 2], [1.0; 2])]);
    for sample in &mut samples {
        sample.v = 0.1;
    }
    let kinds = ["Displacement"];
    assert_finds(&contract_of(&samples), &samples, &kinds);
}

#[test]
fn ends_missed_by_a_hundred_thousandth() {
    let samples = s_curve();
    let missed = |change: &dyn Fn(&mut Contract), kind| {
        let mut contract = s_curve_contract();
        change(&mut contract);
        assert_finds(&contract, &samples, &[kind]);
    };
    missed(&|contract| contract.start[0] += 1e-5, "Start");
    missed(&|contract| contract.start[1] -= 1e-5, "Start");
    missed(&|contract| contract.start[2] += 1e-5, "StartHeading");
    missed(&|contract| contract.start_speed = Some(1e-5), "StartSpeed");
    missed(
        &|contract| contract.start_turn_rate = Some(-1e-5),
        "StartTurnRate",
    );
    missed(&|contract| contract.goal[0] += 1e-5, "Goal");
    missed(&|contract| contract.goal[1] -= 1e-5, "Goal");
    missed(
        &|contract| contract.goal_heading = Some(samples[samples.len() - 1].theta + 1e-5),
        "GoalHeading",
    );
    missed(&|contract| contract.goal_speed = Some(1e-5), "GoalSpeed");
}

#[test]
fn an_end_that_stops_short() {
    let samples = line();
    let contract = contract_of(&samples);
    assert_finds(&contract, &samples[..samples.len() - 1], &["Goal"]);
    assert_finds(&contract, &samples[..1], &["Goal"]);
}

#[test]
fn accelerating_too_hard() {
    let contract = |acceleration, angular| Contract {
        acceleration_max: Some(acceleration),
        angular_acceleration_max: Some(angular),
        ..s_curve_contract()
    };
    let samples = s_curve();
    assert_finds(
        &contract(0.99 * V_MAX, OMEGA_MAX),
        &samples,
        &["Acceleration"],
    );
    assert_finds(
        &contract(V_MAX, 0.99 * OMEGA_MAX),
        &samples,
        &["AngularAcceleration"],
    );
}

#[test]
fn controls_that_step_although_they_must_not() {
    let stretches = [
        Stretch(1.0, [0.1; 2], [0.5; 2]),
        Stretch(1.0, [0.2; 2], [-0.5; 2]),
    ];
    let samples = drive([0.0; 3], &stretches);
    let mut contract = contract_of(&samples);
    assert_finds(&contract, &samples, &[]);
    contract.acceleration_max = Some(1.0);
    assert_finds(&contract, &samples, &["SpeedStep"]);
    contract.angular_acceleration_max = Some(1.0);
    assert_finds(&contract, &samples, &["SpeedStep", "TurnRateStep"]);
}

#[test]
fn samples_too_sparse_to_be_trusted() {
    let samples: Vec<_> = line().into_iter().step_by(5).collect();
    assert_finds(&contract_of(&samples), &samples, &["Spacing"]);
}
