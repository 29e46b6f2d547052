//! Input of the page.

use statistics::Sample;

use crate::plans::Plans;
use crate::statistics::BySeed;

/// Input of the page. The page notes missing parts.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Evidence {
    /// Escape chance by speed, our planners on random layouts.
    pub speed: Option<Study>,
    /// The same with RRT* evaders.
    pub speed_rrt_star: Option<Study>,
    /// Escape chance by speed, the published game (the paper's Fig. 2).
    pub speed_paper: Option<Study>,
    /// Exact knowledge and particle filter, our planners on random layouts.
    pub knowledge: Option<Study>,
    /// The same in the published game (the paper's Fig. 3).
    pub knowledge_paper: Option<Study>,
    /// Single plans.
    pub plans: Option<Plans>,
}

/// The results of one experiment.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Study {
    /// Name of the experiment.
    pub name: String,
    /// Version of the program that executed it.
    pub program: String,
    /// The seeds, as text.
    pub seeds: String,
    /// The methods that are compared, in the order of the experiment.
    pub methods: Vec<Method>,
    /// The cells, in the order of the experiment.
    pub cells: Vec<Cell>,
}

/// A method that is compared: a way to evade, or the knowledge of the Police.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Method {
    /// Name of its case.
    pub name: String,
    /// Title.
    pub title: String,
}

/// All games of one method at one speed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cell {
    /// Name of its case.
    pub method: String,
    /// Speed of the evaders relative to the Police.
    pub ratio: f64,
    /// Escaped evaders and all evaders, game by game.
    pub games: BySeed,
    /// Evaders that were caught.
    pub caught: u64,
    /// Evaders that were still in the game at the time limit.
    pub held_out: u64,
    /// Failed games; they are not in other counts.
    pub failed: u64,
}

impl Cell {
    /// Returns the escapes of all games.
    pub fn escapes(&self) -> Sample {
        self.games.values().copied().collect()
    }
}

impl Evidence {
    /// Returns the escape chances by speed of all our planners.
    pub fn all_speeds(&self) -> Option<Study> {
        let mut all = self.speed.clone()?;
        if let Some(more) = &self.speed_rrt_star {
            all.methods.extend_from_slice(&more.methods);
            all.cells.extend_from_slice(&more.cells);
        }
        Some(all)
    }
}

impl Study {
    /// Returns the cell of a method at a speed.
    pub fn cell(&self, method: &str, ratio: f64) -> Option<&Cell> {
        self.cells
            .iter()
            .find(|c| c.method == method && same(c.ratio, ratio))
            .filter(|c| c.escapes().members() > 0)
    }

    /// Returns the speeds of a method that have games, ascending.
    pub fn ratios(&self, method: &str) -> Vec<f64> {
        let cells = self
            .cells
            .iter()
            .filter(|c| c.method == method && c.escapes().members() > 0);
        let mut ratios: Vec<f64> = cells.map(|c| c.ratio).collect();
        ratios.sort_by(f64::total_cmp);
        ratios
    }

    /// Returns the games of a method at several speeds, those of one seed as one; `None` if a speed has
    /// none. Seeds that a speed lacks are left out.
    pub fn pooled(&self, method: &str, ratios: &[f64]) -> Option<BySeed> {
        let cells: Option<Vec<&Cell>> = ratios.iter().map(|&r| self.cell(method, r)).collect();
        let (first, others) = cells?.split_first().map(|(f, o)| (*f, o.to_vec()))?;
        let games = first.games.iter().filter_map(|(seed, &game)| {
            let sum = others.iter().try_fold(game, |(hits, members), cell| {
                let more = cell.games.get(seed)?;
                Some((hits + more.0, members + more.1))
            });
            Some((*seed, sum?))
        });
        Some(games.collect())
    }

    /// Returns the title of a method.
    pub fn title<'a>(&'a self, method: &'a str) -> &'a str {
        let found = self.methods.iter().find(|m| m.name == method);
        found.map_or(method, |m| m.title.as_str())
    }
}

/// Returns `true` if two speeds are equal within rounding.
pub(super) fn same(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}
