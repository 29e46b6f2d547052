//! A robot that patrols a graph with its team.

use std::collections::VecDeque;
use std::sync::Arc;

use avoidance::waypoint_driver::{Situation, WaypointDriver};
use chaotic_maps::{Key, KeyError};
use nalgebra::{Point2, Vector2};
use navigation::shortest_paths::ShortestPaths;
use parameters::{ParamsError, check};
use patrol_graph::{LastVisits, OfMapError, PatrolGraph, Seen, Strategy, Walker, graph_of_map};
use planner_view::limits::Limits;
use planner_view::map::PlannerMap;
use planner_view::stay::{LINGERED_S, Stay};
use planner_view::steering::Steering;
use planner_view::view::{RobotView, View};
use planner_view::waypoint::{Waypoint, WaypointKind, WaypointOutcome, WaypointReport};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use robot::spec::RobotModel;

use crate::chain::{attacks, chain};
use crate::messages::Intention;
use crate::params::GraphPatrolParams;

/// Time without a message after which a robot counts as failed (s), and number of steps, whichever is longer.
const SILENCE: (f64, f64) = (1.0, 3.0);

/// Distance that paths keep from obstacles, as a multiple of the robot's radius.
const CLEARANCE: f64 = 1.1;

/// Spot on which a robot drives around: as a share of its way at full speed within [`LINGERED_S`].
const SPOT: f64 = 0.1;

/// Another robot of the team.
#[derive(Debug, Clone, Copy)]
struct Mate {
    robot: u32,
    stay: Stay,
    /// Its last message, and the time of it (s).
    intention: Option<(Intention, f64)>,
}

/// The patrol on a map.
#[derive(Debug, Clone)]
struct Site {
    graph: Arc<PatrolGraph>,
    paths: Option<ShortestPaths>,
    walker: Walker<ChaCha8Rng>,
    visits: LastVisits,
    /// The last node of the robot, and the one it heads for.
    at: Option<usize>,
    next: Option<usize>,
    /// Points up to that node.
    ahead: VecDeque<Waypoint>,
    began_s: f64,
}

/// One robot of a team that patrols a graph.
#[derive(Debug, Clone)]
pub struct GraphPatrol {
    params: GraphPatrolParams,
    limits: Limits,
    model: RobotModel,
    seed: u64,
    me: u32,
    mates: Vec<Mate>,
    driver: WaypointDriver,
    site: Option<Site>,
    number: u64,
    /// Number of robots of the team in play.
    team: usize,
    reports: Vec<WaypointReport>,
}

impl GraphPatrol {
    /// Returns a robot that has not set out yet, with its limits and its seed.
    ///
    /// # Errors
    /// [`ParamsError`] naming the invalid parameter.
    pub fn new(
        params: &GraphPatrolParams,
        model: &RobotModel,
        limits: Limits,
        seed: u64,
    ) -> Result<Self, ParamsError> {
        check(params)?;
        let driver = params
            .driver
            .for_drive(model.acceleration, model.angular_acceleration);
        Ok(Self {
            params: params.clone(),
            limits,
            model: *model,
            seed,
            me: 0,
            mates: Vec::new(),
            driver: WaypointDriver::new(driver, limits, model.radius)?,
            site: None,
            number: 0,
            team: 1,
            reports: Vec::new(),
        })
    }

    /// Makes it the robot with this index, one of a team, itself included.
    pub fn join(&mut self, me: u32, team: &[u32]) {
        self.me = me;
        let others = team.iter().filter(|&&robot| robot != me);
        self.mates = others
            .map(|&robot| Mate {
                robot,
                stay: Stay::default(),
                intention: None,
            })
            .collect();
    }

