//! The algorithm of the referee.

use geometry::region::Region;
use navigation::dominance::{Arena, Cell, Dominance, Runner, Verdict};
use planner_view::map::PlannerMap;
use planner_view::view::RobotView;
use pursuit_evasion::escape::{self, Robot};
use robot::spec::RobotModel;
use robot::team::{Role, Team};

use crate::RefereeParams;

/// Data of a game for a referee, besides the map and the state.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Game {
    /// Exits of evaders.
    pub exits: Vec<Region>,
    /// Distance within which pursuers catch (m).
    pub capture: f64,
    /// Bodies and limits of the robots, by index.
    pub models: Vec<RobotModel>,
    /// Length of a tick (s).
    pub dt: f64,
}

/// Judgement of an evader.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judgement {
    /// Index of the evader.
    pub robot: usize,
    /// Guaranteed outcome.
    pub verdict: Verdict,
}

/// Judges moments of a chase.
///
/// Apart from caches of the map, it is a function of its inputs.
#[derive(Debug, Clone)]
pub struct Referee {
    params: RefereeParams,
    game: Game,
    arena: Option<(u64, f64, Arena)>,
    dominance: Dominance,
    police: Vec<Runner>,
    evaders: Vec<Runner>,
    police_robots: Vec<usize>,
    evader_robots: Vec<usize>,
    judgements: Vec<Judgement>,
    cells: Vec<Cell>,
}

impl Referee {
    /// Returns a referee of a game.
    pub fn new(params: RefereeParams, game: Game) -> Self {
        Self {
            dominance: Dominance::default(),
            params,
            game,
            arena: None,
            police: Vec::new(),
            evaders: Vec::new(),
            police_robots: Vec::new(),
            evader_robots: Vec::new(),
            judgements: Vec::new(),
            cells: Vec::new(),
        }
    }

    /// Prepares a new map for robots of this radius (m) before the next tick. Otherwise
    /// [`Referee::judge`] does it within a tick.
    pub fn prepare(&mut self, map: &PlannerMap, radius: f64) {
        let known = |(revision, of, _): &(u64, f64, Arena)| {
            *revision == map.revision() && of.to_bits() == radius.to_bits()
        };
        if !self.arena.as_ref().is_some_and(known) {
            let widest = self.game.models.iter().map(|model| model.radius);
            let reach = self.game.capture.max(2.0 * widest.fold(radius, f64::max));
            let arena = Arena::new(map, &self.params.dominance, radius, &self.game.exits, reach);
            self.arena = Some((map.revision(), radius, arena));
        }
    }

    /// Judges a moment: one judgement per evader in play, in the order of the robots.
    ///
    /// All robots count as narrow as the narrowest of them.
    pub fn judge(&mut self, map: &PlannerMap, robots: &[RobotView]) -> &[Judgement] {
        self.judgements.clear();
        self.prepare(map, narrowest(robots));
        let in_play = |robot: &&RobotView| robot.active && robot.team.role == Role::Evader;
        let mut judged: Vec<Team> = Vec::new();
        for robot in robots.iter().filter(in_play) {
            if !judged.iter().any(|team| team.has_opponents_of(robot.team)) {
                judged.push(robot.team);
            }
        }
        for team in &judged {
            self.assess(map, robots, |pursuer| pursuer.is_hostile_to(*team));
            self.judge_evaders(map, robots, *team);
        }
        if judged.len() != 1 {
            // For the cells.
            self.assess(map, robots, |_| true);
            self.judgements.sort_by_key(|judgement| judgement.robot);
        }
        &self.judgements
    }

    /// Computes the dominance of all robots, of which these pursuers catch; the others are bodies that move.
    fn assess(&mut self, map: &PlannerMap, robots: &[RobotView], catches: impl Fn(Team) -> bool) {
        self.police.clear();
        self.evaders.clear();
        self.police_robots.clear();
        self.evader_robots.clear();
        let widest = robots
            .iter()
            .filter(|robot| robot.active && robot.team.role == Role::Evader && robot.is_sane())
            .fold(0.0_f64, |widest, robot| widest.max(robot.radius));
        for robot in robots
            .iter()
            .filter(|robot| robot.present && robot.is_sane())
        {
            let runner = Runner {
                at: robot.pose.position(),
                speed: if robot.active { robot.v_max } else { 0.0 },
                reach: widest + robot.radius,
            };
            match robot.team.role {
                Role::Evader if robot.active => {
                    self.evaders.push(runner);
                    self.evader_robots.push(robot.index);
                }
                Role::Pursuer if robot.active && catches(robot.team) => {
                    self.police.push(Runner {
                        reach: runner.reach.max(self.game.capture),
                        ..runner
                    });
                    self.police_robots.push(robot.index);
                }
                _ => {
                    self.police.push(runner);
                    self.police_robots.push(robot.index);
                }
            }
        }
        if let Some((_, _, arena)) = &self.arena {
            self.dominance
                .assess(map, arena, &self.police, &self.evaders);
        }
    }

    /// Judges the evaders that have the same opponents as this team.
    fn judge_evaders(&mut self, map: &PlannerMap, robots: &[RobotView], team: Team) {
        let Some((_, _, arena)) = &self.arena else {
            return;
        };
        let evaders = self.evader_robots.iter().zip(&self.evaders).enumerate();
        for (i, (&index, runner)) in evaders {
            let robot = robots.iter().find(|robot| robot.index == index);
            let robot = robot.filter(|robot| robot.team.has_opponents_of(team));
            let verdict = self.dominance.verdicts().get(i).copied();
            let (Some(robot), Some(mut verdict)) = (robot, verdict) else {
                continue;
            };
            if verdict.escape_possible {
                let drive = self.game.models.get(index).map(|model| Robot {
                    pose: robot.pose,
                    twist: robot.twist,
                    model: *model,
                    dt: self.game.dt,
                });
                let escape = drive.and_then(|drive| {
                    escape::plan(map, arena, &mut self.dominance, i, runner, &drive)
                });
                verdict.escape_possible = escape.is_some();
                verdict.time = escape.as_ref().map_or(f64::INFINITY, |found| found.time);
                if let Some(escape) = escape {
                    verdict.exit = Some(escape.exit);
                    verdict.margin = escape.margin;
                }
            }
            self.judgements.push(Judgement {
                robot: index,
                verdict,
            });
        }
    }

    /// Returns the robot that reaches every cell first, at the moment judged last. The cells lie in
    /// the frame of the arena's lattice; their `first` is a robot's index.
    pub fn cells(&mut self, map: &PlannerMap) -> Option<(&Arena, &[Cell])> {
        use navigation::dominance::Owner;

        let (_, _, arena) = self.arena.as_ref()?;
        self.dominance
            .cells(map, arena, &self.evaders, &mut self.cells);
        for cell in &mut self.cells {
            let robots = match cell.owner {
                Owner::Neither => continue,
                Owner::Police => &self.police_robots,
                Owner::Evader | Owner::CutOff => &self.evader_robots,
            };
            cell.first = robots
                .get(cell.first as usize)
                .map_or(u32::MAX, |&robot| robot as u32);
        }
        Some((arena, &self.cells))
    }
}

/// Returns the radius (m) of the narrowest of the robots that chase or flee, in play or not; 0
/// without any.
pub(crate) fn narrowest(robots: &[RobotView]) -> f64 {
    let radius = robots
        .iter()
        .filter(|robot| robot.team.role != Role::Neutral && robot.is_sane())
        .map(|robot| robot.radius)
        .fold(f64::INFINITY, f64::min);
    if radius.is_finite() { radius } else { 0.0 }
}
