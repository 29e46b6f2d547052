//! Hypotheses about the goals of a route that a robot has reached.

use chaotic_maps::AnySource;

/// Maximum excess of a hypothesis's cost over the best one.
pub const MARGIN: f64 = 20.0;
/// Maximum number of hypotheses.
const MAX_GUESSES: usize = 24;
/// Hypotheses that agree on this number of last goals count as equal.
pub const RECENT: usize = 3;

/// Finds the state of a generator from its noisy outputs in the unit square.
pub trait Finder: Clone {
    /// Processes the next output, its coordinates with these standard deviations; returns `true` if
    /// it fits those before.
    fn observe(&mut self, output: [f64; 2], sd: [f64; 2]) -> bool;

    /// Skips an output that was not observed.
    fn gap(&mut self);

    /// Returns minus the logarithm of the outputs' likelihood relative to outputs anywhere in the
    /// square.
    fn cost(&self) -> f64;

    /// Returns the generator after the last processed or skipped output; `None` while its state is
    /// not known.
    fn source(&self) -> Option<AnySource>;
}

/// Hypothesis that assigns the detections to goals of the route.
#[derive(Debug, Clone)]
pub struct Guess<F> {
    /// Number of the last one, in the round.
    pub(super) at: u64,
    /// `true` if the last one may be any of its run ([`crate::layout::Layout::run_of`]).
    pub(super) is_floating: bool,
    pub(super) finder: F,
    /// Cost of overlooked goals, false detections and fixed goals.
    pub(super) cost: f64,
    /// Detections since the last that fitted.
    pub(super) outliers: u32,
    /// The last ones: pairs of detection and goal of the route, of a run the first.
    pub(super) recent: [(u32, u64); RECENT],
}

impl<F: Finder> Guess<F> {
    /// Returns its cost.
    pub(super) fn score(&self) -> f64 {
        self.cost + self.finder.cost()
    }

    /// Returns the hypothesis that this detection is the goal with this number, in the run that begins
    /// at `first`.
    pub(super) fn with(&self, nth: u32, [number, first]: [u64; 2], finder: F, cost: f64) -> Self {
        let [_, recent @ ..] = self.recent;
        let [b, c] = recent;
        Self {
            at: number,
            is_floating: false,
            finder,
            cost,
            outliers: 0,
            recent: [b, c, (nth, first)],
        }
    }
}

/// Returns the hypotheses that are likely enough, the likeliest first.
pub fn likeliest<F: Finder>(mut guesses: Vec<Guess<F>>) -> Vec<Guess<F>> {
    guesses.sort_by(|a, b| a.score().total_cmp(&b.score()));
    let limit = guesses.first().map_or(0.0, Guess::score) + MARGIN;
    let mut kept: Vec<Guess<F>> = Vec::with_capacity(MAX_GUESSES);
    for guess in guesses {
        if guess.score() > limit || kept.len() == MAX_GUESSES {
            break;
        }
        let known =
            |other: &Guess<F>| other.recent == guess.recent && other.outliers == guess.outliers;
        if !kept.iter().any(known) {
            kept.push(guess);
        }
    }
    kept
}
