//! `TangentBug`: navigation around unknown obstacles to a point, with a range sensor and no map.
//!
//! Kamon, Rimon and Rivlin, *`TangentBug`: A Range-Sensor-Based Navigation Algorithm* (IJRR 1998; first
//! by Kamon, Rivlin and Rimon, ICRA 1996). The robot moves towards the goal, or towards the
//! discontinuity Oᵢ of its scan over which the path d(x, Oᵢ) + d(Oᵢ, goal) is shortest, as long as its
//! distance from the goal falls. At a local minimum of the distance it follows the boundary on one side
//! and stores `d_followed`, the minimum distance of the seen boundary from the goal. It leaves for a
//! visible free point that is nearer by a margin (`d_reach` < `d_followed`). If it has circled the
//! boundary without leaving, no path leads to the goal.
//!
//! The robot is a disc: echoes are grown by its radius and a margin, and the algorithm works with a
//! point among them. Passages narrower than the grown disc count as closed. Each stretch of motion
//! towards the goal, except for a few that begin because the goal is visible, ends nearer to it than the
//! last, by a fixed margin, so their number is finite. The loop is closed when the robot drives along
//! its own trail.
//!
//! Beams miss edges, so a real scan can close a loop falsely or lead in circles without any progress. In
//! both cases the robot plans a path over the echoes that it remembers from the boundary (its detour). It
//! says that the goal is unreachable only if they enclose it or the goal.
//!
//! The heading decides which edges the beams miss, so the view changes while the robot turns on the spot.
//! It keeps its choice until it has turned; a robot that chose anew at every scan would turn back and forth.

mod detour;
mod follow;
mod progress;
mod remembered;
mod run;
mod sight;
mod surroundings;
mod trail;

use geometry::pose::Pose2;
use nalgebra::{Point2, Vector2};

use detour::Detour;
use follow::{Follow, FollowStep};
use parameters::{ParamsError, positive};
use planner_view::view::ScanView;
use progress::Progress;
use remembered::EchoMemory;
use run::RunEnd;
pub use run::Side;
use sight::Sight;
use surroundings::Surroundings;
pub(crate) use surroundings::echoes;

/// Cosine of the angle to the goal (85°) above which the path along a boundary no longer approaches the
/// goal.
const NO_NEARER: f64 = 0.087;
/// Rise of the distance from the goal, in grown radii, at which motion towards the goal ends: a turn at speed
/// takes room.
const MAX_RISE: f64 = 0.5;
/// Number of consecutive scans with nothing but boundary after which the robot counts as walled in.
const ENCLOSED_LOOKS: u32 = 60;
/// Number of times that a visible goal counts as reachable: between obstacles that leave slightly too
/// little room for the robot it may become visible at every turn, forever.
const MAX_SIGHTINGS: u32 = 5;
/// Minimum saving of the other side of an obstacle for a change of side, in grown radii.
const SIDE_HOLD: f64 = 1.5;
/// Maximum changes of mode within one scan: towards the goal, to the boundary, away from it, once each.
const MAX_CHANGES: usize = 4;

/// Distance from the place of a decision (m) below which the robot turns on the spot.
const STILL: f64 = 5e-3;
/// Cosine of the bearing below which the robot still turns.
const ALIGNED: f64 = 0.95;

/// Clearance between the robot's edge and obstacles (m). It covers the tracking error of the drive and
/// the error of the sensor; passages narrower than the robot and twice this count as closed.
pub const MARGIN: f64 = 0.05;
/// Jump of the free distance between neighbouring directions at which a piece of boundary ends (m). Gaps
/// between obstacles behind a smaller jump are ignored.
const JUMP: f64 = 0.06;
/// Minimum difference of the distances to the goal, of all seen boundary and a free point, for leaving
/// the boundary (m).
const LEAVE_MARGIN: f64 = 0.03;

/// Mode of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Straight to the goal.
    ToGoal,
    /// Along the tangent of an obstacle, nearer to the goal.
    Tangent(Side),
    /// Along a boundary.
    Boundary(Side),
    /// From a boundary to a point nearer to the goal.
    Leaving,
    /// Along a path among the remembered obstacles.
    Detour,
}

