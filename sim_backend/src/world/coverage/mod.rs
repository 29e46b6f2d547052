//! Coverage: the free cells that robots have visited, with the numbers and times of visits.
//!
//! A cell is visited when its centre comes within a robot's footprint, a disc about the robot's centre,
//! anywhere along the robot's path. Between two ticks the disc is swept along the exact arc that the
//! robot drove, or along the pieces of its path after contacts. Speed and tick rate make no difference.

mod coverable;
mod swept;
#[cfg(test)]
mod tests;

use core::time::Duration;

use geometry::grid::GridFrame;
use geometry::map::WorldMap;
use geometry::pose::Pose2;
use nalgebra::Point2;

use self::coverable::CoverageDomain;
use self::swept::SweptPath;
use super::motion::Motion;
use crate::robot::Robot;
use crate::spec::CoverageSpec;
use parameters::ParamsError;
use robot::team::Role;

/// Maximum number of accounted cells: 24 bytes each.
const MAX_CELLS: f64 = 16_000_000.0;

/// Visits of a cell.
#[derive(Debug, Clone, Copy, Default)]
struct Cell {
    /// Time of the last visit (ns).
    last_ns: u64,
    /// Tick of the last visit.
    last_tick: u64,
    visits: u32,
    free: bool,
    coverable: bool,
}

/// A robot that counts.
#[derive(Debug, Clone, Copy)]
struct Sweeper {
    robot: usize,
    /// Radius of its footprint (m).
    reach: f64,
    /// Pose at the start of the step, if it was in the game then.
    before: Option<Pose2>,
}

/// Totals of a [`Coverage`] at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoverageFigures {
    /// Number of free cells now.
    pub free: usize,
    /// Number of visited ones among them.
    pub visited: usize,
    /// Number of free cells that some counted robot can visit (see [`Coverage::is_coverable`]).
    pub coverable: usize,
    /// Number of visited ones among them.
    pub covered: usize,
    /// Number of visits of all cells.
    pub visits: u64,
    /// Unevenness of the visits of coverable cells: standard deviation divided by the mean; 0 before any
    /// visit.
    pub unevenness: f64,
    /// Distance driven by the counted robots together (m).
    pub way: f64,
    /// Mean time since the last visit over the coverable cells (s); since the start for those not
    /// visited yet.
    pub mean_idleness: f64,
    /// Largest of these times (s).
    pub max_idleness: f64,
    /// Maximum time that any coverable cell has waited for a visit so far (s).
    pub worst_idleness: f64,
}

impl CoverageFigures {
    /// Visited share of the free cells, 0…1 (1 if there are none).
    pub fn fraction(&self) -> f64 {
        part(self.visited, self.free)
    }

    /// Visited share of the coverable cells, 0…1 (1 if there are none).
    pub fn coverable_fraction(&self) -> f64 {
        part(self.covered, self.coverable)
    }
}

fn part(some: usize, all: usize) -> f64 {
    if all == 0 {
        1.0
    } else {
        some as f64 / all as f64
    }
}

/// The visited area: cells, numbers and times of visits.
///
/// ```
/// # use core::time::Duration;
/// # use geometry::map::{MapSpec, VectorMap};
/// # use geometry::pose::{Pose2, Twist2};
/// # use robot::spec::RobotSpec;
/// # use sim_backend::spec::{CoverageSpec, RulesSpec, WorldSpec};
/// # use robot::team::Role;
/// # use sim_backend::world::World;
/// let mut world = World::new(WorldSpec {
///     map: MapSpec::Vector(VectorMap::empty([0.0, 0.0], [4.0, 3.0], 0.05)),
///     robots: vec![RobotSpec::new("walle", Role::Neutral, Pose2::new(1.0, 1.5, 0.0))],
///     rules: RulesSpec { coverage: Some(CoverageSpec::default()), ..RulesSpec::default() },
///     seed: 1,
/// })?;
/// let visited = |world: &World| world.coverage().map(|c| c.fraction());
/// let before = visited(&world);
/// world.step(&[Some(Twist2::new(0.2, 0.0))], Duration::from_secs(1));
/// assert!(visited(&world) > before);
/// # Ok::<(), sim_backend::world::WorldError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Coverage {
    spec: CoverageSpec,
    frame: GridFrame,
    cells: Vec<Cell>,
    sweepers: Vec<Sweeper>,
    free: usize,
    visited: usize,
    coverable: usize,
    covered: usize,
    visits: u64,
    /// Distance driven by the counted robots together (m).
    way: f64,
    /// Maximum time between two visits of a coverable cell (ns).
    worst_gap_ns: u64,
}

