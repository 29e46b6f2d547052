//! Tests of the navigator without processes: an ideal world, and a planner of straight lines only.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::unreachable
)]

use core::f64::consts::{FRAC_PI_2, PI};

use geometry::grid::{Grid, GridFrame};
use geometry::map::{CellMap, WorldMap};
use geometry::math;
use geometry::pose::{Pose2, Twist2};
use ipc_types::messages::optimiser::PlanRequest;
use nalgebra::{Point2, Vector2};
use navigator::drive::Drive;
use navigator::params::AtPopup;
use navigator::trajectory::Sample;
use navigator::{Navigator, NavigatorError, NavigatorParams, PlanFailure, Trajectory};
use parameters::check;
use planner_view::map::PlannerMap;
use planner_view::view::{RobotView, View};
use robot::spec::RobotModel;
use robot::team::Role;
use testing::circle;
use trajectory_problem::Problem;

const DT: f64 = 0.05;

/// A robot in its world.
struct Rig {
    navigator: Navigator,
    map: PlannerMap,
    pose: Pose2,
    twist: Twist2,
    tick: u32,
    asked: Option<Problem>,
    /// All requests, with their times (s).
    asks: Vec<(f64, Problem)>,
    /// Answer instead of a straight line.
    refusal: Option<PlanFailure>,
    /// Number of ticks by which every answer is late.
    late: u32,
    overdue: u32,
}

fn map(discs: &[(f64, f64, f64)], revision: u64) -> PlannerMap {
    let discs = discs.iter().map(|&(x, y, radius)| circle([x, y], radius));
    let map = testing::map([0.0, 0.0], [6.0, 4.0], 0.1, discs);
    let world = WorldMap::from_vectors(&map).unwrap();
    PlannerMap::of_world(&world, 0.19, revision).unwrap()
}

/// Turn on the spot, straight ahead at full speed; or backwards, if that takes less turning and is
/// allowed.
fn straight(ask: &Problem) -> Trajectory {
    let way: Vector2<f64> = ask.goal - ask.start.position();
    let heading = math::atan2(way.y, way.x);
    let forwards = math::angle_difference(heading, ask.start.theta);
    if ask.limits.v_min < 0.0 && forwards.abs() > FRAC_PI_2 {
        let turn = math::angle_difference(heading + PI, ask.start.theta);
        return leg(ask, turn, ask.limits.v_min);
    }
    leg(ask, forwards, ask.limits.v_max)
}

/// Turn on the spot by an angle (rad), then straight to the goal at a speed (m/s).
fn leg(ask: &Problem, turn: f64, v: f64) -> Trajectory {
    let way: Vector2<f64> = ask.goal - ask.start.position();
    let omega = turn.signum() * ask.limits.omega_max;
    let (turned, there) = (turn / omega, turn / omega + way.norm() / v.abs());
    let sample = |t: f64, at: Point2<f64>, theta: f64, v: f64, omega: f64| Sample {
        t,
        pose: Pose2 {
            x: at.x,
            y: at.y,
            theta,
        },
        twist: Twist2::new(v, omega),
    };
    let (start, theta) = (ask.start.position(), ask.start.theta);
    Trajectory::new(vec![
        sample(0.0, start, theta, 0.0, omega),
        sample(turned, start, theta + turn, 0.0, omega),
        sample(turned, start, theta + turn, v, 0.0),
        sample(there, ask.goal, theta + turn, v, 0.0),
    ])
    .unwrap()
}

impl Rig {
    fn new(params: NavigatorParams, goals: &[[f64; 2]], discs: &[(f64, f64, f64)]) -> Self {
        check(&params).unwrap();
        let goals = goals.iter().copied().map(Point2::from).collect();
        let model = RobotModel::turtlebot3_burger();
        Self {
            navigator: Navigator::new(params, model, goals).unwrap(),
            map: map(discs, 1),
            pose: Pose2::new(1.0, 1.0, 0.0),
            twist: Twist2::STOP,
            tick: 0,
            asked: None,
            asks: Vec::new(),
            refusal: None,
            late: 0,
            overdue: 0,
        }
    }

    fn time(&self) -> f64 {
        f64::from(self.tick) * DT
    }

    fn popup(&mut self, discs: &[(f64, f64, f64)]) {
        self.map = map(discs, self.map.revision() + 1);
    }

    fn step(&mut self) {
        let time_s = self.time();
        if self.navigator.is_due(time_s) {
            self.overdue += 1;
            if self.overdue > self.late {
                self.overdue = 0;
                let ask = self.asked.take().expect("something was asked");
                let answer = self.refusal.clone().map_or_else(|| Ok(straight(&ask)), Err);
                self.navigator
                    .take(answer, self.map.space().unwrap(), time_s);
            }
        }
        let robots = [RobotView {
            index: 0,
            team: Role::Neutral.into(),
            active: true,
            present: true,
            pose: self.pose,
            twist: self.twist,
            radius: 0.105,
            v_max: 0.22,
        }];
        let view = View {
            time_s,
            dt: DT,
            me: 0,
            robots: &robots,
            beliefs: &[],
            exits: &[],
            scan: None,
        };
        let decision = self
            .navigator
            .step(&self.map, self.map.space().unwrap(), &view);
        if let Some(ask) = decision.ask {
            self.asks.push((time_s, ask.clone()));
            self.asked = Some(ask);
        }
        let drive = Drive::new(RobotModel::turtlebot3_burger());
        self.twist = drive.execute(self.twist, decision.command, DT);
        self.pose = control::go_to::coast(&self.pose, self.twist, DT);
        self.tick += 1;
    }

