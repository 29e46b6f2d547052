//! The paper's claims, and their verdicts from our games.

mod compare;
mod crossing;
mod knowledge;
mod planning;
mod speed;

use super::evidence::{Evidence, Study};
use crate::plans::Plans;

/// Verdict on a claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// The claim is true.
    Confirmed,
    /// The claim is false.
    Refuted,
    /// The games do not decide.
    Undecided,
    /// There are no games for a decision.
    NoData,
}

impl Verdict {
    /// Returns the text of the page.
    pub fn markdown(self) -> &'static str {
        match self {
            Self::Confirmed => "**confirmed**",
            Self::Refuted => "**refuted**",
            Self::Undecided => "undecided",
            Self::NoData => "no data",
        }
    }
}

/// A verdict and its numbers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// The verdict.
    pub verdict: Verdict,
    /// The numbers, a line each.
    pub numbers: Vec<String>,
}

impl Finding {
    /// Returns a finding without data.
    fn missing(what: &str) -> Self {
        Self {
            verdict: Verdict::NoData,
            numbers: vec![format!("There are no results for this: {what}.")],
        }
    }
}

/// One of the paper's claims.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Claim {
    /// Letter of the claim on the page.
    pub letter: &'static str,
    /// Finding with our planners.
    pub ours: Finding,
    /// Finding with the paper's parameters.
    pub paper: Finding,
}

/// Largest difference of chances that counts as none.
pub(super) const MARGIN: f64 = 0.05;

/// Returns all claims.
pub fn claims(evidence: &Evidence) -> Vec<Claim> {
    let all_speeds = evidence.all_speeds();
    let speed = |test: fn(&Study) -> Finding| {
        let of = |study: &Option<Study>, name: &str| {
            study.as_ref().map_or_else(|| Finding::missing(name), test)
        };
        (
            of(&all_speeds, "experiment escape_vs_speed"),
            of(&evidence.speed_paper, "experiment escape_vs_speed_paper"),
        )
    };
    let knowledge = |test: fn(&Study) -> Finding| {
        let of = |study: &Option<Study>, name: &str| {
            study.as_ref().map_or_else(|| Finding::missing(name), test)
        };
        (
            of(&evidence.knowledge, "experiment knowledge"),
            of(&evidence.knowledge_paper, "experiment knowledge_paper"),
        )
    };
    let plans = |test: fn(&Plans, bool) -> Finding| {
        let of = |paper| match &evidence.plans {
            Some(plans) => test(plans, paper),
            None => Finding::missing("plans.csv of `pages plans`"),
        };
        (of(false), of(true))
    };
    let claim = |letter, (ours, paper)| Claim {
        letter,
        ours,
        paper,
    };
    vec![
        claim("a", speed(speed::order)),
        claim("b", speed(crossing::field)),
        claim("c", speed(speed::drop)),
        claim("d", speed(speed::never)),
        claim("e", speed(crossing::rrt)),
        claim("f1", knowledge(knowledge::raises)),
        claim("f2", knowledge(knowledge::fades)),
        claim("g", plans(planning::arcs)),
        claim("h", plans(planning::avoids)),
    ]
}
