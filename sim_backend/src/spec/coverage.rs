//! Specification of the visited area.

use geometry::extent::positive;
use parameters::Parameters;

parameters::table! {
    /// Accounting of the free area that robots have visited, and of the time since then.
    ///
    /// ```toml
    /// [rules.coverage]
    /// radius = 0.2
    /// teams = ["neutral"]
    /// ```
    pub struct CoverageSpec {
        /// Radius of the disc about a robot's centre that it visits, of its tool or its view (walls do
        /// not limit it). Each robot's own radius if absent.
        pub radius: Option<f64> [positive("m")],
        /// Side of the accounted cells, at most 16 million of them; that of the map's grid if absent.
        pub resolution: Option<f64> [positive("m")],
        /// Names of the robots that count, in addition to those of `teams`.
        pub robots: Vec<String>,
        /// Names of the teams whose robots count. All robots count if `robots` and `teams` are both empty.
        pub teams: Vec<String>,
        /// Time between two reports.
        pub period: f64 [positive("s")] = 1.0,
    }
}

impl CoverageSpec {
    /// Returns `true` if a robot counts.
    pub fn counts(&self, name: &str, team: &str) -> bool {
        (self.robots.is_empty() && self.teams.is_empty())
            || self.teams.iter().any(|counted| counted == team)
            || self.robots.iter().any(|robot| robot == name)
    }
}

impl Parameters for CoverageSpec {}

#[cfg(test)]
mod tests {
    use parameters::check;

    use super::*;

    #[test]
    fn without_a_choice_all_robots_count() {
        let all = CoverageSpec::default();
        assert!(all.counts("walle", "police"));
        let some: CoverageSpec = toml::from_str("robots = ['walle']\nteams = ['evader']").unwrap();
        assert!(some.counts("walle", "neutral"));
        assert!(some.counts("eve", "evader"));
        assert!(!some.counts("auto", "neutral"));
    }

    #[test]
    fn bad_fields_are_named() {
        for (text, field) in [
            ("radius = 0.0", "`radius` is 0"),
            ("resolution = -1.0", "`resolution` is -1"),
            ("period = nan", "`period` is NaN"),
        ] {
            let spec: CoverageSpec = toml::from_str(text).unwrap();
            let error = check(&spec).unwrap_err().to_string();
            assert!(error.contains(field), "{error}");
        }
        assert!(toml::from_str::<CoverageSpec>("radios = 1.0").is_err());
    }
}
