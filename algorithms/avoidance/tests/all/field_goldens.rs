//! Potential-field values of the chasing-game paper's published code, reproduced by the `paper()`
//! presets on the map as that code registered it.

use core::f64::consts::PI;

use avoidance::potential_field::{
    Goal, RepulsionParams, Repulsor, attraction, capped, obstacle, repulsion,
};
use control::feedback_linearisation::{FeedbackParams, command};
use geometry::pose::Pose2;
use nalgebra::{Point2, Vector2};
use navigation::bearing::Bearings;
use parameters::Fidelity;
use planner_view::limits::Limits;
use testing::Arena;

const POLICE: [(f64, f64); 4] = [(7.5, 4.5), (7.5, 1.5), (7.5, -1.5), (7.5, -4.5)];

fn assert_near(got: Vector2<f64>, expected: (f64, f64), tolerance: f64) {
    let off = (got - Vector2::new(expected.0, expected.1)).norm();
    assert!(off < tolerance, "{got:?} instead of {expected:?}");
}

#[test]
fn the_field_of_the_evader_at_its_start() {
    let map = Arena::city().paper_map();
    let params = FeedbackParams::paper();
    let pose = Pose2::new(-4.5, 7.5, 0.0);
    let at = params.field_point_of(&pose);
    let exit = Goal {
        at: Point2::new(9.0, 0.0),
        weight: 1.0,
    };
    let goal = attraction(at, [exit], &Bearings::Straight);
    assert_near(goal, (1.747, -0.974), 1e-3);
    let others = POLICE
        .iter()
        .map(|&(x, y)| Repulsor {
            at: Point2::new(x, y),
            weight: 1.5,
        })
        .chain([Repulsor {
            at: Point2::new(-4.5, -7.5),
            weight: 0.8,
        }]);
    let avoid = repulsion(at, others, &Bearings::Straight, &RepulsionParams::paper());
    assert_near(avoid, (-0.570, 0.486), 2e-3);
    let sum = capped(goal + avoid + obstacle(&map, at, Fidelity::Published), 2.0);
    assert_near(sum, (1.175, -0.920), 0.02);
    let got = command(
        sum,
        pose.theta,
        &Limits::new(0.6, 0.06, 2.84).unwrap(),
        &params,
    );
    assert!((got.v - 0.6).abs() < 1e-9 && (got.omega + 0.5).abs() < 1e-9);
}

#[test]
fn the_field_of_the_first_pursuer_at_its_start() {
    let map = Arena::city().paper_map();
    let params = FeedbackParams::paper();
    let pose = Pose2::new(7.5, 4.5, PI);
    let at = params.field_point_of(&pose);
    let ahead = Point2::new(-4.5 + 5.0, 7.5);
    let goal = attraction(
        at,
        [Goal {
            at: ahead,
            weight: 1.0,
        }],
        &Bearings::Straight,
    );
    assert_near(goal, (-1.836, 0.793), 1e-3);
    // The paper's code repels a robot from its own centre too.
    let all = POLICE.iter().map(|&(x, y)| Repulsor {
        at: Point2::new(x, y),
        weight: 0.5,
    });
    let scatter = repulsion(at, all, &Bearings::Straight, &RepulsionParams::paper());
    assert_near(scatter, (-0.181, 0.384), 2e-3);
    let walls = obstacle(&map, at, Fidelity::Published);
    assert_near(walls, (-0.434, -0.001), 0.02);
    let sum = capped(goal + scatter + walls, 2.0);
    assert_near(sum, (-1.803, 0.865), 0.01);
    let got = command(
        sum,
        pose.theta,
        &Limits::new(0.3, 0.03, 2.84).unwrap(),
        &params,
    );
    assert!((got.v - 0.3).abs() < 1e-9 && (got.omega + 0.5).abs() < 1e-9);
}

#[test]
fn a_single_pursuer_repels_itself_in_the_papers_code() {
    let at = Point2::new(0.05, 0.0);
    let own = [Repulsor {
        at: Point2::new(0.0, 0.0),
        weight: 0.5,
    }];
    let push = repulsion(at, own, &Bearings::Straight, &RepulsionParams::paper());
    assert!(
        (push.norm() - 0.2245).abs() < 1e-3 && push.x > 0.2 && push.y < 0.0,
        "{push:?}"
    );
}

#[test]
fn the_gradient_of_the_blurred_city() {
    let map = Arena::city().paper_map();
    // The published values carry the gain 2.2 that the code keeps in its gradient, without the field
    // speed of 2.
    for (x, y, value, gradient) in [
        (4.5, 4.5, 0.9999, (-0.001, -0.001)),
        (4.5, 0.0, 0.9918, (-0.126, 0.0)),
        (8.5, 1.0, 0.8804, (0.015, -2.331)),
        (-4.5, 7.5, 0.9940, (0.0, -0.217)),
        (1.1, 1.5, 0.9948, (0.068, -0.115)),
    ] {
        let at = Point2::new(x, y);
        assert_near(
            0.5 * obstacle(&map, at, Fidelity::Published),
            gradient,
            0.012,
        );
        let cell = *map.blurred().grid().at(at).unwrap();
        assert!(
            (f64::from(cell) - value).abs() < 2e-3,
            "{cell} instead of {value} at {at}"
        );
    }
}

#[test]
fn the_masked_gradient_jumps_at_a_wall_and_ours_does_not() {
    let map = Arena::city().map();
    let largest_jump = |fidelity| {
        let mut last = obstacle(&map, Point2::new(1.5, 0.0), fidelity);
        let mut jump: f64 = 0.0;
        for step in 1..500 {
            let now = obstacle(
                &map,
                Point2::new(1.5 - f64::from(step) * 1e-3, 0.0),
                fidelity,
            );
            jump = jump.max((now - last).norm());
            last = now;
        }
        jump
    };
    let (ours, masked) = (
        largest_jump(Fidelity::Ours),
        largest_jump(Fidelity::Published),
    );
    assert!(ours < 0.2, "{ours}");
    assert!(masked > 5.0, "{masked}");
}
