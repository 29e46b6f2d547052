//! `TangentBug`: around unknown obstacles to a point, with a range sensor and no map.
//!
//! Kamon, Rimon and Rivlin, *`TangentBug`: A Range-Sensor-Based Navigation Algorithm* (IJRR 1998;
//! first by Kamon, Rivlin and Rimon, ICRA 1996). The robot moves towards the goal, or towards the
//! discontinuity Oᵢ of its scan over which the way d(x, Oᵢ) + d(Oᵢ, goal) is shortest, as long as
//! that brings it nearer to the goal. At a local minimum of the distance it follows the boundary on
//! one side and remembers `d_followed`, the least distance from the goal of the boundary it saw; it
//! leaves for a visible free point that is nearer by a margin (`d_reach` < `d_followed`). When
//! it has been all around without leaving, no way leads to the goal.
//!
//! The robot is a disc: echoes are grown by its radius and a margin, and the algorithm works with a
//! point among them. What is narrower than the grown disc counts as closed. Each stretch of motion
//! towards the goal, but for a few that begin because it is in sight, ends nearer to it, by a fixed
//! margin, than the one before, so there can only be finitely many; the loop is closed when the robot
//! drives along its own trail.

mod follow;
mod run;
mod surroundings;
mod trail;

use geometry::pose::Pose2;
use nalgebra::{Point2, Vector2};

use follow::{Follow, Following, is_turning};
use parameters::{ParamsError, positive};
use planner_view::view::ScanView;
pub use run::Side;
use run::{Run, RunEnd};
pub(crate) use surroundings::echoes;
use surroundings::{Surroundings, nearest_direction};

/// Cosine of the angle to the goal at which the way along a boundary brings nothing any more (85°).
const NO_NEARER: f64 = 0.087;
/// Looks in a row at nothing but boundary after which the robot is taken for walled in.
const ENCLOSED_LOOKS: u32 = 60;
/// Times that a goal in sight is believed to be reachable: between obstacles that leave just too little
/// room for the robot it may come into sight at every turn, and for ever.
const MAX_SIGHTINGS: u32 = 5;
/// What the other side of an obstacle must save before the side is changed, in grown radii.
const SIDE_HOLD: f64 = 1.5;
/// Changes of mode within one look: towards the goal, to the boundary, away from it, once each.
const MAX_CHANGES: usize = 4;

/// Kept free between the robot's edge and obstacles (m). It covers what the drive strays from the advice
/// and what the sensor errs; passages narrower than the robot and twice this count as closed.
pub const MARGIN: f64 = 0.05;
/// Jump of the free distance between neighbouring directions at which a piece of boundary ends (m). Gaps
/// between obstacles that are hidden behind less are not looked into.
const JUMP: f64 = 0.06;
/// How much nearer to the goal than all boundary seen a free point must be before the boundary is left
/// for it (m).
const LEAVE_MARGIN: f64 = 0.03;

/// What the robot is doing.
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
}

/// What to do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Advice {
    /// Drive straight towards a point.
    Head {
        /// The point (m); where the robot stands if it shall wait and look again.
        towards: Point2<f64>,
        /// What for.
        mode: Mode,
    },
    /// No way leads to the goal.
    Unreachable,
}

#[derive(Debug, Clone, PartialEq)]
enum State {
    ToGoal {
        side: Option<Side>,
    },
    Following(Follow),
    Leaving {
        point: Point2<f64>,
        follow: Follow,
        /// Where that was decided (m).
        from: Point2<f64>,
    },
    Unreachable,
}

/// What became of a state in one look.
enum Change {
    /// An answer.
    Answer(Advice),
    /// Another state, which has to answer.
    To(State),
}

/// Leads a disc robot to one goal after the other.
#[derive(Debug, Clone)]
pub struct TangentBug {
    /// Radius that obstacles are grown by (m).
    grown: f64,
    goal: Option<Point2<f64>>,
    state: State,
    /// Looks in a row at nothing but boundary.
    enclosed: u32,
    /// Times that a boundary was left because the goal was in sight, and for no other reason.
    sightings: u32,
    view: Surroundings,
}