    /// Takes the map. The first one may make the graph; later changes lead around other obstacles only.
    ///
    /// # Errors
    /// [`OfMapError`] if the map has no graph.
    pub fn enter(&mut self, map: &PlannerMap) -> Result<(), OfMapError> {
        let paths = ShortestPaths::new(map, CLEARANCE * self.model.radius).ok();
        if let Some(site) = &mut self.site {
            site.paths = paths;
            return Ok(());
        }
        let graph = graph(&self.params, map, self.model.radius)?;
        let Ok(graph) = PatrolGraph::new(&graph).map(Arc::new) else {
            // Checked with the parameters, and connected if it is from the map.
            return Ok(());
        };
        let v = self.limits.v_max() * self.params.driver.go_to.speed_fraction;
        let rng = ChaCha8Rng::seed_from_u64(self.seed);
        let mut walker = Walker::new(graph.clone(), self.params.strategy, v, rng);
        // Checked with the task.
        if self.params.strategy == Strategy::Markov
            && let Ok(chain) = attacks(&self.params, &graph, &self.model).and_then(chain)
            && let Ok(key) = self.key()
        {
            walker = walker.on_chain(chain, key);
        }
        self.site = Some(Site {
            visits: LastVisits::new(&graph, 0.0),
            walker: walker.with(self.params.bayes, self.params.assignment),
            graph,
            paths,
            at: None,
            next: None,
            ahead: VecDeque::new(),
            began_s: 0.0,
        });
        Ok(())
    }

    /// The key of its draws.
    fn key(&self) -> Result<[u8; 32], KeyError> {
        let before = self.mates.iter().filter(|mate| mate.robot < self.me);
        let of_team = self.params.markov.key;
        Key::secret(
            of_team.map(|key| key.of_robot(before.count() as u64)),
            self.seed,
        )
    }

    /// Takes an intention of a robot of the team, sent at a time (s).
    pub fn hear(&mut self, intention: &Intention, time_s: f64) {
        let mut mates = self.mates.iter_mut();
        if let Some(mate) = mates.find(|mate| mate.robot == intention.robot) {
            mate.intention = Some((*intention, time_s));
        }
    }

    /// The intention of the robot after the last step.
    pub fn intention(&self) -> Intention {
        let site = self.site.as_ref();
        let node = site.and_then(|site| site.walker.target().or(site.next));
        Intention {
            robot: self.me,
            node: node.map_or(Intention::NONE, |node| node as u32),
            team: self.team as u32,
            ready: site.is_some_and(|site| site.walker.is_ready()).into(),
        }
    }

    /// Returns the waypoints that ended in the last tick.
    pub fn reports(&self) -> &[WaypointReport] {
        &self.reports
    }

