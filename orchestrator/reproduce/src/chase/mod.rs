//! The page that compares our chases with the published ones: `docs/results/chase.md`.
//!
//! The published game is that of I. M. Gomes Ribeiro, J. Fiala and R. Shah, *Multi-robot Navigation
//! in the Context of a Chasing Game*. The page has curves, a table of all cells, the critical
//! speeds, and for each of the paper's claims a test and its verdict.

mod claims;
mod crossing;
mod curves;
mod evidence;
mod list;
mod published;
mod read;
mod table;

#[cfg(test)]
mod tests;

pub use evidence::Evidence;
pub use list::list;
pub use read::StudyError;

use self::claims::{Question, Statement, questions};
use self::evidence::Study;
use self::published::Published;
use crate::page::{Image, Page};
use crate::template::{TemplateError, Values};

const TEMPLATE: &str = include_str!("../../templates/chase.md");

/// One experiment of the page.
struct Part<'a> {
    study: Option<&'a Study>,
    published: &'a [Published],
    title: &'static str,
    conditions: &'static str,
    image: &'static str,
    experiment: &'static str,
}

/// Builds the page.
///
/// # Errors
/// [`TemplateError`] if the template does not match the values.
pub fn page(evidence: &Evidence) -> Result<Page, TemplateError> {
    let mut values = Values::default();
    let mut images = Vec::new();
    let mut provenance = String::new();
    let all_speeds = evidence.all_speeds();
    for part in parts(evidence, all_speeds.as_ref()) {
        let Some(study) = part.study else { continue };
        let name = part.experiment;
        values.keep(name);
        let cells = if part.published.is_empty() {
            table::by_speed(study)
        } else {
            table::cells(study, part.published)
        };
        values.set(format!("{name}.cells"), cells);
        values.set(format!("{name}.crossings"), crossing::rows(study));
        images.push(Image {
            name: part.image,
            chart: curves::chart(study, part.published, part.title, part.conditions),
        });
        provenance += &crate::words::provenance(name, &study.seeds, &study.program);
    }
    if let Some(study) = &evidence.speed_rrt_star {
        provenance += &crate::words::provenance(&study.name, &study.seeds, &study.program);
    }
    values.set("provenance", provenance);
    let questions = questions(evidence);
    values.set(
        "verdicts",
        questions.iter().map(verdicts).collect::<String>(),
    );
    values.set("claims", questions.iter().map(section).collect::<String>());
    let text = values.fill(TEMPLATE)?;
    Ok(Page { text, images })
}

/// Returns the row of a statement in the table of verdicts.
fn verdicts(question: &Question) -> String {
    let Statement { letter, text, .. } = question.statement;
    let [ours, paper] = [&question.ours, &question.paper].map(|f| f.verdict.markdown());
    format!("| [{letter}](#claim-{letter}) | {text} | {ours} | {paper} |\n")
}

/// Returns the section of a statement.
fn section(question: &Question) -> String {
    let Statement {
        letter, text, rule, ..
    } = question.statement;
    let mut section = format!("### Claim {letter}\n\n{text}\n\n*Rule.* {rule}\n\n");
    let findings = [&question.ours, &question.paper];
    for (setting, finding) in question.settings.into_iter().zip(findings) {
        let lines = finding.numbers.iter().map(|line| format!("- {line}\n"));
        let numbers = lines.collect::<String>();
        section += &format!("{setting}: {}\n\n{numbers}\n", finding.verdict.markdown());
    }
    section
}

fn parts<'a>(evidence: &'a Evidence, all_speeds: Option<&'a Study>) -> [Part<'a>; 4] {
    [
        Part {
            study: all_speeds,
            published: &[],
            title: "Chance of escape against speed, random layouts",
            conditions: "Police 0.3 m/s with exact knowledge, our planners.",
            image: "chase-escape-vs-speed",
            experiment: "escape_vs_speed",
        },
        Part {
            study: evidence.speed_paper.as_ref(),
            published: &published::SPEED,
            title: "Chance of escape against speed, the paper's parameters",
            conditions: "Police 0.3 m/s with exact knowledge, presets of the paper.",
            image: "chase-escape-vs-speed-paper",
            experiment: "escape_vs_speed_paper",
        },
        Part {
            study: evidence.knowledge.as_ref(),
            published: &[],
            title: "Chance of escape and what the Police know, random layouts",
            conditions: "Police 0.3 m/s; evaders on a potential field that plans around them.",
            image: "chase-knowledge",
            experiment: "knowledge",
        },
        Part {
            study: evidence.knowledge_paper.as_ref(),
            published: &published::KNOWLEDGE,
            title: "Chance of escape and what the Police know, the paper's parameters",
            conditions: "RRT* evaders, Police 0.3 m/s, presets of the paper.",
            image: "chase-knowledge-paper",
            experiment: "knowledge_paper",
        },
    ]
}