/// Result of a scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Advice {
    /// Drive straight towards a point.
    Head {
        /// The point (m); the robot's position if it should wait and scan again.
        towards: Point2<f64>,
        /// Reason.
        mode: Mode,
    },
    /// No path leads to the goal: the remembered echoes enclose the robot or the goal.
    Unreachable,
    /// The robot has tried all that it can; whether a path leads to the goal is not known.
    Stuck,
}

/// The direction that the robot has chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Decision {
    /// Position of the robot (m).
    at: Point2<f64>,
    /// Chosen direction.
    unit: Vector2<f64>,
    /// Heading in the last scan.
    heading: Vector2<f64>,
    /// Free distance in it below which it no longer holds (m).
    least_free: f64,
    advice: Advice,
}

impl Decision {
    /// `None` for an advice without a direction.
    fn new(view: &Surroundings, sight: &Sight, advice: Advice) -> Option<Self> {
        let Advice::Head { towards, .. } = advice else {
            return None;
        };
        let unit = (towards - view.here).try_normalize(f64::EPSILON)?;
        let least_free = (0.5 * view.free_towards(unit)).min(JUMP);
        let at = view.here;
        Some(Self {
            at,
            unit,
            heading: sight.forward,
            least_free,
            advice,
        })
    }

    /// Returns `true` while the robot turns on the spot and the chosen direction stays free.
    fn holds(&mut self, view: &Surroundings, sight: &Sight) -> bool {
        let heading = core::mem::replace(&mut self.heading, sight.forward);
        heading != sight.forward
            && (view.here - self.at).norm() < STILL
            && self.unit.dot(&sight.forward) < ALIGNED
            && view.free_towards(self.unit) > self.least_free
    }
}

#[derive(Debug, Clone, PartialEq)]
enum State {
    ToGoal {
        side: Option<Side>,
        /// Minimum distance from the goal in this mode (m).
        least: f64,
    },
    Following(Follow),
    Leaving {
        point: Point2<f64>,
        follow: Follow,
    },
    Detour(Detour),
    /// The search has ended with this result.
    Ended(Advice),
}

impl State {
    /// A new search.
    const START: Self = Self::ToGoal {
        side: None,
        least: f64::INFINITY,
    };
}

/// Transition of a state in one scan.
enum Change {
    /// A result.
    Answer(Advice),
    /// Another state, which must give the result.
    To(State),
}

/// Leads a disc robot to one goal after the other.
#[derive(Debug, Clone)]
pub struct TangentBug {
    /// Radius by which obstacles are grown (m).
    grown: f64,
    goal: Option<Point2<f64>>,
    state: State,
    decided: Option<Decision>,
    /// Consecutive scans with nothing but boundary.
    enclosed: u32,
    /// Number of times that the robot left a boundary only because the goal was visible.
    sightings: u32,
    progress: Progress,
    remembered: EchoMemory,
    view: Surroundings,
}

impl TangentBug {
    /// Creates one for a robot of this radius (m), > 0.
    ///
    /// # Errors
    /// [`ParamsError`] for a radius that is out of range.
    pub fn new(radius: f64) -> Result<Self, ParamsError> {
        positive("radius", radius)?;
        Ok(Self {
            grown: radius + MARGIN,
            goal: None,
            state: State::START,
            decided: None,
            enclosed: 0,
            sightings: 0,
            progress: Progress::default(),
            remembered: EchoMemory::default(),
            view: Surroundings::default(),
        })
    }

    /// Clears the goal and all state of the path to it.
    pub fn reset(&mut self) {
        self.goal = None;
        self.state = State::START;
        self.decided = None;
        self.enclosed = 0;
        self.sightings = 0;
        self.progress = Progress::default();
        self.remembered.clear();
    }

    /// Goes over to the last resort, a path among the remembered obstacles: for a robot that does not get on.
    pub fn begin_detour(&mut self) {
        if !matches!(self.state, State::Detour(_) | State::Ended(_)) {
            self.state = State::Detour(Detour::default());
            self.decided = None;
        }
    }