impl TangentBug {
    /// For a robot of this radius (m), > 0.
    ///
    /// # Errors
    /// [`ParamsError`] for a radius that is out of range.
    pub fn new(radius: f64) -> Result<Self, ParamsError> {
        positive("radius", radius)?;
        Ok(Self {
            grown: radius + MARGIN,
            goal: None,
            state: State::ToGoal { side: None },
            enclosed: 0,
            sightings: 0,
            view: Surroundings::default(),
        })
    }

    /// The radius that obstacles are grown by: the robot's and the margin (m).
    pub fn grown_radius(&self) -> f64 {
        self.grown
    }

    /// Forgets the goal and everything about the way there.
    pub fn reset(&mut self) {
        self.goal = None;
        self.state = State::ToGoal { side: None };
        self.enclosed = 0;
        self.sightings = 0;
    }

    /// What to do at a pose, with the scan made there, to come within `tolerance` (m) of a goal; a
    /// goal other than the last one is begun anew.
    ///
    /// The scan has to go all around (directions without a beam count as free) and see farther than
    /// the grown radius. `None` for a pose, goal or tolerance that is not finite and for a scan
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
        let margin = MARGIN;
        self.view.look(pose, scan, self.grown - margin, margin);
        let sight = Sight::new(&self.view, pose, goal, tolerance.max(0.0));
        for _ in 0..MAX_CHANGES {
            let state = core::mem::replace(&mut self.state, State::Unreachable);
            match self.answer(state, &sight) {
                Change::Answer(advice) => return Some(advice),
                Change::To(state) => self.state = state,
            }
        }
        // The modes disagree about what is seen (noise): look again.
        Some(self.wait(Mode::ToGoal))
    }

    /// Answers in a state, leaving `self.state` as it shall be at the next look, or changes it.
    fn answer(&mut self, state: State, sight: &Sight) -> Change {
        match state {
            State::Unreachable => Change::Answer(Advice::Unreachable),
            State::ToGoal { side } => self.approach(side, sight),
            State::Following(follow) => self.follow(follow, sight),
            State::Leaving {
                point,
                follow,
                from,
            } => self.leave((point, from), follow, sight),
        }
    }

    /// Motion to the goal.
    fn approach(&mut self, side: Option<Side>, sight: &Sight) -> Change {
        let blocking = sight.blocking(&self.view, JUMP);
        let Some(run) = blocking.filter(|_| !sight.is_open) else {
            self.enclosed = 0;
            self.state = State::ToGoal { side: None };
            return Change::Answer(Advice::Head {
                towards: sight.goal,
                mode: Mode::ToGoal,
            });
        };
        let ends =
            [Side::Right, Side::Left].map(|side| run.end(&self.view, side).map(|end| (side, end)));
        let cost = |side_of: Side, end: &RunEnd| {
            // The way over Oᵢ; a point too near says little about how the way goes on.
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
        let nearer = |end: &RunEnd| end.unit.dot(&sight.towards) >= NO_NEARER;
        let Some((side, end, _)) = best.filter(|(_, end, _)| nearer(end)) else {
            let side = best.map(|(side, ..)| side).or(side).unwrap_or(Side::Right);
            let wall = self.view.obstacle(run.nearest(&self.view));
            let follow = Follow::begin(side, sight.distance, wall.unwrap_or(self.view.here));
            return Change::To(State::Following(follow));
        };
        self.enclosed = 0;
        self.state = State::ToGoal { side: Some(side) };
        Change::Answer(Advice::Head {
            towards: self.view.here + end.unit * end.free,
            mode: Mode::Tangent(side),
        })
    }

    /// Whether a goal in sight is reason enough to leave a boundary.
    fn may_trust(&self) -> bool {
        self.sightings < MAX_SIGHTINGS
    }

    /// Boundary following.
    fn follow(&mut self, mut follow: Follow, sight: &Sight) -> Change {
        let may_trust = self.may_trust();
        match follow.step(&self.view, sight, self.grown, may_trust) {
            Following::Lost => Change::To(State::ToGoal { side: None }),
            Following::Leave(point) => Change::To(State::Leaving {
                point,
                follow,
                from: self.view.here,
            }),
            Following::Enclosed(towards) => self.walled_in(follow, towards),
            Following::Closed => Change::To(State::Unreachable),
            Following::Along(towards) => {
                self.enclosed = 0;
                let mode = Mode::Boundary(follow.side());
                self.state = State::Following(follow);
                Change::Answer(Advice::Head { towards, mode })
            }
        }
    }

    /// The transition from a boundary to motion towards the goal.
    fn leave(
        &mut self,
        (point, from): (Point2<f64>, Point2<f64>),
        follow: Follow,
        sight: &Sight,
    ) -> Change {
        let to = point - self.view.here;
        let left = to.norm();
        let nearer = sight.distance < follow.least() - 0.5 * LEAVE_MARGIN;
        let is_trusted = sight.is_reachable && self.may_trust();
        if nearer || left < 0.25 * LEAVE_MARGIN || is_trusted {
            self.sightings += u32::from(!nearer);
            return Change::To(State::ToGoal {
                side: Some(follow.side()),
            });
        }
        let free = self.view.free_towards(to / left);
        // Turning on the spot moves the beams: what they say is believed when it has turned.
        let turning = is_turning(&self.view, sight, from, to / left) && free > JUMP;
        if !turning && free + JUMP < left.min(self.view.reach) {
            // Something has come between: on along the boundary.
            return Change::To(State::Following(follow));
        }
        self.state = State::Leaving {
            point,
            follow,
            from,
        };
        Change::Answer(Advice::Head {
            towards: point,
            mode: Mode::Leaving,
        })
    }

    /// Nothing but boundary all around: on a little to where it is farthest away, for the tip of a wedge
    /// looks like that, the sensor may err or a body move on.
    fn walled_in(&mut self, follow: Follow, towards: Point2<f64>) -> Change {
        self.enclosed += 1;
        if self.enclosed >= ENCLOSED_LOOKS {
            return Change::To(State::Unreachable);
        }
        let mode = Mode::Boundary(follow.side());
        self.state = State::Following(follow);
        Change::Answer(Advice::Head { towards, mode })
    }

    fn wait(&self, mode: Mode) -> Advice {
        Advice::Head {
            towards: self.view.here,
            mode,
        }
    }
}

