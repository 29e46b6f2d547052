//! The statements of the paper, and the rules of their verdicts.

/// A statement of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Statement {
    /// Letter on the page.
    pub letter: &'static str,
    /// The statement.
    pub text: &'static str,
    /// The paper's words for it, a few.
    pub published: &'static str,
    /// Rule of the verdict.
    pub rule: &'static str,
}

/// All statements, in the order of the page.
pub(super) const STATEMENTS: [Statement; 9] = [
    Statement {
        letter: "a",
        text: "At every speed, RRT* evaders escape at least as often as those on a potential field, and these at least as often as Braitenberg vehicles.",
        published: "at least as often",
        rule: "Eight comparisons, two at each speed of Fig. 2. Confirmed if every one is higher, or its interval rules out that it is lower by more than 5 points; refuted if one is lower.",
    },
    Statement {
        letter: "b",
        text: "On a potential field, the critical speed, above which half of the evaders escape, is about twice that of the Police.",
        published: "about 2.0×",
        rule: "The range by the intervals, as above. Confirmed if all of it lies between 1.75× and 2.25× (half a step of Fig. 2 to either side); refuted if none of it does.",
    },
    Statement {
        letter: "c",
        text: "On a potential field, evaders escape less often when they are faster than twice the Police.",
        published: "less often",
        rule: "The games at 2.5× and 3.0× together against those at 2.0×. Confirmed if lower; refuted if higher, or if the interval rules out a drop by more than 5 points.",
    },
    Statement {
        letter: "d",
        text: "Braitenberg vehicles have no critical speed: they rarely escape, however fast they are.",
        published: "rarely",
        rule: "Simultaneous intervals over all speeds. Confirmed if fewer than half escape at every speed; refuted if more than half escape at one.",
    },
    Statement {
        letter: "e",
        text: "With RRT*, the critical speed lies between 1.0× and 1.5×.",
        published: "1.0× … 1.5×",
        rule: "As for (b), between 1.0× and 1.5×.",
    },
    Statement {
        letter: "f1",
        text: "Evaders escape more often when the Police rely on a particle filter.",
        published: "more often",
        rule: "Three comparisons, one at each speed of Fig. 3. Confirmed if all are higher; refuted if one is lower, or if all intervals rule out a rise by more than 5 points.",
    },
    Statement {
        letter: "f2",
        text: "Knowledge of the Police matters less at high speeds.",
        published: "less",
        rule: "The rise by the particle filter at 0.8× to 1.0× together, less that at 2.0× to 3.0× together, with its 95 % interval. Confirmed if the interval lies above 0; refuted if it lies below.",
    },
    Statement {
        letter: "g",
        text: "RRT* of circular arcs rarely finds a path from the start to the exit within 5000 iterations.",
        published: "rarely",
        rule: "Plans of the first evader at its published start, 5000 iterations each (fewer if a path is found earlier). Confirmed if the Wilson interval of the chance to find a path lies below one half; refuted if it lies above.",
    },
    Statement {
        letter: "h",
        text: "RRT* paths visibly avoid the Police.",
        published: "visibly",
        rule: "Plans from the published start among Police at random places: the distance of the path to the nearest Police, minus that of the shortest path, plan by plan. Confirmed if the 95 % interval of the mean lies above 0.25 m, a quarter of a street; refuted if it lies below.",
    },
];
