//! Controller of one evader: when it plans, its motion meanwhile, and the follower of its plans.

use control::feedback_linearisation::EPSILON;
use control::path_tracking::{PathTracker, TrackingParams};
use geometry::pose::Pose2;
use nalgebra::Point2;
use navigation::shortest_paths::END_TOLERANCE;
use parameters::{ParamsError, check};
use planner_view::free_space::FreeSpace;
use planner_view::limits::Limits;
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::{RobotView, View};
use pursuit_evasion::potential_evader::{Evader, EvaderParams};
use robot::team::Role;

use crate::collision_map::{Body, CollisionMap};
use crate::cost::{CostModel, Pursuer};
use crate::follow;
use crate::params::{Follower, ReplanRule, RrtStarParams};
use crate::planning::{self, Planning, Task};
use crate::replan::{is_threatened, papers_safety};
use crate::route::Route;
use crate::tree::NONE;

/// Maximum distance by which a start in contact may be moved to be free (m).
const MAX_PUSH: f64 = 1.0;

/// Tolerance of times (s).
const SAME_TIME: f64 = 1e-9;

/// Maximum distance between arcs and the straight pieces that draw them (m).
const CHORD: f64 = 0.003;

/// Speed below which a robot counts as an obstacle (m/s).
const STANDING: f64 = 0.02;

/// Threshold of the paper's measure of safety below which its rule replans.
const PAPER_THRESHOLD: f64 = 1.5;

/// Distance from the exit within which the paper's rule plans at every chance (m).
const PAPER_NEAR_EXIT: f64 = 0.3;

/// Distance of the control point from a point of the path at which the potential field turns to the
/// next (m).
const WAYPOINT_REACHED: f64 = 0.3;

/// Maximum number of edges of a shown tree.
pub const SHOWN_EDGES: usize = 512;

/// An edge of a tree, drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShownEdge {
    /// The parent (m).
    pub from: Point2<f64>,
    /// The child (m).
    pub to: Point2<f64>,
    /// Cost from the root to the child (m).
    pub cost: f64,
    /// `true` if it belongs to the chosen path.
    pub on_path: bool,
}

/// A plan that has been computed but is not in force yet.
#[derive(Debug, Clone)]
struct PendingPlan {
    due_s: f64,
    route: Option<Route>,
    tree: Vec<ShownEdge>,
}

/// An evader that plans with RRT*.
#[derive(Debug)]
pub struct RrtStarEvader {
    params: RrtStarParams,
    field: EvaderParams,
    limits: Limits,
    planning: Box<dyn Planning>,
    cost: CostModel,
    pursuers: Vec<Pursuer>,
    bodies: Vec<Body>,
    flight: Evader,
    /// The map with the margin, and without.
    grounds: [Option<CollisionMap>; 2],
    /// `true` if the last plan found no path with the margin.
    is_tight: bool,
    /// Inputs of the last plan: revision of the map, and the bodies.
    planned_for: (u64, Vec<Body>),
    /// Inputs of the last check that found the route free.
    route_checked: (u64, Vec<Body>),
    route: Option<Route>,
    tracker: PathTracker,
    /// Next point of the route, for the potential field.
    next: usize,
    pending: Option<PendingPlan>,
    /// Start of the last plan, and the last check of the paper's rule (s).
    begun_s: Option<f64>,
    looked_s: f64,
    off_path: f64,
    tree: Vec<ShownEdge>,
    tree_is_new: bool,
    /// Output of the last tick.
    last: Steering,
}

impl RrtStarEvader {
    /// Returns an evader for a robot with these limits; all random values follow from the seed.
    ///
    /// # Errors
    /// [`ParamsError`] if a parameter is out of range.
    pub fn new(params: RrtStarParams, limits: Limits, seed: u64) -> Result<Self, ParamsError> {
        check(&params)?;
        let field = params.follower.field();
        Ok(Self {
            params,
            field,
            limits,
            planning: planning::for_robot(&params, &limits, seed),
            cost: CostModel::new(params.cost, params.search.algorithm, limits.v_max()),
            pursuers: Vec::new(),
            bodies: Vec::new(),
            flight: Evader::new(field, limits, seed)?,
            grounds: [None, None],
            is_tight: false,
            planned_for: (u64::MAX, Vec::new()),
            route_checked: (u64::MAX, Vec::new()),
            route: None,
            tracker: PathTracker::default(),
            next: 0,
            pending: None,
            begun_s: None,
            looked_s: f64::NEG_INFINITY,
            off_path: 0.0,
            tree: Vec::new(),
            tree_is_new: false,
            last: Steering::stop(),
        })
    }

