//! The report as a page for a browser: the table, and the figures inside the file.

use data_encoding::BASE64;
use draw::canvas::escape;
use draw::figures::draw;

use super::Report;
use crate::claim::{Claim, Verdict};

const TEMPLATE: &str = include_str!("../../templates/reproduce.html");

/// Returns the page.
pub(super) fn text(report: &Report) -> String {
    let mut page = String::new();
    let mut rest = TEMPLATE;
    while let Some((before, after)) = rest.split_once("{{") {
        let Some((slot, after)) = after.split_once("}}") else {
            break;
        };
        page += before;
        page += &match slot {
            "program" => escape(report.program),
            "papers" => papers(report),
            "claims" => report.claims.iter().map(row).collect(),
            "figures" => figures(report),
            "experiments" => experiments(report),
            _ => String::new(),
        };
        rest = after;
    }
    page + rest
}

fn papers(report: &Report) -> String {
    let row = |paper: &super::PaperSummary| {
        let count = |verdict: &Verdict| paper.verdicts.get(verdict).copied().unwrap_or(0);
        let cell = |verdict: &Verdict| format!("<td>{}</td>", count(verdict));
        let counts: String = Verdict::ALL.iter().map(cell).collect();
        format!("<tr><td>{}</td>{counts}</tr>\n", escape(paper.title))
    };
    report.papers.iter().map(row).collect()
}

/// Returns the row of a claim; its rule and further numbers unfold.
fn row(claim: &Claim) -> String {
    let ours = &claim.ours;
    let numbers = claim
        .details
        .iter()
        .map(|line| format!("<li>{}</li>", escape(line)));
    let timed = if claim.timed {
        " (CPU times of this machine)"
    } else {
        ""
    };
    format!(
        "<tr id=\"{id}\"><td>{paper}</td><td><details><summary>{text}{timed}</summary><p>{rule}</p><ul>{numbers}</ul>\
         </details></td><td>{published}</td><td>{value}</td><td>{interval}</td><td>{n} {of}</td>\
         <td class=\"{class}\">{verdict}</td></tr>\n",
        id = escape(&claim.id),
        paper = claim.paper.key(),
        text = escape(&claim.claim),
        rule = escape(claim.rule),
        numbers = numbers.collect::<String>(),
        published = escape(&claim.published.text),
        value = escape(&ours.text),
        interval = escape(&ours.interval_text()),
        n = ours.n,
        of = ours.of,
        class = claim.verdict.word().replace(' ', "-"),
        verdict = claim.verdict.word(),
    )
}

/// Returns the figures. Each is an image of its own, so that names inside the drawings do not collide.
fn figures(report: &Report) -> String {
    let figure = |image: &crate::page::Image| {
        let svg = draw(&image.chart).svg();
        format!(
            "<figure><img alt=\"{}\" src=\"data:image/svg+xml;base64,{}\"></figure>\n",
            escape(image.name),
            BASE64.encode(svg.as_bytes())
        )
    };
    report.images().map(figure).collect()
}

fn experiments(report: &Report) -> String {
    let row = |ran: &crate::run::Ran| {
        format!(
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
            escape(&ran.name),
            escape(&ran.seeds),
            ran.missions,
            ran.failed
        )
    };
    report.experiments.iter().map(row).collect()
}
