//! Parameters of the process.

use serde::{Deserialize, Serialize};
use sim_backend::params::{ParamsError, finite, not_negative, positive, require, within};

/// How the optimiser plans.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// The path is a B-spline.
    #[default]
    Bspline,
    /// The path pursues a virtual prey on a B-spline.
    Lp,
    /// The path hides before a virtual prey on a B-spline.
    Vmc,
    /// The exact shortest path.
    Tangent,
}

/// From what path the optimiser starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Guess {
    /// The exact shortest path.
    #[default]
    Tangent,
    /// The wavefront on a grid.
    Wavefront,
}

/// What a robot does when something pops up on its way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AtPopup {
    /// Goes on along what of the old plan is still safe while the new one is made.
    #[default]
    Follow,
    /// Stops at once and waits for the new plan, as in the paper.
    Stop,
}

/// How plans are asked for; what is absent is the optimiser's choice.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PlanningParams {
    /// The method.
    pub method: Method,
    /// The path that it starts from.
    pub guess: Guess,
    /// Degree of the B-spline, 2…8.
    pub degree: Option<u32>,
    /// Control points of the B-spline, degree + 1…64.
    pub control_points: Option<u32>,
    /// N of the N + 1 nodes of `vmc`, 2…64.
    pub nodes: Option<u32>,
    /// Reference point of `vmc` [m].
    pub reference_point: Option<[f64; 2]>,
}

/// Parameters of the process `navigator`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct NavigatorParams {
    /// Where to drive, one after the other [m]; none: to the centre of the robot's `goal`.
    pub goals: Vec<[f64; 2]>,
    /// Whether to begin anew after the last of them.
    pub repeat: bool,
    /// How plans are asked for.
    pub plan: PlanningParams,
    /// Simulated time that planning takes [s], ≥ 0: a plan takes effect at the first tick so much
    /// later, and one tick later at least. In real time it takes effect when it has come, and this
    /// is the time that the optimiser is given.
    pub planning_time_s: f64,
    /// What happens at a pop-up.
    pub at_popup: AtPopup,
    /// Distance kept from obstacles beyond the radius [m], > 0: covers the tracking error.
    pub margin: f64,
    /// Distance from where the robot should be beyond which it stops and plans anew [m], > 0 and at
    /// most `margin`.
    pub max_error: f64,
    /// Share of the robot's speed limits that plans use, in (0, 1]: the rest is for corrections.
    pub speed_fraction: f64,
    /// Time for which another robot is let stand in the way before it is planned around [s], ≥ 0.
    pub patience_s: f64,
    /// Real time after which the optimiser counts as hung in lock-step [s], > 0; absent: four fifths
    /// of the time after which the run would take this process for the one that hangs.
    pub answer_timeout_s: Option<f64>,
}

impl Default for NavigatorParams {
    fn default() -> Self {
        Self {
            goals: Vec::new(),
            repeat: false,
            plan: PlanningParams::default(),
            planning_time_s: 0.05,
            at_popup: AtPopup::Follow,
            margin: 0.02,
            max_error: 0.015,
            speed_fraction: 1.0,
            patience_s: 0.5,
            answer_timeout_s: None,
        }
    }
}

impl NavigatorParams {
    /// As in the published experiments: local pursuit, and a stop at every pop-up on the way.
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

    /// Checks every field.
    ///
    /// # Errors
    /// [`ParamsError`] naming the first field that is out of range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        for (i, goal) in self.goals.iter().enumerate() {
            for (axis, &value) in goal.iter().enumerate() {
                finite(&format!("goals[{i}][{axis}]"), value)?;
            }
        }
        require(
            !self.repeat || self.goals.len() > 1,
            "repeat",
            &self.repeat,
            "false, or at least two `goals`",
        )?;
        self.plan.validate().map_err(within("plan"))?;
        not_negative("planning_time_s", self.planning_time_s)?;
        positive("margin", self.margin)?;
        positive("max_error", self.max_error)?;
        require(
            self.max_error <= self.margin,
            "max_error",
            &self.max_error,
            "at most `margin`",
        )?;
        require(
            self.speed_fraction > 0.0 && self.speed_fraction <= 1.0,
            "speed_fraction",
            &self.speed_fraction,
            "a number above 0 and at most 1",
        )?;
        not_negative("patience_s", self.patience_s)?;
        if let Some(time) = self.answer_timeout_s {
            let expected = "above 0 and at most 3600 [s]";
            require(
                time > 0.0 && time <= 3600.0,
                "answer_timeout_s",
                &time,
                expected,
            )?;
        }
        Ok(())
    }
}

impl PlanningParams {
    fn validate(&self) -> Result<(), ParamsError> {
        let range = |field, value: Option<u32>, low: u32, high: u32, expected| {
            let fits = value.is_none_or(|value| (low..=high).contains(&value));
            require(fits, field, &value.unwrap_or(0), expected)
        };
        range("degree", self.degree, 2, 8, "a number from 2 to 8")?;
        let least = self.degree.unwrap_or(2) + 1;
        let expected = "a number from `degree` + 1 to 64";
        range("control_points", self.control_points, least, 64, expected)?;
        range("nodes", self.nodes, 2, 64, "a number from 2 to 64")?;
        for (axis, value) in self.reference_point.iter().flatten().enumerate() {
            let field = format!("reference_point[{axis}]");
            finite(&field, *value)?;
            require(value.abs() <= 1e6, &field, value, "at most 1e6 m in size")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_out_of_range_is_named() {
        let refused = |text: &str| {
            let params: NavigatorParams = serde_json::from_str(text).unwrap();
            params.validate().unwrap_err().field
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
        assert_eq!(NavigatorParams::default().validate(), Ok(()));
        assert_eq!(NavigatorParams::paper().validate(), Ok(()));
    }
}
