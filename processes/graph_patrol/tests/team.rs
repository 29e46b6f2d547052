//! Teams on a graph in a world with bodies: all nodes are visited, also when a robot falls silent.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use core::time::Duration;

use geometry::map::{MapSpec, VectorMap};
use geometry::pose::Pose2;
use graph_patrol::{GraphPatrol, GraphPatrolParams, Intention};
use metrics::idleness::NodeIdleness;
use nalgebra::Point2;
use patrol_graph::Strategy;
use planner_view::limits::Limits;
use planner_view::map::PlannerMap;
use planner_view::view::{RobotView, ScanView, View};
use robot::spec::RobotSpec;
use robot::team::Role;
use sim_backend::spec::{RulesSpec, WorldSpec};
use sim_backend::world::World;

const TICK: Duration = Duration::from_millis(100);
const SIDE: f64 = 16.0;

fn params(strategy: Strategy) -> GraphPatrolParams {
    let mut params = GraphPatrolParams {
        strategy,
        ..GraphPatrolParams::default()
    };
    // 3 × 3 nodes.
    for node in 0..9 {
        let (column, row) = (node % 3, node / 3);
        params
            .graph
            .nodes
            .push([3.0 + 5.0 * column as f64, 3.0 + 5.0 * row as f64]);
        if column > 0 {
            params.graph.edges.push([node - 1, node]);
        }
        if row > 0 {
            params.graph.edges.push([node - 3, node]);
        }
    }
    params
}

fn spec(index: usize) -> RobotSpec {
    let mut spec: RobotSpec = toml::from_str(
        "name = \"guard\"\nteam = \"neutral\"\nstart = { x = 0.0, y = 0.0, theta = 0.0 }\nradius = 0.22\n\
         limits = { v_max = 1.0, omega_max = 5.0 }\n\
         scan = { beams = 72, angle_increment = 0.08726646, range_min = 0.0, range_max = 2.0, noise = 0.0 }",
    )
    .unwrap();
    spec.name = format!("guard_{index}");
    spec.start = Pose2::new(2.0 + 2.0 * index as f64, 1.0, 0.5);
    spec
}

struct Team {
    world: World,
    map: PlannerMap,
    guards: Vec<GraphPatrol>,
    /// Robots that get no commands and say nothing.
    failed: Vec<usize>,
}

impl Team {
    fn new(params: &GraphPatrolParams, count: usize) -> Self {
        let world = World::new(WorldSpec {
            map: MapSpec::Vector(VectorMap::empty([0.0, 0.0], [SIDE, SIDE], 0.1)),
            robots: (0..count).map(spec).collect(),
            rules: RulesSpec::default(),
            seed: 1,
        })
        .unwrap();
        let map = PlannerMap::of_world(world.map(), 0.2, 1).unwrap();
        let companions: Vec<u32> = (0..count as u32).collect();
        let guard = |index: usize| {
            let limits = Limits::new(1.0, 0.0, 5.0).unwrap();
            let (model, seed) = (spec(index).model(), index as u64);
            let mut guard = GraphPatrol::new(params, &model, limits, seed).unwrap();
            guard.join(index as u32, &companions);
            guard.enter(&map).unwrap();
            guard
        };
        Self {
            guards: (0..count).map(guard).collect(),
            map,
            world,
            failed: Vec::new(),
        }
    }

    /// Drives for a time (s), and measures the idleness of the nodes within it.
    fn drive(&mut self, nodes: &[[f64; 2]], seconds: f64) -> NodeIdleness {
        let nodes: Vec<Point2<f64>> = nodes.iter().map(|&node| node.into()).collect();
        let mut idleness = NodeIdleness::new(nodes, 0.5);
        let began_s = self.world.time().as_secs_f64();
        let mut intentions: Vec<Intention> = Vec::new();
        while self.world.time().as_secs_f64() < began_s + seconds {
            let now_s = self.world.time().as_secs_f64();
            let robots: Vec<RobotView> = self
                .world
                .robots()
                .iter()
                .enumerate()
                .map(|(index, state)| RobotView {
                    index,
                    team: Role::Neutral.into(),
                    active: true,
                    present: true,
                    pose: state.pose,
                    twist: state.twist,
                    radius: state.radius(),
                    v_max: 1.0,
                })
                .collect();
            let mut ranges = Vec::new();
            let mut commands = Vec::new();
            for (me, guard) in self.guards.iter_mut().enumerate() {
                for intention in &intentions {
                    guard.hear(intention, now_s);
                }
                let scan = *self.world.scan(me, &mut ranges).unwrap();
                let view = View {
                    time_s: now_s,
                    dt: TICK.as_secs_f64(),
                    me,
                    robots: &robots,
                    beliefs: &[],
                    exits: &[],
                    scan: Some(ScanView {
                        angle_min: scan.angle_min,
                        angle_increment: scan.angle_increment,
                        range_min: scan.range_min,
                        range_max: scan.range_max,
                        ranges: &ranges,
                    }),
                };
                let command = guard.steer(&self.map, &view).command;
                commands.push((!self.failed.contains(&me)).then_some(command));
            }
            intentions.clear();
            let guards = self.guards.iter().enumerate();
            let heard = guards.filter(|(me, _)| !self.failed.contains(me));
            intentions.extend(heard.map(|(_, guard)| guard.intention()));
            self.world.step(&commands, TICK);
            let moving = robots
                .iter()
                .filter(|robot| !self.failed.contains(&robot.index));
            idleness.add(now_s - began_s, moving.map(|robot| robot.pose.position()));
        }
        idleness
    }
}

const ALL: [Strategy; 9] = [
    Strategy::Random,
    Strategy::ConscientiousReactive,
    Strategy::HeuristicReactive,
    Strategy::HeuristicPathfinder,
    Strategy::Greedy,
    Strategy::StateExchange,
    Strategy::TaskAssignment,
    Strategy::Partition,
    Strategy::Cyclic,
];

#[test]
fn every_strategy_visits_all_nodes_again_after_a_robot_has_fallen_silent() {
    for strategy in ALL {
        let params = params(strategy);
        let mut team = Team::new(&params, 3);
        let worst_s = |idleness: &NodeIdleness| idleness.figures().map(|f| f.worst_s);
        let before = worst_s(&team.drive(&params.graph.nodes, 400.0));
        assert!(before.is_some(), "{strategy:?}: a node has no visits");
        team.failed = vec![1];
        let after = worst_s(&team.drive(&params.graph.nodes, 400.0));
        assert!(
            after.is_some(),
            "{strategy:?}: a node has no visits after a failure"
        );
        if strategy == Strategy::Cyclic {
            // A walk of 9 to 10 edges of 5 m at 1 m/s, shared by three robots and then by two, after they have gathered.
            let settled = worst_s(&team.drive(&params.graph.nodes, 400.0)).unwrap();
            assert!((20.0..40.0).contains(&settled), "{settled}");
        }
    }
}