    /// Prepares a new map for a robot of this radius (m) before the next tick. Otherwise
    /// [`Self::command`] does it within a tick.
    pub fn prepare(&mut self, map: &PlannerMap, radius: f64) {
        self.flight.prepare(map, radius);
        if let Some(space) = map.space() {
            self.learn(space, radius, map.revision());
        }
    }

    /// The route it follows now.
    pub fn route(&self) -> Option<&Route> {
        self.route.as_ref()
    }

    /// Returns the progress along the route (m).
    pub fn progress(&self) -> f64 {
        self.tracker.progress()
    }

    /// Returns the tree of the followed plan, each tree once; `None` if there is no new one.
    pub fn take_tree(&mut self) -> Option<&[ShownEdge]> {
        core::mem::take(&mut self.tree_is_new).then_some(&self.tree[..])
    }

    /// Returns the command of the robot `view.me` for this tick.
    ///
    /// It stands still if it is not listed or no longer takes part. Without a path to an exit it
    /// drives as far towards one as it found a path, and otherwise flees by its potential field; by
    /// the paper's rule its last command continues. It also flees so where the map's exact geometry
    /// is not known.
    pub fn command(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        let Some(own) = view.own().filter(|own| own.active) else {
            self.route = None;
            return Steering::stop();
        };
        let Some(space) = map.space() else {
            return self.flight.command(map, view);
        };
        self.look_round(view, own);
        self.learn(space, own.radius, map.revision());
        let goals = self.goals(view);
        self.take_up(view.time_s);
        self.drop_blocked(own, map.revision());
        if self.wants_plan(view.time_s, own, &goals) {
            self.begin(view.time_s, own, &goals, map.revision());
            self.take_up(view.time_s);
        }
        let steering = self.follow(map, view, own).unwrap_or_else(|| {
            if self.params.replan.rule.keeps_command() && !goals.is_empty() {
                self.last
            } else {
                self.flight.command(map, view)
            }
        });
        self.last = steering;
        steering
    }

    fn look_round(&mut self, view: &View<'_>, own: &RobotView) {
        self.pursuers.clear();
        let police = view.opponents(Role::Pursuer);
        self.pursuers.extend(police.map(|robot| Pursuer {
            at: robot.pose.position(),
            v_max: robot.v_max,
        }));
        self.bodies.clear();
        let standing = view.bodies().filter(|robot| {
            let pursues = view.is_opponent(robot, Role::Pursuer);
            robot.index != own.index && !pursues && robot.twist.v.abs() < STANDING
        });
        self.bodies.extend(standing.map(|robot| Body {
            at: robot.pose.position(),
            reach: robot.radius + own.radius,
        }));
    }

    fn learn(&mut self, space: &FreeSpace, radius: f64, revision: u64) {
        let margin = if self.is_tight {
            0.0
        } else {
            self.params.margin
        };
        let radius = radius + margin;
        let [wide, tight] = &mut self.grounds;
        let collision_map = if self.is_tight { tight } else { wide };
        if !collision_map
            .as_ref()
            .is_some_and(|collision_map| collision_map.is_of(radius, revision))
        {
            *collision_map = Some(CollisionMap::new(space, radius, revision));
        }
    }

    /// Returns the map for the next plan.
    fn collision_map(&self) -> Option<&CollisionMap> {
        let [wide, tight] = &self.grounds;
        let collision_map = if self.is_tight { tight } else { wide };
        collision_map.as_ref()
    }

    /// Returns the exits, each moved to a place that the robot can reach; exits without one are
    /// left out.
    fn goals(&self, view: &View<'_>) -> Vec<Point2<f64>> {
        let Some(collision_map) = self.collision_map() else {
            return Vec::new();
        };
        view.usable_exits()
            .filter_map(|exit| collision_map.free_place(exit, END_TOLERANCE))
            .collect()
    }

