//! `protean sweep page`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use super::{EXIT_FAILED, EXIT_INVALID, print};
use crate::chase_page::{Evidence, MARK, Page, Plans, page};
use crate::figures::{SaveError, draw, save};
use crate::plan_page;
use crate::route_page;
use crate::sweep::planning::PlanResults;
use crate::sweep::{Kind, Results, kind_of};

/// The page of the chase's experiments.
const CHASE_PAGE: &str = "docs/chase-results.md";
/// The page of the experiments with plans.
const PLANS_PAGE: &str = "docs/vmc-lp-results.md";
/// The page of the experiments with patrols and coverage.
const ROUTES_PAGE: &str = "docs/patrol-results.md";

/// What `protean sweep page` takes.
#[derive(Debug, clap::Args)]
pub(super) struct PageArgs {
    /// The directories of the results: of the chase's experiments, of those with plans, or of those
    /// with patrols and coverage
    #[arg(required = true, value_name = "DIR")]
    results: Vec<PathBuf>,
    /// A table of single plans, as `protean sweep plans` writes it
    #[arg(long, value_name = "FILE")]
    plans: Option<PathBuf>,
    /// The page; its pictures go to the folder images beside it [default: docs/chase-results.md,
    /// docs/vmc-lp-results.md for plans, docs/patrol-results.md for patrols and coverage]
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Overwrite a file that this command has not written
    #[arg(long)]
    force: bool,
}

/// Writes the page and prints what was written.
pub(super) fn write(args: &PageArgs) -> ExitCode {
    let about = about(&args.results);
    let gathered = match about {
        About::Plans => gather_plans(args).map(|evidence| plan_page::page(&evidence)),
        About::Routes => gather_routes(args).map(|evidence| route_page::page(&evidence)),
        About::Chase => gather(args).map(|evidence| page(&evidence)),
    };
    let page = match gathered {
        Ok(page) => page,
        Err(error) => return refused(&error),
    };
    let default = match about {
        About::Plans => PLANS_PAGE,
        About::Routes => ROUTES_PAGE,
        About::Chase => CHASE_PAGE,
    };
    let out = args.out.clone().unwrap_or_else(|| default.into());
    if !args.force && !is_ours(&out) {
        return refused(&format!(
            "{} was not written by this command; choose another name with --out or overwrite it with \
             --force",
            out.display()
        ));
    }
    match put(&page, &out) {
        Ok(files) => {
            for file in files {
                print(&file.display().to_string());
            }
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(EXIT_FAILED)
        }
    }
}

/// Which page results belong to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum About {
    Chase,
    Plans,
    Routes,
}

fn about(directories: &[PathBuf]) -> About {
    let is_of_plans = |dir: &PathBuf| matches!(kind_of(dir), Ok(Kind::Planning));
    let is_of_routes = |dir: &PathBuf| {
        Results::read(dir).is_ok_and(|results: Results| {
            route_page::Evidence::is_about(&results.manifest().experiment)
        })
    };
    if directories.iter().any(is_of_plans) {
        About::Plans
    } else if directories.iter().any(is_of_routes) {
        About::Routes
    } else {
        About::Chase
    }
}

fn refused(error: &dyn std::fmt::Display) -> ExitCode {
    eprintln!("error: {error}");
    ExitCode::from(EXIT_INVALID)
}

fn gather_plans(args: &PageArgs) -> Result<plan_page::Evidence, Box<dyn std::error::Error>> {
    let mut evidence = plan_page::Evidence::default();
    for directory in &args.results {
        let results = PlanResults::read(directory)?;
        let missing = results.missing().len();
        if missing > 0 {
            eprintln!("note: {}: {missing} plans are missing", directory.display());
        }
        evidence.add(&results)?;
    }
    Ok(evidence)
}

fn gather_routes(args: &PageArgs) -> Result<route_page::Evidence, Box<dyn std::error::Error>> {
    let mut evidence = route_page::Evidence::default();
    for directory in &args.results {
        evidence.add(&read_missions(directory)?)?;
    }
    Ok(evidence)
}

/// Results of missions; says so if some are missing.
fn read_missions(directory: &Path) -> Result<Results, Box<dyn std::error::Error>> {
    let results = Results::read(directory)?;
    let missing = results.missing().len();
    if missing > 0 {
        eprintln!(
            "note: {}: {missing} missions are missing",
            directory.display()
        );
    }
    Ok(results)
}

fn gather(args: &PageArgs) -> Result<Evidence, Box<dyn std::error::Error>> {
    let mut evidence = Evidence::default();
    for directory in &args.results {
        evidence.add(&read_missions(directory)?)?;
    }
    if let Some(path) = &args.plans {
        evidence.plans = Some(Plans::read(path)?);
    }
    Ok(evidence)
}

/// Whether a file is not there, or begins as ours do.
fn is_ours(path: &Path) -> bool {
    match std::fs::read(path) {
        Ok(bytes) => bytes.starts_with(MARK.as_bytes()),
        Err(error) => error.kind() == std::io::ErrorKind::NotFound,
    }
}

fn put(page: &Page, out: &Path) -> Result<Vec<PathBuf>, SaveError> {
    let images = out.with_file_name("images");
    let mut written = Vec::new();
    for image in &page.images {
        let path = images.join(format!("{}.svg", image.name));
        save(draw(&image.chart).svg().as_bytes(), &path)?;
        written.push(path);
    }
    save(page.text.as_bytes(), out)?;
    written.push(out.to_owned());
    Ok(written)
}
