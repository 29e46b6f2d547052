//! Teams of robots: their roles in the game, and which of them are hostile.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Part that a team's robots take in the game.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "lowercase")]
#[repr(u8)]
pub enum Role {
    /// Takes no part in capture or escape (patrol, coverage, a single robot).
    Neutral = 0,
    /// Catches evaders of hostile teams.
    Pursuer = 1,
    /// Tries to reach an exit uncaught (the chasing-game paper's "Baddie").
    Evader = 2,
}

impl Role {
    /// All roles, by wire code.
    pub const ALL: [Self; 3] = [Self::Neutral, Self::Pursuer, Self::Evader];

    /// Returns the role with this wire code, as sent in messages; `None` for an unknown code.
    pub fn from_code(code: u8) -> Option<Self> {
        Self::ALL.get(usize::from(code)).copied()
    }

    /// Returns the wire code of the role.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// Returns the name of the role.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Neutral => "neutral",
            Self::Pursuer => "pursuer",
            Self::Evader => "evader",
        }
    }

    /// Returns the name of the team that has this role without stating it.
    pub const fn team(self) -> &'static str {
        match self {
            Self::Neutral => "neutral",
            Self::Pursuer => "police",
            Self::Evader => "evader",
        }
    }

    /// Returns the role of a team that need not state it; `None` for other teams.
    pub fn of_team(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|role| role.team() == name)
    }

    /// Returns the role of the robots that may be hostile to this one; `None` if there are none.
    pub const fn opposite(self) -> Option<Self> {
        match self {
            Self::Neutral => None,
            Self::Pursuer => Some(Self::Evader),
            Self::Evader => Some(Self::Pursuer),
        }
    }
}

/// Team of a robot among the teams of a run.
///
/// Hostility is mutual, and only between pursuers and evaders.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Team {
    /// Role of its robots.
    pub role: Role,
    /// Number of the team, below 64.
    number: u8,
    /// Numbers of the hostile teams, one bit each.
    hostile: u64,
}

impl Team {
    /// Returns the teams of robots `0..robots`, at most 64 teams, from the role of each robot and relations between two of
    /// them: same team, and hostile.
    pub fn of_robots(
        robots: usize,
        role: impl Fn(usize) -> Role,
        is_same: impl Fn(usize, usize) -> bool,
        is_hostile: impl Fn(usize, usize) -> bool,
    ) -> Vec<Self> {
        let mut firsts: Vec<usize> = Vec::new();
        let numbers: Vec<usize> = (0..robots)
            .map(|i| {
                let known = firsts.iter().position(|&first| is_same(first, i));
                known.unwrap_or_else(|| {
                    firsts.push(i);
                    firsts.len() - 1
                })
            })
            .collect();
        let bit = |number: usize| 1_u64.checked_shl(number as u32).unwrap_or(0);
        let team = |(i, &number): (usize, &usize)| {
            let hostile = firsts.iter().enumerate();
            let hostile = hostile.filter(|&(_, &first)| is_hostile(i, first));
            Self {
                role: role(i),
                number: number.min(usize::from(u8::MAX)) as u8,
                hostile: hostile.fold(0, |bits, (other, _)| bits | bit(other)),
            }
        };
        numbers.iter().enumerate().map(team).collect()
    }

    /// Returns `true` if the robots of the two teams are hostile to each other.
    pub fn is_hostile_to(self, other: Self) -> bool {
        1_u64.checked_shl(u32::from(other.number)).unwrap_or(0) & self.hostile != 0
    }

    /// Returns `true` if the same teams are hostile to it and to another one.
    pub fn has_opponents_of(self, other: Self) -> bool {
        self.hostile == other.hostile
    }

    /// Returns `true` if it is the same team.
    pub fn is_same(self, other: Self) -> bool {
        self.number == other.number
    }
}

/// The only team of this role, hostile to that of the opposite role.
impl From<Role> for Team {
    fn from(role: Role) -> Self {
        Self {
            role,
            number: role.code(),
            hostile: role.opposite().map_or(0, |other| 1 << other.code()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_and_names_map_back() {
        for role in Role::ALL {
            assert_eq!(Role::from_code(role.code()), Some(role));
            assert_eq!(Role::of_team(role.team()), Some(role));
        }
        assert_eq!(Role::from_code(3), None);
        assert_eq!(Role::of_team("guards"), None);
    }

    #[test]
    fn hostility_is_that_of_the_teams() {
        // Robots 0 and 2 are of one team, which is hostile to that of robot 3.
        let names = ["a", "b", "a", "c"];
        let hostile = |i: usize, j: usize| matches!((names[i], names[j]), ("a", "c") | ("c", "a"));
        let is_same = |i: usize, j: usize| names[i] == names[j];
        let teams = Team::of_robots(4, |_| Role::Pursuer, is_same, hostile);
        for i in 0..4 {
            for j in 0..4 {
                assert_eq!(teams[i].is_hostile_to(teams[j]), hostile(i, j));
                assert_eq!(teams[i].is_same(teams[j]), is_same(i, j));
            }
        }
    }
}