    fn steps(&mut self, seconds: f64) {
        for _ in 0..(seconds / DT).round() as u32 {
            self.step();
        }
    }

    fn distance(&self, x: f64, y: f64) -> f64 {
        (self.pose.position() - Point2::new(x, y)).norm()
    }
}

#[test]
fn goals_are_reached_in_their_order_without_a_pause_between_them() {
    let goals = [[3.0, 1.0], [3.0, 3.0], [1.0, 3.0]];
    let mut rig = Rig::new(NavigatorParams::default(), &goals, &[]);
    let mut nearest = [f64::INFINITY; 3];
    let mut standing = 0;
    while rig.navigator.goal().is_some() {
        rig.step();
        for (nearest, [x, y]) in nearest.iter_mut().zip(goals) {
            *nearest = nearest.min(rig.distance(x, y));
        }
        standing += u32::from(rig.twist == Twist2::STOP);
        assert!(rig.tick < 1000, "{:?}", rig.pose);
    }
    assert!(nearest.iter().all(|n| *n < 0.03), "{nearest:?}");
    // 6 m and two quarter turns; at rest only before the first plan and at the end.
    assert!(standing <= 3, "{standing}");
    assert!(
        rig.time() < 6.0 / 0.22 + 2.0 * 1.571 / 2.84 + 0.5,
        "{}",
        rig.time()
    );
    assert_eq!(rig.asks.len(), 3);
}

#[test]
fn plans_may_drive_backwards_if_the_parameters_allow_it() {
    for backwards in [false, true] {
        let mut params = NavigatorParams::default();
        params.plan.backwards = backwards;
        // Behind the robot, ahead of it (a cusp), and behind it again.
        let goals = [[0.5, 1.0], [1.5, 1.1], [0.6, 1.0]];
        let mut rig = Rig::new(params, &goals, &[]);
        let (mut ahead, mut back, mut turned) = (0.0, 0.0, 0.0);
        while rig.navigator.goal().is_some() {
            rig.step();
            ahead += rig.twist.v.max(0.0) * DT;
            back -= rig.twist.v.min(0.0) * DT;
            turned += rig.twist.omega.abs() * DT;
            assert!(rig.tick < 1000, "{:?}", rig.pose);
        }
        assert!(rig.distance(0.6, 1.0) < 0.03, "{:?}", rig.pose);
        let reverse = -rig.asks[0].1.limits.v_min;
        if backwards {
            assert_eq!(reverse, 0.22);
            assert!((back - 1.4).abs() < 0.05 && (ahead - 1.0).abs() < 0.05);
            assert!(turned < 0.5, "{turned}");
        } else {
            assert_eq!(reverse, 0.0);
            assert!(back < 1e-3 && turned > 8.0, "{back} {turned}");
        }
    }
}

#[test]
fn a_tour_begins_anew() {
    let params = NavigatorParams {
        goals: vec![[2.0, 1.0], [1.0, 1.0]],
        repeat: true,
        ..NavigatorParams::default()
    };
    let goals = params.goals.clone();
    let mut rig = Rig::new(params, &goals, &[]);
    rig.steps(40.0);
    assert!(rig.asks.len() >= 6 && rig.navigator.goal().is_some());
}

#[test]
fn a_plan_takes_effect_a_stated_time_after_it_was_asked_for_and_begins_there() {
    let params = NavigatorParams {
        planning_time_s: 0.42,
        ..NavigatorParams::default()
    };
    let mut rig = Rig::new(params, &[[3.0, 1.0]], &[]);
    rig.steps(0.45);
    assert_eq!((rig.pose.x, rig.twist.v), (1.0, 0.0));
    rig.step();
    assert!((rig.twist.v - 0.22).abs() < 1e-9);
    rig.steps(2.0);
    rig.popup(&[(2.5, 1.05, 0.2)]);
    rig.step();
    let (asked_at, ask) = rig.asks.last().unwrap().clone();
    assert!((asked_at - 2.5).abs() < 1e-9, "{asked_at}");
    rig.steps(0.4);
    let off = (ask.start.position() - rig.pose.position()).norm();
    // One of the nine ticks is left.
    assert!(off < 0.012, "{off}");
}

