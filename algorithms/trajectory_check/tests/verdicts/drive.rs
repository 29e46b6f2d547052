//! Trajectories for the tests, driven by an integrator of the tests' own (Runge–Kutta, tiny steps).

use trajectory_check::{Contract, Sample, Violation, check};

/// Maximum speed (m/s) and turning rate (rad/s) of the robot under test.
pub const V_MAX: f64 = 0.2;
pub const OMEGA_MAX: f64 = 2.0;

/// Time between samples (s): 1 cm at full speed.
const SAMPLING: f64 = 0.05;

/// A stretch of controls that change linearly: duration (s), speeds (m/s) and turning rates (rad/s)
/// at its two ends. Where a stretch does not begin as the previous one ended, the controls step.
#[derive(Debug, Clone, Copy)]
pub struct Stretch(pub f64, pub [f64; 2], pub [f64; 2]);

/// Samples of the stretches, driven in order from a pose.
pub fn drive(start: [f64; 3], stretches: &[Stretch]) -> Vec<Sample> {
    let mut pose = start;
    let mut time = 0.0;
    let mut samples: Vec<Sample> = Vec::new();
    for &Stretch(duration, v, w) in stretches {
        let sample = |[x, y, theta]: [f64; 3], t: f64, s: f64| Sample {
            t,
            x,
            y,
            theta,
            v: v[0] + (v[1] - v[0]) * s,
            omega: w[0] + (w[1] - w[0]) * s,
        };
        let first = sample(pose, time, 0.0);
        if samples.last() != Some(&first) {
            samples.push(first);
        }
        let count = (duration / SAMPLING).ceil().max(1.0);
        for k in 0..count as u32 {
            let ends = [f64::from(k) / count, f64::from(k + 1) / count];
            pose = integrate(pose, duration, ends, v, w);
            samples.push(sample(pose, time + duration * ends[1], ends[1]));
        }
        time += duration;
    }
    samples
}

fn integrate(
    mut pose: [f64; 3],
    duration: f64,
    ends: [f64; 2],
    v: [f64; 2],
    w: [f64; 2],
) -> [f64; 3] {
    const STEPS: u32 = 50;
    let h = (ends[1] - ends[0]) / f64::from(STEPS);
    let slope = |theta: f64, s: f64| {
        let speed = v[0] + (v[1] - v[0]) * s;
        let (sin, cos) = libm::sincos(theta);
        [speed * cos, speed * sin, w[0] + (w[1] - w[0]) * s].map(|rate| rate * duration)
    };
    for k in 0..STEPS {
        let s = ends[0] + h * f64::from(k);
        let k1 = slope(pose[2], s);
        let k2 = slope(pose[2] + h / 2.0 * k1[2], s + h / 2.0);
        let k3 = slope(pose[2] + h / 2.0 * k2[2], s + h / 2.0);
        let k4 = slope(pose[2] + h * k3[2], s + h);
        for i in 0..3 {
            pose[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
    }
    pose
}

/// The contract that samples fulfil: their ends, the limits of the robot under test.
pub fn contract_of(samples: &[Sample]) -> Contract {
    let (first, last) = (samples[0], samples[samples.len() - 1]);
    Contract {
        start_speed: Some(first.v),
        start_turn_rate: Some(first.omega),
        goal_heading: Some(last.theta),
        goal_speed: Some(last.v),
        ..Contract::new(
            [first.x, first.y, first.theta],
            [last.x, last.y],
            V_MAX,
            OMEGA_MAX,
        )
    }
}

/// A left turn and a right turn from rest to rest, with ramps of the speed: nothing steps.
pub fn s_curve() -> Vec<Sample> {
    drive(
        [0.3, 0.2, 0.4],
        &[
            Stretch(1.0, [0.0, V_MAX], [0.0, 0.0]),
            Stretch(0.5, [V_MAX; 2], [0.0, 1.0]),
            Stretch(1.0, [V_MAX; 2], [1.0, 1.0]),
            Stretch(1.0, [V_MAX; 2], [1.0, -1.0]),
            Stretch(1.0, [V_MAX; 2], [-1.0, -1.0]),
            Stretch(0.5, [V_MAX; 2], [-1.0, 0.0]),
            Stretch(1.0, [V_MAX, 0.0], [0.0, 0.0]),
        ],
    )
}

/// The contract of [`s_curve`], with the acceleration limits that it keeps.
pub fn s_curve_contract() -> Contract {
    Contract {
        acceleration_max: Some(V_MAX),
        angular_acceleration_max: Some(OMEGA_MAX),
        ..contract_of(&s_curve())
    }
}

/// Returns `true` if a check finds a violation of the kind.
pub fn finds(contract: &Contract, samples: &[Sample], kind: impl Fn(&Violation) -> bool) -> bool {
    check(contract, samples).violations.iter().any(kind)
}

/// Asserts that a check finds exactly the named kinds, in the order as found, separated by `,`.
#[track_caller]
pub fn assert_finds(contract: &Contract, samples: &[Sample], expected: &[&str]) {
    let report = check(contract, samples);
    let mut kinds: Vec<String> = report.violations.iter().map(name).collect();
    kinds.sort();
    let mut expected: Vec<_> = expected.iter().map(ToString::to_string).collect();
    expected.sort();
    assert_eq!(kinds, expected, "{report}");
}

fn name(violation: &Violation) -> String {
    let debug = format!("{violation:?}");
    let end = debug.find(|c: char| !c.is_alphanumeric());
    debug[..end.unwrap_or(debug.len())].to_owned()
}
