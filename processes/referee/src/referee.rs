//! The algorithm of the referee.

use geometry::region::Region;
use navigation::dominance::{Arena, Cell, Dominance, Runner, Verdict};
use planner_view::map::PlannerMap;
use planner_view::view::RobotView;
use sim_backend::team::Team;

use crate::RefereeParams;

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
    exits: Vec<Region>,
    capture: f64,
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
    /// Returns a referee of a game with these exits, in which Police catch within `capture` (m).
    pub fn new(params: RefereeParams, exits: Vec<Region>, capture: f64) -> Self {
        Self {
            dominance: Dominance::default(),
            params,
            exits,
            capture,
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
            let arena = Arena::new(map, &self.params.dominance, radius, &self.exits);
            self.arena = Some((map.revision(), radius, arena));
        }
    }

    /// Judges a moment: one judgement per evader in play, in the order of the robots.
    ///
    /// All robots count as narrow as the narrowest of them.
    pub fn judge(&mut self, map: &PlannerMap, robots: &[RobotView]) -> &[Judgement] {
        self.police.clear();
        self.evaders.clear();
        self.police_robots.clear();
        self.evader_robots.clear();
        self.judgements.clear();
        let playing = || {
            robots
                .iter()
                .filter(|robot| robot.active && robot.is_sane())
        };
        for robot in playing() {
            let runner = Runner {
                at: robot.pose.position(),
                speed: robot.v_max,
            };
            match robot.team {
                Team::Police => {
                    self.police.push(runner);
                    self.police_robots.push(robot.index);
                }
                Team::Evader => {
                    self.evaders.push(runner);
                    self.evader_robots.push(robot.index);
                }
                Team::Neutral => {}
            }
        }
        let radius = narrowest(robots);
        self.prepare(map, radius);
        if let Some((_, _, arena)) = &self.arena {
            let verdicts =
                self.dominance
                    .assess(map, arena, &self.police, &self.evaders, self.capture);
            let judged = self.evader_robots.iter().zip(verdicts);
            self.judgements
                .extend(judged.map(|(&robot, &verdict)| Judgement { robot, verdict }));
        }
        &self.judgements
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
        .filter(|robot| robot.team != Team::Neutral && robot.is_sane())
        .map(|robot| robot.radius)
        .fold(f64::INFINITY, f64::min);
    if radius.is_finite() { radius } else { 0.0 }
}