impl Coverage {
    /// Creates the account at time 0: the robots have visited the cells below them.
    ///
    /// # Errors
    /// The error names the field of the specification that does not fit the map or the robots.
    pub(super) fn new(
        spec: &CoverageSpec,
        map: &WorldMap,
        robots: &[Robot],
    ) -> Result<Self, ParamsError> {
        if let Some(unknown) = spec
            .robots
            .iter()
            .position(|name| robots.iter().all(|robot| robot.name != *name))
        {
            let names: Vec<_> = robots.iter().map(|robot| robot.name.as_str()).collect();
            return Err(ParamsError::new(
                &format!("coverage.robots[{unknown}]"),
                &spec.robots[unknown],
                format!("one of the robots {}", names.join(", ")),
            ));
        }
        // The standard teams may have no robots.
        let is_known = |team: &String| {
            Role::of_team(team).is_some() || robots.iter().any(|robot| robot.team_name == *team)
        };
        if let Some(unknown) = spec.teams.iter().position(|team| !is_known(team)) {
            let field = format!("coverage.teams[{unknown}]");
            let expected = "a team with robots in it";
            return Err(ParamsError::new(&field, &spec.teams[unknown], expected));
        }
        let sweepers: Vec<_> = robots
            .iter()
            .enumerate()
            .filter(|(_, robot)| spec.counts(&robot.name, &robot.team_name))
            .map(|(i, robot)| Sweeper {
                robot: i,
                reach: spec.radius.unwrap_or(robot.radius()),
                before: None,
            })
            .collect();
        if sweepers.is_empty() {
            let given = format!("{:?}", spec.teams);
            let expected = "a team with robots in it";
            return Err(ParamsError::new("coverage.teams", &given, expected));
        }
        let frame = frame(spec, map)?;
        let mut coverage = Self {
            spec: spec.clone(),
            frame,
            cells: vec![Cell::default(); frame.len()],
            sweepers,
            free: 0,
            visited: 0,
            coverable: 0,
            covered: 0,
            visits: 0,
            way: 0.0,
            worst_gap_ns: 0,
        };
        coverage.follow_map(map, robots);
        for k in 0..coverage.sweepers.len() {
            let Sweeper { robot, reach, .. } = coverage.sweepers[k];
            let at = robots[robot].pose.position();
            coverage.visit(SweptPath::Straight { from: at, to: at }, reach, 0, 0);
        }
        Ok(coverage)
    }