/// The goal as it is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Sight {
    goal: Point2<f64>,
    /// d(x, goal) (m).
    distance: f64,
    /// Unit vector towards it.
    towards: Vector2<f64>,
    /// Unit vector along the robot's heading.
    forward: Vector2<f64>,
    /// How far the straight way there is free (m).
    free: f64,
    /// Whether it is free as far as can be seen, or to the goal.
    is_open: bool,
    /// Whether it is free to the goal.
    is_reachable: bool,
}

impl Sight {
    fn new(view: &Surroundings, pose: &Pose2, goal: Point2<f64>, tolerance: f64) -> Self {
        let offset = goal - view.here;
        let distance = offset.norm();
        let towards = if distance > 0.0 {
            offset / distance
        } else {
            Vector2::x()
        };
        let free = view.free_towards(towards);
        let needed = distance - tolerance;
        Self {
            goal,
            distance,
            towards,
            forward: pose.forward(),
            free,
            is_open: free >= needed.min(view.reach),
            is_reachable: free >= needed,
        }
    }

    /// The boundary that blocks the way.
    fn blocking(&self, view: &Surroundings, jump: f64) -> Option<Run> {
        let k = nearest_direction(self.towards) + surroundings::DIRECTIONS;
        // The directions are a raster: the one beside may be the blocked one.
        [k, k + 1, k - 1]
            .into_iter()
            .find_map(|k| Run::around(view, k, jump))
    }
}
