//! Parameters of adversaries.

use metrics::detection::DetectionRule;
use nalgebra::Point2;
use parameters::{Parameters, ParamsError, above, at_least, between, each, require, unit, within};
use patrol::attack::{Method, Schedule, places_along};
use patrol::mission::MissionParams;

/// Longest duration, pause and window (s).
const MAX_TIME: f64 = 3600.0;

/// Maximum number of places.
const MAX_PLACES: usize = 2000;

parameters::table! {
    /// Parameters of adversaries.
    pub struct AttackerParams {
        /// Names of the robots that guard the places; empty: all.
        pub watch: Vec<String>,
        /// The adversaries, each independent of the others: at `random`; by the full `history` of visits; by mean and standard
        /// deviation of the times between visits (`statistical`); by the guards' method with other keys (`best_response`).
        #[schemars(length(min = 1))]
        pub methods: Vec<Method> = vec![Method::Random],
        /// Duration of an attack.
        pub duration_s: f64 [above(0).at_most(MAX_TIME).unit("s")] = 20.0,
        /// Distance from the place at which a guard detects an attack, whatever it sees.
        pub distance: f64 [at_least(0).unit("m")] = 1.0,
        /// Range at which a guard with a free line of sight to the place detects an attack, too; if absent, by `distance` only.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub sight: Option<f64> [above(0).unit("m")],
        /// The places; empty: those along the contour of `mission`.
        #[schemars(length(max = MAX_PLACES), transform = each(each(unit("m"))))]
        pub places: Vec<[f64; 2]>,
        /// Distance of the places along that contour.
        pub step: f64 [at_least(0.1).unit("m")] = 1.0,
        /// Time in which an adversary only watches.
        pub first_s: f64 [at_least(0).unit("s")] = 300.0,
        /// Time from the end of an attack until an adversary looks for the next one.
        pub pause_s: f64 [at_least(0).at_most(MAX_TIME).unit("s")] = 10.0,
        /// Time in which an adversary then begins an attack.
        pub window_s: f64 [at_least(0).at_most(MAX_TIME).unit("s")] = 60.0,
        /// Number of keys that `best_response` draws for each attack.
        pub samples: u32 [between(1, 1000)] = 32,
        /// Task of the guards, if they patrol a contour: its parameters but the key.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub mission: Option<MissionParams>,
    }
}

impl Parameters for AttackerParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        let mut methods = self.methods.clone();
        methods.sort_unstable();
        methods.dedup();
        require(
            methods.len() == self.methods.len(),
            "methods",
            &"a list with repetitions",
            "each method at most once",
        )?;
        let Some(mission) = &self.mission else {
            require(
                !self.methods.contains(&Method::BestResponse),
                "mission",
                &"absent",
                "the guards' task, which `best_response` knows",
            )?;
            return require(
                !self.places.is_empty(),
                "places",
                &"empty",
                "at least one place, or the guards' task in `mission`",
            );
        };
        require(
            mission.key.is_none(),
            "mission.key",
            &"given",
            "no key: an adversary does not know it",
        )?;
        mission.check_relations().map_err(within("mission"))?;
        let places = self.places().len();
        require(
            places <= MAX_PLACES,
            "step",
            &format!("{} ({places} places)", self.step),
            format!("at most {MAX_PLACES} places"),
        )
    }
}

impl AttackerParams {
    /// The places (m), at least one for valid parameters.
    pub fn places(&self) -> Vec<Point2<f64>> {
        let contour = self.mission.as_ref().and_then(|m| m.contour().ok());
        match contour {
            Some(contour) if self.places.is_empty() => places_along(&contour, self.step),
            _ => self.places.iter().map(|&place| place.into()).collect(),
        }
    }

    /// The times of attacks.
    pub fn schedule(&self) -> Schedule {
        Schedule {
            duration_s: self.duration_s,
            first_s: self.first_s,
            pause_s: self.pause_s,
            window_s: self.window_s,
        }
    }

    /// The way in which guards detect attacks.
    pub fn rule(&self) -> DetectionRule {
        DetectionRule {
            distance: self.distance,
            sight: self.sight.unwrap_or(0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value as Json, json};

    fn checked(values: &Json) -> Result<usize, String> {
        let params: AttackerParams = serde_json::from_value(values.clone()).unwrap();
        match parameters::check(&params) {
            Ok(()) => Ok(params.places().len()),
            Err(errors) => Err(errors.to_string()),
        }
    }

    #[test]
    fn places_are_given_or_along_the_contour_of_the_guards() {
        let contour = json!([[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0]]);
        let mission = json!({ "contour": contour, "t_max": 200.0 });
        let long =
            json!({ "contour": [[0.0, 0.0], [200.0, 0.0], [200.0, 200.0]], "t_max": 2000.0 });
        assert_eq!(checked(&json!({ "mission": mission })), Ok(80));
        assert_eq!(
            checked(&json!({ "mission": mission, "step": 0.5 })),
            Ok(160)
        );
        let given =
            json!({ "mission": mission, "places": [[1.0, 2.0]], "methods": ["best_response"] });
        assert_eq!(checked(&given), Ok(1));
        for (values, words) in [
            (json!({}), "`places`"),
            (
                json!({ "places": [[1.0, 2.0]], "methods": ["best_response"] }),
                "`mission`",
            ),
            (
                json!({ "places": [[1.0, 2.0]], "methods": ["random", "random"] }),
                "`methods`",
            ),
            (
                json!({ "places": [[1.0, 2.0]], "methods": [] }),
                "`methods`",
            ),
            (json!({ "mission": long, "step": 0.1 }), "`step`"),
            (
                json!({ "mission": { "contour": contour, "t_max": 200.0, "key": "catp:1,2" } }),
                "`mission.key`",
            ),
        ] {
            let found = checked(&values);
            assert!(
                found.as_ref().is_err_and(|text| text.contains(words)),
                "{values}: {found:?}"
            );
        }
    }
}
