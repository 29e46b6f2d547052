//! Parameters of the process.

use parameters::{Parameters, ParamsError, above, at_least, between, each, require, unit, within};
use trajectory_problem::{Guess, Method};

parameters::choice! {
    /// Reaction of a robot to an obstacle that appears on its path.
    pub enum AtPopup {
        /// Follows the part of the old plan that is still safe while the optimiser computes a new one.
        #[default]
        Follow,
        /// Stops at once and waits for the new plan, as in the paper.
        Stop,
    }
}

parameters::table! {
    /// Parameters of requests for plans; the optimiser's defaults hold for absent ones.
    #[derive(Copy)]
    pub struct PlanningParams {
        /// The method.
        pub method: Method,
        /// The path that it starts from.
        pub guess: Guess,
        /// Degree of the B-spline.
        pub degree: Option<u32> [between(2, 8)],
        /// Control points of the B-spline, more than `degree`.
        pub control_points: Option<u32> [between(3, 64)],
        /// N of the N + 1 nodes of `vmc`.
        pub nodes: Option<u32> [between(2, 64)],
        /// `true` for plans that may drive backwards, up to the robot's `v_reverse_max`.
        pub backwards: bool,
        /// Reference point of `vmc`.
        pub reference_point: Option<[f64; 2]> [each(between(-1e6, 1e6)).unit("m")],
    }
}

parameters::table! {
    /// Parameters of the process `navigator`.
    pub struct NavigatorParams {
        /// Goals to visit, in this order; none: the centre of the robot's `goal`.
        pub goals: Vec<[f64; 2]> [each(each(unit("m")))],
        /// `true` to begin again after the last goal.
        pub repeat: bool = false,
        /// Parameters of requests for plans.
        pub plan: PlanningParams,
        /// Simulated planning time: a plan takes effect at the first tick that much later, at least one
        /// tick later. In real time it takes effect on arrival, and this is the optimiser's time limit.
        pub planning_time_s: f64 [at_least(0).unit("s")] = 0.05,
        /// Reaction to an obstacle that appears on the path.
        pub at_popup: AtPopup = AtPopup::Follow,
        /// Distance kept from obstacles beyond the radius: covers the tracking error.
        pub margin: f64 [above(0).unit("m")] = 0.02,
        /// Largest tracking error, at most `margin`: a robot with a larger error stops and replans.
        pub max_error: f64 [above(0).unit("m")] = 0.015,
        /// Share of the robot's speed limits that plans use: the rest is for corrections.
        pub speed_fraction: f64 [above(0).at_most(1)] = 1.0,
        /// Time for which another robot may block the path before the robot plans around it.
        pub patience_s: f64 [at_least(0).unit("s")] = 0.5,
    }
}

impl Parameters for NavigatorParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        require(
            !self.repeat || self.goals.len() > 1,
            "repeat",
            &self.repeat,
            "false, or at least two `goals`",
        )?;
        self.plan.check_relations().map_err(within("plan"))?;
        require(
            self.max_error <= self.margin,
            "max_error",
            &self.max_error,
            "at most `margin`",
        )
    }
}

impl NavigatorParams {
    /// Returns the values of the published experiments: local pursuit, and a stop at every new
    /// obstacle on the path.
    pub fn paper() -> Self {
        Self {
            plan: PlanningParams {
                method: Method::Lp,
                guess: Guess::Wavefront,
                ..PlanningParams::default()
            },
            at_popup: AtPopup::Stop,
            ..Self::default()
        }
    }
}

impl Parameters for PlanningParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        let least = self.degree.unwrap_or(2) + 1;
        let points = self.control_points.unwrap_or(least);
        let expected = "a number from `degree` + 1 to 64";
        require(points >= least, "control_points", &points, expected)
    }
}

#[cfg(test)]
mod tests {
    use parameters::check;

    use super::*;

    #[test]
    fn values_out_of_range_are_reported() {
        let refused = |text: &str| {
            let params: NavigatorParams = serde_json::from_str(text).unwrap();
            check(&params).unwrap_err().field
        };
        for (text, field) in [
            (r#"{"margin": 0.0}"#, "margin"),
            (r#"{"max_error": 0.5}"#, "max_error"),
            (r#"{"repeat": true, "goals": [[1.0, 2.0]]}"#, "repeat"),
            (r#"{"speed_fraction": 1.5}"#, "speed_fraction"),
            (r#"{"planning_time_s": -1.0}"#, "planning_time_s"),
            (r#"{"plan": {"degree": 1}}"#, "plan.degree"),
            (
                r#"{"plan": {"degree": 3, "control_points": 3}}"#,
                "plan.control_points",
            ),
            (r#"{"plan": {"nodes": 65}}"#, "plan.nodes"),
            (
                r#"{"plan": {"reference_point": [0.0, 1e9]}}"#,
                "plan.reference_point[1]",
            ),
        ] {
            assert_eq!(refused(text), field);
        }
        assert_eq!(check(&NavigatorParams::default()), Ok(()));
        assert_eq!(check(&NavigatorParams::paper()), Ok(()));
    }
}
