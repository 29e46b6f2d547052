//! Guards that pursue an intruder: who leaves the patrol, how the others spread, and the return of all.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use core::time::Duration;

use geometry::map::{MapSpec, VectorMap};
use geometry::pose::{Pose2, Twist2};
use metrics::idleness::Ring;
use nalgebra::Point2;
use patrol_planners::{Guard, PatrolAwg, PatrolAwgParams};
use planner_view::event::RobotEventKind;
use planner_view::limits::Limits;
use planner_view::map::PlannerMap;
use planner_view::view::{BeliefView, RobotView, View};
use robot::spec::RobotSpec;
use robot::team::{Role, Team};
use sim_backend::spec::{RulesSpec, WorldSpec};
use sim_backend::world::World;

const TICK: Duration = Duration::from_millis(100);

/// Driven in 100 s.
const SQUARE: [[f64; 2]; 4] = [[3.0, 3.0], [3.0, 15.0], [15.0, 15.0], [15.0, 3.0]];

const GUARDS: usize = 3;
const INTRUDER: usize = GUARDS;

/// Three guards and an intruder that circles in the middle, slower than they are.
struct Chase {
    world: World,
    map: PlannerMap,
    guards: Vec<Guard>,
    ring: Ring,
    /// `true` while the intruder is seen.
    is_seen: bool,
    /// Events: time (s), guard, kind.
    events: Vec<(f64, usize, RobotEventKind)>,
}

fn spec(index: usize) -> RobotSpec {
    let pose = match index {
        0 => Pose2::new(3.0, 3.0, 1.5),
        1 => Pose2::new(7.0, 15.0, 0.0),
        2 => Pose2::new(15.0, 7.0, -1.5),
        _ => Pose2::new(9.0, 6.0, 0.0),
    };
    let mut spec = support::robot(pose);
    spec.name = format!("robot_{index}");
    spec
}

impl Chase {
    fn new() -> Self {
        let text = format!(
            "mission = {{ contour = {SQUARE:?}, t_max = 100.0 }}\npursue = {{ lost_s = 5.0 }}"
        );
        let params: PatrolAwgParams = toml::from_str(&text).unwrap();
        let all: Vec<u32> = (0..GUARDS as u32).collect();
        let guard = |index: usize| {
            let (model, seed) = (spec(index).model(), index as u64);
            let patrol = PatrolAwg::new(&params, &model, seed).unwrap();
            let limits = Limits::new(model.v_max, model.v_reverse_max, model.omega_max).unwrap();
            let guard = Guard::new(patrol.in_team(&all));
            guard
                .pursuing(params.pursue.as_ref().unwrap(), &all, limits, seed)
                .unwrap()
        };
        let world = World::new(WorldSpec {
            map: MapSpec::Vector(VectorMap::empty([0.0, 0.0], [18.0, 18.0], 0.1)),
            robots: (0..=GUARDS).map(spec).collect(),
            rules: RulesSpec::default(),
            seed: 1,
        })
        .unwrap();
        let mut corners: Vec<Point2<f64>> = SQUARE.iter().map(|&p| Point2::from(p)).collect();
        corners.push(corners[0]);
        Self {
            map: support::planner_map(&world),
            guards: (0..GUARDS).map(guard).collect(),
            ring: Ring::new(&corners).unwrap(),
            is_seen: false,
            events: Vec::new(),
            world,
        }
    }

    fn position(&self, robot: usize) -> Point2<f64> {
        self.world.robots()[robot].pose.position()
    }

    /// The guards that pursue.
    fn pursuing(&self) -> Vec<usize> {
        let guards = 0..GUARDS;
        guards
            .filter(|&guard| self.guards[guard].is_in_pursuit())
            .collect()
    }

    /// Distance between two guards along the contour (m).
    fn apart(&self, a: usize, b: usize) -> f64 {
        self.ring.between(self.position(a), self.position(b))
    }

    /// Distances of the guards from the intruder (m).
    fn distances(&self) -> Vec<f64> {
        let intruder = self.position(INTRUDER);
        let guards = 0..GUARDS;
        guards
            .map(|guard| (self.position(guard) - intruder).norm())
            .collect()
    }

