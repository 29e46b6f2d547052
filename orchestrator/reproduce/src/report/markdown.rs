//! The report as Markdown: one table of all claims.

use super::Report;
use crate::claim::{Claim, Verdict};
use crate::words::in_table;

/// Mark of claims about times of this machine.
const TIMED: &str = " †";

/// Returns the text.
pub(super) fn text(report: &Report) -> String {
    let mut text = format!(
        "# Published results, reproduced\n\n\
         Every published number and statement of the papers beside ours, by Protean {}. The same seeds give the same \
         table, byte for byte, except for rows with{TIMED}, which compare CPU times.\n\n",
        report.program
    );
    text += &verdicts(report);
    text += "\n| paper | claim | published | ours | 95 % | n | verdict |\n|---|---|---|---|---|---|---|\n";
    text += &report.claims.iter().map(row).collect::<String>();
    text += "\n## Rules\n\n";
    let mut seen = Vec::new();
    for claim in &report.claims {
        if !seen.contains(&claim.rule) {
            seen.push(claim.rule);
            text += &format!("- From `{}` on: {}\n", claim.id, claim.rule);
        }
    }
    text += "\n## Experiments\n\n| experiment | seeds | missions | failed |\n|---|---|---|---|\n";
    for ran in &report.experiments {
        let (name, seeds) = (&ran.name, &ran.seeds);
        text += &format!(
            "| `{name}` | {seeds} | {} | {} |\n",
            ran.missions, ran.failed
        );
    }
    text
}

/// Returns the table of verdicts by paper.
fn verdicts(report: &Report) -> String {
    let words: Vec<&str> = Verdict::ALL.iter().map(|verdict| verdict.word()).collect();
    let mut text = format!(
        "| paper | | {} |\n|---|---|---|---|---|---|\n",
        words.join(" | ")
    );
    for paper in &report.papers {
        let count = |verdict: &Verdict| {
            paper
                .verdicts
                .get(verdict)
                .copied()
                .unwrap_or(0)
                .to_string()
        };
        let counts: Vec<String> = Verdict::ALL.iter().map(count).collect();
        let (key, title) = (paper.paper.key(), paper.title);
        text += &format!("| {key} | {title} | {} |\n", counts.join(" | "));
    }
    text
}

/// Returns the row of a claim.
fn row(claim: &Claim) -> String {
    let mark = if claim.timed { TIMED } else { "" };
    format!(
        "| {} | {}{mark} | {} | {} | {} | {} {} | {} |\n",
        claim.paper.key(),
        in_table(&claim.claim),
        in_table(&claim.published.text),
        in_table(&claim.ours.text),
        claim.ours.interval_text(),
        claim.ours.n,
        claim.ours.of,
        claim.verdict.markdown(),
    )
}
