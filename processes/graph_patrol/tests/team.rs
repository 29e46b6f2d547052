//! Teams on a graph in a world with bodies: all nodes are visited, also when a robot falls silent.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use core::time::Duration;

use geometry::map::{MapSpec, VectorMap};
use geometry::pose::{Pose2, Twist2};
use graph_patrol::{GraphPatrol, GraphPatrolParams, Intention};
use metrics::idleness::NodeIdleness;
use nalgebra::Point2;
use patrol_chain::KeyedStream;
use patrol_graph::{Attacks, PatrolGraph, Strategy};
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
    /// Robots that drive in circles.
    trapped: Vec<usize>,
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
            trapped: Vec::new(),
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
                let mut command = guard.steer(&self.map, &view).command;
                if self.trapped.contains(&me) {
                    command = Twist2::new(0.5, 1.0);
                }
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

const ALL: [Strategy; 10] = [
    Strategy::Random,
    Strategy::ConscientiousReactive,
    Strategy::HeuristicReactive,
    Strategy::HeuristicPathfinder,
    Strategy::Greedy,
    Strategy::StateExchange,
    Strategy::TaskAssignment,
    Strategy::Partition,
    Strategy::Cyclic,
    Strategy::Markov,
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

#[test]
fn a_robot_that_drives_around_on_one_spot_is_left_out_until_it_gets_on() {
    let params = params(Strategy::StateExchange);
    let mut team = Team::new(&params, 3);
    let counted = |team: &Team| [0, 2].map(|at: usize| team.guards[at].intention().team);
    team.drive(&params.graph.nodes, 60.0);
    assert_eq!(counted(&team), [3, 3]);
    team.trapped = vec![1];
    team.drive(&params.graph.nodes, 15.0);
    assert_eq!(counted(&team), [3, 3]);
    team.drive(&params.graph.nodes, 10.0);
    assert_eq!(counted(&team), [2, 2]);
    team.trapped.clear();
    team.drive(&params.graph.nodes, 10.0);
    assert_eq!(counted(&team), [3, 3]);
}

#[test]
fn a_node_on_which_a_robot_failed_is_visited_beside_it_without_delay() {
    let params = params(Strategy::Cyclic);
    let nodes = &params.graph.nodes;
    let mut team = Team::new(&params, 2);
    team.drive(nodes, 60.0);
    let is_on_a_node = |team: &Team| {
        let at = team.world.robots()[1].pose.position();
        let apart = |node: &[f64; 2]| (Point2::from(*node) - at).norm();
        nodes.iter().any(|node| apart(node) < 0.15)
    };
    while !is_on_a_node(&team) {
        team.drive(nodes, TICK.as_secs_f64());
    }
    team.failed = vec![1];
    team.drive(nodes, 100.0);
    let worst_s = team.drive(nodes, 300.0).figures().unwrap().worst_s;
    // A walk of 10 edges of 5 m at 1 m/s by one robot: 51.7 s, and 56.4 s if it tries to reach the body.
    assert!(worst_s <= 54.0, "{worst_s}");
}

#[test]
fn an_ally_with_the_key_knows_where_a_robot_on_a_chain_drives_and_when() {
    let mut params = params(Strategy::Markov);
    params.markov.key = Some(format!("keyed:{}", "5a".repeat(32)).parse().unwrap());
    let mut team = Team::new(&params, 2);
    let nodes = &params.graph.nodes;

    // Each robot of the team has a key of its own.
    let graph = PatrolGraph::new(&params.graph).unwrap();
    let chain = Attacks::new(&graph, 120.0, 1.0, core::f64::consts::PI / 5.0)
        .and_then(|attacks| attacks.chain())
        .unwrap();
    let mut heads_for: [Vec<(usize, f64)>; 2] = Default::default();
    for tick in 0..4000 {
        team.drive(nodes, TICK.as_secs_f64());
        for (headed, guard) in heads_for.iter_mut().zip(&team.guards) {
            let node = guard.intention().node as usize;
            if headed.last().map(|last| last.0) != Some(node) {
                headed.push((node, f64::from(tick) * TICK.as_secs_f64()));
            }
        }
    }
    for (number, headed) in heads_for.iter().enumerate() {
        let key = params.markov.key.unwrap().of_robot(number as u64);
        let mut ally = KeyedStream::new(chaotic_maps::Key::secret(Some(key), 0).unwrap());
        assert!(headed.len() > 60, "{}", headed.len());
        for pair in headed.windows(2) {
            assert_eq!(pair[1].0, chain.draw(pair[0].0, &mut ally));
        }
        // From the second drive on, each takes no longer than the chain counts, unless robots evade each other.
        let late = headed[1..]
            .windows(2)
            .filter(|pair| pair[1].1 - pair[0].1 > 5.7);
        assert!(late.count() * 10 < headed.len());
    }
}
