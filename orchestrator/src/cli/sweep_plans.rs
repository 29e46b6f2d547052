//! `protean sweep plans`.

use std::path::PathBuf;
use std::process::ExitCode;

use indicatif::ProgressBar;

use super::{EXIT_FAILED, print};
use crate::chase_page::measure;
use crate::figures::save;

/// What `protean sweep plans` takes.
#[derive(Debug, clap::Args)]
pub(super) struct PlansArgs {
    /// Plans of every planner, with the Police where a game begins and again at random places
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    count: u32,
    /// The table, as CSV
    #[arg(long, short, value_name = "FILE", default_value = "results/plans.csv")]
    out: PathBuf,
}

/// Plans, writes the table and prints its name.
pub(super) fn write(args: &PlansArgs) -> ExitCode {
    match written(args) {
        Ok(()) => {
            print(&args.out.display().to_string());
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(EXIT_FAILED)
        }
    }
}

fn written(args: &PlansArgs) -> Result<(), Box<dyn std::error::Error>> {
    let bar = ProgressBar::new(0);
    let plans = measure(args.count, |done, of| {
        bar.set_length(of);
        bar.set_position(done);
    })?;
    bar.finish_and_clear();
    save(&plans.to_csv()?, &args.out)?;
    Ok(())
}