    fn drive(&mut self, seconds: f64) {
        let until = self.world.time().as_secs_f64() + seconds;
        let role = |index: usize| {
            if index == INTRUDER {
                Role::Evader
            } else {
                Role::Pursuer
            }
        };
        let teams = Team::of_robots(
            GUARDS + 1,
            role,
            |i, j| role(i) == role(j),
            |i, j| role(i) != role(j),
        );
        while self.world.time().as_secs_f64() < until - 1e-6 {
            let time_s = self.world.time().as_secs_f64();
            let robots: Vec<RobotView> = self
                .world
                .robots()
                .iter()
                .enumerate()
                .map(|(index, state)| RobotView {
                    index,
                    team: teams[index],
                    active: true,
                    present: true,
                    pose: state.pose,
                    twist: state.twist,
                    radius: state.radius(),
                    v_max: 1.0,
                })
                .collect();
            let beliefs = [BeliefView {
                robot: INTRUDER,
                particles: &[],
                mean: robots[INTRUDER].pose,
                position_std: 0.0,
                seen: self.is_seen,
            }];
            let mut commands: Vec<Option<Twist2>> = Vec::new();
            for (me, guard) in self.guards.iter_mut().enumerate() {
                let view = View {
                    time_s,
                    dt: TICK.as_secs_f64(),
                    me,
                    robots: &robots,
                    beliefs: &beliefs,
                    exits: &[],
                    scan: None,
                };
                commands.push(Some(guard.steer(&self.map, &view).command));
                let events = guard.events().iter();
                self.events
                    .extend(events.map(|event| (time_s, me, event.kind)));
            }
            commands.resize(INTRUDER, None);
            // A circle of 3 m.
            commands.push(Some(Twist2::new(0.6, 0.2)));
            self.world.step(&commands, TICK);
        }
    }
}

#[test]
fn the_nearest_guard_pursues_the_others_close_the_gap_and_all_return() {
    let mut chase = Chase::new();
    chase.drive(30.0);
    assert!(chase.pursuing().is_empty());
    chase.is_seen = true;
    chase.drive(0.1);
    let [pursuer] = chase.pursuing()[..] else {
        panic!("{:?}", chase.pursuing());
    };
    let all = chase.distances();
    assert!(
        all.iter().all(|&d| d >= all[pursuer] - 0.2),
        "{pursuer} {all:?}"
    );

    // It stays at the intruder; the others are half of the contour apart.
    chase.drive(60.0);
    assert_eq!(chase.pursuing(), [pursuer]);
    assert!(chase.distances()[pursuer] < 1.5, "{:?}", chase.distances());
    let others: Vec<usize> = (0..GUARDS).filter(|&guard| guard != pursuer).collect();
    for _ in 0..10 {
        chase.drive(3.0);
        assert!(chase.apart(others[0], others[1]) > 0.4 * 48.0);
    }

    // It is not seen any more: after 5 s the guard gives up, and all are a third of the contour apart again.
    chase.is_seen = false;
    chase.drive(4.0);
    assert_eq!(chase.pursuing(), [pursuer]);
    chase.drive(2.0);
    assert!(chase.pursuing().is_empty());
    chase.drive(60.0);
    for _ in 0..10 {
        chase.drive(3.0);
        for (a, b) in [(0, 1), (1, 2), (2, 0)] {
            assert!(
                chase.apart(a, b) > 0.25 * 48.0,
                "{a} {b} {}",
                chase.apart(a, b)
            );
        }
    }
    let kinds: Vec<(usize, RobotEventKind)> = chase
        .events
        .iter()
        .map(|&(_, guard, kind)| (guard, kind))
        .collect();
    assert_eq!(
        kinds,
        [
            (pursuer, RobotEventKind::Sighted),
            (pursuer, RobotEventKind::Lost),
            (pursuer, RobotEventKind::Returned)
        ]
    );
}

#[test]
fn a_guard_of_its_own_returns_to_where_it_is_nearest_to_the_contour() {
    let mut chase = Chase::new();
    let text =
        format!("mission = {{ contour = {SQUARE:?}, t_max = 100.0 }}\npursue = {{ lost_s = 1.0 }}");
    let params: PatrolAwgParams = toml::from_str(&text).unwrap();
    let model = spec(0).model();
    let limits = Limits::new(model.v_max, model.v_reverse_max, model.omega_max).unwrap();
    let patrol = PatrolAwg::new(&params, &model, 1).unwrap();
    let guard = Guard::new(patrol).pursuing(params.pursue.as_ref().unwrap(), &[0], limits, 1);
    chase.guards = vec![guard.unwrap()];
    // The others stand.
    chase.drive(20.0);
    chase.is_seen = true;
    chase.drive(20.0);
    chase.is_seen = false;
    chase.drive(15.0);
    let at = chase.position(0);
    chase.drive(10.0);
    // It goes on along the contour from there, not from where it left it.
    let ahead = chase.ring.between(at, chase.position(0));
    assert!((2.0..10.0).contains(&ahead), "{ahead}");
    assert_eq!(chase.events.last().unwrap().2, RobotEventKind::Returned);
}