    /// The advice at a pose, with the scan made there, to come within `tolerance` (m) of a goal; a goal
    /// other than the last one starts a new search.
    ///
    /// The scan must cover the full circle (directions without a beam count as free) and reach farther
    /// than the grown radius. `None` for a pose, goal or tolerance that is not finite and for a scan
    /// without beams.
    pub fn advise(
        &mut self,
        pose: &Pose2,
        scan: &ScanView<'_>,
        goal: Point2<f64>,
        tolerance: f64,
    ) -> Option<Advice> {
        let finite = goal.x.is_finite() && goal.y.is_finite() && tolerance.is_finite();
        let seeing = !scan.ranges.is_empty() && scan.range_max.is_finite();
        if !(finite && seeing && pose.is_finite()) {
            return None;
        }
        if self.goal != Some(goal) {
            self.reset();
            self.goal = Some(goal);
        }
        let radius = self.grown - MARGIN;
        // Paths among remembered obstacles keep the whole margin; half of it remains for deviations.
        let margin = match self.state {
            State::Detour(_) => 0.5 * MARGIN,
            _ => MARGIN,
        };
        self.view.look(pose, scan, radius, margin);
        let sight = Sight::new(&self.view, pose, goal, tolerance.max(0.0));
        self.note(pose, scan, &sight);
        // A visible goal is sufficient reason to leave a boundary at once.
        let leaves =
            matches!(self.state, State::Following(_)) && sight.is_reachable && self.may_trust();
        let held = self.decided.as_mut().filter(|_| !leaves);
        if let Some(decision) = held
            && decision.holds(&self.view, &sight)
        {
            return Some(decision.advice);
        }
        let advice = self.decide(&sight);
        self.decided = Decision::new(&self.view, &sight, advice);
        Some(advice)
    }

    /// Chooses anew.
    fn decide(&mut self, sight: &Sight) -> Advice {
        for _ in 0..MAX_CHANGES {
            let state = core::mem::replace(&mut self.state, State::START);
            match self.answer(state, sight) {
                Change::Answer(advice) => return advice,
                Change::To(state) => self.state = state,
            }
        }
        // The modes disagree about the scan (noise): wait for the next one.
        self.wait(Mode::ToGoal)
    }

    /// Records the scan where it may be needed for a detour, and begins one if there is no progress.
    fn note(&mut self, pose: &Pose2, scan: &ScanView<'_>, sight: &Sight) {
        let stalls = self.progress.stalls(pose, sight.distance, self.grown);
        let (is_last_resort, is_at_boundary) = match self.state {
            State::Detour(_) => (true, true),
            State::Following(_) | State::Leaving { .. } => (stalls, true),
            State::ToGoal { .. } => (stalls, stalls),
            State::Ended(_) => return,
        };
        let due = is_last_resort || self.remembered.is_due(self.view.here, self.grown);
        if is_at_boundary && due {
            self.remembered.record(pose, scan, self.grown);
        }
        if is_last_resort {
            self.begin_detour();
        }
    }

    /// Gives a result in a state and sets `self.state` for the next scan, or changes the state.
    fn answer(&mut self, state: State, sight: &Sight) -> Change {
        match state {
            State::Ended(advice) => {
                self.state = State::Ended(advice);
                Change::Answer(advice)
            }
            State::ToGoal { side, least } => self.approach(side, least, sight),
            State::Following(follow) => self.follow(follow, sight),
            State::Leaving { point, follow } => self.leave(point, follow, sight),
            State::Detour(detour) => self.go_around(detour, sight),
        }
    }

