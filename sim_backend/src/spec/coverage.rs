//! Which area counts as visited.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::positive;
use crate::params::ParamsError;
use crate::team::Team;

/// Accounting of the free area that robots have visited, and of how long it has been since.
///
/// ```toml
/// [rules.coverage]
/// radius = 0.2
/// teams = ["neutral"]
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct CoverageSpec {
    /// Radius of the disc about a robot's centre that it visits (m), > 0: of its tool, or of what
    /// it sees (walls do not limit it). Each robot's own radius if absent.
    pub radius: Option<f64>,
    /// Side of the cells that are accounted for (m), > 0; that of the map's grid if absent.
    pub resolution: Option<f64>,
    /// Names of the robots that count, beside those of `teams`.
    pub robots: Vec<String>,
    /// Teams whose robots count. All robots count if `robots` and `teams` are both empty.
    pub teams: Vec<Team>,
    /// Time between two reports (s), > 0.
    pub period: f64,
}

impl Default for CoverageSpec {
    fn default() -> Self {
        Self {
            radius: None,
            resolution: None,
            robots: Vec::new(),
            teams: Vec::new(),
            period: 1.0,
        }
    }
}

impl CoverageSpec {
    /// Whether a robot counts.
    pub fn counts(&self, name: &str, team: Team) -> bool {
        (self.robots.is_empty() && self.teams.is_empty())
            || self.teams.contains(&team)
            || self.robots.iter().any(|robot| robot == name)
    }

    /// Checks every field by itself.
    ///
    /// # Errors
    /// Names the first field that is out of its range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        if let Some(radius) = self.radius {
            positive("radius", radius, "m")?;
        }
        if let Some(resolution) = self.resolution {
            positive("resolution", resolution, "m")?;
        }
        positive("period", self.period, "s")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_a_choice_all_robots_count() {
        let all = CoverageSpec::default();
        assert!(all.counts("walle", Team::Police));
        let some: CoverageSpec = toml::from_str("robots = ['walle']\nteams = ['evader']").unwrap();
        assert!(some.counts("walle", Team::Neutral));
        assert!(some.counts("eve", Team::Evader));
        assert!(!some.counts("auto", Team::Neutral));
    }

    #[test]
    fn bad_fields_are_named() {
        for (text, field) in [
            ("radius = 0.0", "`radius` is 0"),
            ("resolution = -1.0", "`resolution` is -1"),
            ("period = nan", "`period` is NaN"),
        ] {
            let spec: CoverageSpec = toml::from_str(text).unwrap();
            let error = spec.validate().unwrap_err().to_string();
            assert!(error.contains(field), "{error}");
        }
        assert!(toml::from_str::<CoverageSpec>("radios = 1.0").is_err());
    }
}
