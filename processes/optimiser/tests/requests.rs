//! Any request yields a valid plan or a typed refusal, never a panic.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use ipc_types::messages::optimiser::{PlanRequest, PlanResponse};
use ipc_types::messages::world::ShapePoint;
use optimiser::service;
use optimiser::wire::{Refusal, decode_request, encode_answer};
use proptest::prelude::*;
use trajectory::obstacle_field::ObstacleField;
use trajectory::validity_check;
use zerocopy::{FromBytes as _, IntoBytes as _};

/// A valid request.
fn sensible() -> PlanRequest {
    PlanRequest {
        start_x: 0.5,
        start_y: 0.5,
        start_v: f64::NAN,
        start_omega: f64::NAN,
        goal_x: 3.5,
        goal_y: 2.5,
        goal_theta: f64::NAN,
        goal_v: f64::NAN,
        v_max: 0.5,
        omega_max: 3.0,
        acceleration_max: f64::INFINITY,
        angular_acceleration_max: f64::INFINITY,
        wheel_speed_max: f64::INFINITY,
        wheel_separation: 0.16,
        clearance: 0.1,
        start_tolerance: f64::NAN,
        bounds: [0.1, 0.1, 3.9, 2.9],
        reference_x: f64::NAN,
        reference_y: f64::NAN,
        method: PlanRequest::TANGENT,
        ..PlanRequest::default()
    }
}

fn disc(shape: u32, x: f64, y: f64, radius: f64) -> ShapePoint {
    ShapePoint {
        x,
        y,
        radius,
        shape,
        reserved: 0,
    }
}

/// Returns the answer of the process; the solver gives up soon, as at a deadline.
fn serve(header: &PlanRequest, points: &[ShapePoint]) -> PlanResponse {
    let mut patience = 10;
    let mut stop = || {
        patience -= 1;
        patience <= 0
    };
    let decoded = decode_request(header, points).map_err(Refusal::from);
    let result = decoded.and_then(|(problem, options)| {
        let plan = service::solve(&problem, &options, None, &mut stop)?;
        let world_map = ObstacleField::new(&problem).expect("it was planned on");
        let report = validity_check::report(&problem, &world_map, &plan.samples);
        assert!(report.is_valid(), "{header:?}: {:?}", report.violations);
        assert!(plan.final_time >= plan.lower_bound - 1e-9, "{header:?}");
        Ok(plan)
    });
    let (response, samples) = encode_answer(header, &result, 0);
    assert_ne!(response.status, PlanResponse::FAILED, "{header:?}");
    assert_eq!(response.is_plan(), !samples.is_empty());
    response
}

/// Numbers at the limits.
fn awkward() -> impl Strategy<Value = f64> {
    prop_oneof![
        Just(f64::NAN),
        Just(f64::INFINITY),
        Just(f64::NEG_INFINITY),
        Just(0.0),
        Just(-0.0),
        Just(f64::MIN_POSITIVE),
        Just(f64::MAX),
        Just(1e6),
        Just(-1e6),
        Just(1e-12),
        -10.0..10.0f64,
    ]
}

