//! Reproduction of the published results: the experiments, the claims of the papers with verdicts on them, and the
//! reports.
//!
//! [`run`](run::run) executes the experiments; [`claims`](evidence::Evidence::claims) are a pure function of their
//! results, and so are the pages of documentation: Markdown templates with slots. The same results give
//! the same reports, byte for byte.
//!
//! Modules from the lowest to the highest:
//!
//! | modules | content |
//! |---|---|
//! | `words`, `statistics`, `template`, `page`, `place` | text of numbers, tests of hypotheses, pages |
//! | [`claim`] | claims as data |
//! | `plans`, `rrt_star` | single plans of the RRT* evaders |
//! | `chase`, `patrol`, `vmc_lp` | published values, evidence, verdicts and pages of the papers |
//! | [`experiments`], [`evidence`], [`run`] | the experiments, their results, their execution |
//! | [`report`] | all claims as Markdown, JSON and HTML |

mod chase;
pub mod claim;
pub mod evidence;
pub mod experiments;
mod page;
mod patrol;
mod place;
mod plans;
pub mod report;
mod rrt_star;
pub mod run;
mod statistics;
mod template;
mod vmc_lp;
mod words;
