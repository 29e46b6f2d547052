//! `protean reproduce`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use platform::eprintln;
use platform::machine::processors;
use platform::output_format::OutputFormat;
use reproduce::claim::{Paper, Verdict};
use reproduce::report::{Report, ReportError};
use reproduce::run::{self, Options, RunError, SeedChoice};
use scenario::kind;
use sweep::{Seeds, SweepError};

use super::common::{JsonArg, QuietArg, out};
use super::output::{EXIT_FAILED, EXIT_INVALID, EXIT_PARTIAL, print, print_json};
use super::run::handle_signals;

/// Help below the options.
pub(super) const HELP: &str = "\
Runs the experiments of the papers and writes reproduce.md, reproduce.json and reproduce.html: every published number
and statement beside ours, its interval, the number of observations and a verdict by a stated rule. The results of each
experiment are a folder beside them; pages has the pages of docs/results. On two cores all seeds take less than an hour,
--quick less than ten minutes.

The command may be interrupted or killed: the same command resumes it and repeats no finished mission. The same seeds
give the same bytes, except where CPU times are compared.

Exit codes: 0 all missions are done, 1 the results cannot be written, 2 wrong usage or a directory with other files,
3 missions failed or are missing.";

/// A paper on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum PaperArg {
    /// The chasing game
    Chase,
    /// Patrols with the cat map
    Patrol,
    /// Coverage with the Chebyshev map
    Coverage,
    /// Motion camouflage and local pursuit
    VmcLp,
}

impl From<PaperArg> for Paper {
    fn from(paper: PaperArg) -> Self {
        match paper {
            PaperArg::Chase => Self::Chase,
            PaperArg::Patrol => Self::Patrol,
            PaperArg::Coverage => Self::Coverage,
            PaperArg::VmcLp => Self::VmcLp,
        }
    }
}

/// Arguments of `protean reproduce`.
#[derive(Debug, clap::Args)]
pub(super) struct ReproduceArgs {
    /// Take a part of the seeds: less than ten minutes on two cores
    #[arg(long, conflicts_with = "seeds")]
    quick: bool,
    /// Seeds A to B, inclusive, of every experiment [default: the experiments']
    #[arg(long, value_name = "A..B")]
    seeds: Option<String>,
    /// Reproduce this paper only (repeatable)
    #[arg(long = "paper", value_name = "PAPER")]
    papers: Vec<PaperArg>,
    /// Write the results to directory DIR
    #[arg(long, short, value_name = "DIR", default_value = "results/reproduce", value_parser = out(OutputFormat::FOLDER))]
    out: PathBuf,
    /// Run N missions at once [default: number of processors]
    #[arg(long, short, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    jobs: Option<u16>,
    #[command(flatten)]
    quiet: QuietArg,
    #[command(flatten)]
    json: JsonArg,
}

/// Runs `protean reproduce`.
pub(super) fn run(kinds: &'static [kind::Kind], args: &ReproduceArgs) -> ExitCode {
    runtime::logging::start("warn");
    let interrupted = Arc::new(AtomicBool::new(false));
    if let Err(source) = handle_signals(&interrupted) {
        eprintln!("error: cannot handle signals: {source}");
        return ExitCode::from(EXIT_FAILED);
    }
    let seeds = match (args.quick, args.seeds.as_deref().map(Seeds::parse)) {
        (_, Some(Ok(seeds))) => SeedChoice::These(seeds),
        (_, Some(Err(error))) => {
            eprintln!("error: --seeds: {error}");
            return ExitCode::from(EXIT_INVALID);
        }
        (true, None) => SeedChoice::Quick,
        (false, None) => SeedChoice::All,
    };
    let chosen = |paper: &Paper| {
        args.papers.is_empty() || args.papers.iter().any(|&arg| Paper::from(arg) == *paper)
    };
    let options = Options {
        kinds,
        papers: Paper::ALL.into_iter().filter(chosen).collect(),
        seeds,
        jobs: args.jobs.map_or_else(processors, usize::from),
        quiet: args.quiet.quiet,
        interrupted,
    };
    let outcome = match run::run(&args.out, &options) {
        Ok(outcome) => outcome,
        Err(error) => {
            eprintln!("error: {error}");
            return ExitCode::from(exit_code(&error));
        }
    };
    if outcome.interrupted {
        eprintln!(
            "interrupted: the same command continues; the reports are written when all missions are done"
        );
        return ExitCode::from(EXIT_PARTIAL);
    }
    if let Err(error) = reported(&outcome, &options.papers, args) {
        eprintln!("error: {error}");
        return ExitCode::from(EXIT_FAILED);
    }
    if outcome.has_failures() {
        ExitCode::from(EXIT_PARTIAL)
    } else {
        ExitCode::SUCCESS
    }
}

/// Writes the reports and prints the result.
fn reported(
    outcome: &run::Outcome,
    papers: &[Paper],
    args: &ReproduceArgs,
) -> Result<(), ReportError> {
    let report = Report::new(outcome, papers)?;
    report.write(&args.out)?;
    if args.json.json {
        print_json(&report.json()?);
    } else {
        print(&summary(&report, &args.out));
    }
    Ok(())
}

/// Returns the number of claims of every paper by verdict, and the files.
fn summary(report: &Report, out: &Path) -> String {
    let mut text = String::new();
    for paper in &report.papers {
        let count = |verdict: &Verdict| {
            let count = paper.verdicts.get(verdict).copied().unwrap_or(0);
            (count > 0).then(|| format!("{count} {}", verdict.word()))
        };
        let counts: Vec<String> = Verdict::ALL.iter().filter_map(count).collect();
        text += &format!("{:9} {}\n", paper.paper.key(), counts.join(", "));
    }
    for (name, file) in [("table", "reproduce.md"), ("page", "reproduce.html")] {
        text += &format!("{name:9} {}\n", out.join(file).display());
    }
    text.trim_end().to_owned()
}

fn exit_code(error: &RunError) -> u8 {
    match error {
        RunError::Sweep(SweepError::Io { .. } | SweepError::Resource { .. })
        | RunError::Save(_)
        | RunError::Csv(_)
        | RunError::Measure(_) => EXIT_FAILED,
        _ => EXIT_INVALID,
    }
}