/// Offset of the first number in a request (bytes), and the count of numbers.
const NUMBERS: (usize, usize) = (64, 23);

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_bytes_get_an_answer(
        header in proptest::collection::vec(any::<u8>(), size_of::<PlanRequest>()),
        points in proptest::collection::vec(
            proptest::collection::vec(any::<u8>(), size_of::<ShapePoint>()), 0..8),
    ) {
        let header = PlanRequest::read_from_bytes(&header).unwrap();
        let points: Vec<ShapePoint> =
            points.iter().map(|bytes| ShapePoint::read_from_bytes(bytes).unwrap()).collect();
        serve(&header, &points);
    }

    #[test]
    fn a_sensible_request_with_awkward_numbers_gets_an_answer(
        changes in proptest::collection::vec((0..NUMBERS.1, awkward()), 0..4),
        method in 0u32..5,
        x in awkward(), y in awkward(), radius in awkward(),
    ) {
        let mut header = PlanRequest { method, shapes: 1, ..sensible() };
        for (which, value) in changes {
            let at = NUMBERS.0 + 8 * which;
            header.as_mut_bytes()[at..at + 8].copy_from_slice(value.as_bytes());
        }
        serve(&header, &[disc(0, x, y, radius)]);
    }

    #[test]
    fn random_discs_gets_a_valid_plan_or_a_reason(
        discs in proptest::collection::vec((0.0..4.0f64, 0.0..3.0f64, 0.0..0.5f64), 0..12),
        start in (0.1..3.9f64, 0.1..2.9f64), goal in (0.1..3.9f64, 0.1..2.9f64),
        acceleration in proptest::option::of(0.05..3.0f64),
        goal_theta in proptest::option::of(-4.0..4.0f64),
        speed in proptest::option::of(0.0..0.5f64),
        method in 0u32..4,
    ) {
        let header = PlanRequest {
            start_x: start.0,
            start_y: start.1,
            start_v: speed.unwrap_or(f64::NAN),
            goal_x: goal.0,
            goal_y: goal.1,
            goal_theta: goal_theta.unwrap_or(f64::NAN),
            acceleration_max: acceleration.unwrap_or(f64::INFINITY),
            angular_acceleration_max: acceleration.map_or(f64::INFINITY, |a| 8.0 * a),
            shapes: discs.len() as u32,
            method,
            ..sensible()
        };
        let discs = (0u32..).zip(&discs);
        let points: Vec<ShapePoint> =
            discs.map(|(i, (x, y, radius))| disc(i, *x, *y, radius.max(1e-3))).collect();
        serve(&header, &points);
    }
}

#[test]
fn nothing_many_and_no_way_at_all() {
    let status = |header: &PlanRequest, points: &[ShapePoint]| serve(header, points).status;
    assert_eq!(status(&sensible(), &[]), PlanResponse::PLANNED);
    let here = PlanRequest {
        goal_x: 0.5,
        goal_y: 0.5,
        ..sensible()
    };
    let response = serve(&here, &[]);
    assert_eq!((response.status, response.final_time), (0, 0.0));
    // 500 discs, most of them away from the path.
    let discs: Vec<ShapePoint> = (0..500)
        .map(|i| disc(i, 5.0 + f64::from(i), 1.5, 0.1))
        .collect();
    let many = PlanRequest {
        shapes: 500,
        ..sensible()
    };
    assert_eq!(status(&many, &discs), PlanResponse::PLANNED);
    let too_many = vec![disc(0, 0.0, 0.0, 0.1); PlanRequest::MAX_POINTS + 1];
    assert_eq!(status(&sensible(), &too_many), PlanResponse::INVALID);
    // The start slightly and far inside a grown disc; the goal inside one.
    let one = PlanRequest {
        shapes: 1,
        ..sensible()
    };
    let grazed = disc(0, 0.5, 0.797, 0.2);
    assert_eq!(status(&one, &[grazed]), PlanResponse::PLANNED);
    for covered in [disc(0, 0.5, 0.7, 0.2), disc(0, 3.5, 2.5, 0.2)] {
        assert_eq!(status(&one, &[covered]), PlanResponse::INVALID);
    }
    // All around the start.
    let ring: Vec<ShapePoint> = (0u32..40)
        .map(|i| {
            let (sin, cos) = geometry::math::sincos(f64::from(i) * 0.157_08);
            disc(i, 2.0 + cos, 1.5 + sin, 0.1)
        })
        .collect();
    let walled_in = PlanRequest {
        start_x: 2.0,
        start_y: 1.5,
        shapes: 40,
        ..sensible()
    };
    assert_eq!(status(&walled_in, &ring), PlanResponse::NO_PATH);
}
