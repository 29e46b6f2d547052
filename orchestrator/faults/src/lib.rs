//! Fault injection: a process of a run is killed, stopped or paused at a moment drawn from a seed.
//! Then the guarantees of a run (`docs/reference/guarantees.md`) are checked from outside: by
//! `/proc`, `/dev/shm`, the exit code, the summary and the log.
//!
//! * `faulty_run`: a run in a separate process with a separate runtime directory;
//! * `check`: checks of the guarantees.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

mod check;
mod faulty_run;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};
use serde::Serialize;

use scenario::ResolvedScenario;

use self::faulty_run::Baseline;

/// Kinds of faults.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FaultKind {
    /// A process is killed (SIGKILL).
    Kill,
    /// A process is stopped for good (SIGSTOP).
    Hang,
    /// A process is stopped for 0.2 s (SIGSTOP, SIGCONT).
    Pause,
    /// The orchestrator is killed (SIGKILL).
    KillOrchestrator,
}

impl FaultKind {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::Kill, Self::Hang, Self::Pause, Self::KillOrchestrator];

    /// Returns its name, and its effect in one line.
    pub fn describe(self) -> (&'static str, &'static str) {
        match self {
            Self::Kill => ("kill", "A process is killed (SIGKILL)"),
            Self::Hang => ("hang", "A process is stopped for good (SIGSTOP)"),
            Self::Pause => ("pause", "A process is stopped for 0.2 s (SIGSTOP, SIGCONT)"),
            Self::KillOrchestrator => ("kill-orchestrator", "The orchestrator is killed (SIGKILL)"),
        }
    }
}

/// A fault and its outcome.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outcome {
    /// Number of the fault, from 0.
    pub number: u64,
    /// Its kind.
    pub kind: FaultKind,
    /// Name of the target process.
    pub target: String,
    /// Index of that process in the run; 0 for the orchestrator, too.
    #[serde(skip)]
    index: usize,
    /// Moment of the fault, as a share of the real time of a mission without faults, 0 to 1.
    pub moment: f64,
    /// `true` if the fault was injected; `false` if the mission had ended before.
    pub injected: bool,
    /// Violated guarantees.
    pub broken: Vec<String>,
    /// Real time from the fault to the end of the mission (s).
    pub over_after_s: f64,
    /// Real time before the death of the orchestrator that is missing in the log (s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost_s: Option<f64>,
}

impl Outcome {
    /// Draws a fault.
    fn draw(options: &ChaosOptions, number: u64) -> Self {
        // A stream per fault: the first faults do not depend on how many follow.
        let mut random = ChaCha8Rng::seed_from_u64(options.seed);
        random.set_stream(number);
        let mut below = |count: usize| (random.next_u64() % count.max(1) as u64) as usize;
        let kind = options.kinds.get(below(options.kinds.len()));
        let kind = kind.copied().unwrap_or(FaultKind::Kill);
        let mut index = below(options.scenario.processes.len() + 1);
        let moment = below(1 << 24) as f64 / f64::from(1 << 24);
        let mut target = "simulator";
        if kind == FaultKind::KillOrchestrator {
            (index, target) = (0, "orchestrator");
        } else if let Some(position) = index.checked_sub(1) {
            target = &options.scenario.processes[position].name;
        }
        Self {
            number,
            kind,
            target: target.to_owned(),
            index,
            moment,
            injected: false,
            broken: Vec::new(),
            over_after_s: 0.0,
            lost_s: None,
        }
    }
}

/// Parameters of the faults.
#[derive(Debug, Clone)]
pub struct ChaosOptions {
    /// The mission.
    pub scenario: ResolvedScenario,
    /// Seed of the faults.
    pub seed: u64,
    /// Number of faults.
    pub faults: u64,
    /// The kinds to draw from, with equal probability.
    pub kinds: Vec<FaultKind>,
    /// Set by the caller (Ctrl-C): ends after the current fault.
    pub interrupted: Arc<AtomicBool>,
}

/// The outcome of all faults.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChaosReport {
    /// Every fault.
    pub outcomes: Vec<Outcome>,
    /// Number of injected faults.
    pub injected: u64,
    /// Number of violated guarantees.
    pub broken: u64,
    /// Real time (s).
    pub lasted_s: f64,
    /// `true` if it was interrupted.
    pub interrupted: bool,
}

/// Failure to inject faults at all.
#[derive(Debug, thiserror::Error)]
pub enum ChaosError {
    /// The mission fails without faults.
    #[error("without faults, the mission {0}")]
    Baseline(String),
    /// A program cannot be started, or a file cannot be written.
    #[error("{what}: {source}")]
    System {
        /// The attempt.
        what: String,
        /// The answer of the system.
        source: std::io::Error,
    },
}

/// Injects the faults one after the other, each into a new mission; calls `on_outcome` with each outcome.
///
/// # Errors
/// [`ChaosError`] if missions fail without faults, or the operating system refuses.
pub fn chaos(
    options: &ChaosOptions,
    mut on_outcome: impl FnMut(&Outcome),
) -> Result<ChaosReport, ChaosError> {
    let start = Instant::now();
    let baseline = Baseline::measure(&options.scenario)?;
    let mut outcomes = Vec::new();
    let interrupted = || options.interrupted.load(Ordering::SeqCst);
    for number in 0..options.faults {
        if interrupted() {
            break;
        }
        let mut outcome = Outcome::draw(options, number);
        check::inject(&options.scenario, &mut outcome, &baseline)?;
        on_outcome(&outcome);
        outcomes.push(outcome);
    }
    Ok(ChaosReport {
        injected: outcomes.iter().filter(|o| o.injected).count() as u64,
        broken: outcomes.iter().map(|o| o.broken.len() as u64).sum(),
        outcomes,
        lasted_s: start.elapsed().as_secs_f64(),
        interrupted: interrupted(),
    })
}

/// Describes a fault in one line, and each violated guarantee in another.
pub fn line(outcome: &Outcome) -> String {
    let (number, target, over_after_s) = (outcome.number, &outcome.target, outcome.over_after_s);
    let (kind, _) = outcome.kind.describe();
    let moment = 100.0 * outcome.moment;
    let what = if outcome.injected {
        format!("ended after {over_after_s:.2} s")
    } else {
        "not injected: the mission had ended".to_owned()
    };
    let mut line = format!("{number:5}  {kind} {target} at {moment:.0} %: {what}");
    for broken in &outcome.broken {
        line += &format!("\n       VIOLATED: {broken}");
    }
    line
}

/// Returns the result as text: every fault that violated a guarantee, and totals.
pub fn text(report: &ChaosReport) -> String {
    let broken = report.outcomes.iter().filter(|o| !o.broken.is_empty());
    let mut lines: Vec<String> = broken.map(line).collect();
    let lost = report.outcomes.iter().filter_map(|o| o.lost_s);
    lines.push(format!(
        "{} faults injected in {:.1} min, {} guarantees violated, at most {:.3} s of a log lost",
        report.injected,
        report.lasted_s / 60.0,
        report.broken,
        lost.fold(0.0, f64::max)
    ));
    lines.join("\n")
}
