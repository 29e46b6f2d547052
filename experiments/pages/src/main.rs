//! Pages of documentation that compare results of the experiments with published ones.
//!
//! A page is a Markdown template with slots ([`template`]) and a pure function of results of
//! sweeps: the same results give the same page, byte for byte.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

mod chase;
mod page;
mod patrol;
mod place;
mod plans;
mod rrt_star;
mod statistics;
mod template;
mod vmc_lp;
mod words;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};
use platform::atomic_file::save;
use sweep::planning::PlanResults;
use sweep::{Record, Results};

use self::page::Page;
use self::plans::Plans;

/// Write the pages of documentation that compare results of the experiments with published ones
#[derive(Debug, Parser)]
#[command(name = "pages")]
enum Command {
    #[command(flatten)]
    Page(PageCommand),
    /// Measure single plans of the RRT* evaders, for the page of the chase
    Plans {
        /// Plans of every planner, with the Police at their starts and again at random places
        #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=100_000))]
        count: u32,
        /// The table, as CSV
        #[arg(long, short, value_name = "FILE", default_value = "results/plans.csv")]
        out: PathBuf,
    },
}

#[derive(Debug, Subcommand)]
enum PageCommand {
    /// Write the page of the chase: escape against speed and knowledge
    Chase {
        #[command(flatten)]
        results: ResultArgs,
        /// A table of single plans, as `pages plans` writes it
        #[arg(long, value_name = "FILE")]
        plans: Option<PathBuf>,
        /// File of the page
        #[arg(
            long,
            short,
            value_name = "FILE",
            default_value = "docs/results/chase.md"
        )]
        out: PathBuf,
    },
    /// Write the page of minimum-time plans: motion camouflage and local pursuit
    VmcLp {
        #[command(flatten)]
        results: ResultArgs,
        /// File of the page
        #[arg(
            long,
            short,
            value_name = "FILE",
            default_value = "docs/results/vmc-lp.md"
        )]
        out: PathBuf,
    },
    /// Write the page of patrols and coverage
    Patrol {
        #[command(flatten)]
        results: ResultArgs,
        /// File of the page
        #[arg(
            long,
            short,
            value_name = "FILE",
            default_value = "docs/results/patrol.md"
        )]
        out: PathBuf,
    },
}

#[derive(Debug, Args)]
struct ResultArgs {
    /// The directories of results, one of each experiment; the page lists missing ones
    #[arg(value_name = "DIR")]
    results: Vec<PathBuf>,
}

fn main() -> ExitCode {
    match run(&Command::parse()) {
        Ok(files) => {
            for file in files {
                println!("{}", file.display());
            }
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Executes a command; returns the files written.
fn run(command: &Command) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    match command {
        Command::Page(command) => {
            let (page, out) = made(command)?;
            Ok(page.write(out)?)
        }
        Command::Plans { count, out } => {
            save(&rrt_star::measure(*count)?.to_csv()?, out)?;
            Ok(vec![out.clone()])
        }
    }
}

/// Returns the page of a command, and its path.
fn made(command: &PageCommand) -> Result<(Page, &Path), Box<dyn Error>> {
    match command {
        PageCommand::Chase {
            results,
            plans,
            out,
        } => {
            let mut evidence = chase::Evidence::default();
            for directory in &results.results {
                evidence.add(&read(directory)?)?;
            }
            evidence.plans = plans.as_deref().map(Plans::read).transpose()?;
            Ok((chase::page(&evidence)?, out))
        }
        PageCommand::VmcLp { results, out } => {
            let mut evidence = vmc_lp::Evidence::default();
            for directory in &results.results {
                let results: PlanResults = read(directory)?;
                evidence.add(&results)?;
            }
            Ok((vmc_lp::page(&evidence)?, out))
        }
        PageCommand::Patrol { results, out } => {
            let mut evidence = patrol::Evidence::default();
            for directory in &results.results {
                evidence.add(&read(directory)?)?;
            }
            Ok((patrol::page(&evidence)?, out))
        }
    }
}

/// Reads the results of a sweep; prints the number of missing missions to stderr.
fn read<R: Record>(directory: &Path) -> Result<Results<R>, Box<dyn Error>> {
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
