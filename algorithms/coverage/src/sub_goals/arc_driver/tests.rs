use crate::decomposition::Decomposition;
use crate::plan::{CoveragePlan, PlanSpec};
use crate::tour::Iterations;
use crate::workplace::Workplace;
use chaotic_maps::{Emission, Key, KeyKind};
use control::go_to::coast;
use geometry::pose::Pose2;
use geometry::shape::Convex;

use super::*;

const DT: f64 = 0.05;

/// Case 1 of the coverage paper, with a robot of 0.105 m.
fn workplace(margin: f64) -> Workplace {
    let bounds = Aabb {
        min: Point2::new(0.0, 0.0),
        max: Point2::new(10.0, 10.0),
    };
    let hole = Convex::rectangle(Point2::new(5.0, 5.0), [2.5, 2.5], 0.0);
    Workplace::from_parts(bounds, 0.105 + margin, &[hole], 0.1).unwrap()
}

#[test]
fn sub_goals_are_passed_on_arcs_without_contact() {
    let params = FollowParams::default();
    let limits = Limits::new(0.22, 0.22, 2.84).unwrap();
    let workplace = workplace(params.margin);
    let decomposition = Decomposition::new(&workplace).unwrap();
    let start = Point2::new(1.0, 8.0);
    let spec = PlanSpec {
        iterations: Iterations::InAll(20),
        loops: 1,
        ..PlanSpec::default()
    };
    let source = Key::from_seed(KeyKind::ChebP(Emission::Raw), 5)
        .source()
        .unwrap();
    let mut plan = CoveragePlan::new(decomposition, start, &spec, source).unwrap();
    let mut driver = ArcDriver::new(&params, limits).unwrap();
    let mut pose = Pose2::new(start.x, start.y, 0.3);
    let (mut reports, mut clearance, mut moving) = (Vec::new(), f64::INFINITY, 0);
    let mut ticks = 0;
    loop {
        let situation = Situation {
            pose,
            twist: Twist2::STOP,
            scan: None,
            known: None,
            time_s: f64::from(ticks) * DT,
            dt: DT,
        };
        let driving = driver.drive(&mut || plan.step(), &situation, &mut reports);
        if driving.towards.is_none() {
            break;
        }
        assert!(limits.allow(driving.command));
        moving += u32::from(driving.command.v > 0.1);
        pose = coast(&pose, driving.command, DT);
        let p = pose.position();
        let walls = p.x.min(p.y).min(10.0 - p.x).min(10.0 - p.y);
        let hole = workplace.rectangles()[0].distance(p);
        clearance = clearance.min(walls).min(hole);
        ticks += 1;
        assert!(ticks < 200_000, "it does not end");
    }
    let goals = plan.tour().iterations() + plan.dwell().goals();
    assert_eq!(reports.len() as u64, goals);
    for (number, report) in reports.iter().enumerate() {
        assert_eq!(report.outcome, WaypointOutcome::Reached, "{report:?}");
        assert_eq!(report.waypoint.number, number as u64);
        // Arcs miss by 0.1 m at most, and the tracking error is half of that.
        assert!(report.closest < 0.15, "{report:?}");
    }
    assert!(clearance > 0.105, "{clearance}");
    // It hardly ever stops.
    assert!(
        f64::from(moving) > 0.8 * f64::from(ticks),
        "{moving} of {ticks}"
    );
}

#[test]
fn a_goal_that_takes_too_long_is_given_up() {
    let params = FollowParams::default();
    let limits = Limits::new(0.22, 0.22, 2.84).unwrap();
    let decomposition = Decomposition::new(&workplace(0.05)).unwrap();
    let start = Point2::new(1.0, 8.0);
    let source = Key::from_seed(KeyKind::Keyed, 5).source().unwrap();
    let mut plan = CoveragePlan::new(decomposition, start, &PlanSpec::default(), source).unwrap();
    let mut driver = ArcDriver::new(&params, limits).unwrap();
    let mut reports = Vec::new();
    // A robot that is held in place.
    let mut ticks = 0.0;
    while reports.is_empty() {
        let situation = Situation {
            pose: Pose2::new(start.x, start.y, 0.0),
            twist: Twist2::STOP,
            scan: None,
            known: None,
            time_s: ticks * DT,
            dt: DT,
        };
        driver.drive(&mut || plan.step(), &situation, &mut reports);
        ticks += 1.0;
    }
    assert_eq!(reports[0].outcome, WaypointOutcome::TimedOut);
    let expected = (reports[0].waypoint.point - start).norm() / 0.22;
    // Twice the path, which the arc at its end shortens, and twice half a turn.
    let taken = ticks * DT;
    assert!(
        taken > 1.5 * expected && taken < 2.0 * expected + 4.0,
        "{taken} {expected}"
    );
}
