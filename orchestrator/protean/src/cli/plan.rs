//! `protean plan`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::ValueEnum;
use platform::atomic_file::save;
use platform::eprintln;
use platform::progress::Progress;
use trajectory::Method;
use trajectory::options::{Constraints, Guess};

use super::output::{EXIT_FAILED, EXIT_INVALID, EXIT_PARTIAL, print};
use super::run::handle_signals;
use plan::batch::{Settings, solve_all};
use plan::summary::Summary;
use plan::{Answer, Element, PlanOptions, read};
use platform::machine::processors;

/// What stands below the options.
pub(super) const HELP: &str = "\
The file is a JSON array of instances: id, cm_per_px, vmax_px_s, wmax_rad_s, buffer_px,
bounds_px [x, y, x, y], start {x, y, theta}, start_speed or null, goal {x, y}, obstacles
[{x, y, r}, {\"polygon\": [[x, y], …]}, …]; perhaps goal.theta, goal_speed, start_turn_rate,
wheel_speed_px_s with wheel_separation_px, acceleration_px_s2, angular_acceleration_rad_s2. Lengths in
pixels, times in seconds, angles in radians. Other fields are ignored. `protean instances` makes such
files.

--json prints a line of JSON for every instance, in the order of the file: id, status, honest, t_s,
lower_bound_s, gap, cpu_ms, min_clearance, method, iterations, control_points, length, error, and
with --samples samples [[t, x, y, theta, v, omega], …]; in the instance's own units. status is planned,
fallback (the exact shortest path instead of the method's curve), no_path, infeasible, not_honest
(with --no-fallbacks), invalid or failed. honest says whether the plan keeps what the instance asks
for: checked again, by code that shares nothing with the planner. cpu_ms is the CPU time of the thread
that planned.

Exit codes: 0 every instance has its answer (that there is no path is one), 1 the results cannot be
written, 2 wrong usage or a file that is not of this form, 3 some instances are invalid, or it was
interrupted.";

/// What `protean plan` takes.
#[derive(Debug, clap::Args)]
pub(super) struct PlanArgs {
    /// A JSON file of instances (see the end of --help)
    instances: PathBuf,
    #[command(flatten)]
    how: PlanMethodArgs,
    /// Only the first N instances
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    limit: Option<u32>,
    /// Instances at once [default: as many as there are processors]
    #[arg(long, short, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    jobs: Option<u16>,
    /// Plan each instance K times and give the least CPU time
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    repeat: u32,
    /// Print a line of JSON for every instance, not the table
    #[arg(long)]
    json: bool,
    /// With the samples of the plans in the lines of JSON
    #[arg(long)]
    samples: bool,
    /// Write the lines of JSON to this file
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Show nothing but errors and the result
    #[arg(long, short)]
    quiet: bool,
}

/// How plans are made.
#[derive(Debug, clap::Args)]
struct PlanMethodArgs {
    /// The method
    #[arg(long, value_enum, default_value_t = MethodName::Bspline)]
    method: MethodName,
    /// From what path it starts
    #[arg(long, value_enum, default_value_t = GuessName::Tangent)]
    guess: GuessName,
    /// Where along the curve obstacles are looked at
    #[arg(long, value_enum, default_value_t = ConstraintsName::Dense)]
    constraints: ConstraintsName,
    /// Degree of the B-spline [default: 3, or 2 for the prey of lp]
    #[arg(long, value_name = "D")]
    degree: Option<usize>,
    /// Number of its control points [default: what the path needs]
    #[arg(long, value_name = "N")]
    control_points: Option<usize>,
    /// N of the N + 1 Legendre-Gauss-Lobatto nodes [default: 15]
    #[arg(long, value_name = "N")]
    nodes: Option<usize>,
    /// Reference point of vmc (px) [default: far beyond the lower corner of the bounds]
    #[arg(long, value_name = "X,Y", value_parser = parse_point, allow_hyphen_values = true)]
    reference_point: Option<[f64; 2]>,
    /// Try nothing else where the curve asked for is of no use
    #[arg(long)]
    no_fallbacks: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum MethodName {
    /// The path is a cubic B-spline
    Bspline,
    /// Local pursuit: the path pursues a virtual prey on a B-spline
    Lp,
    /// Virtual motion camouflage: the path hides before a virtual prey on a B-spline
    Vmc,
    /// The exact shortest path, with turns on the spot
    Tangent,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum GuessName {
    /// The exact shortest path
    Tangent,
    /// The wavefront on a grid, pulled taut
    Wavefront,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum ConstraintsName {
    /// Everywhere
    Dense,
    /// At the nodes only; what lies between two of them is not seen
    Nodes,
}

fn parse_point(text: &str) -> Result<[f64; 2], String> {
    let read = || {
        let (x, y) = text.split_once(',')?;
        let point = [x.trim().parse().ok()?, y.trim().parse().ok()?];
        point.iter().all(|v: &f64| v.is_finite()).then_some(point)
    };
    read().ok_or_else(|| "expected two numbers (px), for example -1800,-1800".to_owned())
}

impl PlanMethodArgs {
    fn options(&self) -> PlanOptions {
        PlanOptions {
            method: match self.method {
                MethodName::Bspline => Method::Bspline,
                MethodName::Lp => Method::Lp,
                MethodName::Vmc => Method::Vmc,
                MethodName::Tangent => Method::Tangent,
            },
            guess: match self.guess {
                GuessName::Tangent => Guess::Tangent,
                GuessName::Wavefront => Guess::Wavefront,
            },
            constraints: match self.constraints {
                ConstraintsName::Dense => Constraints::Dense,
                ConstraintsName::Nodes => Constraints::Nodes,
            },
            fallbacks: !self.no_fallbacks,
            degree: self.degree,
            control_points: self.control_points,
            nodes: self.nodes,
            reference_point: self.reference_point,
        }
    }
}

/// Plans every instance of a file.
pub(super) fn plan(args: &PlanArgs) -> ExitCode {
    let options = args.how.options();
    if let Err(error) = options.validate() {
        eprintln!("error: --{}", error.to_string().replace('_', "-"));
        return ExitCode::from(EXIT_INVALID);
    }
    let mut elements = match read(&args.instances) {
        Ok(elements) => elements,
        Err(error) => {
            eprintln!("error: {error}");
            return ExitCode::from(EXIT_INVALID);
        }
    };
    elements.truncate(args.limit.map_or(usize::MAX, |n| n as usize));
    let interrupted = Arc::new(AtomicBool::new(false));
    if let Err(error) = handle_signals(&interrupted) {
        eprintln!("error: cannot handle signals: {error}");
        return ExitCode::from(EXIT_FAILED);
    }
    // A planner that breaks down is said by its instance, in one line.
    std::panic::set_hook(Box::new(|_| ()));
    let settings = Settings {
        options,
        jobs: args.jobs.map_or_else(processors, usize::from),
        repeat: args.repeat,
    };
    let mut told = AnswerCounts::new(args, elements.len());
    let solved = solve_all(&elements, &settings, &interrupted, |index, answer| {
        told.tell(index, answer, &elements);
    });
    let _ = std::panic::take_hook();
    told.progress.finish();
    if let Err(error) = solved {
        eprintln!("error: cannot start a thread: {error}; choose fewer --jobs");
        return ExitCode::from(EXIT_FAILED);
    }
    told.conclude(&settings.options, interrupted.load(Ordering::SeqCst))
}

/// What has been said of the answers so far.
struct AnswerCounts<'a> {
    args: &'a PlanArgs,
    progress: Progress,
    summary: Summary,
    total: usize,
    refused: usize,
    /// Lines that wait for those before them.
    waiting: BTreeMap<usize, String>,
    next: usize,
    /// What goes to the file.
    lines: String,
}

impl<'a> AnswerCounts<'a> {
    fn new(args: &'a PlanArgs, total: usize) -> Self {
        Self {
            args,
            progress: Progress::new(total, 0, args.quiet, "plans"),
            summary: Summary::default(),
            total,
            refused: 0,
            waiting: BTreeMap::new(),
            next: 0,
            lines: String::new(),
        }
    }

    fn tell(&mut self, index: usize, mut answer: Answer, elements: &[Element]) {
        self.summary.add(&answer);
        if !answer.is_answer() {
            self.refused += 1;
            let file = self.args.instances.display();
            let why = answer.error.as_deref().unwrap_or_default();
            self.progress
                .say(&format!("error: {file}: {}: {why}", answer.id));
        }
        self.progress.done(false, String::new);
        if !self.args.json && self.args.out.is_none() {
            return;
        }
        if !self.args.samples {
            answer.samples = None;
        }
        match serde_json::to_string(&answer) {
            Ok(line) => {
                self.waiting.insert(index, line);
            }
            Err(error) => self.progress.say(&format!("error: {}: {error}", answer.id)),
        }
        debug_assert!(index < elements.len());
        while let Some(line) = self.waiting.remove(&self.next) {
            self.line(&line);
            self.next += 1;
        }
    }

    /// A line of the results whose turn it is.
    fn line(&mut self, line: &str) {
        if self.args.json {
            print(line);
        }
        if self.args.out.is_some() {
            self.lines.push_str(line);
            self.lines.push('\n');
        }
    }

    fn conclude(mut self, options: &PlanOptions, interrupted: bool) -> ExitCode {
        // After an interruption some are missing; what there is keeps its order.
        for line in std::mem::take(&mut self.waiting).into_values() {
            self.line(&line);
        }
        if let Some(out) = &self.args.out
            && let Err(error) = save(self.lines.as_bytes(), out)
        {
            eprintln!("error: {error}");
            return ExitCode::from(EXIT_FAILED);
        }
        let stem = self.args.instances.file_stem().map(Path::new);
        let name = stem.map_or_else(String::new, |s| s.display().to_string());
        let text = self.summary.text([&name, options.method.name()]);
        if !self.args.json {
            print(&text);
        } else if !self.args.quiet {
            eprintln!("{text}");
        }
        let missing = self.total - self.summary.answered;
        if interrupted && missing > 0 {
            eprintln!(
                "interrupted: {missing} of {} instances are missing",
                self.total
            );
        }
        if self.refused > 0 || (interrupted && missing > 0) {
            ExitCode::from(EXIT_PARTIAL)
        } else {
            ExitCode::SUCCESS
        }
    }
}