    /// Recomputes the free and the coverable cells after a change of the map.
    pub(super) fn follow_map(&mut self, map: &WorldMap, robots: &[Robot]) {
        let frame = self.frame;
        let clearance: Vec<f64> = if frame == *map.frame() {
            map.clearance().cells.iter().map(|&c| c.into()).collect()
        } else {
            let centers = (0..frame.height)
                .flat_map(|row| (0..frame.width).map(move |col| frame.center(col, row)));
            centers.map(|center| map.distance(center)).collect()
        };
        let domain = CoverageDomain {
            frame: &frame,
            clearance: &clearance,
        };
        let mut coverable = vec![false; frame.len()];
        let mut kinds: Vec<(f64, f64)> = Vec::new();
        for sweeper in &self.sweepers {
            let kind = (robots[sweeper.robot].radius(), sweeper.reach);
            if kinds.contains(&kind) {
                continue;
            }
            kinds.push(kind);
            let alike = self.sweepers.iter().map(|s| (&robots[s.robot], s.reach));
            let starts = alike
                .filter(|(robot, reach)| (robot.radius(), *reach) == kind)
                .map(|(robot, _)| robot.pose.position());
            coverable::mark(&domain, starts, kind.0, kind.1, &mut coverable);
        }
        (self.free, self.visited, self.coverable, self.covered) = (0, 0, 0, 0);
        for ((cell, &clearance), &coverable) in
            self.cells.iter_mut().zip(&clearance).zip(&coverable)
        {
            cell.free = clearance > 0.0;
            cell.coverable = cell.free && coverable;
            let seen = usize::from(cell.visits > 0);
            self.free += usize::from(cell.free);
            self.visited += usize::from(cell.free) * seen;
            self.coverable += usize::from(cell.coverable);
            self.covered += usize::from(cell.coverable) * seen;
        }
    }

    /// Stores the poses of the robots at the start of a step.
    pub(super) fn begin(&mut self, robots: &[Robot]) {
        for sweeper in &mut self.sweepers {
            let robot = &robots[sweeper.robot];
            sweeper.before = robot.is_active().then_some(robot.pose);
        }
    }

    /// Accounts for a step of `dt` (s) to `tick` and `time`.
    pub(super) fn end(
        &mut self,
        robots: &[Robot],
        motion: &Motion,
        dt: f64,
        tick: u64,
        time: Duration,
    ) {
        self.way = self
            .sweepers
            .iter()
            .map(|sweeper| robots[sweeper.robot].distance_travelled)
            .sum();
        // 585 years.
        let now = u64::try_from(time.as_nanos()).unwrap_or(u64::MAX);
        for k in 0..self.sweepers.len() {
            let Sweeper {
                robot,
                reach,
                before: Some(before),
            } = self.sweepers[k]
            else {
                continue;
            };
            if motion.touch[robot].blocked {
                let mut from = before.position();
                self.visit(SweptPath::Straight { from, to: from }, reach, tick, now);
                for &(_, to) in motion.trace.iter().filter(|(mover, _)| *mover == robot) {
                    self.visit(SweptPath::Straight { from, to }, reach, tick, now);
                    from = to;
                }
            } else {
                let after = &robots[robot];
                let way = SweptPath::from_twist(before, after.twist, dt, after.pose.position());
                self.visit(way, reach, tick, now);
            }
        }
    }

    fn visit(&mut self, way: SweptPath, reach: f64, tick: u64, now: u64) {
        let (frame, bounds) = (self.frame, way.bounds());
        // The cells whose centres may be near enough, and possibly one more on each side.
        let range = |low: f64, high: f64, origin: f64, cells: usize| {
            let first = ((low - reach - origin) / frame.resolution - 1.5).max(0.0) as usize;
            let last = ((high + reach - origin) / frame.resolution + 1.5).max(0.0) as usize;
            first..cells.min(last)
        };
        let columns = range(bounds.min.x, bounds.max.x, frame.origin.x, frame.width);
        for row in range(bounds.min.y, bounds.max.y, frame.origin.y, frame.height) {
            for col in columns.clone() {
                let index = frame.index(col, row);
                let cell = &self.cells[index];
                let done = cell.visits > 0 && cell.last_tick == tick;
                if cell.free && !done && way.passes(frame.center(col, row), reach) {
                    self.mark(index, tick, now);
                }
            }
        }
    }

    /// An uninterrupted stay, of any robots, is one visit.
    fn mark(&mut self, index: usize, tick: u64, now: u64) {
        let cell = &mut self.cells[index];
        if cell.visits == 0 {
            self.visited += 1;
            self.covered += usize::from(cell.coverable);
        }
        if cell.visits == 0 || cell.last_tick + 1 < tick {
            cell.visits = cell.visits.saturating_add(1);
            self.visits += 1;
        }
        if cell.coverable {
            self.worst_gap_ns = self.worst_gap_ns.max(now - cell.last_ns.min(now));
        }
        (cell.last_tick, cell.last_ns) = (tick, now);
    }