    /// Starts to follow the plan that is due.
    fn take_up(&mut self, time_s: f64) {
        let is_due = |pending: &PendingPlan| pending.due_s <= time_s + SAME_TIME;
        let Some(pending) = self.pending.take_if(|pending| is_due(pending)) else {
            return;
        };
        self.tree = pending.tree;
        self.tree_is_new = true;
        let drops = self.params.replan.rule.keeps_command();
        if drops {
            self.route = None;
        }
        let complete_before = self.route.as_ref().is_some_and(|route| route.is_complete);
        let found = pending.route.filter(|route| route.is_complete || !drops);
        let Some(route) = found else {
            return;
        };
        // A path that ends elsewhere does not replace one to an exit.
        if route.is_complete || !complete_before {
            self.tracker.set_path(route.path.clone());
            self.next = 1;
            self.off_path = 0.0;
            self.route = Some(route);
            self.route_checked = self.planned_for.clone();
        }
    }

    /// Drops a route that new obstacles block.
    fn drop_blocked(&mut self, own: &RobotView, revision: u64) {
        let (Some(route), Some(collision_map)) = (&self.route, self.collision_map()) else {
            return;
        };
        let now = (revision, &self.bodies);
        if (self.route_checked.0, &self.route_checked.1) == now {
            return;
        }
        let progress = self.tracker.progress();
        let ahead = route
            .path
            .points()
            .windows(2)
            .zip(route.path.along().windows(2));
        // The robot's own radius: the margin applies to plans only.
        let is_free = ahead
            .filter(|(_, along)| along.last().is_some_and(|&end| end > progress))
            .all(|(points, _)| match points {
                &[a, b] => collision_map.is_free_line(a, b, own.radius - CHORD, &self.bodies),
                _ => true,
            });
        if is_free {
            self.route_checked = (revision, self.bodies.clone());
        } else {
            self.route = None;
        }
    }

    fn wants_plan(&mut self, time_s: f64, own: &RobotView, goals: &[Point2<f64>]) -> bool {
        if self.pending.is_some() || goals.is_empty() {
            return false;
        }
        let replan = self.params.replan;
        let since = self.begun_s.map_or(f64::INFINITY, |begun| time_s - begun);
        if since + SAME_TIME < replan.rule.least_s() {
            return false;
        }
        let Some(route) = &self.route else {
            return true;
        };
        if self.off_path > replan.rule.off_path() {
            return true;
        }
        let here = own.pose.position();
        match replan.rule {
            ReplanRule::Periodic => {
                since + SAME_TIME >= replan.period_s || {
                    let progress = self.tracker.progress();
                    let length = route.path.length();
                    is_threatened(
                        |ahead| {
                            let along = progress + ahead;
                            (along <= length).then(|| route.path.at(along)).flatten()
                        },
                        self.limits.v_max(),
                        &self.pursuers,
                        replan.threat_distance,
                    )
                }
            }
            ReplanRule::Paper => {
                if goals
                    .iter()
                    .any(|goal| (goal - here).norm() < PAPER_NEAR_EXIT)
                {
                    return true;
                }
                if time_s - self.looked_s + SAME_TIME < replan.period_s {
                    return false;
                }
                self.looked_s = time_s;
                let ahead: Vec<_> = route
                    .waypoints
                    .iter()
                    .skip(self.next)
                    .map(|waypoint| waypoint.pose.position())
                    .collect();
                papers_safety(&ahead, &self.pursuers) < PAPER_THRESHOLD
            }
        }
    }