#[test]
fn at_a_popup_it_goes_on_as_far_as_the_way_is_free_or_stops_at_once() {
    for (at_popup, stops_at) in [(AtPopup::Follow, 3.0 - 0.325), (AtPopup::Stop, 1.44)] {
        let params = NavigatorParams {
            at_popup,
            ..NavigatorParams::default()
        };
        let mut rig = Rig::new(params, &[[5.0, 1.0]], &[]);
        rig.steps(2.05);
        rig.popup(&[(3.0, 1.0, 0.2)]);
        // No answer comes for a long time.
        rig.late = 200;
        rig.refusal = Some(PlanFailure::NoPath);
        rig.steps(9.0);
        let off = (rig.pose.x - stops_at).abs();
        assert!(off < 0.015, "{at_popup:?}: {:?}", rig.pose);
        assert_eq!(rig.twist.v, 0.0);
        // Then there is no path: the navigator requests again, but not in every tick.
        rig.late = 0;
        rig.steps(5.0);
        let asks = rig.asks.len();
        assert!((5..10).contains(&asks), "{asks}");
        // At once after the obstacle has disappeared.
        rig.popup(&[]);
        rig.refusal = None;
        rig.steps(20.0);
        assert!(rig.distance(5.0, 1.0) < 0.03, "{:?}", rig.pose);
    }
}

#[test]
fn a_robot_without_a_path_stands() {
    let mut rig = Rig::new(NavigatorParams::default(), &[[5.0, 1.0]], &[]);
    rig.steps(2.05);
    rig.popup(&[(3.0, 1.0, 0.2)]);
    rig.refusal = Some(PlanFailure::NoPath);
    rig.steps(3.0);
    assert!(rig.pose.x < 1.47 && rig.twist.v == 0.0, "{:?}", rig.pose);
}

#[test]
fn an_obstacle_off_the_path_changes_nothing() {
    let run = |popup: bool| {
        let mut rig = Rig::new(NavigatorParams::default(), &[[5.0, 1.0]], &[]);
        rig.steps(2.0);
        if popup {
            rig.popup(&[(3.0, 3.0, 0.2)]);
        }
        rig.steps(20.0);
        rig.pose
    };
    assert_eq!(run(true), run(false));
}

#[test]
fn a_robot_pushed_off_its_path_stops_and_replans() {
    let mut rig = Rig::new(NavigatorParams::default(), &[[5.0, 1.0]], &[]);
    rig.steps(2.0);
    rig.pose.y += 0.1;
    rig.step();
    assert_eq!(rig.twist.v, 0.0);
    rig.steps(25.0);
    assert!(rig.distance(5.0, 1.0) < 0.03, "{:?}", rig.pose);
    let (_, ask) = rig.asks.last().unwrap();
    assert!((ask.start.y - 1.1).abs() < 0.02, "{ask:?}");
}

#[test]
fn a_late_answer_is_taken_up_on_the_way() {
    let mut rig = Rig::new(NavigatorParams::default(), &[[5.0, 1.0], [5.0, 3.0]], &[]);
    rig.late = 7;
    rig.steps(45.0);
    assert!(rig.distance(5.0, 3.0) < 0.03, "{:?}", rig.pose);
}

#[test]
fn without_goals_or_turns_there_is_no_navigator() {
    let model = RobotModel::turtlebot3_burger();
    let none = Navigator::new(NavigatorParams::default(), model, Vec::new());
    assert!(matches!(none, Err(NavigatorError::NoGoals)));
    let stiff = RobotModel {
        omega_max: 0.0,
        ..model
    };
    let goals = vec![Point2::origin()];
    let stiff = Navigator::new(NavigatorParams::default(), stiff, goals);
    assert!(matches!(stiff, Err(NavigatorError::CannotTurn)));
}

#[test]
fn a_map_that_is_too_large_for_a_request_is_crossed_in_stretches_without_a_pause() {
    let goals = [[22.0, 1.0]];
    let mut rig = Rig::new(NavigatorParams::default(), &goals, &[]);
    let frame = GridFrame {
        width: 480,
        height: 60,
        resolution: 0.05,
        origin: Point2::origin(),
    };
    // Pillars of one cell, every second one, on both sides of a lane.
    let mut cells = Grid::filled(frame, false);
    let lane = 12..28;
    for row in (0..60).step_by(2).filter(|row| !lane.contains(row)) {
        for col in (0..480).step_by(2) {
            cells.cells[frame.index(col, row)] = true;
        }
    }
    let world = WorldMap::from_cells(&CellMap::from_grid(&cells)).unwrap();
    assert!(world.parts().len() > PlanRequest::MAX_SHAPES);
    rig.map = PlannerMap::of_world(&world, 0.19, 1).unwrap();
    let mut standing = 0;
    while rig.navigator.goal().is_some() {
        rig.step();
        standing += u32::from(rig.twist.v == 0.0);
        let clearance = rig.map.space().unwrap().distance(rig.pose.position());
        assert!(clearance >= 0.105, "{:?}", rig.pose);
        assert!(rig.tick < 2500, "{:?}", rig.pose);
    }
    assert!(rig.distance(22.0, 1.0) < 0.03);
    assert!(standing <= 10, "{standing}");
    assert!(rig.asks.len() > 2, "{}", rig.asks.len());
    for (time, ask) in &rig.asks {
        assert!(
            ask.obstacles.len() <= 1024,
            "{time}: {}",
            ask.obstacles.len()
        );
    }
}
