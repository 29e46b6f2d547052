//! Colours of robots in output to a terminal.

use platform::terminal::Colours;
use scenario::ResolvedScenario;
use sim_backend::team::Team;

/// Returns the names of the robots in the colours of their teams, which are those of the page of a log.
pub fn team_colours(scenario: &ResolvedScenario) -> Colours {
    let robots = scenario.world.robots.iter();
    let colour = |team| match team {
        Team::Police => Some(32),
        Team::Evader => Some(166),
        Team::Neutral => None,
    };
    robots
        .filter_map(|robot| Some((robot.name.clone(), colour(robot.team)?)))
        .collect()
}
