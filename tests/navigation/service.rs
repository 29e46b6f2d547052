//! The optimiser process, spoken to over iceoryx2.

use crate::process::send_map;
use crate::support::rig::{Rig, World};
use ipc_types::bus::Answer;
use ipc_types::messages::optimiser::{PlanRequest, PlanResponse, TrajectorySample};
use ipc_types::messages::world::ShapePoint;
use ipc_types::topics::OptimiserPlan;
use runtime::lockstep::SlotState;
use runtime::service_client::ServiceClient;
use trajectory::Sample;
use zerocopy::{FromBytes as _, IntoBytes as _};

/// Two robots that would ask.
fn room(workers: u32) -> String {
    format!(
        r#"
[world]
map = "builtin:hello"
[rules]
time_limit = 10.0
[defaults.robot]
goal = {{ circle = {{ center = [3.5, 0.5], radius = 0.2 }} }}
[[robots]]
name = "a"
team = "neutral"
start = {{ x = 0.5, y = 0.5, theta = 0.0 }}
[[robots]]
name = "b"
team = "neutral"
start = {{ x = 0.5, y = 2.5, theta = 0.0 }}
[[processes]]
kind = "optimiser"
params = {{ workers = {workers} }}
[[processes]]
kind = "navigator"
team = "neutral"
"#
    )
}

fn optimiser(workers: u32) -> Rig {
    let mut rig = Rig::new(&room(workers), "optimiser");
    rig.wait_for(SlotState::Ready);
    rig
}

fn client(rig: &Rig, source: u32) -> ServiceClient<OptimiserPlan> {
    ServiceClient::open(&rig.bus, source, PlanRequest::MAX_POINTS).unwrap()
}

/// Across a field of 4 m by 3 m.
fn request(robot: u32) -> PlanRequest {
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
        clearance: 0.1,
        start_tolerance: f64::NAN,
        bounds: [0.1, 0.1, 3.9, 2.9],
        reference_x: f64::NAN,
        reference_y: f64::NAN,
        robot,
        method: PlanRequest::LOCAL_PURSUIT,
        shapes: 2,
        ..PlanRequest::default()
    }
}

/// A disc and a square in the way.
fn obstacles() -> Vec<ShapePoint> {
    let corner = |x: f64, y: f64| point(1, x, y, 0.0);
    vec![
        point(0, 1.5, 1.2, 0.3),
        corner(2.3, 1.6),
        corner(2.7, 1.6),
        corner(2.7, 2.0),
        corner(2.3, 2.0),
    ]
}

fn point(shape: u32, x: f64, y: f64, radius: f64) -> ShapePoint {
    ShapePoint {
        x,
        y,
        radius,
        shape,
        reserved: 0,
    }
}

/// Something that takes long: a way through 500 discs.
fn labyrinth(robot: u32) -> (PlanRequest, Vec<ShapePoint>) {
    let points = (0..500).map(|i| {
        let (column, row) = (f64::from(i % 25), f64::from(i / 25));
        point(
            i,
            0.8 + 0.6 * column + 0.3 * (row % 2.0),
            0.8 + 0.6 * row,
            0.05,
        )
    });
    let header = PlanRequest {
        start_x: 0.3,
        start_y: 0.3,
        goal_x: 16.0,
        goal_y: 13.0,
        bounds: [0.1, 0.1, 16.5, 13.5],
        shapes: 500,
        method: PlanRequest::BSPLINE,
        ..request(robot)
    };
    (header, points.collect())
}

#[track_caller]
fn answer(client: &mut ServiceClient<OptimiserPlan>) -> Answer<OptimiserPlan> {
    let answer = client.wait().unwrap();
    answer.expect("something was asked")
}

/// Asserts that an answer is a plan of the request, and valid by the trajectory check.
#[track_caller]
fn is_valid(request: &PlanRequest, points: &[ShapePoint], answer: &Answer<OptimiserPlan>) {
    let (header, samples) = answer;
    let reason = header.reason_text();
    assert!(header.is_plan(), "status {}: {reason}", header.status);
    assert_eq!(header.robot, request.robot);
    let (problem, _) = optimiser::wire::decode_request(request, points).unwrap();
    let ground = trajectory::obstacle_field::ObstacleField::new(&problem).unwrap();
    let report = trajectory::validity_check::report(&problem, &ground, &as_samples(samples));
    assert!(report.is_valid(), "{:?}", report.violations);
    assert!(header.lower_bound > 0.0 && header.final_time >= header.lower_bound - 1e-9);
    assert!(header.min_clearance >= -1e-3, "{}", header.min_clearance);
    assert!(header.length > 3.6, "{}", header.length);
    assert_eq!(samples.last().unwrap().time_s, header.final_time);
}