    /// The specification.
    pub fn spec(&self) -> &CoverageSpec {
        &self.spec
    }

    /// Frame of the cells.
    pub fn frame(&self) -> &GridFrame {
        &self.frame
    }

    /// Number of visits of each cell, row by row. An uninterrupted stay counts once.
    pub fn visits(&self) -> impl ExactSizeIterator<Item = u32> + '_ {
        self.cells.iter().map(|cell| cell.visits)
    }

    /// Time since the last visit of each cell (s), row by row, at the time `now`; since the start for
    /// those not visited yet.
    pub fn idleness(&self, now: Duration) -> impl ExactSizeIterator<Item = f64> + '_ {
        let now = now.as_nanos() as u64;
        self.cells
            .iter()
            .map(move |cell| now.saturating_sub(cell.last_ns) as f64 / 1e9)
    }

    /// Returns `true` if a cell's centre lies outside all obstacles now; false for an index out of range.
    pub fn is_free(&self, index: usize) -> bool {
        self.cells.get(index).is_some_and(|cell| cell.free)
    }

    /// Returns `true` if a counted robot can reach a free cell from its position at the last change of
    /// the map; `false` for an index out of range.
    ///
    /// The decision uses the cells' centres: a passage wider than the robot by less than a cell may count
    /// as closed, and a barely reachable cell at the rim as unreachable.
    pub fn is_coverable(&self, index: usize) -> bool {
        self.cells.get(index).is_some_and(|cell| cell.coverable)
    }

    /// The totals at the time `now` of the world. One pass over the cells.
    pub fn figures(&self, now: Duration) -> CoverageFigures {
        let (mut sum, mut largest) = (0.0, 0.0_f64);
        let (mut visits, mut squares) = (0.0, 0.0);
        for (cell, idleness) in self.cells.iter().zip(self.idleness(now)) {
            if cell.coverable {
                sum += idleness;
                largest = largest.max(idleness);
                let count = f64::from(cell.visits);
                visits += count;
                squares += count * count;
            }
        }
        let cells = self.coverable.max(1) as f64;
        let mean = visits / cells;
        let variance = (squares / cells - mean * mean).max(0.0);
        CoverageFigures {
            free: self.free,
            visited: self.visited,
            coverable: self.coverable,
            covered: self.covered,
            visits: self.visits,
            unevenness: if mean > 0.0 {
                variance.sqrt() / mean
            } else {
                0.0
            },
            way: self.way,
            mean_idleness: sum / cells,
            max_idleness: largest,
            worst_idleness: largest.max(self.worst_gap_ns as f64 / 1e9),
        }
    }

    /// Visited share of the free cells, 0…1 (1 if there are none).
    pub fn fraction(&self) -> f64 {
        part(self.visited, self.free)
    }
}

/// The frame of the accounted cells.
fn frame(spec: &CoverageSpec, map: &WorldMap) -> Result<GridFrame, ParamsError> {
    let resolution = match spec.resolution {
        Some(resolution) if resolution != map.frame().resolution => resolution,
        _ => return Ok(*map.frame()),
    };
    let bounds = map.bounds();
    let size = bounds.max - bounds.min;
    // A side that is an integer number of cells except for rounding gets exactly that number.
    let count = |side: f64| (side / resolution - 1e-6).ceil().max(1.0);
    let (width, height) = (count(size.x), count(size.y));
    if width * height > MAX_CELLS {
        let least = (size.x * size.y / MAX_CELLS).sqrt();
        return Err(ParamsError::new(
            "coverage.resolution",
            &resolution,
            format!("at least about {least:.3} m on this map: at most {MAX_CELLS} cells"),
        ));
    }
    let origin: Point2<f64> = bounds.min;
    Ok(GridFrame {
        width: width as usize,
        height: height as usize,
        resolution,
        origin,
    })
}
