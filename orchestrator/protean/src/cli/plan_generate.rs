//! `protean plan generate`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::builder::PossibleValuesParser;
use platform::eprintln;
use platform::output_format::OutputFormat;

use super::common::{ForceArg, out};
use super::output::{EXIT_FAILED, EXIT_INVALID, create, print, write};
use super::tips;
use plan::Recipe;
use plan::generate::{NAMES, with_reference};

/// Help below the options.
pub const HELP: &str = "\
Recipes (board 640 x 480 px at 0.75 cm/px, robot 15 cm/s and 16 rad/s, clearance 10 px):
  base       corner to corner, 10 to 20 discs of 5 to 15 px, heading 40 to 45 degrees
  ang0_90    base with a heading of 0 to 90 degrees
  obs1_10    base with 1 to 10 discs
  obs30_40   base with 30 to 40 discs
  rad20_30   base with radii of 20 to 30 px
  dense      base with 30 to 40 discs of 20 to 30 px; some have no path
  t3         start and goal at least 560 px apart, 5 discs of one radius of 20 to 35 px
  t4a        t3 with 3 discs
  t4b        the rest of a t4a instance from 36 % of its shortest path on, where 2 discs appear

Recipe and seed determine an instance. --count N --seed S gives the seeds S to S + N - 1. `reference` in the file holds
the length of the exact shortest path and the resulting lower bound of the time.";

/// Arguments of `protean plan generate`.
#[derive(Debug, clap::Args)]
pub struct GenerateArgs {
    /// Recipe (described at the end of --help)
    #[arg(value_parser = PossibleValuesParser::new(NAMES))]
    recipe: String,
    /// Number of instances
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    count: u32,
    /// Seed of the first instance
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = tips::seed)]
    seed: u64,
    /// Write the instances to FILE [default: stdout]
    #[arg(long, short, value_name = "FILE", value_parser = out(OutputFormat::JSON))]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArg,
}

/// Generates random instances.
pub fn generate(args: &GenerateArgs) -> ExitCode {
    let invalid = |text: &str| {
        eprintln!("error: {text}");
        ExitCode::from(EXIT_INVALID)
    };
    let Some(recipe) = Recipe::by_name(&args.recipe) else {
        return invalid("unknown recipe; see `protean plan generate --help`");
    };
    let Some(last) = args.seed.checked_add(u64::from(args.count) - 1) else {
        return invalid("--seed: the last seed would be larger than 2^64 - 1");
    };
    let out = args.out.as_deref();
    let file = match out.map(|out| create(out, args.force.force)).transpose() {
        Ok(file) => file,
        Err(error) => return invalid(&error.to_string()),
    };
    let mut without = 0;
    let lines: Vec<String> = (args.seed..=last)
        .map(|seed| {
            let id = format!("{}-{seed}", args.recipe);
            let json = with_reference(&recipe.instance(id, seed));
            without += usize::from(json["reference"]["feasible"] == false);
            json.to_string()
        })
        .collect();
    let text = format!("[\n{}\n]", lines.join(",\n"));
    if without > 0 {
        eprintln!("note: {without} of {} instances have no path", args.count);
    }
    match file.zip(out) {
        None => print(&text),
        Some((file, out)) => {
            if let Err(error) = write(file, out, format!("{text}\n")) {
                eprintln!("error: {error}");
                return ExitCode::from(EXIT_FAILED);
            }
            print(&out.display().to_string());
        }
    }
    ExitCode::SUCCESS
}