    /// Returns the command for this tick; a stop if its pose or the map is not known.
    pub fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        self.reports.clear();
        let (Some(own), Some(mut site)) = (view.own(), self.site.take()) else {
            return Steering::stop();
        };
        let steering = self.patrol(&mut site, own, map, view);
        self.site = Some(site);
        steering
    }

    fn patrol(
        &mut self,
        site: &mut Site,
        own: &RobotView,
        map: &PlannerMap,
        view: &View<'_>,
    ) -> Steering {
        let here = own.pose.position();
        if site.began_s == 0.0 && site.at.is_none() && site.next.is_none() {
            site.began_s = view.time_s;
            site.visits = LastVisits::new(&site.graph, view.time_s);
        }
        let mates = self.in_play(site, view);
        self.team = mates.len() + 1;
        let robots = mates
            .iter()
            .filter_map(|mate| view.robot(mate.robot as usize));
        for robot in robots.chain([own]) {
            let (at, within) = (robot.pose.position(), self.params.visit);
            site.visits.robot_at(&site.graph, at, within, view.time_s);
        }
        let situation = Situation {
            pose: own.pose,
            twist: own.twist,
            scan: view.scan,
            known: map.space().map(AsRef::as_ref),
            time_s: view.time_s,
            dt: view.dt,
        };
        let mut absent: Vec<u32> = self.mates.iter().map(|mate| mate.robot).collect();
        absent.retain(|robot| mates.iter().all(|mate| mate.robot != *robot));
        let counts = |robot: &RobotView| robot.active && !absent.contains(&(robot.index as u32));
        let visit = self.params.visit;
        let is_covered = |point: Point2<f64>| {
            (point - here).norm() <= visit && view.is_covered(point, own, counts)
        };
        // A robot that arrives goes on in the same tick.
        for _ in 0..2 {
            let first = self.reports.len();
            let ahead = &mut site.ahead;
            let mut next = || ahead.pop_front();
            (self.driver).leave_out(is_covered, view.time_s, &mut self.reports);
            let driving = self.driver.drive(&mut next, &situation, &mut self.reports);
            let ended = self.reports.get(first..).unwrap_or_default();
            let failed = ended.iter().any(|r| r.outcome != WaypointOutcome::Reached);
            if let Some(waypoint) = self.driver.current() {
                return Steering {
                    command: driving.command,
                    target: None,
                    aim: site.next.and_then(|n| site.graph.points().get(n).copied()),
                    waypoint: driving.towards.or(Some(waypoint.point)),
                    field: Vector2::zeros(),
                };
            }
            self.arrive(site, here, failed);
            self.choose(site, here, &mates, view);
        }
        Steering::stop()
    }

    /// The other robots that take part: in play, not silent for long since the start, and not lost on the way to a node.
    fn in_play(&mut self, site: &Site, view: &View<'_>) -> Vec<Mate> {
        let silence_s = SILENCE.0.max(SILENCE.1 * view.dt);
        let is_in_play = |mate: &mut Mate| {
            let seen = view.robot(mate.robot as usize);
            let Some(robot) = seen.filter(|robot| robot.active) else {
                mate.stay = Stay::default();
                return false;
            };
            let (here, points) = (robot.pose.position(), site.graph.points());
            let to = mate
                .intention
                .and_then(|(i, _)| points.get(i.node as usize));
            let is_due = to.is_none_or(|to| (to - here).norm() <= self.params.visit);
            let reach = [robot.radius, SPOT * robot.v_max * LINGERED_S];
            let is_lost = mate.stay.is_lost(here, view.time_s, reach, is_due);
            let heard_s = mate.intention.map_or(site.began_s, |(_, heard_s)| heard_s);
            !is_lost && view.time_s - heard_s <= silence_s
        };
        let mates = self.mates.iter_mut();
        mates
            .filter_map(|mate| is_in_play(mate).then_some(*mate))
            .collect()
    }

    /// The robot is at the node that it headed for, unless a waypoint failed away from it.
    fn arrive(&self, site: &mut Site, here: Point2<f64>, failed: bool) {
        let Some(next) = site.next.take() else {
            return;
        };
        let distance = site
            .graph
            .points()
            .get(next)
            .map(|node| (node - here).norm());
        if failed && distance.is_none_or(|distance| distance > self.params.visit) {
            site.walker.give_up();
            site.at = Some(site.graph.nearest(here));
        } else {
            site.at = Some(next);
        }
    }

    /// Chooses the next node, and the way to it.
    fn choose(&mut self, site: &mut Site, here: Point2<f64>, mates: &[Mate], view: &View<'_>) {
        let next = match site.at {
            // First to the nearest node.
            None => Some(site.graph.nearest(here)),
            Some(at) => {
                let heard: Vec<Intention> = mates
                    .iter()
                    .filter_map(|mate| Some(mate.intention?.0))
                    .collect();
                let intentions: Vec<usize> = heard.iter().map(|i| i.node as usize).collect();
                let ready = heard
                    .iter()
                    .filter(|i| i.ready == 1 && i.team as usize == self.team);
                let seen = Seen {
                    idleness_s: &site.visits.idleness_s(view.time_s),
                    intentions: &intentions,
                    rank: mates.iter().filter(|mate| mate.robot < self.me).count(),
                    robots: self.team,
                    others_ready: ready.count() == mates.len(),
                    time_s: view.time_s,
                };
                site.walker.next(at, &seen)
            }
        };
        let Some(next) = next else {
            return;
        };
        let Some(&to) = site.graph.points().get(next) else {
            return;
        };
        let corners = site
            .paths
            .as_ref()
            .and_then(|paths| paths.corners(here, to).ok());
        let corners = corners.filter(|corners| !corners.is_empty());
        let corners = corners.unwrap_or_else(|| vec![here, to]);
        let last = corners.len().saturating_sub(1);
        for (place, &point) in corners.iter().enumerate().skip(last.min(1)) {
            let kind = if place == last {
                WaypointKind::SubGoal
            } else {
                WaypointKind::Transit
            };
            site.ahead.push_back(Waypoint {
                number: self.number,
                lap: 0,
                kind,
                point,
            });
            self.number += 1;
        }
        site.next = Some(next);
    }
}

/// The graph that a robot of this radius (m) patrols on a map.
///
/// # Errors
/// [`OfMapError`] if it follows from the map and the map has none.
pub fn graph(
    params: &GraphPatrolParams,
    map: &PlannerMap,
    radius: f64,
) -> Result<patrol_graph::GraphParams, OfMapError> {
    if params.graph.nodes.is_empty() {
        graph_of_map(map, radius, params.spacing)
    } else {
        Ok(params.graph.clone())
    }
}
