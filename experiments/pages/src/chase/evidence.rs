//! Input of the page.

use statistics::Sample;

use crate::plans::Plans;

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
    /// Escaped evaders, game by game.
    pub escapes: Sample,
    /// Evaders that were caught.
    pub caught: u64,
    /// Evaders that were still in the game at the time limit.
    pub held_out: u64,
    /// Failed games; they are not in other counts.
    pub failed: u64,
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
            .filter(|c| c.escapes.members() > 0)
    }

    /// Returns the speeds of a method that have games, ascending.
    pub fn ratios(&self, method: &str) -> Vec<f64> {
        let cells = self
            .cells
            .iter()
            .filter(|c| c.method == method && c.escapes.members() > 0);
        let mut ratios: Vec<f64> = cells.map(|c| c.ratio).collect();
        ratios.sort_by(f64::total_cmp);
        ratios
    }

    /// Returns the games of a method at several speeds as one sample; `None` if one of them has
    /// none.
    pub fn pooled(&self, method: &str, ratios: &[f64]) -> Option<Sample> {
        ratios.iter().try_fold(Sample::default(), |sum, &ratio| {
            Some(sum.with(&self.cell(method, ratio)?.escapes))
        })
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
