//! What can be done to whom.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::Rng as _;
use serde::Serialize;

use super::ChaosOptions;
use super::mission::Course;

/// What is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum FaultKind {
    /// A process is killed (SIGKILL)
    Kill,
    /// A process is asked to end (SIGTERM)
    Terminate,
    /// A process is stopped for good (SIGSTOP): it lives and says nothing
    Hang,
    /// A process is stopped for a moment (SIGSTOP, SIGCONT)
    Pause,
    /// A process gets a tenth of its time for a while
    Slow,
    /// The orchestrator is killed (SIGKILL)
    KillOrchestrator,
    /// The orchestrator is asked to end (SIGTERM)
    TerminateOrchestrator,
    /// The orchestrator is stopped for a moment
    PauseOrchestrator,
}

impl FaultKind {
    /// Every kind.
    pub const ALL: [Self; 8] = [
        Self::Kill,
        Self::Terminate,
        Self::Hang,
        Self::Pause,
        Self::Slow,
        Self::KillOrchestrator,
        Self::TerminateOrchestrator,
        Self::PauseOrchestrator,
    ];

    /// As the command line writes it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kill => "kill",
            Self::Terminate => "terminate",
            Self::Hang => "hang",
            Self::Pause => "pause",
            Self::Slow => "slow",
            Self::KillOrchestrator => "kill-orchestrator",
            Self::TerminateOrchestrator => "terminate-orchestrator",
            Self::PauseOrchestrator => "pause-orchestrator",
        }
    }

    /// Whether it is done to the orchestrator.
    pub fn hits_orchestrator(self) -> bool {
        matches!(
            self,
            Self::KillOrchestrator | Self::TerminateOrchestrator | Self::PauseOrchestrator
        )
    }

    /// Whether a process is gone for good by it.
    pub fn is_failure(self) -> bool {
        matches!(self, Self::Kill | Self::Terminate | Self::Hang)
    }

    /// Whether everything goes on afterwards as if nothing had been.
    pub fn passes(self) -> bool {
        matches!(self, Self::Pause | Self::Slow | Self::PauseOrchestrator)
    }
}

/// What the processes of the mission do when they fail.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Policy {
    /// As the scenario says
    Scenario,
    /// Every process but the simulator is started again
    Restart,
}

/// A fault.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fault {
    /// What is done.
    pub kind: FaultKind,
    /// Name of the process that it is done to; the orchestrator's is `orchestrator`.
    pub target: String,
    /// In lock-step or by the clock.
    pub course: Course,
    /// What processes do when they fail.
    pub policy: Policy,
    /// When: share of the real time that the mission takes if it is left alone, 0 to 1.
    pub moment: f64,
}

impl Fault {
    /// Whether a process is gone for good by it.
    pub fn is_failure(&self) -> bool {
        self.kind.is_failure()
    }

    /// Whether everything goes on afterwards as if nothing had been.
    pub fn passes(&self) -> bool {
        self.kind.passes()
    }

    /// Draws one.
    pub(super) fn draw(options: &ChaosOptions, random: &mut ChaCha8Rng) -> Self {
        let mut below = |count: usize| (random.next_u64() % count.max(1) as u64) as usize;
        let kind = options.kinds.get(below(options.kinds.len()));
        let kind = kind.copied().unwrap_or(FaultKind::Kill);
        let mut targets = options.targets();
        let target = targets.swap_remove(below(targets.len()));
        let course = [Course::LockStep, Course::RealTime][below(2)];
        let policy = options.policies.get(below(options.policies.len()));
        let moment = below(1 << 24) as f64 / f64::from(1 << 24);
        Self {
            kind,
            target: if kind.hits_orchestrator() {
                "orchestrator".to_owned()
            } else {
                target
            },
            course,
            // In lock-step nothing is started again.
            policy: policy
                .copied()
                .filter(|_| course == Course::RealTime)
                .unwrap_or(Policy::Scenario),
            moment,
        }
    }
}
