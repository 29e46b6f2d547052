//! Planners that steer otherwise from a tick on.

use std::cell::RefCell;
use std::collections::BTreeMap;

use evader_potential::process::PotentialPlanner;
use geometry::region::Region;
use ipc_types::bus::Bus;
use planner::{PlannedPoint, Planner, PlannerError, PlannerProcess};
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::View;
use pursuer::process::PursuerPlanner;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use runtime::ProcessError;
use runtime::config::{ProcessConfig, RobotInfo};
use runtime::declaration::Declaration;
use scenario::kind::ConfiguredKind;

use super::{TICKS, assert_caused, compared, run};

thread_local! {
    /// First tick in which the planner of a robot steers otherwise.
    static CHANGED_FROM: RefCell<BTreeMap<String, u64>> = const { RefCell::new(BTreeMap::new()) };
}

/// A planner that turns a little faster from a tick on.
struct Changed<P> {
    inner: P,
    from: u64,
}

impl<P: Planner> Planner for Changed<P> {
    const NAME: &'static str = P::NAME;
    const SUMMARY: &'static str = P::SUMMARY;
    type Params = P::Params;

    fn declare(params: &Self::Params) -> Declaration {
        P::declare(params)
    }

    fn new(params: &Self::Params, robot: &RobotInfo, seed: u64) -> Result<Self, PlannerError> {
        let from = CHANGED_FROM.with_borrow(|all| all.get(&robot.name).copied());
        Ok(Self {
            inner: P::new(params, robot, seed)?,
            from: from.unwrap_or(u64::MAX),
        })
    }

    fn rules(&mut self, exits: &[Region], capture_radius: f64) {
        self.inner.rules(exits, capture_radius);
    }

    fn open(&mut self, config: &ProcessConfig, bus: &Bus, robot: u32) -> Result<(), ProcessError> {
        self.inner.open(config, bus, robot)
    }

    fn prepare(&mut self, map: &PlannerMap, robot: &RobotInfo) {
        self.inner.prepare(map, robot);
    }

    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        let mut steering = self.inner.steer(map, view);
        if view.time_s > (self.from as f64 - 0.5) * view.dt {
            steering.command.omega += 1e-9;
        }
        steering
    }

    fn plan(&self, steering: &Steering, out: &mut Vec<PlannedPoint>) {
        self.inner.plan(steering, out);
    }
}

/// The pursuers and evaders of the chase, with their processes.
const ROBOTS: [(&str, &str); 6] = [
    ("evader_1", "evader_potential_evader_1"),
    ("evader_2", "evader_potential_evader_2"),
    ("police_1", "pursuer_police_1"),
    ("police_2", "pursuer_police_2"),
    ("police_3", "pursuer_police_3"),
    ("police_4", "pursuer_police_4"),
];

/// The kinds of all planners of the chase, changed.
fn programs() -> Vec<(String, ConfiguredKind)> {
    let scenario = kinds::load("chase", &[], None).unwrap();
    let processes = scenario.processes.iter().filter_map(|process| {
        let kind = process.program.kind()?;
        let changed = if let Some(params) = kind.params::<<PursuerPlanner as Planner>::Params>() {
            ConfiguredKind::new::<PlannerProcess<Changed<PursuerPlanner>>>(*params)
        } else {
            let params = kind.params::<<PotentialPlanner as Planner>::Params>()?;
            ConfiguredKind::new::<PlannerProcess<Changed<PotentialPlanner>>>(*params)
        };
        Some((process.name.clone(), changed))
    });
    processes.collect()
}

#[test]
fn the_planners_that_steer_otherwise_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let a = run(&folder, "a.mcap", programs());
    let original = run(&folder, "original.mcap", Vec::new());
    assert!(compared(&a, &original).same);
    let mut rng = ChaCha8Rng::seed_from_u64(54);
    for mutant in 0..40 {
        // The last 20 have two changed planners.
        let count = if mutant < 20 { 1 } else { 2 };
        let from = rng.random_range(0..TICKS);
        let first = rng.random_range(0..ROBOTS.len());
        let second = (first + rng.random_range(1..ROBOTS.len())) % ROBOTS.len();
        let mut changed = [first, second][..count].to_vec();
        changed.sort_unstable();
        CHANGED_FROM.with_borrow_mut(|all| {
            all.clear();
            all.extend(changed.iter().map(|&at| (ROBOTS[at].0.to_owned(), from)));
        });
        let b = run(&folder, &format!("{mutant}.mcap"), programs());
        let expected: Vec<_> = changed
            .iter()
            .map(|&at| (ROBOTS[at].1, "robot/command", "omega"))
            .collect();
        let report = compared(&a, &b);
        assert_caused(&report, from, &expected);
        let causes = &report.comparison.first.unwrap().causes;
        let robots: Vec<_> = causes.iter().map(|cause| cause.robot.as_deref()).collect();
        let named: Vec<_> = changed.iter().map(|&at| Some(ROBOTS[at].0)).collect();
        assert_eq!(robots, named);
        std::fs::remove_file(b).unwrap();
    }
}