fn as_samples(samples: &[TrajectorySample]) -> Vec<Sample> {
    let samples = samples.iter().map(|s| Sample {
        t: s.time_s,
        x: s.x,
        y: s.y,
        theta: s.theta,
        v: s.v,
        omega: s.omega,
    });
    samples.collect()
}

#[test]
fn two_clients_at_once_get_their_own_valid_plans() {
    let rig = optimiser(2);
    let (mut a, mut b) = (client(&rig, 2), client(&rig, 3));
    let points = obstacles();
    for method in [
        PlanRequest::BSPLINE,
        PlanRequest::LOCAL_PURSUIT,
        PlanRequest::MOTION_CAMOUFLAGE,
        PlanRequest::TANGENT,
    ] {
        let of_a = PlanRequest {
            method,
            ..request(0)
        };
        let of_b = PlanRequest {
            goal_x: 3.5,
            goal_y: 0.6,
            goal_theta: 1.0,
            ..of_a
        };
        let of_b = PlanRequest { robot: 1, ..of_b };
        let easy = PlanRequest {
            shapes: 0,
            goal_y: 2.6,
            ..of_b
        };
        a.ask(of_a, &points).unwrap();
        b.ask(easy, &[]).unwrap();
        is_valid(&easy, &[], &answer(&mut b));
        let first = answer(&mut a);
        is_valid(&of_a, &points, &first);
        assert!(first.0.solve_ns > 0);
        assert_eq!(first.0.stamp.source, rig.plan.launches[1].config.index);
        // Earlier requests make no difference.
        a.ask(of_a, &points).unwrap();
        let again = answer(&mut a);
        assert_eq!(as_samples(&again.1), as_samples(&first.1));
    }
}

#[test]
fn a_request_that_names_the_plan_it_follows_begins_near_it() {
    let rig = optimiser(2);
    let mut client = client(&rig, 2);
    let points = obstacles();
    let first = PlanRequest {
        method: PlanRequest::BSPLINE,
        ..request(0)
    };
    client.ask(first, &points).unwrap();
    let (header, samples) = answer(&mut client);
    let middle = samples[samples.len() / 3];
    let on = PlanRequest {
        start_x: middle.x,
        start_y: middle.y,
        start_theta: middle.theta,
        ..first
    };
    let mut ask = |last: u64| {
        client.ask(PlanRequest { last, ..on }, &points).unwrap();
        answer(&mut client)
    };
    let cold = ask(0);
    // An unknown plan id counts as none.
    let unknown = ask(1_000);
    assert_eq!(as_samples(&unknown.1), as_samples(&cold.1));
    let follows = header.stamp.sequence + 1;
    let warm = ask(follows);
    assert!(warm.0.is_plan() && warm.0.iterations <= cold.0.iterations);
    // It does begin elsewhere, and ends about as well.
    assert_ne!(as_samples(&warm.1), as_samples(&cold.1));
    assert!((warm.0.final_time / cold.0.final_time - 1.0).abs() < 1e-3);
    // What was asked in between makes no difference.
    assert_eq!(as_samples(&ask(follows).1), as_samples(&warm.1));
}

/// A change that makes a request invalid.
type Change = fn(&mut PlanRequest, &mut Vec<ShapePoint>);

#[test]
fn what_makes_no_sense_is_refused_by_its_name_and_counted() {
    let mut rig = optimiser(1);
    let world = World::open(&rig);
    rig.take_off();
    world.begin(&mut rig, send_map);
    let mut client = client(&rig, 2);
    let hostile: [(&str, Change); 16] = [
        ("start.x", |r, _| r.start_x = f64::NAN),
        ("start.theta", |r, _| r.start_theta = f64::INFINITY),
        ("goal.y", |r, _| r.goal_y = f64::NEG_INFINITY),
        ("v_max", |r, _| r.v_max = 0.0),
        ("omega_max", |r, _| r.omega_max = -1.0),
        ("acceleration", |r, _| r.acceleration_max = f64::NAN),
        ("wheel_speed", |r, _| r.wheel_speed_max = -1.0),
        ("clearance", |r, _| r.clearance = f64::NAN),
        ("bounds", |r, _| r.bounds = [1.0; 4]),
        ("method", |r, _| r.method = 9),
        ("guess", |r, _| r.guess = u32::MAX),
        ("degree", |r, _| r.degree = 1000),
        ("shapes", |r, _| r.shapes = u32::MAX),
        ("convex", |_, points| points.swap(1, 2)),
        // In the disc, and beyond the bounds.
        ("start", |r, _| (r.start_x, r.start_y) = (1.5, 1.2)),
        ("goal", |r, _| r.goal_x = 5.0),
    ];
    let refusals = hostile.len() as u64;
    for (field, change) in hostile {
        let (mut header, mut points) = (request(0), obstacles());
        change(&mut header, &mut points);
        client.ask(header, &points).unwrap();
        let (header, samples) = answer(&mut client);
        let reason = header.reason_text();
        assert_eq!(header.status, PlanResponse::INVALID, "{field}: {reason}");
        assert!(reason.contains(field) && samples.is_empty(), "{reason}");
    }
    // Walled in.
    let wall = |shape: u32, x: f64| {
        [(x, -1.0), (x + 0.1, -1.0), (x + 0.1, 9.0), (x, 9.0)].map(|(x, y)| point(shape, x, y, 0.0))
    };
    let closed = PlanRequest {
        shapes: 1,
        ..request(0)
    };
    client.ask(closed, &wall(0, 2.0)).unwrap();
    assert_eq!(answer(&mut client).0.status, PlanResponse::NO_PATH);
    client.ask(request(0), &obstacles()).unwrap();
    is_valid(&request(0), &obstacles(), &answer(&mut client));
    // It does its ticks meanwhile, and reports then what it has refused.
    for tick in 0..3 {
        world.tick(&rig, tick);
    }
    rig.rejected(refusals);
}

