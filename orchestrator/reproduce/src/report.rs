//! All claims with their verdicts, as Markdown, JSON and a page with the figures.

mod html;
mod markdown;

#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use platform::atomic_file::{SaveError, save};
use serde::Serialize;

use crate::claim::{Claim, Paper, Verdict};
use crate::evidence::Evidence;
use crate::page::{Image, Page};
use crate::patrol::LapsError;
use crate::run::{Outcome, REPORTS, Ran};
use crate::template::TemplateError;

/// Failure to write the reports.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// Laps of the patrol cannot be computed.
    #[error(transparent)]
    Laps(#[from] LapsError),
    /// A page does not match its template.
    #[error(transparent)]
    Template(#[from] TemplateError),
    /// The claims cannot be written as JSON.
    #[error("cannot write the claims as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// A file cannot be written.
    #[error(transparent)]
    Save(#[from] SaveError),
}

/// A paper in the report.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PaperSummary {
    /// The paper.
    pub paper: Paper,
    /// Its title.
    pub title: &'static str,
    /// Number of its claims by verdict.
    pub verdicts: BTreeMap<Verdict, usize>,
}

/// The report: a pure function of results.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Version of the program.
    pub program: &'static str,
    /// The papers.
    pub papers: Vec<PaperSummary>,
    /// The executed experiments.
    pub experiments: Vec<Ran>,
    /// All claims.
    pub claims: Vec<Claim>,
    /// Pages of documentation, with the names of their files.
    #[serde(skip)]
    pages: Vec<(&'static str, Page)>,
}

impl Report {
    /// Returns the report on a reproduction of papers.
    ///
    /// # Errors
    /// [`ReportError`].
    pub fn new(outcome: &Outcome, papers: &[Paper]) -> Result<Self, ReportError> {
        let evidence: &Evidence = &outcome.evidence;
        let claims = evidence.claims(papers)?;
        Ok(Self {
            program: env!("CARGO_PKG_VERSION"),
            papers: papers
                .iter()
                .map(|&paper| summary(paper, &claims))
                .collect(),
            experiments: outcome.experiments.clone(),
            claims,
            pages: evidence.pages(papers)?,
        })
    }

    /// Returns the figures of all pages.
    fn images(&self) -> impl Iterator<Item = &Image> {
        self.pages.iter().flat_map(|(_, page)| &page.images)
    }

    /// Returns the report as JSON.
    ///
    /// # Errors
    /// The error of the writer.
    pub fn json(&self) -> Result<serde_json::Value, serde_json::Error> {
        serde_json::to_value(self)
    }

    /// Writes the reports and the pages to a directory; returns the files, the table first.
    ///
    /// # Errors
    /// [`ReportError`].
    pub fn write(&self, directory: &Path) -> Result<Vec<PathBuf>, ReportError> {
        let [markdown, json, html, pages] = REPORTS.map(|name| directory.join(name));
        save(markdown::text(self).as_bytes(), &markdown)?;
        let mut text = serde_json::to_vec_pretty(self)?;
        text.push(b'\n');
        save(&text, &json)?;
        save(html::text(self).as_bytes(), &html)?;
        let mut written = vec![markdown, json, html];
        for (name, page) in &self.pages {
            written.extend(page.write(&pages.join(name))?);
        }
        Ok(written)
    }
}

/// Counts the verdicts on the claims of a paper.
fn summary(paper: Paper, claims: &[Claim]) -> PaperSummary {
    let count = |verdict: Verdict| {
        let of = claims
            .iter()
            .filter(|c| c.paper == paper && c.verdict == verdict);
        (verdict, of.count())
    };
    PaperSummary {
        paper,
        title: paper.title(),
        verdicts: Verdict::ALL.into_iter().map(count).collect(),
    }
}
