//! The paper's claims, and their verdicts from our games.

mod compare;
mod crossing;
mod knowledge;
mod planning;
mod speed;
mod statements;

use self::statements::STATEMENTS;
pub use self::statements::Statement;

use super::evidence::{Evidence, Study};
use crate::claim::Finding;
use crate::plans::Plans;

/// A statement with our findings.
#[derive(Debug, Clone, PartialEq)]
pub struct Question {
    /// The statement.
    pub statement: Statement,
    /// Finding with our planners; for single plans: with our parameters.
    pub ours: Finding,
    /// Finding in the published game; for single plans: with the paper's parameters.
    pub paper: Finding,
    /// Text before each of both.
    pub settings: [&'static str; 2],
}

/// Largest difference of chances that counts as none.
pub(super) const MARGIN: f64 = 0.05;

/// Before findings of games.
const GAMES: [&str; 2] = [
    "With our planners on random layouts",
    "In the published game",
];
/// Before findings of single plans.
const PLANS: [&str; 2] = ["With our parameters", "With the paper's parameters"];

/// Returns all statements with their findings.
pub fn questions(evidence: &Evidence) -> Vec<Question> {
    let all_speeds = evidence.all_speeds();
    let speed = |test: fn(&Study) -> Finding| {
        let of = |study: &Option<Study>, name: &str| {
            study.as_ref().map_or_else(|| Finding::missing(name), test)
        };
        let ours = of(&all_speeds, "experiment escape_vs_speed");
        let paper = of(&evidence.speed_paper, "experiment escape_vs_speed_paper");
        (ours, paper, GAMES)
    };
    let knowledge = |test: fn(&Study) -> Finding| {
        let of = |study: &Option<Study>, name: &str| {
            study.as_ref().map_or_else(|| Finding::missing(name), test)
        };
        let ours = of(&evidence.knowledge, "experiment knowledge");
        let paper = of(&evidence.knowledge_paper, "experiment knowledge_paper");
        (ours, paper, GAMES)
    };
    let plans = |test: fn(&Plans, bool) -> Finding| {
        let of = |paper| match &evidence.plans {
            Some(plans) => test(plans, paper),
            None => Finding::missing("single plans"),
        };
        (of(false), of(true), PLANS)
    };
    let findings = [
        speed(speed::order),
        speed(crossing::field),
        speed(speed::drop),
        speed(speed::never),
        speed(crossing::rrt),
        knowledge(knowledge::raises),
        knowledge(knowledge::fades),
        plans(planning::arcs),
        plans(planning::avoids),
    ];
    let question = |(statement, (ours, paper, settings))| Question {
        statement,
        ours,
        paper,
        settings,
    };
    STATEMENTS.into_iter().zip(findings).map(question).collect()
}
