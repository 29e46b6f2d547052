//! Colours of robots in output to a terminal.

use platform::terminal::Colours;
use robot::team::Role;
use scenario::ResolvedScenario;

/// Returns the names of the robots in the colours of their roles, which are those of the page of a log.
pub fn team_colours(scenario: &ResolvedScenario) -> Colours {
    let robots = scenario.world.robots.iter();
    let colour = |role| match role {
        Role::Pursuer => Some(32),
        Role::Evader => Some(166),
        Role::Neutral => None,
    };
    robots
        .filter_map(|robot| Some((robot.name.clone(), colour(robot.role())?)))
        .collect()
}
