//! The claims of the paper as data: its statements, each with two findings, and the values of its figures.

use statistics::Z95;

use super::claims::{Question, questions};
use super::evidence::{Evidence, Study};
use super::published::{self, KNOWLEDGE, SPEED};
use crate::claim::{self, Claim, Finding, Measured, Paper, Unit, Verdict};
use crate::words::ratio;

/// Rule of the values of the figures.
const RULE: &str = "Refuted if Fisher's exact test of our games against the published ten has p < 0.05; \
                    confirmed if not, and our 95 % interval by game lies within that of the published ten (Wilson).";

/// Returns all claims.
pub fn list(evidence: &Evidence) -> Vec<Claim> {
    let mut claims: Vec<Claim> = questions(evidence).iter().flat_map(statements).collect();
    claims.extend(values(evidence.speed_paper.as_ref(), &SPEED, 2));
    claims.extend(values(evidence.knowledge_paper.as_ref(), &KNOWLEDGE, 3));
    claims
}

/// Returns a statement with each of its findings.
fn statements(question: &Question) -> [Claim; 2] {
    let statement = question.statement;
    let [first, second] = question.settings;
    let claim = |side: &str, setting: &str, finding: &Finding| Claim {
        paper: Paper::Chase,
        id: format!("chase.{}.{side}", statement.letter),
        claim: format!("({}) {} {setting}.", statement.letter, statement.text),
        published: claim::Published::text(statement.published),
        ours: finding.ours.clone(),
        verdict: finding.verdict,
        rule: statement.rule,
        details: finding.numbers.clone(),
        timed: false,
    };
    [
        claim("ours", first, &question.ours),
        claim("paper", second, &question.paper),
    ]
}

/// Returns the published values of a figure.
fn values<'a>(
    study: Option<&'a Study>,
    published: &'a [published::Published],
    figure: u8,
) -> impl Iterator<Item = Claim> + 'a {
    published.iter().map(move |value| {
        let title = study.map_or(value.method, |study| study.title(value.method));
        let speed = ratio(value.ratio);
        let Finding {
            verdict,
            ours,
            numbers,
        } = finding(study, value);
        Claim {
            paper: Paper::Chase,
            id: format!("chase.fig{figure}.{}.{}", value.method, value.ratio),
            claim: format!("Fig. {figure}: chance to escape, {title}, at {speed}"),
            published: claim::Published::number(value.share(), Unit::Share),
            ours,
            verdict,
            rule: RULE,
            details: numbers,
            timed: false,
        }
    })
}

/// Compares a published value with our games.
fn finding(study: Option<&Study>, value: &published::Published) -> Finding {
    let cell = study.and_then(|study| study.cell(value.method, value.ratio));
    let Some((cell, share)) = cell.and_then(|cell| Some((cell, cell.escapes().share()?))) else {
        return Finding::missing(&format!("{} at {}", value.method, ratio(value.ratio)));
    };
    let sample = cell.escapes();
    let interval = sample.interval(Z95);
    let p = value.alike(&sample);
    let verdict = if p < 0.05 {
        Verdict::Refuted
    } else if interval.is_within(&value.interval()) {
        Verdict::Confirmed
    } else {
        Verdict::Undecided
    };
    Finding {
        verdict,
        ours: Measured::number(share, interval, Unit::Share, (sample.groups(), "games")),
        numbers: vec![format!("Fisher's exact test: {}", crate::words::p_value(p))],
    }
}
