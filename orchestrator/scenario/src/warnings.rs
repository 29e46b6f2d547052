//! Probable mistakes in a valid scenario.

use sim_backend::team::Team;

use super::resolved::ResolvedScenario;

impl ResolvedScenario {
    /// Returns one line for every probable mistake in the rules.
    pub fn warnings(&self) -> Vec<String> {
        let Some(capture) = self.rules().capture else {
            return Vec::new();
        };
        let widest = |team: Team| {
            let robots = self.world.robots.iter().filter(|r| r.team == team);
            robots.map(|r| r.model().radius).reduce(f64::max)
        };
        let (Some(police), Some(evader)) = (widest(Team::Police), widest(Team::Evader)) else {
            return Vec::new();
        };
        let contact = police + evader;
        if capture.radius >= contact {
            return Vec::new();
        }
        vec![format!(
            "rules.capture.radius is {} m, below the sum of the radii of a Police robot and an evader ({contact} m): \
             they touch before a capture",
            capture.radius
        )]
    }
}
