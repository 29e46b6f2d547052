//! `protean plan`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::{Subcommand, ValueEnum};
use platform::atomic_file::AtomicFile;
use platform::eprintln;
use platform::output_format::OutputFormat;
use platform::progress::Progress;
use trajectory_problem::{Constraints, Guess, Method};

use super::common::{Expected, ForceArg, QuietArg, out};
use super::output::{EXIT_FAILED, EXIT_INVALID, EXIT_PARTIAL, create, print, write};
use super::plan_generate;
use super::run::handle_signals;
use plan::batch::{Settings, solve_all};
use plan::summary::Summary;
use plan::{Answer, Options, read};
use platform::machine::processors;

/// Help below the options.
pub const HELP: &str = "\
The file is a JSON array of instances. Fields: id, cm_per_px, vmax_px_s, wmax_rad_s, buffer_px, bounds_px
[x, y, x, y], start {x, y, theta}, start_speed or null, goal {x, y}, obstacles [{x, y, r}, {\"polygon\": [[x, y], …]}, …].
Optional fields: v_min (the speed backwards, negative; 0 for plans that only drive forwards; absent: -vmax_px_s),
goal.theta, goal_speed, start_turn_rate, wheel_speed_px_s with wheel_separation_px, acceleration_px_s2,
angular_acceleration_rad_s2. Lengths are in pixels, times in seconds, angles in radians. Other fields are ignored. `protean plan generate` writes such files.

--json prints one line for every instance, in the order of the file: id, status, honest, t_s, lower_bound_s, gap,
cpu_ms, min_clearance, method, iterations, control_points, basis, failed_searches, residual, length, error, and with
--samples samples [[t, x, y, theta, v, omega], …], in the units of the instance. status is planned, curve (no search in
the controls succeeded near it), fallback (the exact shortest path instead of the method's curve), no_path, infeasible,
not_honest (with --no-fallbacks), invalid or failed. basis is optimal (a local optimum in the controls), exact (as fast
as the lower bound) or curve (neither). honest is
true if the trajectory passes the trajectory check, which shares no code with the planner. cpu_ms is the CPU time of
the planning thread.

Exit codes: 0 every instance has an answer (no_path is one), 1 the results cannot be written, 2 wrong usage or a
malformed file, 3 some instances are invalid, or interrupted.";

/// Arguments of `protean plan`.
#[derive(Debug, clap::Args)]
pub struct PlanArgs {
    #[command(subcommand)]
    command: Option<PlanCommand>,
    #[command(flatten)]
    file: FileArgs,
}

/// Subcommands of `protean plan`.
#[derive(Debug, Subcommand)]
enum PlanCommand {
    /// Generate random instances to plan
    #[command(after_long_help = plan_generate::HELP)]
    Generate(plan_generate::GenerateArgs),
}

/// Arguments of `protean plan INSTANCES`.
#[derive(Debug, clap::Args)]
struct FileArgs {
    /// JSON file of instances (described at the end of --help)
    #[arg(required = true)]
    instances: Option<PathBuf>,
    #[command(flatten)]
    method: PlanMethodArgs,
    /// Plan only the first N instances
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    limit: Option<u32>,
    /// Plan N instances at once [default: number of processors]
    #[arg(long, short, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    jobs: Option<u16>,
    /// Plan each instance K times and report the minimum CPU time
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    repeat: u32,
    /// Print one JSON object for every instance
    #[arg(long)]
    json: bool,
    /// Add the samples of the trajectories to the JSON objects
    #[arg(long)]
    samples: bool,
    /// Write the JSON objects to FILE
    #[arg(long, short, value_name = "FILE", value_parser = out(OutputFormat::JSON))]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArg,
    #[command(flatten)]
    quiet: QuietArg,
}

/// Options of the planner.
#[derive(Debug, clap::Args)]
struct PlanMethodArgs {
    /// Planning method
    #[arg(long, value_enum, default_value_t = MethodName::Bspline)]
    method: MethodName,
    /// Initial path of the optimisation
    #[arg(long, value_enum, default_value_t = GuessName::Tangent)]
    guess: GuessName,
    /// Points of the curve at which obstacles are checked
    #[arg(long, value_enum, default_value_t = ConstraintsName::Dense)]
    constraints: ConstraintsName,
    /// Degree of the B-spline [default: 3; lp: 2]
    #[arg(long, value_name = "D")]
    degree: Option<usize>,
    /// Number of control points [default: depends on the path]
    #[arg(long, value_name = "N")]
    control_points: Option<usize>,
    /// Use N + 1 Legendre-Gauss-Lobatto nodes [default: 15]
    #[arg(long, value_name = "N")]
    nodes: Option<usize>,
    /// Reference point of vmc (px) [default: far outside the lower corner of the bounds]
    #[arg(long, value_name = "X,Y", value_parser = parse_point, allow_hyphen_values = true)]
    reference_point: Option<[f64; 2]>,
    /// Fail where the method gives no valid trajectory, instead of using the shortest path
    #[arg(long)]
    no_fallbacks: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum MethodName {
    /// Cubic B-spline
    Bspline,
    /// Local pursuit of a virtual prey on a B-spline
    Lp,
    /// Virtual motion camouflage towards a virtual prey on a B-spline
    Vmc,
    /// Exact shortest path with turns on the spot
    Tangent,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum GuessName {
    /// Exact shortest path
    Tangent,
    /// Shortened wavefront path on a grid
    Wavefront,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum ConstraintsName {
    /// Dense samples
    Dense,
    /// Nodes only
    Nodes,
}

fn parse_point(text: &str) -> Result<[f64; 2], Expected> {
    let read = || {
        let (x, y) = text.split_once(',')?;
        let point = [x.trim().parse().ok()?, y.trim().parse().ok()?];
        point.iter().all(|v: &f64| v.is_finite()).then_some(point)
    };
    read().ok_or_else(|| Expected("two numbers (px), for example -1800,-1800".to_owned()))
}

impl PlanMethodArgs {
    fn options(&self) -> Options {
        Options {
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
            ..Options::default()
        }
    }
}

/// Runs `protean plan`.
pub fn run(args: &PlanArgs) -> ExitCode {
    match &args.command {
        Some(PlanCommand::Generate(args)) => plan_generate::generate(args),
        None => plan(&args.file),
    }
}

/// Plans every instance of a file.
fn plan(args: &FileArgs) -> ExitCode {
    // clap requires the file unless there is a subcommand.
    let file = args.instances.as_deref().unwrap_or(Path::new(""));
    let options = args.method.options();
    if let Err(error) = options.validate() {
        eprintln!("error: --{}", error.to_string().replace('_', "-"));
        return ExitCode::from(EXIT_INVALID);
    }
    let mut elements = match read(file) {
        Ok(elements) => elements,
        Err(error) => {
            eprintln!("error: {error}");
            return ExitCode::from(EXIT_INVALID);
        }
    };
    let out = args.out.as_deref();
    let out = match out.map(|out| create(out, args.force.force)).transpose() {
        Ok(out) => out,
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
    // A panic of a planner becomes the error of its instance.
    std::panic::set_hook(Box::new(|_| ()));
    let settings = Settings {
        options,
        jobs: args.jobs.map_or_else(processors, usize::from),
        repeat: args.repeat,
    };
    let mut output = AnswerWriter::new(args, file, out, elements.len());
    let solved = solve_all(&elements, &settings, &interrupted, |index, answer| {
        output.add(index, answer);
    });
    let _ = std::panic::take_hook();
    output.progress.finish();
    if let Err(error) = solved {
        eprintln!("error: cannot start a thread: {error}; choose fewer --jobs");
        return ExitCode::from(EXIT_FAILED);
    }
    output.conclude(&settings.options, interrupted.load(Ordering::SeqCst))
}

/// Prints answers in the order of the file and counts them.
struct AnswerWriter<'a> {
    args: &'a FileArgs,
    file: &'a Path,
    progress: Progress,
    summary: Summary,
    total: usize,
    refused: usize,
    /// Lines that wait for earlier ones.
    waiting: BTreeMap<usize, String>,
    next: usize,
    out: Option<AtomicFile>,
    /// Content of the output file.
    lines: String,
}

impl<'a> AnswerWriter<'a> {
    fn new(args: &'a FileArgs, file: &'a Path, out: Option<AtomicFile>, total: usize) -> Self {
        Self {
            args,
            file,
            progress: Progress::new(total, 0, args.quiet.quiet, "plans"),
            summary: Summary::default(),
            total,
            refused: 0,
            waiting: BTreeMap::new(),
            next: 0,
            out,
            lines: String::new(),
        }
    }

    fn add(&mut self, index: usize, mut answer: Answer) {
        self.summary.add(&answer);
        if !answer.is_answer() {
            self.refused += 1;
            let file = self.file.display();
            let why = answer.error.as_deref().unwrap_or_default();
            self.progress
                .say(&format!("error: {file}: {}: {why}", answer.id));
        }
        self.progress.done(false, String::new);
        if !self.args.json && self.out.is_none() {
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
        while let Some(line) = self.waiting.remove(&self.next) {
            self.line(&line);
            self.next += 1;
        }
    }

    /// Writes the next line.
    fn line(&mut self, line: &str) {
        if self.args.json {
            print(line);
        }
        if self.out.is_some() {
            self.lines.push_str(line);
            self.lines.push('\n');
        }
    }

    fn conclude(mut self, options: &Options, interrupted: bool) -> ExitCode {
        // After an interruption, earlier lines may be missing; the order stays.
        for line in std::mem::take(&mut self.waiting).into_values() {
            self.line(&line);
        }
        if let (Some(file), Some(path)) = (self.out.take(), &self.args.out)
            && let Err(error) = write(file, path, &self.lines)
        {
            eprintln!("error: {error}");
            return ExitCode::from(EXIT_FAILED);
        }
        let stem = self.file.file_stem().map(Path::new);
        let name = stem.map_or_else(String::new, |s| s.display().to_string());
        let text = self.summary.text([&name, options.method.name()]);
        if !self.args.json {
            print(&text);
        } else if !self.args.quiet.quiet {
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
