//! Results of all experiments, and the claims and pages that follow from them.

use sweep::planning::PlanResults;
use sweep::{Results, SweepError};

use crate::chase::{self, StudyError};
use crate::claim::{Claim, Paper};
use crate::page::Page;
use crate::patrol::{self, LapsError};
use crate::place::PlaceError;
use crate::plans::Plans;
use crate::template::TemplateError;
use crate::vmc_lp;

/// Failure to use results.
#[derive(Debug, thiserror::Error)]
pub enum EvidenceError {
    /// Results of the chase.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// Results of another experiment.
    #[error(transparent)]
    Place(#[from] PlaceError),
    /// The results cannot be read.
    #[error(transparent)]
    Sweep(#[from] SweepError),
}

/// Results of all experiments; missing ones are noted.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Evidence {
    chase: chase::Evidence,
    patrol: patrol::Evidence,
    vmc_lp: vmc_lp::Evidence,
}

impl Evidence {
    /// Adds the results of missions of robots.
    ///
    /// # Errors
    /// [`EvidenceError`].
    pub fn add(&mut self, paper: Paper, results: &Results) -> Result<(), EvidenceError> {
        match paper {
            Paper::Chase => self.chase.add(results)?,
            Paper::Patrol | Paper::Coverage | Paper::VmcLp => self.patrol.add(results)?,
        }
        Ok(())
    }

    /// Adds the results of plans of minimum-time trajectories.
    ///
    /// # Errors
    /// [`EvidenceError`].
    pub fn add_planning(&mut self, results: &PlanResults) -> Result<(), EvidenceError> {
        Ok(self.vmc_lp.add(results)?)
    }

    /// Adds single plans of the RRT* evaders.
    pub fn add_plans(&mut self, plans: Plans) {
        self.chase.plans = Some(plans);
    }

    /// Returns the claims of papers.
    ///
    /// # Errors
    /// `LapsError` if a built-in scenario of the patrol is unusable.
    pub fn claims(&self, papers: &[Paper]) -> Result<Vec<Claim>, LapsError> {
        let mut claims = Vec::new();
        for paper in papers {
            claims.extend(match paper {
                Paper::Chase => chase::list(&self.chase),
                Paper::Patrol => patrol::list(&self.patrol)?,
                Paper::Coverage => patrol::coverage_list(&self.patrol),
                Paper::VmcLp => vmc_lp::list(&self.vmc_lp),
            });
        }
        Ok(claims)
    }

    /// Returns the pages of documentation about papers, with the names of their files.
    ///
    /// # Errors
    /// `TemplateError` if a template does not match its values.
    pub fn pages(&self, papers: &[Paper]) -> Result<Vec<(&'static str, Page)>, TemplateError> {
        let mut pages = Vec::new();
        if papers.contains(&Paper::Chase) {
            pages.push(("chase.md", chase::page(&self.chase)?));
        }
        if papers.contains(&Paper::Patrol) || papers.contains(&Paper::Coverage) {
            pages.push(("patrol.md", patrol::page(&self.patrol)?));
        }
        if papers.contains(&Paper::VmcLp) {
            pages.push(("vmc-lp.md", vmc_lp::page(&self.vmc_lp)?));
        }
        Ok(pages)
    }
}
