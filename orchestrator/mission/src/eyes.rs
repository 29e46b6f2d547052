//! Who looks, from where, how far and how wide: what viewers and reports draw as seen.

use geometry::visibility::polygon::SightLimits;
use recorder::{EyeInfo, EyePlace};
use runtime::kind::Lookout;
use sim_backend::spec::RobotSpec;
use sim_backend::team::Team;

use scenario::ResolvedScenario;

/// The eyes of a scenario.
pub fn of_scenario(scenario: &ResolvedScenario) -> Vec<EyeInfo> {
    let robots = &scenario.world.robots;
    let lookouts = scenario.processes.iter().filter_map(|process| {
        let kind = process.program.kind()?;
        Some((&*process.name, kind.lookout(&process.robots, robots)?))
    });
    eyes(robots, lookouts)
}

/// The eyes of these processes, each with its name. Where none looks, the Police are drawn as if
/// they did.
pub fn eyes<'a>(
    robots: &[RobotSpec],
    lookouts: impl IntoIterator<Item = (&'a str, Lookout)>,
) -> Vec<EyeInfo> {
    let name = |robot: usize| robots.get(robot).map_or("", |robot| robot.name.as_str());
    let mut eyes: Vec<EyeInfo> = Vec::new();
    let mut looks = false;
    let mut add = |who: String, by: &str, place, limits: SightLimits| {
        let (range, field_of_view) = (limits.range, limits.field_of_view);
        let same = |eye: &EyeInfo| {
            eye.place == place && eye.range == range && eye.field_of_view == field_of_view
        };
        // What is seen twice from one place is drawn once.
        if !eyes.iter().any(same) {
            eyes.push(EyeInfo {
                name: format!("seen by {who}{by}"),
                place,
                range,
                field_of_view,
            });
        }
    };
    for (process, lookout) in lookouts {
        looks = true;
        let by = format!(" ({process})");
        let given = lookout.robots.iter().copied();
        for robot in given.filter(|&robot| robot < robots.len()) {
            let place = EyePlace::Robot(robot as u32);
            add(name(robot).to_owned(), &by, place, lookout.limits);
        }
        for [x, y] in lookout.points {
            add(
                format!("{x} {y}"),
                &by,
                EyePlace::Point([x, y]),
                lookout.limits,
            );
        }
    }
    if !looks {
        let police = (0..robots.len()).filter(|&robot| robots[robot].team == Team::Police);
        for robot in police {
            let place = EyePlace::Robot(robot as u32);
            add(name(robot).to_owned(), "", place, SightLimits::default());
        }
    }
    eyes
}

#[cfg(test)]
mod tests {
    use super::*;
    use kinds::load;

    fn names(target: &str, set: &[&str]) -> Vec<String> {
        let set: Vec<String> = set.iter().map(|&set| set.to_owned()).collect();
        let eyes = of_scenario(&load(target, &set, None).unwrap());
        eyes.into_iter().map(|eye| eye.name).collect()
    }

    #[test]
    fn perception_looks_from_all_police_within_its_limits() {
        let set = [
            "processes.perception.params.sensor.range=3",
            "processes.perception.params.sensor.field_of_view=2",
        ];
        let scenario = load("chase", &set.map(str::to_owned), None).unwrap();
        let eyes = of_scenario(&scenario);
        assert_eq!(eyes.len(), 4);
        for (robot, eye) in eyes.iter().enumerate() {
            assert_eq!(eye.place, EyePlace::Robot(robot as u32));
            assert_eq!((eye.range, eye.field_of_view), (Some(3.0), Some(2.0)));
        }
        assert_eq!(eyes[0].name, "seen by police_1 (perception)");
        let json = serde_json::to_value(&eyes[1]).unwrap();
        assert_eq!((&json["robot"], &json["range"]), (&1.into(), &3.0.into()));
    }

    #[test]
    fn without_perception_the_police_are_drawn_and_without_police_nobody() {
        assert_eq!(names("chase_exact", &[])[0], "seen by police_1");
        assert_eq!(names("hello", &[]), [""; 0]);
    }

    #[test]
    fn an_observer_looks_from_its_places_and_not_at_all_if_it_is_told_everything() {
        assert_eq!(names("patrol_square", &[]), [""; 0]);
        let places = "processes.observer.params.from_points=[[1.0, 0.5], [1.0, 0.5]]";
        assert_eq!(
            names(
                "patrol_square",
                &[places, "processes.observer.params.eyes.range=2"]
            ),
            ["seen by 1 0.5 (observer)"]
        );
    }
}