#[test]
fn random_bytes_are_answered_like_everything_else() {
    let rig = optimiser(2);
    let mut client = client(&rig, 2);
    // A linear congruential generator: the same bytes everywhere.
    let mut state = 7u64;
    let mut byte = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 56) as u8
    };
    for round in 0..300 {
        let mut header = request(0);
        let mut points = obstacles();
        if round % 2 == 0 {
            header.as_mut_bytes().fill_with(&mut byte);
        } else {
            // One field of something that was sensible.
            let bytes = header.as_mut_bytes();
            let at = 64 + usize::from(byte()) % (bytes.len() / 8 - 8) * 8;
            let end = (at + 8).min(bytes.len());
            bytes[at..end].fill_with(&mut byte);
        }
        if round % 3 == 0 {
            let size = size_of::<ShapePoint>();
            let bytes: Vec<u8> = (0..size).map(|_| byte()).collect();
            points[0] = ShapePoint::read_from_bytes(&bytes).unwrap();
        }
        // Time that it might rightly ask for is not what is tried here.
        header.deadline_ns = 20_000_000;
        client.ask(header, &points).unwrap();
        let (response, samples) = answer(&mut client);
        assert_eq!(response.is_plan(), !samples.is_empty());
        assert_ne!(response.status, PlanResponse::FAILED, "{header:?}");
    }
}

#[test]
fn a_newer_request_of_the_same_robot_cancels_the_older_one() {
    let rig = optimiser(1);
    let (mut busy, mut old, mut new) = (client(&rig, 2), client(&rig, 3), client(&rig, 1));
    let (long, discs) = labyrinth(0);
    busy.ask(long, &discs).unwrap();
    // Behind what takes long; its robot asks once more.
    old.ask(request(1), &obstacles()).unwrap();
    new.ask(request(1), &obstacles()).unwrap();
    let (cancelled, samples) = answer(&mut old);
    assert_eq!(cancelled.status, PlanResponse::CANCELLED);
    assert!(samples.is_empty() && cancelled.reason_text().contains("robot 1"));
    // What is being worked on is cancelled as well.
    busy.ask(request(0), &obstacles()).unwrap();
    is_valid(&request(1), &obstacles(), &answer(&mut new));
    is_valid(&request(0), &obstacles(), &answer(&mut busy));
    // A client that goes takes its request along.
    busy.ask(long, &discs).unwrap();
    drop(busy);
    old.ask(request(1), &obstacles()).unwrap();
    is_valid(&request(1), &obstacles(), &answer(&mut old));
}

#[test]
fn when_the_time_is_over_the_answer_is_what_there_is() {
    let rig = optimiser(2);
    let mut client = client(&rig, 2);
    let (long, discs) = labyrinth(0);
    for deadline_ns in [1, 1_000_000, 20_000_000] {
        let hurried = PlanRequest {
            deadline_ns,
            ..long
        };
        client.ask(hurried, &discs).unwrap();
        let answer = answer(&mut client);
        if answer.0.is_plan() {
            is_valid(&hurried, &discs, &answer);
        } else {
            assert_eq!(answer.0.status, PlanResponse::OUT_OF_TIME);
        }
    }
    let easy = PlanRequest {
        deadline_ns: 10_000_000_000,
        ..request(0)
    };
    client.ask(easy, &obstacles()).unwrap();
    let answer = answer(&mut client);
    is_valid(&easy, &obstacles(), &answer);
    assert_ne!(answer.0.status, PlanResponse::DEADLINE);
}