    /// Motion to the goal, as long as the distance from it falls.
    fn approach(&mut self, side: Option<Side>, least: f64, sight: &Sight) -> Change {
        let least = least.min(sight.distance);
        let blocking = sight.blocking(&self.view, JUMP);
        let Some(run) = blocking.filter(|_| !sight.is_open) else {
            self.enclosed = 0;
            self.state = State::ToGoal { side: None, least };
            return Change::Answer(Advice::Head {
                towards: sight.goal,
                mode: Mode::ToGoal,
            });
        };
        let ends =
            [Side::Right, Side::Left].map(|side| run.end(&self.view, side).map(|end| (side, end)));
        let cost = |side_of: Side, end: &RunEnd| {
            // The path over Oᵢ; a point too near gives little information about its continuation.
            let first = end.edge.max(self.grown).min(end.free);
            let over = self.view.here + end.unit * first;
            let hold = if side == Some(side_of) {
                SIDE_HOLD * self.grown
            } else {
                0.0
            };
            first + (sight.goal - over).norm() - hold
        };
        let mut best: Option<(Side, RunEnd, f64)> = None;
        for (side, end) in ends.into_iter().flatten() {
            let cost = cost(side, &end);
            if best.as_ref().is_none_or(|(_, _, least)| cost < *least) {
                best = Some((side, end, cost));
            }
        }
        let falls = sight.distance <= least + MAX_RISE * self.grown;
        let nearer = |end: &RunEnd| falls && end.unit.dot(&sight.towards) >= NO_NEARER;
        let Some((side, end, _)) = best.filter(|(_, end, _)| nearer(end)) else {
            let side = best.map(|(side, ..)| side).or(side).unwrap_or(Side::Right);
            let wall = self.view.obstacle(run.nearest(&self.view));
            let follow = Follow::begin(side, sight.distance, wall.unwrap_or(self.view.here));
            return Change::To(State::Following(follow));
        };
        self.enclosed = 0;
        self.state = State::ToGoal {
            side: Some(side),
            least,
        };
        Change::Answer(Advice::Head {
            towards: self.view.here + end.unit * end.free,
            mode: Mode::Tangent(side),
        })
    }

    /// Returns `true` if a visible goal is sufficient reason to leave a boundary.
    fn may_trust(&self) -> bool {
        self.sightings < MAX_SIGHTINGS
    }

    /// Boundary following.
    fn follow(&mut self, mut follow: Follow, sight: &Sight) -> Change {
        let may_trust = self.may_trust();
        match follow.step(&self.view, sight, self.grown, may_trust) {
            FollowStep::Lost => Change::To(State::START),
            FollowStep::Leave(point) => Change::To(State::Leaving { point, follow }),
            FollowStep::Enclosed(towards) => self.walled_in(follow, towards),
            FollowStep::Closed => Change::To(State::Detour(Detour::default())),
            FollowStep::Along(towards) => {
                self.enclosed = 0;
                let mode = Mode::Boundary(follow.side());
                self.state = State::Following(follow);
                Change::Answer(Advice::Head { towards, mode })
            }
        }
    }

    /// The transition from a boundary to motion towards the goal.
    fn leave(&mut self, point: Point2<f64>, mut follow: Follow, sight: &Sight) -> Change {
        let to = point - self.view.here;
        let left = to.norm();
        let nearer = sight.distance < follow.least() - 0.5 * LEAVE_MARGIN;
        let is_trusted = sight.is_reachable && self.may_trust();
        if nearer || left < 0.25 * LEAVE_MARGIN || is_trusted {
            self.sightings += u32::from(!nearer);
            return Change::To(State::ToGoal {
                side: Some(follow.side()),
                least: sight.distance,
            });
        }
        let free = self.view.free_towards(to / left);
        if free + JUMP < left.min(self.view.reach) {
            // An obstacle has appeared in between: continue along the boundary.
            follow.return_at(self.view.here);
            return Change::To(State::Following(follow));
        }
        self.state = State::Leaving { point, follow };
        Change::Answer(Advice::Head {
            towards: point,
            mode: Mode::Leaving,
        })
    }

    /// Only boundary is visible: continue slightly towards its farthest point. The tip of a wedge looks
    /// the same, the sensor may err, or a body may move.
    fn walled_in(&mut self, follow: Follow, towards: Point2<f64>) -> Change {
        self.enclosed += 1;
        if self.enclosed >= ENCLOSED_LOOKS {
            return Change::To(State::Detour(Detour::default()));
        }
        let mode = Mode::Boundary(follow.side());
        self.state = State::Following(follow);
        Change::Answer(Advice::Head { towards, mode })
    }

    /// The last resort: along paths among the remembered obstacles.
    fn go_around(&mut self, mut detour: Detour, sight: &Sight) -> Change {
        let (towards, mode) = if sight.is_reachable {
            (sight.goal, Mode::ToGoal)
        } else {
            match detour.step(&self.view, sight, &self.remembered, self.grown) {
                Ok(point) => (point, Mode::Detour),
                Err(end) => return Change::To(State::Ended(end)),
            }
        };
        self.state = State::Detour(detour);
        Change::Answer(Advice::Head { towards, mode })
    }

    fn wait(&self, mode: Mode) -> Advice {
        Advice::Head {
            towards: self.view.here,
            mode,
        }
    }
}
