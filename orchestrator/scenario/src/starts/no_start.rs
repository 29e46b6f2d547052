//! A robot whose start cannot be drawn.

use config::Diagnostic;

use super::Draw;

/// Maximum number of draws for one robot until its start is allowed.
pub const MAX_DRAWS: usize = 1000;

/// Reason why a drawn start is not allowed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fault {
    /// Outside the region.
    Region,
    /// Touches a wall or lies outside the map.
    Wall,
    /// Too near to another robot.
    Robot,
    /// Too near to an exit.
    Exit,
    /// No way to an exit or to the goal.
    Reach,
}

impl Fault {
    const ALL: [Self; 5] = [
        Self::Region,
        Self::Wall,
        Self::Robot,
        Self::Exit,
        Self::Reach,
    ];

    fn words(self) -> &'static str {
        match self {
            Self::Region => "outside the region",
            Self::Wall => "in a wall",
            Self::Robot => "too near to another robot",
            Self::Exit => "too near to an exit",
            Self::Reach => "without a way to an exit or the goal",
        }
    }

    fn remedy(self) -> &'static str {
        match self {
            Self::Region | Self::Wall => "a region with free places",
            Self::Robot => "a larger region, fewer robots or smaller distances",
            Self::Exit => "a region away from the exits, or a smaller exit_distance",
            Self::Reach => "a region from which an evader reaches an exit and a robot its goal",
        }
    }
}

/// A robot without an allowed start in `MAX_DRAWS` draws, with the reasons.
#[derive(Debug, Clone, Copy)]
pub struct NoStart {
    /// Index of the robot.
    pub index: usize,
    draw: Draw,
    /// Number of draws by their fault.
    refused: [usize; Fault::ALL.len()],
}

impl NoStart {
    /// A robot before its first draw.
    pub(super) fn new(index: usize, draw: Draw) -> Self {
        Self {
            index,
            draw,
            refused: [0; Fault::ALL.len()],
        }
    }

    /// Counts a draw that is not allowed.
    pub(super) fn count(&mut self, fault: Fault) {
        if let Some(count) = self.refused.get_mut(fault as usize) {
            *count += 1;
        }
    }

    /// Returns the key that sets the draw.
    pub fn key(&self) -> &'static str {
        self.draw.key()
    }

    /// Returns the most frequent reason.
    fn main_fault(&self) -> Fault {
        let counted = Fault::ALL.into_iter().zip(self.refused);
        let first = (Fault::Region, 0);
        let (fault, _) = counted.fold(
            first,
            |most, next| if next.1 > most.1 { next } else { most },
        );
        fault
    }

    /// Returns the message about the robot with this name.
    pub fn message(&self, name: &str) -> String {
        format!("robot `{name}` has no allowed start in {MAX_DRAWS} draws")
    }

    /// Adds the counts of the reasons, and the remedy, to a problem.
    pub fn explain(&self, problem: Diagnostic) -> Diagnostic {
        let counted = Fault::ALL.into_iter().zip(self.refused);
        let reasons: Vec<String> = counted
            .filter(|(_, count)| *count > 0)
            .map(|(fault, count)| format!("{count} draws {}", fault.words()))
            .collect();
        let remedy = match self.draw {
            Draw::Jitter(_) => "room around the start, or less jitter",
            Draw::Random(_) => self.main_fault().remedy(),
        };
        problem.value(reasons.join(", ")).expected(remedy)
    }
}