    fn begin(&mut self, time_s: f64, own: &RobotView, goals: &[Point2<f64>], revision: u64) {
        self.begun_s = Some(time_s);
        self.looked_s = time_s;
        let iterations = self.params.search.iterations;
        let takes_s = f64::from(iterations) * self.params.timing.time_per_iteration_s;
        let start = self.pose_in(takes_s, own);
        let [wide, tight] = &mut self.grounds;
        let Some(collision_map) = (if self.is_tight { tight } else { wide }) else {
            return;
        };
        let Some(place) = collision_map.free_place(start.position(), MAX_PUSH) else {
            return;
        };
        let mut towards = collision_map.towards(goals);
        let mut goals = goals.to_vec();
        if !towards.is_empty() {
            // Unreachable goals are not searched for.
            towards.retain(|goal| goal.distance(place).is_some());
            goals = towards.iter().map(|goal| goal.goal()).collect();
        }
        self.cost.set_pursuers(self.pursuers.iter().copied());
        let now = (revision, self.bodies.clone());
        let task = Task {
            collision_map,
            bodies: &self.bodies,
            cost: &self.cost,
            start: Pose2::new(place.x, place.y, start.theta),
            goals: &goals,
            towards: &towards,
            map_changed: self.planned_for != now,
            iterations,
        };
        let route = if goals.is_empty() {
            None
        } else {
            self.planning.plan(&task)
        };
        self.planned_for = now;
        // The margin may close a gap: the next plan does without it, and the one after that uses it
        // again.
        let is_complete = route.as_ref().is_some_and(|route| route.is_complete);
        self.is_tight = !is_complete && !self.is_tight && self.params.margin > 0.0;
        self.pending = Some(PendingPlan {
            due_s: time_s + takes_s,
            route,
            tree: if goals.is_empty() {
                Vec::new()
            } else {
                self.shown_tree()
            },
        });
    }

    /// Returns the pose of the robot after some seconds (s), if it follows its route.
    fn pose_in(&self, seconds: f64, own: &RobotView) -> Pose2 {
        let route = self.route.as_ref().filter(|_| seconds > 0.0);
        let is_followed = self.params.follower == Follower::PurePursuit
            && self.off_path <= self.params.replan.rule.off_path();
        let along = self.tracker.progress() + seconds * self.limits.v_max();
        route
            .filter(|_| is_followed)
            .and_then(|route| route.pose_at(along))
            .unwrap_or(own.pose)
    }

    /// Returns the edges of the tree with the lowest costs, and those of the path.
    fn shown_tree(&self) -> Vec<ShownEdge> {
        let tree = self.planning.tree();
        let mut edges: Vec<ShownEdge> = (0..tree.len() as u32)
            .filter(|&node| tree.node(node).parent != NONE)
            .map(|node| {
                let child = tree.node(node);
                ShownEdge {
                    from: tree.node(child.parent).position(),
                    to: child.position(),
                    cost: child.cost,
                    on_path: self.planning.is_on_way(node),
                }
            })
            .collect();
        // A parent is cheaper than its children: the remaining edges form a tree.
        edges.sort_by(|a, b| b.on_path.cmp(&a.on_path).then(a.cost.total_cmp(&b.cost)));
        edges.truncate(SHOWN_EDGES);
        edges
    }

    /// Follows the route; `None` without one and at its end, where it is dropped.
    fn follow(&mut self, map: &PlannerMap, view: &View<'_>, own: &RobotView) -> Option<Steering> {
        let aim = self.route.as_ref()?.path.points().last().copied();
        let steering = match self.params.follower {
            Follower::PurePursuit => self.pursue(map, own),
            Follower::PotentialField => self.float(map, view, own),
        };
        if steering.is_none() {
            self.route = None;
        }
        steering.map(|steering| Steering { aim, ..steering })
    }

    fn pursue(&mut self, map: &PlannerMap, own: &RobotView) -> Option<Steering> {
        let tracking = follow::pursue(
            &mut self.tracker,
            &own.pose,
            &self.limits,
            &TrackingParams::default(),
            map.space()?,
            own.radius,
        )?;
        self.off_path = tracking.off_path;
        (!tracking.arrived).then(|| Steering {
            command: tracking.command,
            waypoint: Some(tracking.target),
            ..Steering::stop()
        })
    }

    fn float(&mut self, map: &PlannerMap, view: &View<'_>, own: &RobotView) -> Option<Steering> {
        let waypoints = &self.route.as_ref()?.waypoints;
        let control = own.pose.position() + own.pose.forward() * EPSILON;
        let to = waypoints.get(self.next)?.pose.position();
        if (control - to).norm() < WAYPOINT_REACHED {
            self.next += 1;
        }
        let to = waypoints.get(self.next)?.pose.position();
        let (command, field) = follow::by_field(map, view, own, to, &self.limits, &self.field);
        Some(Steering {
            command,
            waypoint: Some(to),
            field,
            ..Steering::stop()
        })
    }
}
